"""From markers to a walking skeleton: segments scaled to the person, then all markers fitted at once.

The pose of every frame minimises the squared distances of all markers and joint centres from where a skeleton of
constant bone lengths carries them (marker_fitting.py).
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from stimuli.clip import Clip
from stimuli.motion_files.errors import MotionFileError
from stimuli.motion_files.joint_centres import joint_centres, pelvis_axes, unit
from stimuli.motion_files.marked_body import Body
from stimuli.motion_files.marker_fitting import fitted, places
from stimuli.motion_files.markers import MarkerRecording, filled, seen_part
from stimuli.rotations import continuous, from_matrix, inverse, multiply
from stimuli.skeleton import JOINTS, role_parents

Floats = NDArray[np.floating]

NEEDED = ("asis", "lateral_knee", "lateral_ankle", "heel", "toe")
CARRIED = {
    "UpperLeg": ("trochanter", "thigh", "lateral_knee", "medial_knee"),
    "LowerLeg": ("fibula_head", "tibial_tuberosity", "shank", "lateral_ankle", "medial_ankle"),
    "Foot": ("heel", "first_toe", "toe", "fifth_toe"),
    "Shoulder": ("shoulder",),
    "UpperArm": ("lateral_elbow", "medial_elbow"),
    "LowerArm": ("thumb_wrist", "little_wrist"),
    "Hand": ("finger", "little_finger"),
}


@dataclass(frozen=True, eq=False)
class MarkerFit:
    """A skeleton fitted to markers, and how well.

    residual:          m, root mean square distance of markers from the skeleton's
    marker_residuals:  place -> m, root mean square over frames
    centre_distances:  VRM humanoid joint -> m, largest distance over frames from the joint centre of its markers
    """

    clip: Clip
    residual: float
    marker_residuals: dict[str, float]
    centre_distances: dict[str, float]


@dataclass(frozen=True, eq=False)
class _Skeleton:
    """A body with the names of its joints and, per joint, the places of its markers."""

    joints: tuple[str, ...]
    markers: tuple[tuple[str, ...], ...]
    body: Body


def markers_to_clip(recording: MarkerRecording) -> Clip:
    """The skeleton's motion as a clip; see `fit_markers`."""
    return fit_markers(recording).clip


def fit_markers(recording: MarkerRecording) -> MarkerFit:
    """A skeleton of the person in a marker recording, moving as the markers do.

    Needs front and back pelvis markers, lateral knees and ankles, heels and toes (Plug-in-Gait, Schreiber & Moissenet
    and their kin); trunk and arms are added where their markers are. Raises MotionFileError naming what is missing.
    """
    seen = _seen(recording)
    _check(recording, seen)
    recording = seen_part(recording, [place for place in seen if place.endswith(NEEDED)])
    raw = {place: recording.path_of(place) for place in seen}
    paths = {place: filled(path) for place, path in raw.items()}
    centres = joint_centres(paths)
    joints = tuple(joint for joint in JOINTS if joint in centres)
    guess = _first_guess(paths, centres, joints)
    skeleton = _skeleton(joints, centres, paths, guess)
    targets = [np.stack([raw[place] for place in own], axis=1) if own else None for own in skeleton.markers]
    wanted = [np.stack([of[joint] for joint in joints], axis=1) for of in (centres, guess)]
    rotations, root = fitted(skeleton.body, targets, wanted[0], wanted[1])
    clip = _clip(recording, skeleton, rotations, root)
    return _judged(clip, skeleton, raw, centres, rotations, root)


def _seen(recording: MarkerRecording) -> list[str]:
    return [p for p, index in recording.places.items() if np.isfinite(recording.points[:, index]).all(axis=-1).any()]


def _check(recording: MarkerRecording, places: list[str]) -> None:
    missing = [f"{side}_{place}" for side in ("left", "right") for place in NEEDED if f"{side}_{place}" not in places]
    if "sacrum" not in places and not {"left_psis", "right_psis"} <= set(places):
        missing.append("left_psis and right_psis, or sacrum")
    if missing:
        raise MotionFileError(
            f"{recording.name}: no marker is seen at {', '.join(missing)}; a skeleton needs them, labelled as in "
            f"Plug-in-Gait or by Schreiber & Moissenet"
        )


