"""Reading BVH (Biovision hierarchy) files from any source. Knows nothing of gait.

Position channels replace a joint's OFFSET and are never added to it; channels and their order are taken joint by
joint; unit and axes are found from the body (see `axes`) unless given.
"""

from __future__ import annotations

import warnings
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from stimuli.clip import Clip
from stimuli.motion_files.building import Motion, build_clip
from stimuli.motion_files.errors import MotionFileError
from stimuli.motion_files.sampling import rate_meant
from stimuli.rotations import from_euler

Floats = NDArray[np.floating]

LARGEST = 1 << 29  # bytes; an hour of 120 Hz body motion is a third of it


@dataclass
class _Joint:
    name: str
    parent: int
    offset: tuple[float, ...] = (0.0, 0.0, 0.0)
    channels: list[str] = field(default_factory=list)


def read_bvh(
    path: Path | str,
    *,
    unit_to_m: float | None = None,
    up: str | None = None,
    rate: float | None = None,
    skip_frames: int = 0,
    roles: Mapping[str, str] | None = None,
) -> Clip:
    """The motion in a BVH file.

    unit_to_m:   metres in one file unit; found from the legs' length if None
    up:          the file's up axis, "+Y", "+Z", ...; found from the posed body if None
    rate:        Hz; the file's frame time set to the whole rate it means if None
    skip_frames: frames to leave out at the start, such as an added T-pose
    roles:       VRM humanoid joint name -> joint name in the file, over what the tables say
    raises:      MotionFileError naming file, line and value
    """
    path = Path(path)
    lines = _read_lines(path)
    joints, motion_line = _read_hierarchy(path, lines)
    frame_count, frame_time, written, first_value_line = _read_motion_header(path, lines, motion_line)
    values = _read_values(path, lines, first_value_line, frame_count, joints)
    translations, rotations = _local_motion(joints, values)
    motion = Motion(
        format="BVH",
        path=path,
        joints=tuple(joint.name for joint in joints),
        parents=tuple(joint.parent for joint in joints),
        offsets=np.array([joint.offset for joint in joints]),
        translations=translations,
        rotations=rotations,
        rate=rate_meant(frame_time, written) if rate is None else rate,
        file_rate=1.0 / frame_time,
    )
    return build_clip(motion, unit_to_m=unit_to_m, up=up, skip_frames=skip_frames, roles=roles)


def _read_lines(path: Path) -> list[str]:
    try:
        if path.stat().st_size > LARGEST:
            raise MotionFileError(f"{path}: larger than {LARGEST >> 20} MB; cut the recording into shorter clips")
        text = path.read_bytes().decode("utf-8-sig", errors="replace")
    except OSError as error:
        raise MotionFileError(f"{path}: cannot be read ({error.strerror or error})") from error
    return text.replace("\r\n", "\n").replace("\r", "\n").split("\n")


def _read_hierarchy(path: Path, lines: list[str]) -> tuple[list[_Joint], int]:
    """All joints, end sites among them, and the index of the MOTION line."""
    if not lines or lines[0].strip().upper() != "HIERARCHY":
        raise MotionFileError(f"{path}, line 1: a BVH file begins with HIERARCHY, this one with {lines[0][:30]!r}")
    joints: list[_Joint] = []
    open_joints: list[int] = []
    opened = 0  # joints whose brace has been met
    for number, line in enumerate(lines[1:], start=2):
        words = line.replace("{", " { ").replace("}", " } ").split()
        place = f"{path}, line {number}"
        while words:
            keyword = words.pop(0).upper()
            if keyword == "MOTION":
                _check_hierarchy(path, joints, open_joints, place)
                return joints, number - 1
            if keyword in ("ROOT", "JOINT", "END"):
                end = words.index("{") if "{" in words else len(words)
                named, words = " ".join(words[:end]), words[end:]
                parent = open_joints[-1] if open_joints else -1
                _check_place(place, keyword, named, parent, joints)
                joints.append(_Joint(f"{joints[parent].name} end" if keyword == "END" else named, parent))
            elif keyword == "{":
                if len(joints) == opened:
                    raise MotionFileError(f"{place}: an opening brace without ROOT, JOINT or End Site before it")
                open_joints.append(len(joints) - 1)
                opened = len(joints)
            elif keyword == "}":
                if not open_joints:
                    raise MotionFileError(f"{place}: a closing brace without an opening one; export the file again")
                open_joints.pop()
            elif keyword == "OFFSET" and open_joints:
                joints[open_joints[-1]].offset = _three_numbers(place, words)
                words = words[3:]
            elif keyword == "CHANNELS" and open_joints:
                joints[open_joints[-1]].channels = _channels(place, words)
                words = words[1 + len(joints[open_joints[-1]].channels) :]
            else:
                raise MotionFileError(
                    f"{place}: {keyword[:30]!r} where ROOT, JOINT, End Site, OFFSET, CHANNELS, a brace or MOTION "
                    f"is expected; export the file again"
                )
    raise MotionFileError(f"{path}: ends before the line MOTION, so it is cut off; export it again")


