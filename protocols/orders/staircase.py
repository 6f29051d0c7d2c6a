"""Up-down staircases as values: yes leads down a list of levels, no leads up.

Transformed (Levitt 1971: 1 up 2 down settles where yes has the probability sqrt(1/2) = 0.707) and weighted
(Kaernbach 1991: equal drift where p(yes) x down = p(no) x up).
"""

from __future__ import annotations

from dataclasses import dataclass, replace


@dataclass(frozen=True)
class Staircase:
    """One staircase at one moment.

    levels:    what can be shown, hardest first; place: index of the one to show next.
    down_after, up_after: yes or no in a row before a move; down, up: levels of a move, times the step.
    steps:     levels per step before the first reversal, after it, after the second, ...; the last is kept.
    run:       yes in a row since the last move, or minus the no in a row.
    direction: of the last move: -1 down, 1 up, 0 before the first.
    reversals: levels shown when the direction changed; stops_after: how many of them end the staircase, None never.
    """

    levels: tuple[float, ...]
    place: int
    down_after: int = 2
    up_after: int = 1
    down: int = 1
    up: int = 1
    steps: tuple[int, ...] = (1,)
    run: int = 0
    direction: int = 0
    reversals: tuple[float, ...] = ()
    stops_after: int | None = None

    @property
    def ended(self) -> bool:
        """True once it has turned as often as it is to (Levitt 1971: tracks of so many runs); then nothing moves it."""
        return self.stops_after is not None and len(self.reversals) >= self.stops_after

    @property
    def level(self) -> float:
        """The level to show next."""
        return self.levels[self.place]

    @property
    def settles_at(self) -> float | None:
        """The probability of yes around which the staircase settles; None where no closed form is known.

        1 up n down: p^n = 1/2 (Levitt 1971, table I), and 1 down n up its mirror image; weighted: p down = (1 - p) up,
        so p = up / (up + down) (Kaernbach 1991, equation 1).
        """
        if self.down_after == self.up_after == 1:
            return self.up / (self.up + self.down)
        if self.up == self.down and self.up_after == 1:
            return float(0.5 ** (1.0 / self.down_after))
        if self.up == self.down and self.down_after == 1:
            return float(1.0 - 0.5 ** (1.0 / self.up_after))
        return None

    def after(self, level: float, yes: bool) -> Staircase:
        """The staircase once `level` was shown and answered."""
        if self.ended:
            return self
        here = self.levels.index(level)
        run = max(self.run, 0) + 1 if yes else min(self.run, 0) - 1
        if -self.up_after < run < self.down_after:
            return replace(self, place=here, run=run)
        direction = -1 if run > 0 else 1
        turned = self.direction == -direction
        reversals = (*self.reversals, level) if turned else self.reversals
        step = self.steps[min(len(reversals), len(self.steps) - 1)]
        moved = here + direction * step * (self.down if run > 0 else self.up)
        place = min(max(moved, 0), len(self.levels) - 1)
        return replace(self, place=place, run=0, direction=direction, reversals=reversals)


def fewest_trials(reversals: int, down_after: int, up_after: int) -> int:
    """Trials that a staircase needs at least to turn so often: one run more than reversals, each of one move."""
    longer, shorter = max(down_after, up_after), min(down_after, up_after)
    runs = reversals + 1
    return (runs + 1) // 2 * shorter + runs // 2 * longer


def reversal_mean(staircase: Staircase, leave_out: int = 2) -> float | None:
    """The mean level of an even number of the reversals after the first ones (Levitt 1971); None without any."""
    kept = staircase.reversals[leave_out:]
    kept = kept[len(kept) % 2 :]
    return sum(kept) / len(kept) if kept else None
