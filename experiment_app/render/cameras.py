"""From a scene's camera to an eye and a view-projection matrix. Pure arithmetic: no GL, no state."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np

from experiment_app.scene import Camera, View
from stimuli.skeleton import Floats

NEAR = 0.1  # m
FAR = 4000.0  # m, beyond where the haze has swallowed the ground

HEADINGS: dict[View, float] = {
    "three_quarter": 140.0, "front": 180.0, "side": 90.0, "legs": 90.0, "elevated": 150.0, "first_person": 180.0,
}  # fmt: skip
"""Degrees in which each view looks: 0 along the walking direction (+Z), 90 to the walkers' left (+X).

The camera stands on the walker's right, so that the walker goes from left to right on the screen.
Three-quarter is the canonical view of objects (Palmer, Rosch and Chase 1981; Blanz, Tarr and Bülthoff 1999).
"""

AIM = 0.9  # m above the ground at the place an elevated camera looks at: the middle of a person there

NARROWEST = 0.8
"""Width over height that still shows a walker with the arms' swing in every named view."""

CROWN_AT = 0.93
"""Of half the field of view: as high as the crown may stand for a machine's sake."""

ON_MACHINES = 1.86
"""m, stature that a camera makes room for on a treadmill, so that the machine does not move from actor to actor."""

NOTHING = np.zeros((0, 3))

LEGS_TOP = 0.50  # of stature: the legs view ends here, just below the hips
LEGS_MARGIN = 0.08  # of stature: ground shown below the soles in the legs view


@dataclass(frozen=True, eq=False)
class Viewpoint:
    """A camera placed in the world.

    eye:         (3,) m.
    azimuth:     radians, direction from walker to eye around +Y, 0 along +Z, positive towards +X.
    half_height: tangent of half the vertical field of view.
    matrix:      (4, 4) world to clip space, column vectors (clip = matrix @ point).
    inverse:     (4, 4) clip space to world.
    """

    eye: Floats
    azimuth: float
    half_height: float
    matrix: Floats
    inverse: Floats

    @cached_property
    def matrix_bytes(self) -> bytes:
        """`matrix` as the shaders take it, made once for all passes of a frame."""
        return as_uniform(self.matrix)

    def pixels_per_metre(self, point: Sequence[float], picture_height: int) -> float:
        """Size on the screen of a metre at a point (x, y, z) m, roughly."""
        distance = math.dist(self.eye, point)
        return 0.5 * picture_height / (self.half_height * max(distance, NEAR))


def place_camera(
    camera: Camera, aspect: float, stature: float, walker: tuple[float, float, float], machine: Floats = NOTHING
) -> Viewpoint:
    """Put the camera so that the walker is centred vertically, or at the place the scene gives it.

    camera:  the scene's camera.
    aspect:  width over height of the picture.
    stature: m, of the walker looked at.
    walker:  (x, y, z) m, where the walker is now. Views that follow keep pace with the walker, which on a
             treadmill means that they stand still; the others do not look at it.
    machine: (N, 3) m, corners of what the walker stands on, to be in the picture too; N may be 0.

    The pitch is the mean of the elevation of crown and soles, so both have the same margin whatever the
    distance, height or aspect ratio. In pictures narrower than NARROWEST (upright displays, halves of old screens)
    the field of view is widened so that the horizontal one is what it would be there; otherwise it is exactly
    what the scene asks for. Only the legs view is narrower where that would show more than legs: it ends LEGS_TOP
    above and LEGS_MARGIN below. With a machine the camera looks down to hold it too, in the same direction for
    everybody up to ON_MACHINES; where the field of view is too narrow for both, the machine is cut. An elevated
    camera has its place in the middle of the picture, AIM above the ground; first person looks straight ahead.
    """
    heading = HEADINGS[camera.view] if camera.heading is None else camera.heading
    azimuth = math.radians(heading - 180.0)
    outwards = np.array([math.sin(azimuth), 0.0, math.cos(azimuth)])
    half_angle = math.radians(0.5 * camera.field_of_view)
    if camera.follows:
        base, distance = np.array(walker), camera.distance
        if len(machine) and camera.view != "legs":
            stature = max(stature, ON_MACHINES)
        pitch, half_angle = _framed(camera, stature, half_angle)
        if len(machine) and camera.view != "legs":
            offset = machine - base
            lowest = np.arctan2(offset[:, 1] - camera.height, distance - offset @ outwards).min()
            pitch = _lowered(pitch, half_angle, math.atan2(stature - camera.height, distance), float(lowest))
    else:
        base = np.array([camera.place[0], 0.0, camera.place[1]])
        distance = camera.distance if camera.view == "elevated" else 0.0
        pitch = math.atan2(AIM - camera.height, distance) if camera.view == "elevated" else 0.0
    eye = base + np.array([0.0, camera.height, 0.0]) + distance * outwards
    forward = np.array([0.0, math.sin(pitch), 0.0]) - math.cos(pitch) * outwards
    widened = max(1.0, NARROWEST / aspect) if camera.follows else 1.0
    half_height = math.tan(half_angle) * widened
    turn = look(eye, forward)
    matrix = perspective(half_height, aspect) @ turn
    return Viewpoint(eye, azimuth, half_height, matrix, _from_clip(half_height, aspect, turn, eye))