def _axes(up: Floats, left: Floats) -> Floats:
    """(T, 3, 3) with columns left, up, forward: up kept, left made square to it."""
    up = unit(up)
    left = unit(left - np.sum(left * up, axis=-1, keepdims=True) * up)
    return np.stack([left, up, np.cross(left, up)], axis=-1)


def _first_guess(paths: dict[str, Floats], centres: dict[str, Floats], joints: tuple[str, ...]) -> dict[str, Floats]:
    """Joint -> (T, 3, 3) anatomical axes: bones along -Y, left +X; feet and pelvis as they stand."""
    _, left, up, _ = pelvis_axes(paths)
    guess = {"hips": _axes(up * 0 + up, left)}
    if "spine" in joints:
        shoulders = (
            paths["left_shoulder"] - paths["right_shoulder"]
            if {"left_shoulder", "right_shoulder"} <= set(paths)
            else left
        )
        trunk = _axes(centres["neck"] - centres["spine"], shoulders)
        guess.update({joint: trunk for joint in ("spine", "chest", "neck", "head") if joint in joints})
    for side, sign in (("left", 1.0), ("right", -1.0)):
        knee = _across(paths, f"{side}_lateral_knee", f"{side}_medial_knee", sign, left)
        ankle = _across(paths, f"{side}_lateral_ankle", f"{side}_medial_ankle", sign, left)
        hip, mid, low = (centres[side + part] for part in ("UpperLeg", "LowerLeg", "Foot"))
        guess[f"{side}UpperLeg"] = _axes(hip - mid, knee)
        guess[f"{side}LowerLeg"] = _axes(mid - low, ankle)
        guess[f"{side}Foot"] = guess[f"{side}Toes"] = _foot_axes(paths, side, ankle)
        for part, below in (("Shoulder", ""), ("UpperArm", "LowerArm"), ("LowerArm", "Hand"), ("Hand", "")):
            joint = side + part
            if joint not in joints:
                continue
            above = guess.get(f"{side}LowerArm" if part == "Hand" else "chest", guess["hips"])
            guess[joint] = above
            if below and side + below in joints:
                elbow = _across(paths, f"{side}_lateral_elbow", f"{side}_medial_elbow", sign, above[..., 0])
                guess[joint] = _axes(centres[joint] - centres[side + below], elbow)
    return guess


def _across(paths: dict[str, Floats], lateral: str, medial: str, sign: float, default: Floats) -> Floats:
    """(T, 3) a joint's axis pointing left; the default without its medial marker."""
    return sign * (paths[lateral] - paths[medial]) if lateral in paths and medial in paths else default


def _foot_axes(paths: dict[str, Floats], side: str, left: Floats) -> Floats:
    """(T, 3, 3) axes of a foot in which it stands level: its posture in the frames it moves least is unturned."""
    heel, toe = paths[f"{side}_heel"], paths[f"{side}_toe"]
    forward = unit(toe - heel)
    left = unit(left - np.sum(left * forward, axis=-1, keepdims=True) * forward)
    axes = np.stack([left, np.cross(forward, left), forward], axis=-1)
    speed = np.linalg.norm(np.gradient(heel + toe, axis=0), axis=1) if len(heel) > 1 else np.zeros(1)
    still = speed <= np.quantile(speed, 0.15)
    ahead = forward[still] * [1.0, 0.0, 1.0]
    level = _axes(np.tile([0.0, 1.0, 0.0], (int(still.sum()), 1)), np.cross([0.0, 1.0, 0.0], ahead))
    correction = _nearest_rotation(np.mean(np.swapaxes(axes[still], -1, -2) @ level, axis=0))
    return axes @ correction


