"""What a study file may say of eye tracking: which stream, which channels, in which unit."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field, model_validator

REGIONS = ("legs", "arms", "torso", "head", "elsewhere")
"""Body parts of Niay (2022, section 4.3.2); arms with hands, elsewhere the ground, the treadmill and the background."""

Label = Annotated[str, Field(min_length=1, max_length=80)]


class GazeSettings(BaseModel):
    """Gaze of the participant, recorded in every trial as the body part looked at in each frame."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    source: Literal["lsl", "mouse"] = Field(
        "lsl", description="lsl: an eye tracker over Lab Streaming Layer; mouse: the pointer stands in for the eyes."
    )
    stream_type: Label = Field("Gaze", description="Type of the stream.")
    x: Label | None = Field(None, description="Label of the channel for x; common ones are found by themselves.")
    y: Label | None = Field(None, description="Label of the channel for y.")
    confidence: Label | None = Field(None, description="Label of the channel with the tracker's confidence, 0 to 1.")
    least_confidence: float = Field(
        0.6, strict=True, ge=0.0, le=1.0, description="Samples below it count as no gaze, as in a blink."
    )
    unit: Literal["normalised", "pixels"] = Field("normalised", description="normalised: 0 to 1 over the display.")
    origin: Literal["top_left", "bottom_left"] = Field("top_left", description="Where x and y are 0.")

    @model_validator(mode="after")
    def _both_or_none(self) -> GazeSettings:
        if (self.x is None) != (self.y is None):
            raise ValueError("x and y belong together; name both channels or none")
        return self
