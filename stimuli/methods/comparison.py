"""Every method asked for a walk that was captured, from the person's other captures, and measured against it.

The captured walk is left out of what the methods are made from: time warping and the poulaine start from the nearest
other speed, Fourier and blending from the two around it, the PCA engine from all others.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from stimuli.cycle import Cycle
from stimuli.methods.blend import blend_to_speed, nearest_two
from stimuli.methods.delivery import LEGS, Delivered, delivered, joint_rmse
from stimuli.methods.fourier import fourier_to_speed
from stimuli.methods.making import MethodError
from stimuli.methods.pca import pca_walk
from stimuli.methods.timewarp import timewarp
from stimuli.poulaine.walking import poulaine_to_speed

Method = Callable[[Sequence[Cycle], float], Cycle]


@dataclass(frozen=True, eq=False)
class Compared:
    """One method at one speed. `captured` is also listed as a method, against itself.

    legs, body: deg, root mean square joint angle against the captured walk, legs and all joints
    """

    person: str
    method: str
    speed: float  # m/s, asked for
    cycle: Cycle
    captured: Cycle
    measured: Delivered
    legs: float
    body: float


def _nearest(others: Sequence[Cycle], speed: float) -> Cycle:
    return min(others, key=lambda cycle: abs(cycle.gait.speed - speed))


def _fourier(others: Sequence[Cycle], speed: float) -> Cycle:
    slower, faster, _ = nearest_two(others, speed)
    return fourier_to_speed(slower, faster, speed)


METHODS: dict[str, Method] = {
    "timewarp": lambda others, speed: timewarp(_nearest(others, speed), speed),
    "fourier": _fourier,
    "pca": lambda others, speed: pca_walk(others).cycle(speed),
    "poulaine": lambda others, speed: poulaine_to_speed(_nearest(others, speed), speed),
    "blend": blend_to_speed,
}
"""Name -> walk at a speed (m/s) from a person's captures at other speeds."""


def compared(person: str, walks: Sequence[Cycle], count: int = 3) -> tuple[list[Compared], list[str]]:
    """Every method at `count` of the person's inner speeds, and sentences about what could not be made.

    Raises MethodError unless there are captures at three speeds.
    """
    ordered = sorted(walks, key=lambda cycle: cycle.gait.speed)
    if len(ordered) < 3:
        raise MethodError(f"{person}: comparing methods needs walks at three speeds; there are {len(ordered)}")
    rows: list[Compared] = []
    problems: list[str] = []
    for captured in _spread(ordered[1:-1], count):
        speed = captured.gait.speed
        others = [cycle for cycle in ordered if cycle is not captured]
        rows.append(_measured(person, "captured", captured, captured))
        for name, method in METHODS.items():
            try:
                rows.append(_measured(person, name, method(others, speed), captured))
            except MethodError as error:
                problems.append(f"{person} at {speed:.2f} m/s, {name}: {error}.")
    return rows, problems


def _measured(person: str, method: str, cycle: Cycle, captured: Cycle) -> Compared:
    itself = cycle is captured
    legs, body = (0.0 if itself else joint_rmse(cycle, captured, joints) for joints in (LEGS, captured.joints))
    return Compared(person, method, captured.gait.speed, cycle, captured, delivered(cycle), legs, body)


def _spread(cycles: Sequence[Cycle], count: int) -> list[Cycle]:
    """At most `count` of them, the first, the last and others evenly between."""
    if len(cycles) <= count:
        return list(cycles)
    if count == 1:
        return [cycles[len(cycles) // 2]]
    return [cycles[round(index * (len(cycles) - 1) / (count - 1))] for index in range(count)]
