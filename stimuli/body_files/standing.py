"""Which way up a character of another program stands, which way it looks, and its unit. Knows no file."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from stimuli.skeleton import JOINTS, Floats

UNITS = (1.0, 0.01, 0.0254, 0.001, 10.0, 100.0)  # m per unit of the file, tried until the person is 0.5-3 m tall
USUAL = 1.75
"""m, height given to a person who has none of the usual heights in any of these units."""

UPRIGHT = np.cos(np.radians(12.0))
"""A person leaning further than this in the scene is looked at along the axes of its own bind pose."""

ANKLE_BAND = 0.04
"""Of the height: feet lie below this, when no toes tell which way they point."""

SHORTEST_BONE = 0.005
"""Of the height: shorter limb bones have no direction to be turned in."""

SMALLEST_SKIN = 0.1
"""Of the skeleton's extent: a smaller skin is none."""

LIMBS = tuple(
    (f"{side}{start}", f"{side}{end}")
    for side in ("left", "right")
    for start, end in (("UpperLeg", "LowerLeg"), ("LowerLeg", "Foot"), ("UpperArm", "LowerArm"), ("LowerArm", "Hand"))
)


def without_extent(roles: Mapping[str, int], binds: Floats, points: Floats) -> str:
    """Why a person in the bind pose has no shape to be drawn in, or "".

    roles: role -> node; binds: (N, 4, 4) of every node; points: (V, 3) its vertices.
    """
    tall = float(np.max(np.ptp(points, axis=0)))
    if not tall > SMALLEST_SKIN * float(np.max(np.ptp(binds[list(roles.values()), :3, 3], axis=0))):
        return "all its vertices lie in one place; if its meshes are compressed, export it without compression"
    for start, end in LIMBS:
        if start in roles and end in roles:
            bone = binds[roles[end], :3, 3] - binds[roles[start], :3, 3]
            if np.linalg.norm(bone) < SHORTEST_BONE * tall:
                return (
                    f"its joints {start} and {end} lie in one place in the bind pose; export it again with its "
                    "inverse bind matrices"
                )
    if np.linalg.norm(binds[roles["leftUpperLeg"], :3, 3] - binds[roles["rightUpperLeg"], :3, 3]) < 1e-4 * tall:
        return "both its legs begin in one place in the bind pose; export it again with its inverse bind matrices"
    return ""


def upright(roles: Mapping[str, int], binds: Floats, axes: Floats, points: Floats) -> Floats:
    """(3, 4) to metres, up = +Y, forwards = +Z, sole on the ground below the hips.

    axes: (3, 3) columns, directions of the bind pose's own axes, which count where the person leans in the scene.
    """
    at = {role: binds[node, :3, 3] for role, node in roles.items()}
    feet = 0.5 * (at["leftFoot"] + at["rightFoot"])
    rough = at.get("head", at.get("neck", at["hips"])) - feet
    up = _nearest_axis(np.eye(3), rough)
    if up @ rough < UPRIGHT * np.linalg.norm(rough):
        up = max((up, _nearest_axis(axes, rough)), key=lambda axis: float(axis @ rough))
    left = at["leftUpperLeg"] - at["rightUpperLeg"]
    left = left - up * (left @ up)
    left /= np.linalg.norm(left)
    turn = np.stack([left, up, np.cross(left, up)])
    turned = points @ turn.T
    tall = float(np.ptp(turned[:, 1]))
    unit = next((u for u in UNITS if 0.5 <= tall * u <= 3.0), USUAL / tall)
    hips = turn @ at["hips"] * unit
    shift = -np.array([hips[0], unit * turned[:, 1].min(), hips[2]])
    return np.column_stack([turn * unit, shift])


def walks_backwards(roles: Mapping[str, int], binds: Floats, to_person: Floats, points: Floats) -> bool:
    """Whether the feet point backwards, as they do where the file takes left for right.

    Told by the toes, or without any by where the vertices near the ground lie from the ankles.
    """
    at = {role: to_person[:, :3] @ binds[node, :3, 3] + to_person[:, 3] for role, node in roles.items()}
    ankles = 0.5 * (at["leftFoot"] + at["rightFoot"])
    if "leftToes" in at and "rightToes" in at:
        return bool((0.5 * (at["leftToes"] + at["rightToes"]) - ankles)[2] < 0.0)
    placed = points @ to_person[:, :3].T + to_person[:, 3]
    low = placed[placed[:, 1] < ANKLE_BAND * placed[:, 1].max()]
    return bool(0.5 * (low[:, 2].min() + low[:, 2].max()) < ankles[2])


def other_side(role: str) -> str:
    """The same joint of the other side; a joint of the middle is itself."""
    for side, other in (("left", "right"), ("right", "left")):
        if role.startswith(side) and other + role.removeprefix(side) in JOINTS:
            return other + role.removeprefix(side)
    return role


def _nearest_axis(axes: Floats, direction: Floats) -> Floats:
    """The column of `axes` (3, 3), or its opposite, that is nearest to a direction; unit length."""
    unit = axes / np.linalg.norm(axes, axis=0)
    along = direction @ unit
    best = int(np.argmax(np.abs(along)))
    found: Floats = unit[:, best] * np.sign(along[best])
    return found
