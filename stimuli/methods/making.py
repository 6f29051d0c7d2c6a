"""What every method shares: where a made cycle says it comes from, and looking into a cycle at any phase."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from stimuli.cycle import Cycle, Provenance
from stimuli.cycle import leg_length as length_of_legs
from stimuli.methods.errors import MethodError as MethodError
from stimuli.rotations import normalise, slerp
from stimuli.skeleton import Floats


def check_speed(speed: float, lowest: float = 0.1, highest: float = 4.0) -> None:
    """Raises MethodError for a speed (m/s) that is no walk."""
    if not (np.isfinite(speed) and lowest <= speed <= highest):
        raise MethodError(f"a speed of {speed:g} m/s is no walk; give one from {lowest:g} to {highest:g} m/s")


def check_same_skeleton(cycles: Sequence[Cycle]) -> None:
    """Raises MethodError unless all cycles have the same joints, whose bones differ in length by 5 mm at most."""
    first = cycles[0]
    for other in cycles[1:]:
        if other.joints != first.joints:
            differing = sorted(set(first.joints) ^ set(other.joints)) or ["the order of the joints"]
            raise MethodError(
                f"{first.provenance.clip} and {other.provenance.clip} are on different skeletons "
                f"({', '.join(differing)}); put them on one skeleton first"
            )
        difference = np.abs(bone_lengths(other) - bone_lengths(first)).max()
        if difference > 0.005:
            raise MethodError(
                f"{first.provenance.clip} and {other.provenance.clip} are on different skeletons: a bone differs by "
                f"{100 * difference:.1f} cm; put them on one skeleton first"
            )


def bone_lengths(cycle: Cycle) -> Floats:
    """(R - 1,) m: from every joint but the hips to its parent."""
    return np.asarray(np.linalg.norm(cycle.offsets[1:], axis=1))


def leg_length(cycle: Cycle) -> float:
    """m, hip joint to ankle in the rest pose, mean of both legs. Raises MethodError where the cycle has no legs."""
    legs = (f"{side}{bone}" for side in ("left", "right") for bone in ("UpperLeg", "LowerLeg", "Foot"))
    missing = [joint for joint in legs if joint not in cycle.joints]
    if missing:
        raise MethodError(f"{cycle.provenance.clip} has no {missing[0]}, so its legs cannot be measured")
    return length_of_legs(cycle)


def made_by(method: str, description: str, *sources: Cycle) -> Provenance:
    """Provenance of a made cycle: `format` is the method, `clip` what it did to which captures."""
    names = " and ".join(source.provenance.clip for source in sources)
    return replace(sources[0].provenance, format=method, clip=f"{names}, {description}", seam_phase=0.0)


def rotations_at(cycle: Cycle, phases: Floats) -> Floats:
    """(M, R, 4) local rotations at phases (M,) of the cycle, by slerp between its samples."""
    below, share = _places(len(cycle.rotations), phases)
    above = (below + 1) % len(cycle.rotations)
    return normalise(slerp(cycle.rotations[below], cycle.rotations[above], share[:, None]))


def hips_at(cycle: Cycle, phases: Floats) -> Floats:
    """(M, 3) m place of the hips at phases (M,), linear between samples."""
    below, share = _places(len(cycle.hips), phases)
    above = (below + 1) % len(cycle.hips)
    return np.asarray(cycle.hips[below] + share[:, None] * (cycle.hips[above] - cycle.hips[below]))


def resampled(cycle: Cycle, samples: int) -> Cycle:
    """The same walk with another number of samples."""
    if samples == len(cycle.hips):
        return cycle
    phases = np.arange(samples) / samples
    return replace(cycle, rotations=rotations_at(cycle, phases), hips=hips_at(cycle, phases))


def _places(count: int, phases: Floats) -> tuple[np.ndarray, Floats]:
    place = np.mod(phases, 1.0) * count
    below = np.floor(place).astype(int)
    return below % count, place - below
