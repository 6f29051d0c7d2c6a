"""`gaitlab replay`: every logged frame of a run made again and checked, and a film of what was seen."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path

from experiment_app.errors import UsageError
from experiment_app.opening import recorded_plan, recorded_versions
from experiment_app.pictures.film import Pixels, write_film
from experiment_app.replay.film import film_length, trial_film
from experiment_app.replay.frames import replayed_frames
from experiment_app.replay.recorded import RecordedTrial, recorded_trials
from experiment_app.run_folder import Run, run_at
from experiment_app.terminal import ShowProgress
from protocols.plan import Plan


@dataclass(frozen=True)
class Checked:
    """What became of a trial: how many frames it had, and the numbers of those that are not what was drawn."""

    trial: RecordedTrial
    frames: int
    different: tuple[int, ...]

    @property
    def sentence(self) -> str:
        """One line for people."""
        if not self.different:
            return f"{self.trial.name}: {self.frames} frames, every pose as it was drawn"
        first = self.trial.frames["flips"][self.different[0]] - self.trial.begun["time"]
        return (
            f"{self.trial.name}: {len(self.different)} of {self.frames} poses differ from what was drawn, "
            f"the first {first:.3f} s after onset"
        )


def opened(place: Path, number: int | None, practice: bool) -> tuple[Run, Plan, list[RecordedTrial]]:
    """The run at a path (its folder or its journal), its plan and the trials wanted; raises UsageError without any."""
    run = run_at(place)
    recorded = list(recorded_trials(run.lines))
    of_kind = [trial for trial in recorded if trial.begun["practice"] == practice]
    trials = [trial for trial in of_kind if number in (None, trial.begun["number"])]
    if not trials:
        drawn = sorted(trial.begun["number"] for trial in of_kind)
        what = "training trial" if practice else "trial"
        if drawn:
            raise UsageError(f"--trial {number}: {run.journal} has {what}s {drawn[0]} to {drawn[-1]} with frames.")
        if recorded and not practice:
            raise UsageError(f"{run.journal} has no finished trial but training trials; say --practice for those.")
        raise UsageError(
            f"{run.journal} has no finished {what} with a log of its frames; simulated runs draw nothing, so replay a "
            "run of `gaitlab run` or of `gaitlab demo`."
        )
    return run, recorded_plan(run), trials


def check_trial(plan: Plan, trial: RecordedTrial) -> Checked:
    """Every frame of a trial made again and compared by the checksum of its poses."""
    same = [frame.same for frame in replayed_frames(plan, trial)]
    return Checked(trial, len(same), tuple(number for number, one in enumerate(same) if not one))


def film_trials(
    plan: Plan, trials: list[RecordedTrial], path: Path, rate: Fraction, size: tuple[int, int], progress: ShowProgress
) -> str:
    """Films the trials one after the other into one file, and says what was verified of it."""

    def pictures() -> Iterator[Pixels]:
        for trial in trials:
            yield from trial_film(trial, list(replayed_frames(plan, trial)), rate, size)

    count = sum(film_length(trial, rate) for trial in trials)
    return write_film(iter(progress(pictures(), count, "Drawing")), rate, path)


def changed_versions(run: Run) -> list[str]:
    """Sentences on the programs that are not those the run was recorded with."""
    then, now = run.header.get("versions", {}), recorded_versions()
    return [
        f"{name} was {then[name]}, here it is {now[name]}"
        for name in ("gaitlab", "numpy", "scipy")
        if name in then and name in now and then[name] != now[name]
    ]
