"""Reading Xsens MVNX files (versions 3 and 4): segments, their joints, and the frames of type "normal".

Segments have their origin at their upper joint, so a segment plays a joint. Calibration frames ("identity", "tpose",
"tpose-isb") are no motion and are left out; recording date and original file name may name people and are not read.
Layout: Xsens MVN user manual, chapter on the MVNX file format.
"""

from __future__ import annotations

import xml.etree.ElementTree as ElementTree
from collections.abc import Mapping
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from stimuli.clip import Clip
from stimuli.motion_files.building import build_clip
from stimuli.motion_files.errors import MotionFileError
from stimuli.motion_files.sampling import rate_meant
from stimuli.motion_files.world_motion import motion_from_world, parents_first
from stimuli.rotations import normalise

Floats = NDArray[np.floating]


def read_mvnx(
    path: Path | str,
    *,
    unit_to_m: float | None = 1.0,
    up: str | None = None,
    rate: float | None = None,
    skip_frames: int = 0,
    roles: Mapping[str, str] | None = None,
) -> Clip:
    """The motion in an MVNX file; arguments as for `read_bvh`, the unit being metres by the format.

    raises: MotionFileError naming file, frame and reason
    """
    path = Path(path)
    root = _parse(path)
    subject = next(_all(root, "subject"), root)
    segments, points = _segments(path, subject)
    parents, rest_offsets = _tree(path, subject, segments, points)
    order = _order(path, parents)
    rotations, places = _frames(path, subject, len(segments))
    file_rate = _rate(path, subject, rate)
    new_index = {old: new for new, old in enumerate(order)}
    new_parents = [new_index[parents[old]] if parents[old] >= 0 else -1 for old in order]
    offsets = rest_offsets[order]
    rest_places = np.zeros_like(offsets)
    for joint, parent in enumerate(new_parents):
        rest_places[joint] = offsets[joint] + (rest_places[parent] if parent >= 0 else 0.0)
    motion = motion_from_world(
        "MVNX",
        path,
        [segments[old] for old in order],
        new_parents,
        (np.tile([0.0, 0.0, 0.0, 1.0], (len(order), 1)), rest_places),
        (rotations[:, order], places[:, order]),
        rate_meant(1.0 / file_rate, f"{1.0 / file_rate:.7f}") if rate is None else rate,
        file_rate,
    )
    return build_clip(motion, unit_to_m=unit_to_m, up=up, skip_frames=skip_frames, roles=roles)


def _parse(path: Path) -> ElementTree.Element:
    try:
        data = path.read_bytes()
    except OSError as error:
        raise MotionFileError(f"{path}: cannot be read ({error.strerror or error})") from error
    if b"<!ENTITY" in data:
        raise MotionFileError(f"{path}: defines XML entities, which no MVNX file needs; export it again")
    try:
        return ElementTree.fromstring(data)
    except (ElementTree.ParseError, ValueError, LookupError) as error:
        raise MotionFileError(f"{path}: is no whole XML file ({error}); export it again") from error


def _name(element: ElementTree.Element) -> str:
    return element.tag.rsplit("}", 1)[-1] if isinstance(element.tag, str) else ""


def _all(element: ElementTree.Element, name: str):  # type: ignore[no-untyped-def]
    return (found for found in element.iter() if _name(found) == name)


def _numbers(path: Path, text: str | None, count: int, what: str) -> list[float]:
    try:
        numbers = [float(word) for word in (text or "").split()]
    except ValueError as error:
        raise MotionFileError(f"{path}: {what} holds something that is no number; export it again") from error
    if len(numbers) != count or not np.all(np.isfinite(numbers)):
        raise MotionFileError(f"{path}: {what} has {len(numbers)} finite numbers where {count} belong; export it again")
    return numbers


def _segments(path: Path, subject: ElementTree.Element) -> tuple[list[str], dict[str, list[float]]]:
    """Labels of the segments, and place (m, in the segment's axes) of each of their points by "Segment/point"."""
    labels: list[str] = []
    points: dict[str, list[float]] = {}
    for segment in _all(subject, "segment"):
        label = segment.get("label", "")
        labels.append(label)
        for point in _all(segment, "point"):
            name = f"{label}/{point.get('label', '')}"
            place = next(_all(point, "pos_b"), None)
            if place is not None:
                points[name] = _numbers(path, place.text, 3, f"point {name}")
    if not labels or len(set(labels)) != len(labels):
        raise MotionFileError(f"{path}: lists no segments, or one twice; export it again as MVNX")
    return labels, points


def _tree(
    path: Path, subject: ElementTree.Element, segments: list[str], points: dict[str, list[float]]
) -> tuple[list[int], Floats]:
    parents, offsets = [-1] * len(segments), np.zeros((len(segments), 3))
    for joint in _all(subject, "joint"):
        ends = [next(_all(joint, f"connector{k}"), None) for k in (1, 2)]
        words = [(end.text or "").strip() if end is not None else "" for end in ends]
        above, below = (word.split("/")[0] for word in words)
        if above not in segments or below not in segments:
            raise MotionFileError(f"{path}: joint {joint.get('label')!r} joins segments that are not listed")
        parents[segments.index(below)] = segments.index(above)
        offsets[segments.index(below)] = points.get(words[0], [0.0, 0.0, 0.0])
    return parents, offsets


def _order(path: Path, parents: list[int]) -> list[int]:
    try:
        return parents_first(parents)
    except ValueError as error:
        raise MotionFileError(f"{path}: its joints form no tree ({error}); export it again") from error


def _frames(path: Path, subject: ElementTree.Element, count: int) -> tuple[Floats, Floats]:
    """World rotations (T, S, 4) x y z w and places (T, S, 3) of the normal frames."""
    rotations: list[list[float]] = []
    places: list[list[float]] = []
    for frame in _all(subject, "frame"):
        if frame.get("type", "normal") != "normal":
            continue
        what = f"frame {frame.get('index', len(rotations))}"
        orientation, position = (next(_all(frame, name), None) for name in ("orientation", "position"))
        if orientation is None or position is None:
            raise MotionFileError(f"{path}: {what} has no orientation and position; export them with the motion")
        rotations.append(_numbers(path, orientation.text, 4 * count, f"{what}, orientation"))
        places.append(_numbers(path, position.text, 3 * count, f"{what}, position"))
    if not rotations:
        raise MotionFileError(f"{path}: holds no frame of type normal; export the motion, not only the calibration")
    wxyz = np.array(rotations).reshape(-1, count, 4)
    if np.any(np.linalg.norm(wxyz, axis=-1) < 0.5):
        raise MotionFileError(f"{path}: an orientation is no unit quaternion; export it again")
    return normalise(wxyz[..., [1, 2, 3, 0]]), np.array(places).reshape(-1, count, 3)


def _rate(path: Path, subject: ElementTree.Element, given: float | None) -> float:
    """Hz as the file says; nan where it says none and one is given."""
    try:
        rate = float(subject.get("frameRate", ""))
    except ValueError:
        rate = float("nan")
    if 1 <= rate <= 10_000:
        return rate
    if given is None:
        raise MotionFileError(f"{path}: frameRate {subject.get('frameRate')!r} is not 1 to 10000 Hz; give rate")
    return float("nan")
