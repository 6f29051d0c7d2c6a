"""Tests that a planned analysis can name beside the analysis of variance: t tests, pairs, and tests of choices."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from protocols.orders.order import Factors
from protocols.parts import Name, Number, Part, Text

Condition = Annotated[str, Field(min_length=1)]
Each = Annotated[Factors, Field(description="A test in each level (or combination of levels) of these factors.")]
Adjust = Literal["tukey", "bonferroni", "holm", "none"]
Model = Literal["multivariate", "univariate"]


class TTest(Part):
    """t tests of participants' means: against given values, of pairs of levels, or of pairs of groups."""

    each: Name | None = Field(None, description="A test in each level of this factor.")
    against: dict[str, Number] | Number | None = Field(
        None, description="One-sample tests: level of `each`: its value, or one value for all, as 50."
    )
    paired: Name | None = Field(None, description="Paired tests of all pairs of levels of this within factor.")
    independent: Name | None = Field(None, description="Student's and Welch's tests of all pairs of these groups.")
    label: Text = "reference value"
    where: Text | None = Field(None, description="Only trials that meet this condition, as `shown == matched`.")


class Pairs(Part):
    """Pairwise comparisons of marginal means, whether or not the effect is significant."""

    factors: Factors = Field(description="The factor(s) whose levels (or cells) are compared.")
    by: Factors | None = Field(None, description="Inside each level of these factors: simple effects.")
    adjust: Adjust = "tukey"
    model: Model = "multivariate"


class Proportions(Part):
    """How often an answer is given, against chance: exact, with exact and Wilson limits, and over participants."""

    success: Condition = Field(description="What counts, as `correct == 1` or `chosen != $original`.")
    each: Each | None = None
    chance: Annotated[float, Field(strict=True, gt=0.0, lt=1.0)] = 0.5
    label: Text = "Proportion"


class DPrime(Part):
    """Sensitivity d' of every participant, from hits and false alarms (log-linear rule, Hautus 1995)."""

    signal: Condition = Field(description="Which trials hold the signal, as `difference > 0`.")
    answer: Condition = Field(description="Which answers say that they do, as `chosen == second`.")
    each: Each | None = None


class Psychometric(Part):
    """Psychometric function of every participant: threshold and just noticeable difference."""

    level: Name = Field(description="The factor along which the answers change; its levels are numbers.")
    success: Condition = Field(description="What counts as yes, as `chosen == faster`.")
    each: Each | None = None
    shape: Literal["logistic", "normal"] = "logistic"
    guess: Annotated[float, Field(strict=True, ge=0.0, lt=1.0)] = Field(
        0.0, description="Share of yes without any stimulus: 0.5 for right or wrong out of two."
    )
    lapse: Annotated[float, Field(strict=True, ge=0.0, lt=0.5)] | Literal["estimated"] = Field(
        0.0, description="Share of slips at the top, or estimated (0 to 0.06, Wichmann & Hill 2001)."
    )
    bootstrap: Annotated[int, Field(strict=True, ge=0, le=10_000)] = Field(
        200, description="Samples for the 95 % limits of every fit; 0 for none."
    )
