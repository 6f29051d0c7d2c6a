"""Puts a walk of the gait model on a skeleton: directions kept, feet on the ground, the hips where the legs carry them.

World rotations are kept (not local ones), each limb bone after aligning its rest direction with the model's, so that
another rest pose or proportion does not change where limbs point (characters notes, section 3.3). The height and the
fore-aft place of the hips are not taken from the model: they follow from the standing leg, whose captured angles put
the hips over a foot that rolls on the ground. Knows curves and one skeleton; no blend tree, no actor.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from stimuli import contact
from stimuli.blend import FOOT_CHANNELS, UPPER, WalkCycle
from stimuli.contact import Sole
from stimuli.gait_model import MODEL_ARM, basis, curves
from stimuli.kinematics import rotation_matrices
from stimuli.legs import Leg, reach
from stimuli.rotations import from_exponential, inverse, multiply, shortest_arc
from stimuli.skeleton import JOINTS, PARENTS, Floats, Skeleton

SAMPLES = 256
PHASES = np.arange(SAMPLES) / SAMPLES
SMOOTHING = 6  # samples each way
CLOSING = 0.15
"""Share of swing in which a captured foot comes on to its footprint."""

STEP_TERMS = [0, 3, 4, 7, 8, 11, 12, 15, 16]
"""Columns of gait_model.basis that repeat every step: 1 and the even harmonics of the cycle."""


MIRRORED_FOOT = np.array([1.0, 1.0, 1.0, -1.0, -1.0, -1.0])
"""Sign of each of the FOOT_CHANNELS for the other side."""

BUILT_REACH = 0.9996
"""Largest hip-ankle distance over leg length in a cycle as built (knee bent 3.2 degrees); blending needs the rest."""

SWING_GAIN = (0.8, 1.35)
"""How much less or more than captured the stance leg may swing to make a step of the wanted length."""

PUSH_OFF = np.radians(12.0)
"""Largest change of the captured foot pitch at push-off (two standard deviations between people, S&M tables)."""

LEAST_CLEARANCE = 0.012
"""m, clearance of the lowest point at mid swing (Winter 1992: 1.3 cm on average)."""


@dataclass(frozen=True, eq=False)
class Figure:
    """A skeleton with what retargeting needs to know of it."""

    skeleton: Skeleton

    @cached_property
    def sole(self) -> Sole:
        return Sole.of(self.skeleton)

    @cached_property
    def legs(self) -> tuple[Leg, Leg]:
        """Left and right leg."""
        return Leg.of(self.skeleton, "left"), Leg.of(self.skeleton, "right")

    @property
    def leg_length(self) -> float:
        """m, hip to ankle, mean of both legs."""
        return 0.5 * (self.legs[0].length + self.legs[1].length)


def scaled(skeleton: Skeleton, factor: float) -> Skeleton:
    """The same person, larger or smaller."""
    return Skeleton(np.asarray(skeleton.offsets, dtype=float) * factor)


def walk_cycle(figure: Figure, coefficients: Floats, stance: float, speed: float, step_frequency: float) -> WalkCycle:
    """One cycle of a walk with these Fourier coefficients (S, C) at exactly this speed and step frequency.

    stance: share of the cycle on each foot; speed m/s; step_frequency steps/min.
    """
    right = curves(coefficients, PHASES)
    stride = 120.0 * speed / step_frequency
    rotations, hips_world = _upper_body(figure, coefficients)
    foot = _Foot.of(figure, right, stance)
    hip = rotation_matrices(hips_world) @ figure.legs[1].hip
    hip[:, 0] += figure.leg_length * right["hips_shift"]  # right hip joint, less the height and advance of the hips
    vector = _leg_vector(figure.legs[1], right["thigh"], right["shank"], foot.ankle[:, 0] - hip[:, 0])
    advance, ahead, vector = _advance(vector, hip, foot, stride)
    behind = ahead - stride * PHASES - advance
    height = _height(figure.legs[1].length, vector, hip, foot, behind, right["thigh"] - right["shank"])
    foot = _pushed_off(figure.sole, foot, vector, height + hip[:, 1], behind - hip[:, 2], hip[:, 0])
    hips = np.column_stack([figure.leg_length * right["hips_shift"], height, advance])
    carried = np.column_stack([height, advance]) + hip[:, 1:] + vector  # ankle (up, forward) if the leg had its way
    joint = np.column_stack([hip[:, 0], height + hip[:, 1], advance + hip[:, 2]])
    feet = _foot_channels(foot, carried, stride, ahead, joint, BUILT_REACH * figure.legs[1].length)
    return WalkCycle(
        speed,
        step_frequency,
        hips,
        rotations,
        np.array([feet * MIRRORED_FOOT, feet]),
        np.array([stance, stance]),
        np.array([ahead, ahead]),
    )


@dataclass(frozen=True, eq=False)
class _Foot:
    """The right foot over PHASES, as it would roll on the ground at the place of its footprint.

    pitch: wanted; yaw, knee_yaw: rad; side: m; ankle: (N, 3) m from the footprint's forward place
    """

    stance: float
    pitch: Floats
    yaw: Floats
    knee_yaw: Floats
    side: Floats
    ankle: Floats

    @classmethod
    def of(cls, figure: Figure, right: dict[str, Floats], stance: float) -> _Foot:
        yaw = _still_in_stance(right["foot_yaw"], stance)
        side = figure.leg_length * _still_in_stance(right["foot_shift"], stance)
        return cls.pitched(figure.sole, right["foot"], yaw, right["knee_yaw"], side, stance)

    @classmethod
    def pitched(cls, sole: Sole, drawn: Floats, yaw: Floats, knee_yaw: Floats, side: Floats, stance: float) -> _Foot:
        pitch = contact.wanted_pitch(drawn)
        swing = contact.swing_progress(contact.clock(PHASES, stance))
        forward, up = contact.planted(sole, drawn, contact.toe_bend(drawn, swing))
        ankle = np.column_stack([side + np.sin(yaw) * forward, up, np.cos(yaw) * forward])
        return cls(stance, pitch, yaw, knee_yaw, side, ankle)


def _pushed_off(sole: Sole, foot: _Foot, vector: Floats, hip_up: Floats, behind: Floats, aside: Floats) -> _Foot:
    """The foot with its heel rise at push-off changed, by PUSH_OFF at most, so that the knee stays as captured.

    In double support the hips go where the leading leg carries them; what is left over for the trailing leg is
    made by its heel, which is what a trailing foot is for. hip_up, behind, aside: (N,) m, height of the hip joint,
    footprint from the hip joint along the path, and the hip joint's sideways place.
    """
    drawn = contact.flattened(foot.pitch)
    length = np.linalg.norm(vector, axis=1)
    changes = np.linspace(-PUSH_OFF, PUSH_OFF, 41)
    pitches = drawn[:, None] + changes
    forward, up = contact.planted(sole, pitches, contact.toe_bend(pitches, 0.0))
    reached = np.sqrt((up - hip_up[:, None]) ** 2 + (behind[:, None] + np.cos(foot.yaw)[:, None] * forward) ** 2)
    best = changes[np.argmin((reached - length[:, None]) ** 2 + (0.02 * changes) ** 2, axis=1)]
    late = contact.smooth_step((PHASES - 0.36) / 0.1) * contact.smooth_step((foot.stance + 0.1 - PHASES) / 0.1)
    end = int(np.searchsorted(PHASES, foot.stance - 0.01))
    held = np.where(PHASES[end] > PHASES, best, best[end])
    return _Foot.pitched(sole, drawn + late * _smoothed(held), foot.yaw, foot.knee_yaw, foot.side, foot.stance)


def _upper_body(figure: Figure, coefficients: Floats) -> tuple[Floats, Floats]:
    """Local rotations (N, 13, 4) of the UPPER joints, and the world rotation (N, 4) of the hips."""
    offsets = figure.skeleton.offsets
    right, left = curves(coefficients, PHASES), curves(coefficients, PHASES + 0.5)

    def turned(of: dict[str, Floats], segment: str, mirror: bool = False) -> Floats:
        vector = np.stack([of[f"{segment}_{axis}"] for axis in "xyz"], axis=1)
        return from_exponential(vector * (1.0, -1.0, -1.0) if mirror else vector)

    world = {segment: turned(right, segment) for segment in ("hips", "spine", "chest", "neck", "head")}
    for side, of, mirror, sign in (("right", right, False, -1.0), ("left", left, True, 1.0)):
        world[f"{side}Shoulder"] = turned(of, "shoulder", mirror)
        for joint, end, segment in (
            ("UpperArm", "LowerArm", "upperArm"),
            ("LowerArm", "Hand", "lowerArm"),
            ("Hand", "Hand", "hand"),
        ):
            aligned = shortest_arc(offsets[JOINTS.index(side + end)], MODEL_ARM * (sign, 1.0, 1.0))
            world[side + joint] = multiply(turned(of, segment, mirror), aligned)
    local = [world["hips"]]
    for joint in UPPER[1:]:
        local.append(multiply(inverse(world[JOINTS[PARENTS[JOINTS.index(joint)]]]), world[joint]))
    return np.stack(local, axis=1), world["hips"]


def _leg_vector(leg: Leg, thigh: Floats, shank: Floats, sideways: Floats) -> Floats:
    """(N, 2) m up and forward from hip to ankle, for inclinations of its bones (rad).

    The knee angle is kept, so the part of the leg's length that leads sideways is taken off.
    """
    vector = np.column_stack(
        [
            -leg.thigh * np.cos(thigh) - leg.shank * np.cos(shank),
            leg.thigh * np.sin(thigh) + leg.shank * np.sin(shank),
        ]
    )
    length = reach(leg, thigh - shank)
    return vector * (np.sqrt(length**2 - sideways**2) / np.linalg.norm(vector, axis=1))[:, None]


def _advance(vector: Floats, hip: Floats, foot: _Foot, stride: float) -> tuple[Floats, float, Floats]:
    """Advance (N,) m of the hips, footprint ahead at heel strike (m), and the leg's vector swung to fit the step.

    Least squares over the stance leg: the hips are where the leg puts them over its footprint, in the harmonics of
    the step. A step longer than the captured angles make is made by swinging the whole leg further in proportion,
    which keeps the knee.
    """
    root = np.sqrt(_standing_weight(foot.stance))
    steps = _step_harmonics()[:, 1:]
    wanted = foot.ankle[:, 2] - stride * PHASES - hip[:, 2]
    design = np.column_stack([steps, -np.ones(SAMPLES), vector[:, 1]])
    solution = np.linalg.lstsq(design * root[:, None], wanted * root, rcond=None)[0]
    gain = float(np.clip(solution[-1], *SWING_GAIN))
    solution = np.linalg.lstsq(design[:, :-1] * root[:, None], (wanted - gain * vector[:, 1]) * root, rcond=None)[0]
    length = np.linalg.norm(vector, axis=1)
    forward = np.clip(gain * vector[:, 1], -0.95 * length, 0.95 * length)
    return steps @ solution[:-1], float(solution[-1]), np.column_stack([-np.sqrt(length**2 - forward**2), forward])


def _height(leg_length: float, vector: Floats, hip: Floats, foot: _Foot, behind: Floats, knee: Floats) -> Floats:
    """Height (N,) m of the hips: least squares over the stance leg, lowered where the leg would not reach.

    behind: (N,) m, from the hips' advance to the place of the footprint; knee: (N,) rad. The straighter the knee,
    the more a millimetre of height bends it, and the more it counts.
    """
    weight = _standing_weight(foot.stance) / (np.maximum(knee, 0.0) + 0.05) ** 2 * np.where(PHASES < 0.1, 2.0, 1.0)
    steps = _step_harmonics()
    wanted = foot.ankle[:, 1] - vector[:, 0] - hip[:, 1]
    sideways = foot.ankle[:, 0] - hip[:, 0]
    room = (BUILT_REACH * leg_length) ** 2 - sideways**2 - (behind + foot.ankle[:, 2] - hip[:, 2]) ** 2
    ceiling = foot.ankle[:, 1] + np.sqrt(np.maximum(room, 1e-4)) - hip[:, 1]
    standing = foot.stance - 0.17 > PHASES
    force = np.zeros(SAMPLES)
    for _ in range(12):
        total = weight + force
        target = (weight * wanted + force * (ceiling - 0.002)) / np.maximum(total, 1e-9)
        root = np.sqrt(total)
        height = steps @ np.linalg.lstsq(steps * root[:, None], target * root, rcond=None)[0]
        over = standing & (height > ceiling)
        if not over.any():
            break
        force = force + 4.0 * weight.max() * over
    return np.asarray(height - max(0.0, float(np.max((height - ceiling)[standing]))))


def _standing_weight(stance: float) -> Floats:
    """(N,) how much the right leg tells of the hips: all from heel strike until the other leg takes over."""
    return np.asarray(contact.smooth_step((stance - 0.1 - PHASES) / 0.1))


def _foot_channels(foot: _Foot, carried: Floats, stride: float, ahead: float, hip: Floats, reach: float) -> Floats:
    """(N, 6) FOOT_CHANNELS of the right foot on its own clock.

    carried: (N, 2) m, up and forward: where the swinging leg carries the ankle; hip: (N, 3) m; reach: m.
    """
    swing = contact.swing_progress(PHASES)
    phases = contact.phase_of(PHASES, foot.stance)

    def on_clock(values: Floats) -> Floats:
        return np.interp(phases, np.append(PHASES, 1.0), np.append(values, values[0]))

    leave = contact.smooth_step(swing / 0.07) * contact.smooth_step((1.0 - swing) / 0.18)
    least = LEAST_CLEARANCE * contact.smooth_step(swing / 0.07) * contact.smooth_step((1.0 - swing) / 0.4)
    clearance = least + leave * _soft_positive(on_clock(carried[:, 0] - foot.ankle[:, 1]) - least)

    rolled = on_clock(foot.ankle[:, 2]) + ahead
    course = contact.footprint_travel(phases, foot.stance)
    travel = _swing_window(swing) * (on_clock((carried[:, 1] - foot.ankle[:, 2] - ahead) / stride) - course)
    up = on_clock(foot.ankle[:, 1]) + clearance - on_clock(hip[:, 1])
    sideways = on_clock(foot.ankle[:, 0] - hip[:, 0])
    far = np.sqrt(np.maximum(reach**2 - up**2 - sideways**2, 0.0))
    places = [(on_clock(hip[:, 2]) + sign * far - rolled) / stride - course for sign in (-1.0, 1.0)]
    travel = _smoothed(np.where(swing > 0.0, np.clip(travel, *places), 0.0)) * _swing_window(swing)
    bounded = contact.smooth_step(swing / 0.1) * contact.smooth_step((1.0 - swing) / 0.08)
    travel = travel + bounded * (np.clip(travel, *places) - travel)
    channels = {
        "pitch": on_clock(foot.pitch),
        "clearance": clearance,
        "travel": travel,
        "side": on_clock(foot.side),
        "yaw": on_clock(foot.yaw),
        "knee_yaw": on_clock(foot.knee_yaw),
    }
    return np.column_stack([channels[name] for name in FOOT_CHANNELS])


def _step_harmonics() -> Floats:
    """(N, 9): 1 and the first four harmonics of the step (even ones of the cycle)."""
    return basis(PHASES)[:, STEP_TERMS]


def _still_in_stance(values: Floats, stance: float) -> Floats:
    """A curve (N,) made constant in stance (its mean over the flat foot) and itself in mid swing."""
    still = float(np.mean(values[(PHASES > 0.1) & (PHASES < 0.4)]))
    return still + (values - still) * _swing_window(contact.swing_progress(contact.clock(PHASES, stance)))


def _swing_window(progress: Floats) -> Floats:
    """0 in stance, 1 in mid swing, without a jump in velocity or acceleration."""
    return np.asarray(
        contact.smooth_step((progress - 0.01) / 0.1) * contact.smooth_step((contact.ARRIVAL - progress) / CLOSING)
    )


def _smoothed(values: Floats) -> Floats:
    """A periodic curve (N,) averaged over some 2 per cent of the cycle, which takes corners off."""
    kernel = np.hanning(2 * SMOOTHING + 1)
    padded = np.concatenate([values[-SMOOTHING:], values, values[:SMOOTHING]])
    return np.convolve(padded, kernel / kernel.sum(), mode="valid")


def _soft_positive(values: Floats, width: float = 0.002) -> Floats:
    """values where well above 0, 0 well below, smooth between (m)."""
    return np.asarray(width * np.logaddexp(0.0, values / width))
