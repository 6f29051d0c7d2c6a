"""What walks, as the study file says it, and as it is in one trial: every `$factor` and table replaced.

Names of actors, bodies and styles are only names here; knows no motion.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated, Any, Literal

from pydantic import Field

from protocols.crowd_part import CrowdChange, CrowdOf, CrowdPart
from protocols.parts import Level, Number, Speed, StepFrequency, Text
from protocols.setting import (
    NameSetting,
    NumberSetting,
    SettingOf,
    SettingsPart,
    SpeedSetting,
    StepFrequencySetting,
    value_of,
)
from protocols.viewing import Appearance, Ground

Method = Literal["captured", "blend", "timewarp", "fourier", "pca", "poulaine"]
Points = Literal[4, 5]
Interpolation = Literal["cubic", "pchip", "hermite"]
Regression = Literal["raw", "normalised", "refitted"]
Sex = Literal["F", "M"]
Harmonics = Annotated[int, Field(strict=True, ge=1, le=40)]
Height = Annotated[float, Field(strict=True, ge=0.5, le=2.5)]
WalkRatio = Annotated[float, Field(strict=True, gt=0.0, lt=0.05)]


class MakingPart(SettingsPart):
    """How a walk is made out of captured ones; each value is a constant, `$factor` or a table by a factor."""

    method: SettingOf[Method] = Field(
        "captured", description="captured: the actor's own walk at that speed. The others are in docs/methods.md."
    )
    source_speed: SpeedSetting | None = Field(
        None,
        description="m/s of the captured walk it is made from; left out, the nearest other captured speed (timewarp, "
        "poulaine), the two around the shown speed (blend, fourier) or all others (pca).",
    )
    points: SettingOf[Points] = Field(5, description="Control points of a poulaine: 4 (E, V, I, A) or 5 (and M).")
    interpolation: SettingOf[Interpolation] = Field("hermite", description="Of a poulaine between its points.")
    harmonics: SettingOf[Harmonics] = Field(2, description="Of a Fourier walk; Tilmanne and Dutoit used 2.")
    style: NameSetting | None = Field(None, description="A walking style instead of the actor's own way.")
    share: NumberSetting = Field(
        1.0, description="Of the way from the actor's own walk (0) to the style (1), and beyond; fourier only."
    )
    table: SettingOf[Regression] = Field("normalised", description="By which a poulaine is edited.")
    height: SettingOf[Height] | None = Field(
        None, description="m, of the person a walk is edited towards (poulaine, pca)."
    )
    sex: SettingOf[Sex] | None = Field(None, description="Of the person a poulaine is edited towards.")
    walk_ratio: SettingOf[WalkRatio] | None = Field(
        None, description="m·min that a poulaine is edited towards at its own speed."
    )

    @classmethod
    def takes(cls) -> dict[str, Any]:
        """Field to the type of its values."""
        return {
            "method": Method, "source_speed": Speed, "points": Points, "interpolation": Interpolation,
            "harmonics": Harmonics, "style": Text, "share": Number, "table": Regression, "height": Height,
            "sex": Sex, "walk_ratio": WalkRatio,
        }  # fmt: skip

    def over(self, base: MakingPart | None) -> MakingPart:
        """The base with what is given here in its place."""
        given = {name: getattr(self, name) for name in self.model_fields_set}
        return self if base is None else base.model_copy(update=given)

    def resolved(self, levels: Mapping[str, Level]) -> Making:
        """The way of making in a trial with these levels."""
        return Making(**{name: value_of(getattr(self, name), levels) for name in self.takes()})


class Alternative(SettingsPart):
    """One of the walks that are compared: what differs from `stimulus`, each a constant, `$factor` or a table."""

    actor: NameSetting | None = None
    body: NameSetting | None = None
    speed: SpeedSetting | None = Field(None, description="m/s")
    step_frequency: StepFrequencySetting | None = Field(None, description="steps/min; what the walk has if left out.")
    making: MakingPart | None = None
    crowd: CrowdChange | None = Field(None, description="What of the crowd differs.")

    @classmethod
    def takes(cls) -> dict[str, Any]:
        """Field to the type of its values."""
        return {"actor": Text, "body": Text, "speed": Speed, "step_frequency": StepFrequency}


class Stimulus(SettingsPart, Appearance):
    """What walks: each value is a constant, `$factor` (its level in the trial) or a table by a factor."""

    actor: NameSetting | None = Field(None, description="An actor's name, or $factor. Needed without a crowd.")
    speed: SpeedSetting | None = Field(None, description="Walking speed, m/s, or $factor. Needed without a crowd.")
    body: NameSetting | None = Field(None, description="A body's name or $factor; the actor's own when left out.")
    making: MakingPart | None = Field(None, description="How the walk is made; captured when left out.")
    crowd: CrowdPart | None = Field(None, description="Many people instead of one actor.")

    @classmethod
    def takes(cls) -> dict[str, Any]:
        """Field to the type of its values."""
        return {"actor": Text, "speed": Speed, "body": Text, "ground": Ground}

    def walk(self, levels: Mapping[str, Level], alternative: Alternative | None = None) -> Walk:
        """The walk of a trial with these levels, or an alternative's: what it leaves out is as in the stimulus."""
        given = alternative or Alternative()
        if self.crowd is not None:
            return Walk("", "", 0.0, crowd=self.crowd.resolved(levels, given.crowd))
        body = given.body or self.body
        making = given.making.over(self.making) if given.making is not None else self.making
        frequency = value_of(given.step_frequency, levels)
        return Walk(
            actor=str(value_of(given.actor or self.actor, levels)),
            body=str(value_of(body, levels)) if body else "",
            speed=float(value_of(given.speed or self.speed, levels)),
            step_frequency=None if frequency is None else float(frequency),
            making=making.resolved(levels) if making is not None else Making(),
        )


@dataclass(frozen=True)
class Making:
    """How a walk is made; see MakingPart. source_speed: m/s or None, chosen by the method; style: None, the actor's."""

    method: Method = "captured"
    source_speed: float | None = None
    points: Points = 5
    interpolation: Interpolation = "hermite"
    harmonics: int = 2
    style: str | None = None
    share: float = 1.0
    table: Regression = "normalised"
    height: float | None = None
    sex: Sex | None = None
    walk_ratio: float | None = None


@dataclass(frozen=True)
class Walk:
    """Which walk is shown in a trial.

    body: "" is the actor's own. speed: m/s. step_frequency: steps/min, None: what the walk has by itself.
    crowd: who walks instead of one actor; then the others say nothing.
    """

    actor: str
    body: str
    speed: float
    step_frequency: float | None = None
    making: Making = Making()
    crowd: CrowdOf | None = None
