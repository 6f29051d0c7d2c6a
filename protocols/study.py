"""The study file as types: what an experimenter may write, with limits and units. Knows no file and no motion.

The models are the single source of the JSON Schema (`gaitlab schema`) and of the messages of `gaitlab check`.
"""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import ConfigDict, Field

from protocols.further_tests import DPrime, Pairs, Proportions, Psychometric, TTest
from protocols.gaze import GazeSettings
from protocols.orders.order import ListOrder, Order
from protocols.parts import Key, Level, Name, Number, Part, Text
from protocols.simulated import ChoosingObservers, RatingObservers
from protocols.stimulus import Stimulus
from protocols.tasks.adjustment_part import Adjustment
from protocols.tasks.choice_part import Choice
from protocols.tasks.rating_part import Rating
from protocols.viewing import Display

Task = Annotated[Adjustment | Choice | Rating, Field(discriminator="kind")]


class TextPage(Part):
    """A page the participant reads."""

    title: Text = Field(description="Heading of the page.")
    text: Text = Field(description="Paragraphs, separated by empty lines; any script.")


class ChoiceQuestion(Part):
    """A question answered by choosing one of several options."""

    id: Name = Field(description="Column of the answer in the tables.")
    kind: Literal["choice"]
    prompt: Text
    options: dict[Name, Text] = Field(
        min_length=2, max_length=9, description="Value stored: label the participant reads."
    )


class NumberQuestion(Part):
    """A question answered by typing a whole number."""

    id: Name
    kind: Literal["number"]
    prompt: Text
    minimum: int = Field(0, strict=True, ge=0)
    maximum: int = Field(120, strict=True, le=999_999_999)


class TextQuestion(Part):
    """A question answered by typing words; never used as a factor."""

    id: Name
    kind: Literal["text"]
    prompt: Text
    required: bool = True
    max_length: int = Field(200, ge=1, le=1000, strict=True)


Question = Annotated[ChoiceQuestion | NumberQuestion | TextQuestion, Field(discriminator="kind")]


class Participants(Part):
    """Who takes part and what they are asked."""

    planned: int = Field(ge=1, le=100_000, strict=True, description="Number of participants planned.")
    between: dict[Name, Annotated[list[Name], Field(min_length=2)]] = Field(
        default_factory=dict,
        description="Between-participant factors and their levels: what participants answer to the choice question "
        "of that id, or what the program assigns.",
    )
    assigned: list[Name] = Field(
        default_factory=list,
        description="Those of the between-participant factors that the program assigns, in balanced random order.",
    )
    questions: list[Question] = Field(default_factory=list, description="Asked after consent, in this order.")


class Practice(Part):
    """One training trial: a value for every factor that the stimulus and the task refer to."""

    model_config = ConfigDict(extra="allow", frozen=True)

    @property
    def levels(self) -> dict[str, Any]:
        """Factor name to the value this training trial uses."""
        return dict(self.model_extra or {})


class Breaks(Part):
    """When the participant is offered a rest."""

    every: int = Field(ge=1, strict=True, description="Trials between two breaks.")
    title: Text = "Time for a break"
    text: Text = "You have completed {done} of {total} trials.\n\nRest your eyes, then press Enter to go on."


class Pages(Part):
    """What the participant reads.

    In instructions, before_practice and before_trials, {break} and the names of the task's keys, as {lower}, {raise}
    and {confirm}, or {first}, {second} and {replay}, become the participant's own keys.
    """

    consent: TextPage
    declined: TextPage = TextPage(
        title="Thank you", text="You chose not to take part. Only that you declined has been noted."
    )
    instructions: list[TextPage] = Field(min_length=1)
    before_practice: TextPage | None = None
    before_trials: TextPage | None = None
    debrief: TextPage

    @property
    def in_order(self) -> list[TextPage]:
        """Every page that a participant who takes part reads, in order."""
        found = [self.consent, *self.instructions, self.before_practice, self.before_trials, self.debrief]
        return [page for page in found if page is not None]

    @property
    def told(self) -> str:
        """What the participant is told of the task before the first trial."""
        return " ".join(page.text for page in [*self.instructions, self.before_practice] if page is not None)


class Words(Part):
    """Short texts of the screen, so that a study can be in any language."""

    agree: Text = "I agree to take part"
    decline: Text = "I do not want to take part"
    next: Text = "Continue"
    choose_hint: Text = "Click, or choose with the arrow keys and press Enter"
    page_hint: Text = "Press Enter to continue"
    question_hint: Text = "Move with Tab or the arrow keys, type or choose, then press Enter"
    questions_title: Text = "A few questions about you"
    missing: Text = "Please answer this question."
    not_a_number: Text = "Please type a whole number from {minimum} to {maximum}."
    pause_title: Text = "Paused"
    pause_text: Text = "The study waits for you."
    experimenter_pause_text: Text = "The experimenter has paused the study. It goes on in a moment."
    resume: Text = "Go on"
    stop: Text = "Stop the session"
    stop_title: Text = "Stop the session?"
    stop_text: Text = "Everything you have answered so far is kept. You can come back later."
    stop_really: Text = "Yes, stop"
    break_title: Text = "Break"
    break_text: Text = "Rest as long as you like. The study waits for you."
    stopped: Text = "Thank you"
    stopped_text: Text = "You have stopped, and your answers so far are kept. Please tell the experimenter."
    welcome_back: Text = "Welcome back"
    welcome_back_text: Text = "You will go on where you left off: trial {next} of {total}."
    finished_hint: Text = "Press Enter to close"
    trial_caption: str = Field("", description="A line under the walker during trials.")
    keys: dict[Key, Text] = Field(default_factory=dict, description="What keys are called on pages, as enter: Entrée.")


