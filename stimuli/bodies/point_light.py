"""Point lights: fifteen markers at joint centres, and their scrambled and inverted variants. Pure arithmetic.

The markers are those of Troje (2002, Journal of Vision 2:371-387): head, sternum between the clavicles, shoulders,
elbows, wrists, centre of the pelvis, hips, knees, ankles. A marker is a place of the bind pose carried by one joint,
so the matrices that skin a body also move its markers.
"""

from __future__ import annotations

import numpy as np

from stimuli.skeleton import JOINTS, Floats, Skeleton

MARKERS: tuple[str, ...] = (
    "head_c",
    "sternum",
    "pelvis_c",
    *(f"{side}{part}" for part in ("Shoulder", "Elbow", "Wrist", "Hip", "Knee", "Ankle") for side in ("left", "right")),
)

STICKS: tuple[tuple[str, str], ...] = (
    ("head_c", "sternum"),
    ("sternum", "pelvis_c"),
    *(
        pair
        for side in ("left", "right")
        for pair in (
            ("sternum", f"{side}Shoulder"),
            (f"{side}Shoulder", f"{side}Elbow"),
            (f"{side}Elbow", f"{side}Wrist"),
            ("pelvis_c", f"{side}Hip"),
            (f"{side}Hip", f"{side}Knee"),
            (f"{side}Knee", f"{side}Ankle"),
        )
    ),
)
"""The markers that a stick figure joins (as in the study of Tilmanne)."""

FIGURES: tuple[str, ...] = ("point_light", "point_light_scrambled", "point_light_inverted", "stick_figure")
"""Names that stand in a study for figures drawn instead of a body."""

HEAD_CENTRE = (0.0, 0.054, 0.012)
"""From the head joint to the middle of the head, per stature."""

_JOINT_OF = {"Shoulder": "UpperArm", "Elbow": "LowerArm", "Wrist": "Hand", "Hip": "UpperLeg", "Knee": "LowerLeg"}
_JOINT_OF |= {"Ankle": "Foot"}


def _carrier(marker: str) -> str:
    if marker in ("head_c", "sternum", "pelvis_c"):
        return {"head_c": "head", "sternum": "chest", "pelvis_c": "hips"}[marker]
    side = "left" if marker.startswith("left") else "right"
    return side + _JOINT_OF[marker.removeprefix(side)]


CARRIERS = np.array([JOINTS.index(_carrier(marker)) for marker in MARKERS])
"""(15,) index in JOINTS of the joint that carries each marker."""


def resting(skeleton: Skeleton, stature: float) -> Floats:
    """(15, 3) m: the markers in the bind pose of a person of a stature (m)."""
    places = skeleton.positions
    found = places[CARRIERS]
    found[MARKERS.index("head_c")] += np.array(HEAD_CENTRE) * stature
    found[MARKERS.index("sternum")] = _middle(places, "Shoulder")
    found[MARKERS.index("pelvis_c")] = _middle(places, "UpperLeg")
    return found


def carried(rest: Floats, matrices: Floats) -> Floats:
    """(15, 3) m: resting markers moved by the joints' skinning matrices (21, 3, 4)."""
    turned = matrices[CARRIERS]
    return np.asarray(np.einsum("nij,nj->ni", turned[:, :, :3], rest) + turned[:, :, 3], dtype=float)


def inverted(markers: Floats, stature: float) -> Floats:
    """The figure upside down: y m above the ground becomes y m below the crown."""
    return np.asarray(markers * (1.0, -1.0, 1.0) + (0.0, stature, 0.0))


def scrambling(rest: Floats, seed: int) -> Floats:
    """(15, 3) m to add to every marker: each keeps its motion but takes a random place in the figure's own box.

    The same seed gives the same places.
    """
    low, high = rest.min(axis=0), rest.max(axis=0)
    room = np.array([0.0, 0.0, 0.12])  # m, for the reach of legs and arms that a standing figure does not show
    low, high = low - room, high + room
    return np.asarray(np.random.default_rng(seed).uniform(low, high, rest.shape) - rest)


def figure_lines(figure: str, rest: Floats, matrices: Floats, stature: float, seed: int) -> Floats:
    """(N, 2, 3) m: ends of every stick of a figure, or a dot as a line from a place to itself.

    figure: one of FIGURES.
    """
    markers = carried(rest, matrices)
    if figure == "stick_figure":
        ends = [(MARKERS.index(a), MARKERS.index(b)) for a, b in STICKS]
        return np.asarray(markers[np.array(ends)])
    if figure == "point_light_inverted":
        markers = inverted(markers, stature)
    elif figure == "point_light_scrambled":
        markers = markers + scrambling(rest, seed)
    return np.stack([markers, markers], axis=1)


def _middle(places: Floats, part: str) -> Floats:
    return np.asarray(0.5 * (places[JOINTS.index(f"left{part}")] + places[JOINTS.index(f"right{part}")]))
