"""How simulated observers choose and rate, as a study file gives it: by condition, with spread."""

from __future__ import annotations

from typing import Any

from pydantic import Field

from protocols.parts import Number
from protocols.setting import NumberSetting, Probability, ProbabilitySetting, Seconds, SecondsSetting, SettingsPart


class ChoosingObservers(SettingsPart):
    """How simulated observers choose; settings may be constants, `$factor` or tables by a factor."""

    confusion: ProbabilitySetting = Field(
        0.5,
        description="Probability that a middling observer chooses another than the original; without one, the right or "
        "second one.",
    )
    response_time: SecondsSetting = Field(3.0, description="Median, s, once every alternative can be seen.")
    spread: float = Field(0.3, strict=True, ge=0.0, le=5.0, description="S.d. between participants, logit.")
    pace_spread: float = Field(0.2, strict=True, ge=0.0, le=3.0, description="The same of log response time.")
    time_spread: float = Field(0.4, strict=True, ge=0.0, le=3.0, description="S.d. of it from trial to trial.")

    @classmethod
    def takes(cls) -> dict[str, Any]:
        """Field to the type of its values."""
        return {"confusion": Probability, "response_time": Seconds}


class RatingObservers(SettingsPart):
    """How simulated observers rate; `rating` may be a constant, `$factor` or a table by a factor."""

    rating: NumberSetting | None = Field(None, description="Mean of all ratings; the scale's middle if left out.")
    spread: float = Field(0.4, strict=True, ge=0.0, allow_inf_nan=False, description="S.d. between participants.")
    noise: float = Field(0.8, strict=True, ge=0.0, allow_inf_nan=False, description="S.d. from trial to trial.")
    response_time: Seconds = Field(5.0, description="Median until the first key, s.")
    pace_spread: float = Field(0.2, strict=True, ge=0.0, le=3.0, description="S.d. between participants of its log.")
    time_spread: float = Field(0.4, strict=True, ge=0.0, le=3.0, description="S.d. of it from trial to trial.")

    @classmethod
    def takes(cls) -> dict[str, Any]:
        """Field to the type of its values."""
        return {"rating": Number}