class Anova(Part):
    """Factors of the repeated-measures analysis of variance."""

    within: list[Name] = Field(default_factory=list)
    between: list[Name] = Field(default_factory=list)


class PostHoc(Part):
    """Pairwise comparisons of the significant effects."""

    adjust: Literal["tukey", "bonferroni", "holm", "none"] = "tukey"
    model: Literal["multivariate", "univariate"] = "multivariate"


class Equivalence(Part):
    """Evidence for sameness: two one-sided tests of every pair of levels of a factor."""

    factor: Name = Field(description="Whose levels are compared, pair by pair.")
    bound: float = Field(
        strict=True,
        gt=0.0,
        allow_inf_nan=False,
        description="The largest difference that would not matter, in the unit of the measure.",
    )
    by: Name | None = Field(None, description="Inside each level of this factor; averaged over the others if left out.")


class Regression(Part):
    """Regression of the mean of every level of a factor on what is known of that level."""

    of: Name = Field(description="The factor whose levels are the cases, as actor.")
    on: dict[Name, dict[str, Number]] = Field(min_length=1, description="Predictor: {level: value}.")
    units: dict[Name, str] = Field(default_factory=dict, description="Predictor: unit, for the figure, as height: m.")


class RankTransform(Part):
    """Aligned rank transform: the analysis of variance for measures far from normal, contrasts by ART-C."""

    within: list[Name] = Field(default_factory=list)
    between: list[Name] = Field(default_factory=list)


class MixedModel(Part):
    """Linear mixed model of single trials, with random intercepts of participants and stimuli, crossed."""

    stimulus: Name = Field(description="The factor whose levels are a sample of stimuli, as actor.")
    factors: list[Name] = Field(min_length=1, description="Fixed factors, with all their interactions.")


class Figure(Part):
    """A figure of the report."""

    kind: Literal[
        "means", "interaction", "raincloud", "qq", "order", "t_tests", "regression", "proportions", "psychometric"
    ] = Field(
        description="qq: residuals against a normal distribution; order: the measure over the session, for learning; "
        "t_tests: what was measured and what it was tested against, level by level; regression: the measure over "
        "every predictor; proportions and psychometric: the tests of that name."
    )
    x: Name | None = Field(
        None, description="Factor on the x axis of means, interaction and raincloud; the others have none."
    )
    lines: Name | None = None
    reference: Text | None = Field(
        None, description="Label of the t-test whose values are drawn as diamonds; the t-test of a t_tests figure."
    )
    panels: Name | None = Field(None, description="For t_tests and regression: groups, a panel or a colour each.")


class Exclusion(Part):
    """Trials left out of the analysis, with the reason the report gives."""

    where: Text = Field(description="A condition on one column, as `late_frames > 5`.")
    reason: Text


class LevelGroups(Part):
    """A factor made from another: its levels are groups of the other's levels, as women and men among actors."""

    of: Name = Field(description="The within-participant factor whose levels are grouped.")
    levels: dict[Name, Annotated[list[Level], Field(min_length=1)]] = Field(
        min_length=2, description="Group: the levels in it; every level is in one group."
    )


class FurtherAnalysis(Part):
    """One measure and what is computed of it."""

    measure: Literal[
        "walk_ratio", "step_frequency", "step_length", "response_time", "normalised_walk_ratio", "confusion_rate",
        "correct", "decision_time", "rating", "gaze_share",
    ] = Field(
        "walk_ratio",
        description="normalised_walk_ratio needs heights; confusion_rate (%) and correct (0 or 1) need trials in which "
        "one of two is chosen, rating (of the scale) those in which one is rated; gaze_share (% of looking time) has "
        "the within factor region: legs, arms, torso, head, elsewhere.",
    )  # fmt: skip
    label: Text = "Walk ratio"
    unit: str = "m·min"
    heights: dict[str, Annotated[float, Field(strict=True, ge=0.5, le=2.5)]] | None = Field(
        None, description="Body height of every actor, m, for normalised_walk_ratio (Hof 1996)."
    )
    anova: Anova = Anova()
    post_hoc: PostHoc | None = PostHoc()
    t_tests: list[TTest] = Field(default_factory=list)
    pairs: list[Pairs] = Field(default_factory=list)
    proportions: list[Proportions] = Field(default_factory=list)
    d_prime: DPrime | None = None
    psychometric: Psychometric | None = None
    equivalence: list[Equivalence] = Field(default_factory=list)
    regression: Regression | None = None
    aligned_rank_transform: RankTransform | None = None
    mixed_model: MixedModel | None = None
    normality: Literal["shapiro_wilk"] | None = "shapiro_wilk"
    figures: list[Figure] = Field(default_factory=list)


