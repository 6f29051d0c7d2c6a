"""The order of trials as a study file may write it: a word, or a mapping with squares, limits or adaptive placement."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Field

from protocols.parts import Name, Number, Part, Text


def _as_list(value: Any) -> Any:
    return [value] if isinstance(value, str) else value


def _as_mapping(value: Any) -> Any:
    return {"kind": value} if isinstance(value, str) else value


Factors = Annotated[
    list[Name], BeforeValidator(_as_list, json_schema_input_type=str | list[str]), Field(min_length=1)
]  # fmt: skip
Limit = Annotated[int, Field(strict=True, ge=1, le=1000)]
Stop = Annotated[
    int, Field(strict=True, ge=4, le=1000, description="4 at least: a threshold leaves out the first two.")
]
Distance = Annotated[int, Field(strict=True, ge=2, le=1000, description="1 is the next trial.")]


class ListOrder(Part):
    """An order that is known before the first trial."""

    kind: Literal["random", "blocked", "sequential", "latin_square", "balanced_latin_square"] = Field(
        description="random: all trials shuffled; blocked: every condition once per block, shuffled; sequential: as in "
        "the file; latin_square: by the participant's row of the square; balanced_latin_square: a square in which "
        "every condition also follows every other equally often (Williams 1949)."
    )
    of: Factors | None = Field(
        None, description="Of a square: the factor(s) whose levels are blocks; the conditions themselves if left out."
    )
    at_most_in_a_row: dict[Name, Limit] = Field(
        default_factory=dict, description="Factor: the most trials in a row with one of its levels."
    )
    at_least_apart: dict[Name, Distance] = Field(
        default_factory=dict, description="Factor: trials from one showing of a level to its next, at least."
    )
    repeats_at_least_apart: Distance | None = Field(
        None, description="Trials from one showing of a condition to its next, at least."
    )

    @property
    def placed_factor(self) -> str:
        """None: every level is known beforehand."""
        return ""

    @property
    def is_square(self) -> bool:
        """True when the participant's row of a square decides."""
        return self.kind in ("latin_square", "balanced_latin_square")

    @property
    def limited(self) -> bool:
        """True when not every shuffled list will do."""
        return bool(self.at_most_in_a_row or self.at_least_apart or self.repeats_at_least_apart)


class UpDownRule(Part):
    """What all staircases have: where each track begins, and when it ends."""

    start: list[Number] | None = Field(
        None, min_length=1, max_length=8, description="First level of each interleaved staircase; the last if left out."
    )
    reversals: Stop | None = Field(
        None,
        description="A track ends after so many reversals, as 8 (Levitt 1971), or after `repetitions` trials, what "
        "comes first; if left out, every track has all its trials.",
    )


class StaircaseRule(UpDownRule):
    """A transformed up-down staircase (Levitt 1971) on the levels in the order of the file."""

    kind: Literal["staircase"]
    down_after: Limit = Field(2, description="Times yes in a row before the next level is further down the list.")
    up_after: Limit = Field(1, description="Times no in a row before the next level is further up the list.")
    steps: list[Limit] = Field(
        default_factory=lambda: [1], min_length=1, description="Levels per step: one more entry after each reversal."
    )


class WeightedRule(UpDownRule):
    """A weighted up-down staircase (Kaernbach 1991): every yes is a step down, every no a step up of another size."""

    kind: Literal["weighted"]
    down: Limit = Field(1, description="Levels down after yes.")
    up: Limit = Field(3, description="Levels up after no; up / (up + down) is the share of yes it settles at.")


class QuestPlusRule(Part):
    """QUEST+ (Watson 2017): the level of which the answer is expected to tell most about the psychometric function."""

    kind: Literal["quest_plus"]
    function: Literal["logistic", "normal", "weibull"] = "logistic"
    thresholds: list[Number] | None = Field(
        None, min_length=2, description="Possible thresholds; the levels if left out."
    )
    spreads: list[Annotated[float, Field(strict=True, gt=0.0, allow_inf_nan=False)]] = Field(
        min_length=1,
        description="Possible spreads, in the unit of the levels (logistic: scale; normal: s.d.); weibull: exponents.",
    )
    guess: Annotated[float, Field(strict=True, ge=0.0, lt=1.0)] = Field(
        0.5, description="Share of yes far below threshold: 0.5 for right or wrong out of two."
    )
    lapses: list[Annotated[float, Field(strict=True, ge=0.0, lt=0.5)]] = Field(
        default_factory=lambda: [0.02], min_length=1, description="Possible shares of no far above threshold."
    )


class AdaptiveOrder(Part):
    """Levels of one factor that follow from the answers so far; all other conditions are interleaved."""

    kind: Literal["adaptive"]
    of: Name = Field(description="The factor placed; its levels, from hardest to easiest, are those that can be shown.")
    yes: Text = Field(
        description="When a response counts as yes, as `chosen == faster`, `chosen == $original` or `rating >= 3`."
    )
    rule: Annotated[StaircaseRule | WeightedRule | QuestPlusRule, Field(discriminator="kind")]

    @property
    def stops_after(self) -> int | None:
        """Reversals after which a track ends; None when it has all its trials."""
        return None if isinstance(self.rule, QuestPlusRule) else self.rule.reversals

    @property
    def placed_factor(self) -> str:
        """The factor whose levels only the answers decide."""
        return self.of

    @property
    def is_square(self) -> bool:
        """False: there is no row."""
        return False


Order = Annotated[
    Annotated[ListOrder | AdaptiveOrder, Field(discriminator="kind")],
    BeforeValidator(
        _as_mapping, json_schema_input_type=Literal["random", "blocked", "sequential"] | ListOrder | AdaptiveOrder
    ),
]
