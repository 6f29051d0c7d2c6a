"""Schreiber & Moissenet (2019) walks as Fourier coefficients: markers to segments, standing trial as zero.

Their C3D files give what CMU cannot: force-plate foot strikes, a standing trial, anatomical markers and the sex of
each person. Rotations of pelvis and thorax are relative to the standing trial; arms, thighs, shanks and feet are
directions between joint centres. Knows markers and the model's signals; nothing of regression. Needs ezc3d.
"""

from __future__ import annotations

import csv
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from stimuli.fitting.captures import Walk, average_stride
from stimuli.gait_model import MODEL_ARM
from stimuli.rotations import from_matrix, inverse, multiply, shortest_arc, to_exponential
from stimuli.skeleton import Floats

SHOULDER_DROP = 0.04
"""m, centre of the shoulder below the acromion marker (about, after Rab et al. 2002)."""

MISLABELLED = np.radians(40.0)
"""A trunk turned further than this from standing has its markers' names exchanged (one trial) and is left out."""

Markers = dict[str, Floats]
"""Marker name -> (T, 3) m; X left, Y up, Z the walking direction."""


@dataclass(frozen=True, eq=False)
class _Trial:
    markers: Markers
    rate: float
    first_frame: int


def read_walks(shared: Path) -> tuple[list[Walk], Floats]:
    """The walks of everyone whose markers are complete, and the mean inclination of thigh and shank when standing.

    shared: folder with mocap/ and gait-tables/. Returns walks and (2,) rad.
    """
    folder = shared / "mocap" / "c3d" / "schreiber-moissenet"
    events = _rows(shared / "mocap" / "REFERENCE_C3D_EVENTS.csv")
    walks, postures = [], {}
    for row in _rows(shared / "gait-tables" / "schreiber_moissenet_spatiotemporal.csv"):
        standing = _read(folder / f"{row['subject']}_ST.c3d")
        trial = _read(folder / f"{row['trial']}.c3d")
        if not all({"R_FME", "L_FME", "R_TAM", "L_TAM"} <= set(recording.markers) for recording in (standing, trial)):
            continue
        walk, posture = _walk(trial, standing, row, events)
        walks.append(walk)
        postures[row["subject"]] = posture
    return walks, np.asarray(np.mean(list(postures.values()), axis=0))


def _walk(trial: _Trial, standing: _Trial, row: dict[str, str], events: list[dict[str, str]]) -> tuple[Walk, Floats]:
    own = [event for event in events if Path(event["file"]).stem == row["trial"]]
    marks = {
        (side, kind): sorted(
            float(event["time_s"]) * trial.rate - trial.first_frame
            for event in own
            if event["context"] == side.capitalize() and kind in event["label"]
        )
        for side in ("left", "right")
        for kind in ("Strike", "Off")
    }
    signals, leg, _ = _signals(trial.markers, standing.markers)
    _, _, posture = _signals(standing.markers, standing.markers)
    strikes = {side: [round(frame) for frame in marks[side, "Strike"]] for side in ("left", "right")}
    shares = []
    for side in ("left", "right"):
        first, last = marks[side, "Strike"][:2]
        shares += [(off - first) / (last - first) for off in marks[side, "Off"] if first < off < last][:1]
    coefficients = average_stride(signals, strikes["right"], strikes["left"], leg)
    walk = Walk(
        name=row["trial"],
        person="SM-" + row["subject"],
        laboratory="SM",
        sex=0.5 if row["gender"] == "W" else -0.5,
        leg_length=leg,
        speed=float(row["speed_m_s"]),
        step_frequency=float(row["step_freq_steps_min"]),
        stance_share=float(np.mean(shares)) if shares else float("nan"),
        coefficients=coefficients,
    )
    return walk, posture


def _signals(markers: Markers, standing: Markers) -> tuple[dict[str, Floats], float, Floats]:
    """Per-frame signals as captures.average_stride takes them; leg length m; mean (thigh, shank) inclination rad."""
    signals: dict[str, Floats] = {}
    for segment, frame in (("hips", _pelvis), ("chest", _thorax)):
        zero = from_matrix(_without_yaw(frame(standing).mean(axis=0)))
        signals[segment] = to_exponential(multiply(from_matrix(frame(markers)), inverse(zero)))
        if np.abs(signals[segment]).max() > MISLABELLED:
            signals[segment] = np.full_like(signals[segment], np.nan)
    signals["spine"] = 0.5 * (signals["hips"] + signals["chest"])
    for segment in ("neck", "head"):
        signals[segment] = np.full_like(signals["hips"], np.nan)
    hips = _hip_centres(markers)
    signals["hips_shift"] = 0.5 * (hips["left"] + hips["right"])[:, 0]
    lengths, inclinations = [], []
    for side, sign in (("left", 1.0), ("right", -1.0)):
        mark = {name[2:]: place for name, place in markers.items() if name.startswith(side[0].upper() + "_")}
        knee, ankle = 0.5 * (mark["FLE"] + mark["FME"]), 0.5 * (mark["FAL"] + mark["TAM"])
        thigh, shank, foot = knee - hips[side], ankle - knee, mark["FM2"] - mark["FCC"]
        still = {name[2:]: place for name, place in standing.items() if name.startswith(side[0].upper() + "_")}
        flat = still["FM2"] - still["FCC"]
        signals[f"{side}thigh"], signals[f"{side}shank"] = _inclination(thigh), _inclination(shank)
        signals[f"{side}foot"] = _pitch(foot) - float(np.mean(_pitch(flat)))
        signals[f"{side}foot_yaw"] = np.arctan2(foot[:, 0], np.maximum(foot[:, 2], 0.05))
        outward = (mark["FLE"] - mark["FME"]) * sign
        signals[f"{side}knee_yaw"] = np.arctan2(-outward[:, 2], outward[:, 0])
        signals[f"{side}foot_shift"] = ankle[:, 0]
        signals[f"{side}shoulder"] = signals["chest"]
        elbow, wrist = 0.5 * (mark["HLE"] + mark["HME"]), 0.5 * (mark["RSP"] + mark["UHE"])
        knuckles = 0.5 * (mark["HM2"] + mark["HM5"])
        arm = MODEL_ARM * (sign, 1.0, 1.0)
        shoulder = mark["SAE"] - (0.0, SHOULDER_DROP, 0.0)
        for part, bone in (("upperArm", elbow - shoulder), ("lowerArm", wrist - elbow), ("hand", knuckles - wrist)):
            signals[side + part] = to_exponential(shortest_arc(np.broadcast_to(arm, bone.shape), bone))
        lengths.append(float(np.mean(np.linalg.norm(thigh, axis=1) + np.linalg.norm(shank, axis=1))))
        inclinations.append([np.mean(signals[f"{side}thigh"]), np.mean(signals[f"{side}shank"])])
    return signals, float(np.mean(lengths)), np.mean(inclinations, axis=0)


