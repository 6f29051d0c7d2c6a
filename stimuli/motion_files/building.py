"""From a reader's raw motion to a `Clip`: roles, unit, axes and warnings, the same way for every format."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from stimuli.clip import Clip, Source, cut, world_positions
from stimuli.motion_files.axes import (
    find_forward,
    find_unit,
    find_up,
    leg_length,
    sides_swapped,
    to_y_up,
)
from stimuli.motion_files.errors import MotionFileError
from stimuli.motion_files.joint_names import NEEDED, roles_from_names
from stimuli.motion_files.topology import roles_from_shape
from stimuli.rotations import angle_between, continuous, from_matrix, inverse, multiply, rotate
from stimuli.skeleton import JOINTS

Floats = NDArray[np.floating]

JUMP = 20.0
"""m/s; in the captures no joint is faster than 10, and one wrong frame is ten times that."""

FAR_TURN = np.radians(25.0)  # rad between neighbouring frames; a fast walker's shank turns 6 degrees in 1/120 s
LEAST_TRAVEL = 0.5  # m, less is standing or a treadmill


@dataclass(frozen=True, eq=False)
class Motion:
    """Local motion as a file has it: its own unit and axes. Shapes as in `Clip`."""

    format: str
    path: Path
    joints: tuple[str, ...]
    parents: tuple[int, ...]
    offsets: Floats
    translations: Floats
    rotations: Floats
    rate: float
    file_rate: float


def build_clip(
    motion: Motion,
    *,
    unit_to_m: float | None = None,
    up: str | None = None,
    skip_frames: int = 0,
    roles: Mapping[str, str] | None = None,
) -> Clip:
    """A clip in metres, Y up, with roles; what is None is found from the body. Raises MotionFileError."""
    raw = _drop_frames(_as_clip(motion), skip_frames, motion.path)
    positions = world_positions(raw)
    _check_finite(positions, motion.path)
    names, found, warnings = _find_roles(raw, positions, roles or {}, motion.path)
    if unit_to_m is None:
        unit_to_m, more = find_unit(positions, found, str(motion.path))
        warnings += more
    elif not (np.isfinite(unit_to_m) and unit_to_m > 0):
        raise MotionFileError(f"{motion.path}: unit_to_m {unit_to_m} is not a positive number of metres")
    up = find_up(positions, found) if up is None else up
    forward = find_forward(positions, found, up, LEAST_TRAVEL / unit_to_m)
    clip = _in_our_axes(raw, to_y_up(up), unit_to_m)
    source = replace(raw.source, unit_to_m=unit_to_m, up=up, forward=forward, names=names)
    clip = replace(clip, roles=found, source=source)
    warnings += _body_warnings(clip, positions * unit_to_m @ to_y_up(up).T)
    return replace(clip, warnings=warnings)


def _as_clip(motion: Motion) -> Clip:
    if not (np.isfinite(motion.rate) and 1 <= motion.rate <= 10_000):
        raise MotionFileError(f"{motion.path}: a rate of {motion.rate:g} Hz is not between 1 and 10000; give rate")
    return Clip(
        name=motion.path.stem,
        joints=motion.joints,
        parents=motion.parents,
        offsets=motion.offsets,
        translations=motion.translations,
        rotations=motion.rotations,
        rate=motion.rate,
        roles={},
        source=Source(motion.format, 1.0, "+Y", "", "", motion.file_rate),
    )


def _drop_frames(clip: Clip, skip_frames: int, path: Path) -> Clip:
    if not 0 <= skip_frames < clip.frame_count:
        raise MotionFileError(
            f"{path}: skip_frames {skip_frames} is not between 0 and {clip.frame_count - 1}, one less than its frames"
        )
    return cut(clip, skip_frames, clip.frame_count)


def _check_finite(positions: Floats, path: Path) -> None:
    good = np.all(np.isfinite(positions) & (np.abs(positions) < 1e9), axis=(1, 2))
    if not np.all(good):
        frame = int(np.argmin(good)) + 1
        raise MotionFileError(f"{path}, frame {frame}: a joint's position is no finite number; fill the gap")


def _find_roles(
    clip: Clip, positions: Floats, overrides: Mapping[str, str], path: Path
) -> tuple[str, dict[str, int], tuple[str, ...]]:
    names, roles = roles_from_names(clip.joints, clip.parents)
    warnings: tuple[str, ...] = ()
    if any(role not in roles for role in NEEDED):
        ends = frozenset(index for index, joint in enumerate(clip.joints) if joint.endswith(" end"))
        by_shape = roles_from_shape(clip.parents, positions, ends)
        if sum(role in by_shape for role in NEEDED) > sum(role in roles for role in NEEDED):
            names, roles = "topology", by_shape
            warnings += ("joint names are in no table, so joints were told by the skeleton's shape; check the roles",)
    for role, joint in overrides.items():
        if role not in JOINTS or joint not in clip.joints:
            problem = f"{role!r} is no VRM humanoid joint" if role not in JOINTS else f"there is no joint {joint!r}"
            joints = ", ".join(clip.joints)
            raise MotionFileError(f"{path}: roles: {problem}; roles map e.g. leftFoot to one of {joints}")
        roles[role] = clip.joints.index(joint)
    missing = [role for role in NEEDED if role not in roles]
    if missing:
        warnings += (f"no joint was found for {', '.join(missing)}; name them in a YAML file beside the motion",)
    return names, roles, warnings


def _in_our_axes(clip: Clip, turn: Floats, unit_to_m: float) -> Clip:
    """All vectors turned and scaled, all rotations conjugated: the zero pose turns with them."""
    quaternion = from_matrix(turn)
    rotations = clip.rotations
    if not np.allclose(turn, np.eye(3)):
        rotations = multiply(multiply(quaternion, rotations), inverse(quaternion))
    return replace(
        clip,
        offsets=rotate(quaternion, clip.offsets) * unit_to_m,
        translations=rotate(quaternion, clip.translations) * unit_to_m,
        rotations=continuous(rotations),
    )


def _body_warnings(clip: Clip, positions: Floats) -> tuple[str, ...]:
    warnings: list[str] = []
    leg = leg_length(positions, clip.roles)
    if leg is not None and not 0.45 <= leg <= 1.15:
        warnings.append(f"thigh and shank come to {leg:.2f} m; check unit_to_m ({clip.source.unit_to_m:g})")
    if sides_swapped(positions, clip.roles):
        warnings.append("left and right are swapped or the file is mirrored: the left leg is on the walker's right")
    if clip.frame_count > 2:
        turns = angle_between(clip.rotations[0], clip.rotations[1])
        next_turns = angle_between(clip.rotations[1], clip.rotations[2])
        if np.max(turns) > FAR_TURN and np.sum(turns) > 5 * np.sum(next_turns):
            warnings.append(
                f"the first frame differs from the second by up to {np.degrees(np.max(turns)):.0f} degrees and may "
                f"be an added T-pose; it was kept, give skip_frames 1 to leave it out"
            )
    return (*warnings, *_jumps(clip, positions))


def _jumps(clip: Clip, positions: Floats) -> tuple[str, ...]:
    """A sentence about the furthest jump of a joint after the second frame, if one goes faster than anybody moves."""
    played = sorted(clip.roles.values())
    if clip.frame_count < 3 or not played:
        return ()
    ways = np.linalg.norm(np.diff(positions[1:, played], axis=0), axis=2)
    frame, joint = np.unravel_index(int(np.argmax(ways)), ways.shape)
    if ways[frame, joint] * clip.rate <= JUMP:
        return ()
    return (
        f"from frame {frame + 2} to {frame + 3} {clip.joints[played[joint]]} jumps by {ways[frame, joint]:.2f} m; "
        f"fill that gap and export again, or cut it off",
    )