def _check_place(place: str, keyword: str, named: str, parent: int, joints: list[_Joint]) -> None:
    if keyword == "ROOT" and joints:
        raise MotionFileError(f"{place}: a second skeleton ({named!r}) in one file; export each person to a file")
    if keyword != "ROOT" and parent < 0:
        raise MotionFileError(f"{place}: {keyword} {named!r} outside the ROOT; export the file again")
    if keyword != "END" and not named:
        raise MotionFileError(f"{place}: {keyword} without a name; name the joint")


def _check_hierarchy(path: Path, joints: list[_Joint], open_joints: list[int], place: str) -> None:
    if open_joints:
        raise MotionFileError(f"{place}: {len(open_joints)} braces are still open at MOTION; export the file again")
    if not any(joint.channels for joint in joints):
        raise MotionFileError(f"{path}: no joint has a channel, so nothing moves; export the motion with the skeleton")


def _three_numbers(place: str, words: list[str]) -> tuple[float, ...]:
    try:
        numbers = tuple(float(word) for word in words[:3])
    except ValueError:
        numbers = ()
    if len(numbers) != 3 or not np.all(np.isfinite(numbers)):
        raise MotionFileError(f"{place}: OFFSET {' '.join(words[:3])!r} is not three numbers; export the file again")
    return numbers


def _channels(place: str, words: list[str]) -> list[str]:
    count = int(words[0]) if words and words[0].isdecimal() and len(words[0]) < 3 else -1
    names = [word.lower() for word in words[1 : 1 + max(count, 0)]]
    allowed = {axis + kind for axis in "xyz" for kind in ("position", "rotation")}
    if count != len(names) or not set(names) <= allowed or len(set(names)) != len(names):
        raise MotionFileError(
            f"{place}: CHANNELS {' '.join(words)[:80]!r} is not a number and as many different names out of "
            f"Xposition, ... Zrotation"
        )
    return names


def _read_motion_header(path: Path, lines: list[str], motion_line: int) -> tuple[int, float, str, int]:
    """Number of frames, frame time (s), the frame time as written, and the line index of the first value."""
    found: dict[str, str] = {}
    index = motion_line + 1
    while index < len(lines) and len(found) < 2:
        key, colon, value = lines[index].partition(":")
        if lines[index].strip():
            if not colon or " ".join(key.lower().split()) not in ("frames", "frame time"):
                break
            found[" ".join(key.lower().split())] = value.strip()
        index += 1
    place = f"{path}, after line {motion_line + 1}"
    try:
        frame_count, frame_time = int(found["frames"]), float(found["frame time"])
    except (KeyError, ValueError) as error:
        raise MotionFileError(f"{place}: no 'Frames: N' and 'Frame Time: seconds' with numbers") from error
    if frame_count < 1:
        raise MotionFileError(f"{place}: Frames: {frame_count}, so there is no motion; export the motion with it")
    if not 1e-5 < frame_time < 10:
        raise MotionFileError(f"{place}: Frame Time: {found['frame time']} s is not between 0.00001 and 10 s")
    return frame_count, frame_time, found["frame time"], index


def _read_values(path: Path, lines: list[str], first: int, frame_count: int, joints: list[_Joint]) -> Floats:
    """(T, channels) numbers as in the file."""
    width = sum(len(joint.channels) for joint in joints)
    with warnings.catch_warnings():
        warnings.simplefilter("error", DeprecationWarning)
        try:
            values = np.fromstring("\n".join(lines[first:]), sep=" ")
        except (DeprecationWarning, ValueError) as error:
            raise _bad_number(path, lines, first) from error
    if values.size != frame_count * width:
        raise MotionFileError(
            f"{path}: {values.size} motion values where {frame_count} frames of {width} channels make "
            f"{frame_count * width}; the file is cut off or garbled, export it again"
        )
    values = values.reshape(frame_count, width)
    if not np.all(np.isfinite(values)):
        frame = int(np.argmin(np.all(np.isfinite(values), axis=1)))
        raise MotionFileError(f"{path}, frame {frame + 1}: a value is no finite number; fill the gap, export again")
    return values


def _bad_number(path: Path, lines: list[str], first: int) -> MotionFileError:
    for number, line in enumerate(lines[first:], start=first + 1):
        for word in line.split():
            try:
                float(word)
            except ValueError:
                return MotionFileError(f"{path}, line {number}: {word[:30]!r} is not a number; export the file again")
    return MotionFileError(f"{path}: the motion values cannot be read as numbers; export the file again")


def _local_motion(joints: list[_Joint], values: Floats) -> tuple[Floats, Floats]:
    """Translations (T, J, 3) in file units and rotations (T, J, 4) from channels (T, channels)."""
    offsets = np.array([joint.offset for joint in joints])
    translations = np.repeat(offsets[None], len(values), axis=0)
    rotations = np.zeros((len(values), len(joints), 4))
    rotations[..., 3] = 1.0
    column = 0
    for index, joint in enumerate(joints):
        own = values[:, column : column + len(joint.channels)]
        column += len(joint.channels)
        turning = [k for k, name in enumerate(joint.channels) if name.endswith("rotation")]
        for k, name in enumerate(joint.channels):
            if name.endswith("position"):
                translations[:, index, "xyz".index(name[0])] = own[:, k]
        order = "".join(joint.channels[k][0] for k in turning)
        rotations[:, index] = from_euler(order, np.radians(own[:, turning]))
    return translations, rotations