def _hip_centres(markers: Markers) -> Markers:
    """Hip joint centres from the pelvis markers by the regression of Harrington et al. (2007), "left" and "right"."""
    frame = _pelvis(markers)
    front = 0.5 * (markers["L_IAS"] + markers["R_IAS"])
    back = 0.5 * (markers["L_IPS"] + markers["R_IPS"])
    depth = float(np.mean(np.linalg.norm(front - back, axis=1)))
    width = float(np.mean(np.linalg.norm(markers["L_IAS"] - markers["R_IAS"], axis=1)))
    centres = {}
    for side, sign in (("left", 1.0), ("right", -1.0)):
        local = np.array([sign * (0.33 * width + 0.0073), -0.30 * width - 0.0109, -0.24 * depth - 0.0099])
        centres[side] = front + frame @ local
    return centres


def _pelvis(markers: Markers) -> Floats:
    """(T, 3, 3), columns left, up, forward."""
    front = 0.5 * (markers["L_IAS"] + markers["R_IAS"])
    back = 0.5 * (markers["L_IPS"] + markers["R_IPS"])
    left = _unit(markers["L_IAS"] - markers["R_IAS"])
    up = _unit(np.cross(front - back, left))
    return np.stack([left, up, np.cross(left, up)], axis=-1)


def _thorax(markers: Markers) -> Floats:
    """(T, 3, 3), columns left, up, forward."""
    upper, lower = 0.5 * (markers["CV7"] + markers["SJN"]), 0.5 * (markers["TV10"] + markers["SXS"])
    front, back = 0.5 * (markers["SXS"] + markers["SJN"]), 0.5 * (markers["TV10"] + markers["CV7"])
    up = _unit(upper - lower)
    left = _unit(np.cross(up, front - back))
    return np.stack([left, up, np.cross(left, up)], axis=-1)


def _without_yaw(frame: Floats) -> Floats:
    """A standing frame (3, 3), made orthonormal and turned to face forward."""
    angle = np.arctan2(frame[0, 2], frame[2, 2])
    turn = np.array([[np.cos(angle), 0, -np.sin(angle)], [0, 1, 0], [np.sin(angle), 0, np.cos(angle)]])
    left, up = turn @ frame[:, 0], turn @ frame[:, 1]
    left = _unit(left)
    up = _unit(up - left * (up @ left))
    return np.stack([left, up, np.cross(left, up)], axis=-1)


def _inclination(bone: Floats) -> Floats:
    return np.asarray(np.arctan2(bone[:, 2], -bone[:, 1]))


def _pitch(foot: Floats) -> Floats:
    return np.asarray(np.arctan2(foot[:, 1], np.hypot(foot[:, 0], foot[:, 2])))


def _unit(vectors: Floats) -> Floats:
    return np.asarray(vectors / np.linalg.norm(vectors, axis=-1, keepdims=True))


def _read(path: Path) -> _Trial:
    """Markers in our axes: up is the file's Z, forward the travel along X (or, standing, where the feet point)."""
    import ezc3d

    content = ezc3d.c3d(str(path))
    places = _filled(content["data"]["points"][:3].transpose(2, 1, 0) / 1000.0)
    names = list(content["parameters"]["POINT"]["LABELS"]["value"])
    marker = {name: places[:, index] for index, name in enumerate(names)}
    facing = np.nanmean(marker["R_FM2"] - marker["R_FCC"] + marker["L_FM2"] - marker["L_FCC"], axis=0)[0]
    sign = 1.0 if facing > 0 else -1.0
    ours = {name: np.stack([sign * p[:, 1], p[:, 2], sign * p[:, 0]], axis=1) for name, p in marker.items()}
    header = content["header"]["points"]
    return _Trial(ours, float(header["frame_rate"]), int(header["first_frame"]))


def _filled(places: Floats) -> Floats:
    """Positions (T, M, 3) with short gaps filled along a line; nan for a marker missing for a tenth of the time."""
    missing = np.isnan(places).any(axis=2) | (places == 0.0).all(axis=2)
    frames = np.arange(len(places))
    for marker in range(places.shape[1]):
        seen = ~missing[:, marker]
        if seen.mean() < 0.9:
            places[:, marker] = np.nan
        elif not seen.all():
            for axis in range(3):
                places[:, marker, axis] = np.interp(frames, frames[seen], places[seen, marker, axis])
    return places


def _rows(path: Path) -> list[dict[str, str]]:
    with path.open(newline="", encoding="utf-8") as stream:
        return list(csv.DictReader(stream))
