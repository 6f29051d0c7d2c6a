"""A limping walker as a BVH file: made of the gait model, with a left leg that is spared."""

from pathlib import Path

import numpy as np
from scipy.spatial.transform import Rotation

from stimuli.actor_library import StoredActor, StoredCycle, actor_of
from stimuli.actors import Actor, Person
from stimuli.gait_model import SIGNALS, Step, WalkCurves, load_gait_model
from stimuli.measure import poses
from stimuli.skeleton import JOINTS, PARENTS

NAMES = {
    "hips": "Hips",
    "spine": "Spine",
    "chest": "Spine1",
    "neck": "Neck",
    "head": "Head",
    **{f"{side}{ours}": f"{side.capitalize()}{theirs}" for side in ("left", "right") for ours, theirs in (
        ("Shoulder", "Shoulder"), ("UpperArm", "Arm"), ("LowerArm", "ForeArm"), ("Hand", "Hand"),
        ("UpperLeg", "UpLeg"), ("LowerLeg", "Leg"), ("Foot", "Foot"), ("Toes", "ToeBase"),
    )},
}  # fmt: skip


def limping_actor(speed: float = 1.0, step_frequency: float = 96.0) -> Actor:
    """A man of 1.78 m who spares his left leg: it swings less far and stands shorter, and his right step is quick."""
    model = load_gait_model()
    right = model.coefficients(Step.of(speed, step_frequency, 0.85), -0.5)
    left = right.copy()
    for signal in ("thigh", "shank"):
        left[SIGNALS.index(signal), 1:] *= 0.8
    walk = WalkCurves(np.stack([left, right]), np.array([0.57, 0.66]), 0.55)
    cycle = StoredCycle(speed, step_frequency, walk)
    person = Person("limping", "M", 40.0, 1.78, 75.0, speed, 0.6, "made", ())
    return actor_of(StoredActor(person, "", "", ((0.0, (cycle,)),), True))


def write_bvh(actor: Actor, speed: float, step_frequency: float, path: Path, seconds: float = 5.0) -> None:
    """The actor walking along +Z at 120 Hz, in centimetres, under the names of Mixamo's joints."""
    times = np.arange(round(seconds * 120)) / 120
    pose = poses(actor, speed, step_frequency, times * step_frequency / 120)
    places = (pose.hips + np.outer(times, [0.0, 0.0, speed])) * 100
    lines = ["HIERARCHY"]
    order: list[int] = []

    def joint(index: int, depth: int) -> None:
        order.append(index)
        pad = "  " * depth
        x, y, z = (0.0, 0.0, 0.0) if index == 0 else actor.skeleton.offsets[index] * 100
        channels = "6 Xposition Yposition Zposition " if index == 0 else "3 "
        lines.extend([
            f"{pad}{'ROOT' if index == 0 else 'JOINT'} {NAMES[JOINTS[index]]}",
            f"{pad}{{",
            f"{pad}  OFFSET {x:.6f} {y:.6f} {z:.6f}",
            f"{pad}  CHANNELS {channels}Zrotation Xrotation Yrotation",
        ])  # fmt: skip
        below = [child for child, parent in enumerate(PARENTS) if parent == index]
        for child in below:
            joint(child, depth + 1)
        if not below:
            lines.extend([f"{pad}  End Site", f"{pad}  {{", f"{pad}    OFFSET 0 0 6", f"{pad}  }}"])
        lines.append(f"{pad}}}")

    joint(0, 0)
    turns = Rotation.from_quat(pose.rotations.reshape(-1, 4)).as_euler("ZXY", degrees=True).reshape(len(times), -1, 3)
    rows = np.concatenate([places, turns[:, order].reshape(len(times), -1)], axis=1)
    body = [" ".join(f"{value:.5f}" for value in row) for row in rows]
    path.write_text("\n".join([*lines, "MOTION", f"Frames: {len(rows)}", "Frame Time: .0083333", *body]) + "\n")
