"""A crowd as the study file says it, and as it is in one trial. Knows no motion and no place."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from random import Random
from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Field

from protocols.parts import Level
from protocols.setting import SettingOf, SettingsPart, value_of

Palette = Literal["varied", "equal_luminance"]
Size = Annotated[int, Field(strict=True, ge=2, le=4000)]
Variation = Annotated[
    str, BeforeValidator(lambda value: str(value)), Field(pattern=r"^1(:([1-9][0-9]{0,2}|1000))?$", max_length=6)
]

SizeSetting = SettingOf[Size]
VariationSetting = SettingOf[Variation]
PaletteSetting = SettingOf[Palette]

TAKES: dict[str, Any] = {"size": Size, "variation": Variation, "palette": Palette}


@dataclass(frozen=True)
class CrowdOf:
    """Which crowd is shown in a trial.

    variation: "1:N", one motion for N walkers, or "1", one for each sex.
    seed:      of paths, sizes and which motions; pool: of the walks that motions are chosen from.
    """

    size: int
    variation: str = "1:1"
    palette: Palette = "varied"
    seed: int = 0
    pool: int = 0

    def drawn_by(self, study: str, run_seed: int, trial: str) -> CrowdOf:
        """The crowd of a trial (as "trial-7") of a run: a pool for the run, paths for the trial."""
        return replace(
            self,
            seed=Random(f"{study}/crowd/{trial}/{run_seed}").getrandbits(31),
            pool=Random(f"{study}/walks/{run_seed}").getrandbits(31),
        )


class CrowdPart(SettingsPart):
    """Many people walking the same way, each with a motion, a place and a look; settings as elsewhere."""

    size: SizeSetting = Field(description="Walkers, half of them women.")
    variation: VariationSetting = Field(
        "1:1", description='"1:N" is one motion for N walkers, "1" one for all women and one for all men.'
    )
    palette: PaletteSetting = Field(
        "varied", description="equal_luminance: clothes differ in hue and chroma only, hair and skin not at all."
    )

    @classmethod
    def takes(cls) -> dict[str, Any]:
        """Field to the type of its values."""
        return TAKES

    def resolved(self, levels: Mapping[str, Level], change: CrowdChange | None = None) -> CrowdOf:
        """The crowd of a trial with these levels, or an alternative's: what it leaves out is as here."""
        given = {name: getattr(change, name, None) or getattr(self, name) for name in TAKES}
        found = {name: value_of(setting, levels) for name, setting in given.items()}
        return CrowdOf(int(found["size"]), str(found["variation"]), found["palette"])


class CrowdChange(SettingsPart):
    """What of a crowd differs in an alternative."""

    size: SizeSetting | None = None
    variation: VariationSetting | None = None
    palette: PaletteSetting | None = None

    @classmethod
    def takes(cls) -> dict[str, Any]:
        """Field to the type of its values."""
        return TAKES