@lru_cache(maxsize=8)
def place_still(camera: Camera, aspect: float) -> Viewpoint:
    """A camera that follows nobody, placed once for all frames; what follows from it alone can be kept with it."""
    return place_camera(camera, aspect, 0.0, (0.0, 0.0, 0.0))


def _framed(camera: Camera, stature: float, half_angle: float) -> tuple[float, float]:
    """Pitch and half the vertical field of view (radians) that hold the walker, or the legs, in the middle."""
    top, bottom = stature, 0.0
    if camera.view == "legs":
        top, bottom = stature * LEGS_TOP, -stature * LEGS_MARGIN
    above = math.atan2(top - camera.height, camera.distance)
    below = math.atan2(bottom - camera.height, camera.distance)
    if camera.view == "legs":
        half_angle = min(half_angle, 0.5 * (above - below))
    return 0.5 * (above + below), half_angle


def _lowered(pitch: float, half_angle: float, crown: float, lowest: float) -> float:
    """The pitch at which crown and machine have equal margins, or the crown a small one; angles in radians."""
    middle = 0.5 * (crown + lowest)
    return min(pitch, max(middle, crown - CROWN_AT * half_angle))


def look(eye: Floats, forward: Floats) -> Floats:
    """(4, 4) world to eye space (-Z ahead, +Y up); forward: (3,), not vertical."""
    x, y, z = (float(value) for value in forward)
    length, flat = math.sqrt(x * x + y * y + z * z), math.hypot(x, z)
    x, y, z, across = x / length, y / length, z / length, flat / length
    right = (-z / across, 0.0, x / across)
    above = (-y * x / across, across, -y * z / across)
    matrix = np.eye(4)
    matrix[:3, :3] = (right, above, (-x, -y, -z))
    matrix[:3, 3] = -matrix[:3, :3] @ eye
    return matrix


def _from_clip(half_height: float, aspect: float, turn: Floats, eye: Floats) -> Floats:
    """(4, 4) inverse of perspective @ look, written out: a third of the time of a general inverse."""
    matrix = np.zeros((4, 4))
    rows = turn[:3, :3]
    ahead = 0.5 * (NEAR - FAR) / (FAR * NEAR)
    nearness = 0.5 * (FAR + NEAR) / (FAR * NEAR)
    matrix[:3, 0] = half_height * aspect * rows[0]
    matrix[:3, 1] = half_height * rows[1]
    matrix[:3, 2] = ahead * eye
    matrix[:3, 3] = nearness * eye - rows[2]
    matrix[3, 2], matrix[3, 3] = ahead, nearness
    return matrix


def perspective(half_height: float, aspect: float) -> Floats:
    """(4, 4) eye to clip space; half_height: tangent of half the vertical field of view."""
    matrix = np.zeros((4, 4))
    matrix[0, 0] = 1.0 / (half_height * aspect)
    matrix[1, 1] = 1.0 / half_height
    matrix[2, 2] = (FAR + NEAR) / (NEAR - FAR)
    matrix[2, 3] = 2.0 * FAR * NEAR / (NEAR - FAR)
    matrix[3, 2] = -1.0
    return matrix


def orthographic(half_size: Floats) -> Floats:
    """(4, 4) a centred box of half extents (x, y, z) m to clip space, -Z ahead."""
    return np.diag([1.0 / half_size[0], 1.0 / half_size[1], -1.0 / half_size[2], 1.0])


def as_uniform(matrix: Floats) -> bytes:
    """The bytes GL wants for a mat4 or mat3: float32, column after column."""
    return np.ascontiguousarray(matrix.T, dtype=np.float32).tobytes()