def _nearest_rotation(matrix: Floats) -> Floats:
    """(3, 3) the rotation nearest to a matrix in the least squares sense."""
    u, _, v = np.linalg.svd(matrix)
    return np.asarray(u * [1.0, 1.0, np.sign(np.linalg.det(u @ v))] @ v)


def _skeleton(
    joints: tuple[str, ...], centres: dict[str, Floats], paths: dict[str, Floats], guess: dict[str, Floats]
) -> _Skeleton:
    """Offsets and marker places as their means over all frames, seen from the first guess of the axes."""
    parents = role_parents(joints)
    offsets = np.zeros((len(joints), 3))
    for index, parent in enumerate(parents):
        if parent >= 0:
            joint, above = joints[index], joints[parent]
            offsets[index] = _seen_from(centres[joint], centres[above], guess[above])
    markers = tuple(_markers_of(joint, paths, joints) for joint in joints)
    local = tuple(
        np.array([_seen_from(paths[place], centres[joint], guess[joint]) for place in own]).reshape(-1, 3)
        for joint, own in zip(joints, markers, strict=True)
    )
    return _Skeleton(joints, markers, Body(parents, offsets, local))


def _seen_from(points: Floats, origin: Floats, axes: Floats) -> Floats:
    """(3,) m: mean over frames of a point in moving axes."""
    return np.asarray(np.mean(np.einsum("tji,tj->ti", axes, points - origin), axis=0))


def _markers_of(joint: str, paths: dict[str, Floats], joints: tuple[str, ...]) -> tuple[str, ...]:
    if joint == "hips":
        own: tuple[str, ...] = ("left_asis", "right_asis", "left_psis", "right_psis", "sacrum")
    elif joint == "spine":
        own = ("c7", "t10", "jugular", "xiphoid")
    elif joint == "neck":
        own = ("left_front_head", "right_front_head", "left_back_head", "right_back_head")
        own = own if "head" in joints else ()
    else:
        side = next((side for side in ("left", "right") if joint.startswith(side)), "")
        own = tuple(f"{side}_{place}" for place in CARRIED.get(joint.removeprefix(side), ()))
    return tuple(place for place in own if place in paths)


def _clip(recording: MarkerRecording, skeleton: _Skeleton, rotations: Floats, root: Floats) -> Clip:
    body, joints = skeleton.body, skeleton.joints
    world = from_matrix(rotations)
    local = np.array(world)
    for joint, parent in enumerate(body.parents):
        if parent >= 0:
            local[:, joint] = multiply(inverse(world[:, parent]), world[:, joint])
    translations = np.repeat(body.offsets[None], len(root), axis=0)
    translations[:, 0] = root
    return Clip(
        name=recording.name,
        joints=joints,
        parents=body.parents,
        offsets=body.offsets,
        translations=translations,
        rotations=continuous(local),
        rate=recording.rate,
        roles={joint: index for index, joint in enumerate(joints)},
        source=replace(recording.source, names="markers"),
        warnings=recording.warnings,
        events=recording.events,
        subject=recording.subject,
    )


def _judged(
    clip: Clip, skeleton: _Skeleton, raw: dict[str, Floats], centres: dict[str, Floats], rotations: Floats, root: Floats
) -> MarkerFit:
    there = places(skeleton.body, rotations, root)
    squares: dict[str, Floats] = {}
    for joint, own in enumerate(skeleton.markers):
        for place, local in zip(own, skeleton.body.local[joint], strict=True):
            marker = there[:, joint] + rotations[:, joint] @ local
            distance = np.sum((raw[place] - marker) ** 2, axis=-1)
            squares[place] = distance[np.isfinite(distance)]
    residual = float(np.sqrt(np.mean(np.concatenate(list(squares.values())))))
    return MarkerFit(
        clip=replace(clip, source=replace(clip.source, residual=residual)),
        residual=residual,
        marker_residuals={place: float(np.sqrt(np.mean(s))) for place, s in squares.items()},
        centre_distances={
            joint: float(np.linalg.norm(centres[joint] - there[:, index], axis=-1).max())
            for index, joint in enumerate(skeleton.joints)
        },
    )
