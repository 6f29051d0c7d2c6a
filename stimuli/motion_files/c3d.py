"""Reading C3D files: markers, foot events and what they say of the subject. Parsing itself is ezc3d's.

Screen axes in these files are often missing or wrong, so up is found from the markers (`find_up`). Event times count
from the start of the whole recording and are moved to the first frame of the file. The format: www.c3d.org.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from stimuli.clip import FootEvent, Source, Subject
from stimuli.motion_files.axes import axis_vector, nearest_axis, to_y_up
from stimuli.motion_files.c3d_header import check_header
from stimuli.motion_files.errors import MotionFileError
from stimuli.motion_files.marker_names import places_of
from stimuli.motion_files.markers import MarkerRecording
from stimuli.motion_files.sampling import rate_meant

Floats = NDArray[np.floating]

UNITS = {"m": 1.0, "meters": 1.0, "metres": 1.0, "dm": 0.1, "cm": 0.01, "mm": 0.001, "in": 0.0254, "inch": 0.0254}
NOT_POSITIONS = ("ANGLES", "MOMENTS", "POWERS", "FORCES", "SCALARS", "MODELED_MARKERS")
NOT_POSITION_ENDS = ("angles", "anglesv", "angle", "anglev", "power", "moment", "force", "grf", "#")
LEAST_TRAVEL = 0.5  # m, less is standing or a treadmill


def read_c3d(path: Path | str, *, unit_to_m: float | None = None, up: str | None = None) -> MarkerRecording:
    """The markers of a C3D file in metres, Y up, with its foot events and subject.

    unit_to_m: metres in one file unit; from POINT:UNITS if None, millimetres where that says nothing
    up:        the file's up axis, "+Z", "+Y", ...; found from the markers if None
    raises:    MotionFileError naming file and reason
    """
    path = Path(path)
    parameters, points, first_frame = _parse(path)
    group = parameters.get("POINT", {})
    rate = _number(group, "RATE")
    if rate is None or not 1 <= rate <= 10_000:
        raise MotionFileError(f"{path}: POINT:RATE is {rate} Hz, not between 1 and 10000; export the file again")
    labels = _labels(group, points.shape[1])
    kept, left_out = _positions_only(labels, group)
    points = _missing_to_nan(points[:, kept], path)
    names = tuple(labels[index] for index in kept)
    places = places_of(names)
    unit, warnings = _unit(group) if unit_to_m is None else (unit_to_m, ())
    if not (math.isfinite(unit) and unit > 0):
        raise MotionFileError(f"{path}: unit_to_m {unit} is not a positive number of metres")
    if up is None:
        up, more = find_up(points, places)
        warnings += more
    events, more = _events(parameters, rate, first_frame)
    return MarkerRecording(
        name=path.stem,
        labels=names,
        points=points * unit @ to_y_up(up).T,
        rate=rate_meant(1.0 / rate, f"{1.0 / rate:.7f}"),
        places=places,
        events=events,
        subject=_subject(parameters),
        source=Source("C3D", unit, up, _forward(points, places, up, LEAST_TRAVEL / unit), "markers", rate),
        left_out=tuple(labels[index] for index in left_out),
        warnings=warnings + more,
    )


def find_up(points: Floats, places: Mapping[str, int]) -> tuple[str, tuple[str, ...]]:
    """The file axis from the feet to the pelvis or trunk, and warnings. points: (T, M, 3), file axes."""
    low = [places[p] for p in places if p.endswith(("heel", "toe", "ankle"))]
    high = [places[p] for p in places if p.endswith(("asis", "psis")) or p in ("sacrum", "c7", "jugular")]
    if low and high:
        differences = _mean_place(points, high) - _mean_place(points, low)
        differences = differences[np.all(np.isfinite(differences), axis=1)]
        axis = nearest_axis(differences.mean(axis=0)) if len(differences) else "+Z"
        along = differences @ axis_vector(axis)
        steep = along > 0.7 * np.linalg.norm(differences, axis=1)
        if len(differences) and np.mean(steep) > 0.7:  # else the markers are no body, or one lying down
            return axis, ()
    return "+Z", ("up could not be told from the markers and was taken to be +Z; give up if it is another axis",)


def _forward(points: Floats, places: Mapping[str, int], up: str, least: float) -> str:
    body = [places[p] for p in places if p.endswith(("asis", "psis")) or p == "sacrum"]
    if not body:
        return ""
    path = _mean_place(points, body)
    path = path[np.all(np.isfinite(path), axis=1)]
    if len(path) < 2:
        return ""
    travel = (path[-1] - path[0]) * (np.abs(axis_vector(up)) < 0.5)
    return nearest_axis(travel) if np.linalg.norm(travel) > least else ""


def _mean_place(points: Floats, indices: list[int]) -> Floats:
    """(T, 3): mean of those of the markers that are seen in each frame; NaN where none is."""
    seen = np.isfinite(points[:, indices])
    total = np.sum(np.where(seen, points[:, indices], 0.0), axis=1)
    return np.where(seen.any(axis=1), total / np.maximum(seen.sum(axis=1), 1), np.nan)


def _parse(path: Path) -> tuple[dict[str, Any], Floats, int]:
    """ezc3d's parameters, points (T, M, 3) in file units, and the first frame's number in the recording (from 0)."""
    check_header(path)
    try:
        import ezc3d
    except ImportError as error:
        raise MotionFileError(
            f"{path}: reading C3D files needs ezc3d; install it with: pip install 'gaitlab[mocap]'"
        ) from error
    try:
        content = ezc3d.c3d(str(path))
        points = np.asarray(content["data"]["points"], dtype=np.float64)[:3].transpose(2, 1, 0)
        parameters = {name: group for name, group in content["parameters"].items() if hasattr(group, "items")}
        first_frame = int(content["header"]["points"]["first_frame"])
    except Exception as error:  # ezc3d raises what its C++ and NumPy raise, of many types
        reason = " ".join(str(error).split())[:160] or type(error).__name__
        raise MotionFileError(f"{path}: ezc3d cannot read this C3D file ({reason}); export it again") from error
    if points.shape[0] < 1 or points.shape[1] < 1:
        raise MotionFileError(f"{path}: holds no markers; export the trajectories with the trial")
    return parameters, points, first_frame


def _value(group: Mapping[str, Any], key: str) -> Any:
    entry = group.get(key)
    return entry.get("value") if isinstance(entry, Mapping) else None


def _number(group: Mapping[str, Any], key: str) -> float | None:
    try:
        number = float(np.ravel(np.asarray(_value(group, key), dtype=np.float64))[0])
    except (TypeError, ValueError, IndexError):
        return None
    return number if math.isfinite(number) else None


def _words(group: Mapping[str, Any], key: str) -> list[str]:
    value = _value(group, key)
    return [str(word).strip() for word in value] if isinstance(value, list) else []


def _labels(group: Mapping[str, Any], count: int) -> list[str]:
    """As many different labels as points, from LABELS, LABELS2, ...; "*7" for the eighth where there is none."""
    words = _words(group, "LABELS")
    for number in range(2, 10):
        words += _words(group, f"LABELS{number}") if len(words) < count else []
    words = [words[i] if i < len(words) and words[i] else f"*{i}" for i in range(count)]
    seen: dict[str, int] = {}
    different = []
    for word in words:
        seen[word] = seen.get(word, 0) + 1
        different.append(word if seen[word] == 1 else f"{word}#{seen[word]}")
    return different


def _positions_only(labels: list[str], group: Mapping[str, Any]) -> tuple[list[int], list[int]]:
    named = {label for kind in NOT_POSITIONS[:5] for label in _words(group, kind)}
    other = [i for i, label in enumerate(labels) if label in named or label.lower().endswith(NOT_POSITION_ENDS)]
    return [i for i in range(len(labels)) if i not in other], other


def _missing_to_nan(points: Floats, path: Path) -> Floats:
    """Markers at exactly (0, 0, 0), beyond 1e9 or not finite were not seen; ezc3d gives NaN for residuals below 0."""
    with np.errstate(invalid="ignore"):
        missing = np.all(points == 0, axis=-1) | ~np.all(np.abs(points) < 1e9, axis=-1)
    if points.size == 0 or np.all(missing):
        raise MotionFileError(f"{path}: no marker is seen in any frame; export the trajectories with the trial")
    return np.where(missing[..., None], np.nan, points)


def _unit(group: Mapping[str, Any]) -> tuple[float, tuple[str, ...]]:
    words = _words(group, "UNITS")
    word = words[0].lower() if words else ""
    if word in UNITS:
        return UNITS[word], ()
    said = f"says {word!r}" if word else "is missing"
    return 0.001, (f"POINT:UNITS {said}; millimetres were assumed, give unit_to_m if that is wrong",)


def _events(
    parameters: Mapping[str, Any], rate: float, first_frame: int
) -> tuple[tuple[FootEvent, ...], tuple[str, ...]]:
    """Foot events in order, s from the file's first frame: strikes ("Foot Strike", "Foot Strike1", ...) and offs."""
    group = parameters.get("EVENT", {})
    contexts, labels = _words(group, "CONTEXTS"), _words(group, "LABELS")
    try:
        times = np.asarray(_value(group, "TIMES"), dtype=np.float64)
    except (TypeError, ValueError):
        return (), ()
    if times.ndim == 1 and times.size % 2 == 0:
        times = times.reshape(-1, 2).T  # minutes and seconds one after the other
    if times.ndim != 2 or times.shape[0] != 2 or times.shape[1] < 1 or not contexts:
        return (), ()
    start = _number(parameters.get("TRIAL", {}), "ACTUAL_START_FIELD")
    offset = (first_frame if start is None else start - 1) / rate
    seconds = 60 * times[0] + times[1] - offset
    found = set()
    for time, context, label in zip(seconds, contexts, labels, strict=False):
        word, side = label.lower().replace(" ", ""), context.lower()
        kind = "strike" if word.startswith("footstrike") else "off" if word.startswith("footoff") else ""
        if kind and side in ("left", "right") and math.isfinite(time):
            found.add(FootEvent(float(time), side, kind))
    early = [event for event in found if event.time < -0.5 / rate]
    warning = f"{len(early)} foot events lie before the file's first frame and were left out"
    return tuple(sorted(found - set(early))), (warning,) if early else ()


def _subject(parameters: Mapping[str, Any]) -> Subject:
    """From SUBJECT:LABELS and VALUES (Schreiber & Moissenet) or PROCESSING (Vicon, mm). No name is read."""
    group, processing = parameters.get("SUBJECT", {}), parameters.get("PROCESSING", {})
    try:
        values = np.ravel(np.asarray(_value(group, "VALUES"), dtype=np.float64)).tolist()
    except (TypeError, ValueError):  # words, such as "1.80 m"
        values = []
    said = {what: value for what, value in zip(_words(group, "LABELS"), values, strict=False) if math.isfinite(value)}
    legs = [said[k] for k in ("R_legLength", "L_legLength") if k in said] or [
        length / 1000 for k in ("RLegLength", "LLegLength") if (length := _number(processing, k))
    ]
    height, mass = said.get("height"), said.get("weight")
    if height is None and (millimetres := _number(processing, "Height")):
        height = millimetres / 1000
    if mass is None:
        mass = _number(processing, "Bodymass")
    return Subject(
        sex={0.0: "female", 1.0: "male"}.get(said.get("gender", -1.0)),
        age=said.get("age"),
        height=height,
        mass=mass,
        leg_length=sum(legs) / len(legs) if legs else None,
    )
