"""What every part of a study file is made of: names, levels, numbers with limits; unknown keys are refused."""

from __future__ import annotations

import math
from typing import Annotated, Any, Literal

from pydantic import BaseModel, BeforeValidator, ConfigDict, Field


def _level(value: Any) -> Any:
    """Refuses what YAML reads as a truth value or as no number: neither names a level."""
    if isinstance(value, bool):
        raise ValueError("yes, no, true and false are no levels; write the word in quotes")
    if isinstance(value, float) and not math.isfinite(value):
        raise ValueError("a level must be a finite number or a word")
    return value


Level = Annotated[str | float | int, BeforeValidator(_level)]
Name = Annotated[str, Field(pattern=r"^[A-Za-z][A-Za-z0-9_]*$", max_length=40)]
Text = Annotated[str, Field(min_length=1)]
Number = Annotated[float, Field(strict=True, allow_inf_nan=False)]
Speed = Annotated[float, Field(strict=True, gt=0.0, le=3.0)]
StepFrequency = Annotated[float, Field(strict=True, ge=30.0, le=240.0)]
Reference = Annotated[str, Field(pattern=r"^\$[A-Za-z][A-Za-z0-9_]*$")]
Key = Literal[
    "left", "right", "up", "down", "enter", "space", "escape", "tab", "backspace",
    "a", "b", "c", "d", "e", "f", "g", "h", "i", "j", "k", "l", "m",
    "n", "o", "p", "q", "r", "s", "t", "u", "v", "w", "x", "y", "z",
    "0", "1", "2", "3", "4", "5", "6", "7", "8", "9",
]  # fmt: skip


class Part(BaseModel):
    """Every part of a study file: unknown keys are refused, values never change after reading."""

    model_config = ConfigDict(extra="forbid", frozen=True)