class Analysis(FurtherAnalysis):
    """The analysis planned before the data."""

    anova: Anova
    groups: dict[Name, LevelGroups] = Field(
        default_factory=dict, description="Further within-participant factors, made of groups of a factor's levels."
    )
    exclusions: list[Exclusion] = Field(default_factory=list, description="For every measure alike.")
    also: list[FurtherAnalysis] = Field(
        default_factory=list, description="Further measures, each analysed on its own, in a folder of its own."
    )


class Preference(Part):
    """A simulated population's preferred walk ratio for one actor: normal over participants."""

    mean: Annotated[float, Field(strict=True, gt=0.0, lt=0.05)] = Field(description="m·min")
    sd: Annotated[float, Field(strict=True, ge=0.0, lt=0.05)] = Field(description="m·min, between participants")


PUBLISHED_PREFERENCES = {
    "F1": {"mean": 0.00573, "sd": 0.00065},
    "F2": {"mean": 0.00595, "sd": 0.00062},
    "M1": {"mean": 0.00658, "sd": 0.00051},
    "M2": {"mean": 0.00651, "sd": 0.00058},
}
"""Estimated walk ratios of 22 participants, m·min: Niay (2022), table 3.4."""


def _published() -> dict[str, Preference]:
    return {actor: Preference.model_validate(values) for actor, values in PUBLISHED_PREFERENCES.items()}


class Simulation(Part):
    """Simulated observers: what `gaitlab simulate` uses when nobody sits at the screen.

    Left out, the preferences are the published ones (Niay 2022, table 3.4); an actor without one is preferred at
    the mean of the others.
    """

    preferred_walk_ratio: dict[str, Preference] = Field(
        default_factory=_published, min_length=1, description="Actor: preference; the published ones when left out."
    )
    shared: float = Field(
        0.75,
        strict=True,
        ge=0.0,
        le=1.0,
        description="Correlation of a participant's preferences over actors.",
    )
    trial_noise: float = Field(0.0004, strict=True, ge=0.0, lt=0.05, description="m·min, s.d. from trial to trial.")
    anchoring: float = Field(
        0.0,
        strict=True,
        ge=0.0,
        lt=1.0,
        description="Share of the way back to the start value at which to stop.",
    )
    choice: ChoosingObservers = Field(ChoosingObservers(), description="Of a choice task.")
    rating: RatingObservers = Field(RatingObservers(), description="Of a rating task.")


class Resume(Part):
    """What becomes of a run that was interrupted, by a stop, a crash or a power cut."""

    policy: Literal["trial", "block", "never"] = Field(
        "trial",
        description="trial: goes on with the interrupted trial, again; block: with the first trial since the last "
        "set break or since the block of the design began; never: the run stays unfinished.",
    )
    longest_gap: float | None = Field(
        None,
        strict=True,
        gt=0.0,
        allow_inf_nan=False,
        description="min after the interruption within which the run can be continued; no limit when left out.",
    )


class Study(Part):
    """A whole study: participants, design, stimulus, task, texts, planned analysis."""

    study: Name = Field(description="Short name: folder of the data and column of the tables.")
    title: Text
    about: Text = Field(description="What the study asks and where it comes from.")
    language: str = Field("en", pattern=r"^[a-z]{2,3}(-[A-Za-z0-9]+)*$")
    participants: Participants
    factors: dict[Name, Annotated[list[Level], Field(min_length=1)]] = Field(
        min_length=1, description="Within-participant factors and their levels, in the order of the tables."
    )
    repetitions: int = Field(
        ge=1, le=1000, strict=True, description="Trials per condition; in an adaptive order, trials per track."
    )
    order: Order = Field(
        default_factory=lambda: ListOrder(kind="random"),
        description="A word (random: all trials shuffled; blocked: every condition once per block, shuffled; "
        "sequential: as in the file), or a mapping with kind: squares, limits, adaptive placement.",
    )
    practice: list[Practice] = Field(default_factory=list, description="Training trials, in this order.")
    breaks: Breaks | None = None
    resume: Resume = Resume()
    gaze: GazeSettings | None = Field(None, description="Record what the participant looks at, with an eye tracker.")
    display: Display | None = Field(None, description="Screen and viewing distance, for true angles and perspective.")
    stimulus: Stimulus
    task: Task
    interval: float = Field(0.5, strict=True, ge=0.1, le=10.0, description="s of empty screen between trials.")
    pages: Pages
    words: Words = Words()
    analysis: Analysis
    simulation: Simulation = Field(default_factory=Simulation)
