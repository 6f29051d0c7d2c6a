"""Builds: how much stouter or slimmer than the shipped body somebody is, joint by joint, at the same height."""

from __future__ import annotations

from math import sqrt

LIMBS = tuple(
    f"{side}{part}" for side in ("left", "right") for part in ("UpperLeg", "LowerLeg", "UpperArm", "LowerArm")
)

GIRTHS: dict[str, dict[str, float]] = {
    "slim": dict.fromkeys(("hips", "spine", "chest", *LIMBS), 0.93),
    "medium": {},
    "stout": {"hips": 1.12, "spine": 1.2, "chest": 1.12, "neck": 1.06} | dict.fromkeys(LIMBS, 1.1),
}
"""Build -> joint -> factor across its bone, as `with_girths` takes them."""

AVERAGE = {"F": (67.8, 1.628), "M": (85.5, 1.756)}
"""Sex -> mean weight (kg) and stature (m) of people as broad as the shipped bodies, whose measures are those of ANSUR
II (Gordon et al. 2014, Natick/TR-15/007). Quoted from memory, like the bodies' own measures; the survey's tables
were not at hand to check them."""


def girths_of(sex: str, weight: float, height: float) -> dict[str, float]:
    """Joint -> factor for a person of that sex ("F" or "M"), weight (kg) and height (m).

    A body scaled to a height keeps its shape, so its weight grows with the height's cube; at one height, weight grows
    with the square of all girths. Head, hands and feet stay as they are, and the neck changes half as much.
    """
    mean_weight, mean_height = AVERAGE[sex]
    girth = sqrt(weight / (mean_weight * (height / mean_height) ** 3))
    return {"neck": 0.5 * (1.0 + girth)} | dict.fromkeys(("hips", "spine", "chest", *LIMBS), girth)
