"""Where joints lie inside a body that wears markers on its skin.

Hips: regression of Harrington et al., J. Biomech. 40, 2007 (two-parameter form). Knees and ankles: midway between the
markers on both sides, or, with a marker on one side only, the chord construction of Plug-in-Gait (Davis et al., Hum.
Mov. Sci. 10, 1991). Shoulders: 17 % of their distance below the acromia (Rab et al., J. Orthop. Res. 20, 2002). Elbows
and wrists: midway. Trunk: L5-S1 a third of the pelvis' width behind the front spines (after Dumas et al., J. Biomech.
40, 2007); the others midway between front and back markers. Knows one recording; no skeleton.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.floating]

KNEE_HALF_WIDTH = 0.052  # m, half of 10.4 cm knee width and a marker's radius less the skin; where nothing is known
ANKLE_HALF_WIDTH = 0.042  # m, as above for the ankle
SIDES = ("left", "right")
TOWARDS_LEFT = {"left": 1.0, "right": -1.0}


def unit(vectors: Floats) -> Floats:
    """(..., 3) scaled to length 1; zero stays zero."""
    return vectors / np.maximum(np.linalg.norm(vectors, axis=-1, keepdims=True), 1e-12)


def pelvis_axes(paths: Mapping[str, Floats]) -> tuple[Floats, Floats, Floats, Floats]:
    """Middle of the front spines (T, 3) m, and the pelvis' left, up and forward unit vectors (T, 3).

    paths: place -> (T, 3) m, with left_asis, right_asis and psis markers or the sacrum
    """
    left_front, right_front = paths["left_asis"], paths["right_asis"]
    back = (
        0.5 * (paths["left_psis"] + paths["right_psis"])
        if {"left_psis", "right_psis"} <= set(paths)
        else paths["sacrum"]
    )
    middle = 0.5 * (left_front + right_front)
    left = unit(left_front - right_front)
    ahead = middle - back
    forward = unit(ahead - np.sum(ahead * left, axis=-1, keepdims=True) * left)
    return middle, left, np.cross(forward, left), forward


def joint_centres(paths: Mapping[str, Floats]) -> dict[str, Floats]:
    """VRM humanoid joint -> (T, 3) m, for the joints whose markers are there.

    paths: place on the body -> (T, 3) m without gaps, Y up; asis, psis (or sacrum), lateral knee and ankle, and toe
    markers of both sides are needed.
    """
    middle, left, up, forward = pelvis_axes(paths)
    back = (
        0.5 * (paths["left_psis"] + paths["right_psis"])
        if {"left_psis", "right_psis"} <= set(paths)
        else paths["sacrum"]
    )
    width = np.median(np.linalg.norm(paths["left_asis"] - paths["right_asis"], axis=-1))
    depth = np.median(np.linalg.norm(middle - back, axis=-1))
    centres: dict[str, Floats] = {}
    for side in SIDES:
        outward = TOWARDS_LEFT[side] * left
        hip = (
            middle
            - (0.24 * depth + 0.0099) * forward
            - (0.30 * width + 0.0109) * up
            + (0.33 * width + 0.0073) * outward
        )
        knee = _beside(paths, side, "knee", hip, "thigh", outward, KNEE_HALF_WIDTH)
        ankle = _beside(paths, side, "ankle", knee, "shank", outward, ANKLE_HALF_WIDTH)
        centres.update({f"{side}UpperLeg": hip, f"{side}LowerLeg": knee, f"{side}Foot": ankle})
        centres[f"{side}Toes"] = _toes(paths, side)
    centres["hips"] = 0.5 * (centres["leftUpperLeg"] + centres["rightUpperLeg"])
    _add_trunk(centres, paths, middle - 0.335 * width * forward)
    return centres


def _beside(
    paths: Mapping[str, Floats], side: str, joint: str, above: Floats, wand: str, outward: Floats, half_width: float
) -> Floats:
    lateral = paths[f"{side}_lateral_{joint}"]
    if f"{side}_medial_{joint}" in paths:
        return 0.5 * (lateral + paths[f"{side}_medial_{joint}"])
    along = unit(above - lateral)
    out = paths[f"{side}_{wand}"] - lateral if f"{side}_{wand}" in paths else outward
    inward = -unit(out - np.sum(out * along, axis=-1, keepdims=True) * along)
    inward = np.where(np.sum(inward * outward, axis=-1, keepdims=True) > 0, -inward, inward)
    cosine = half_width / np.maximum(np.linalg.norm(above - lateral, axis=-1, keepdims=True), 2 * half_width)
    return lateral + half_width * (cosine * along + np.sqrt(1 - cosine**2) * inward)


def _toes(paths: Mapping[str, Floats], side: str) -> Floats:
    if f"{side}_first_toe" in paths and f"{side}_fifth_toe" in paths:
        return 0.5 * (paths[f"{side}_first_toe"] + paths[f"{side}_fifth_toe"])
    return paths[f"{side}_toe"]


def _add_trunk(centres: dict[str, Floats], paths: Mapping[str, Floats], lumbar: Floats) -> None:
    if "c7" not in paths or "jugular" not in paths:
        return
    neck = 0.5 * (paths["c7"] + paths["jugular"])
    centres["spine"], centres["neck"] = lumbar, neck
    centres["chest"] = (
        0.5 * (paths["t10"] + paths["xiphoid"])
        if "t10" in paths and "xiphoid" in paths
        else (0.45 * lumbar + 0.55 * neck)
    )
    heads = [f"{side}_{place}_head" for side in SIDES for place in ("front", "back")]
    if all(head in paths for head in heads):
        centres["head"] = 0.5 * (neck + np.mean([paths[head] for head in heads], axis=0))
    if "left_shoulder" not in paths or "right_shoulder" not in paths:
        return
    across = np.linalg.norm(paths["left_shoulder"] - paths["right_shoulder"], axis=-1, keepdims=True)
    drop = 0.17 * np.median(across) * unit(neck - lumbar)
    for side in SIDES:
        centres[f"{side}Shoulder"] = 0.8 * paths["jugular"] + 0.2 * paths[f"{side}_shoulder"]
        centres[f"{side}UpperArm"] = paths[f"{side}_shoulder"] - drop
        _add_arm(centres, paths, side)


def _add_arm(centres: dict[str, Floats], paths: Mapping[str, Floats], side: str) -> None:
    for joint, first, second in (
        ("LowerArm", "lateral_elbow", "medial_elbow"),
        ("Hand", "thumb_wrist", "little_wrist"),
    ):
        there = [paths[f"{side}_{place}"] for place in (first, second) if f"{side}_{place}" in paths]
        if not there:
            return
        centres[side + joint] = np.mean(there, axis=0)
