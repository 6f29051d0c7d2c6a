"""What left and right do differently survives an import, unless actor.yaml asks for an even walk."""

from pathlib import Path

import numpy as np
import pytest

from stimuli.actor_library import StoredActor, actor_of
from stimuli.actors import Actor
from stimuli.importing.folder import import_folder
from stimuli.kinematics import world_joints
from stimuli.measure import delivered_gait, poses
from stimuli.skeleton import JOINTS
from tests.stimuli.limping import limping_actor, write_bvh

SPEED, STEP_FREQUENCY = 1.0, 96.0


def imported(folder: Path, more: str = "") -> StoredActor:
    about = f"sex: male\nheight: 1.78\nweight: 75\nage: 40\nlicence: made\nsource: made\n{more}"
    (folder / "actor.yaml").write_text(about, encoding="utf-8")
    write_bvh(limping_actor(), SPEED, STEP_FREQUENCY, folder / "limp.bvh")
    return import_folder(folder, "limping", folder / "library")


def thigh_ranges(actor: Actor, speed: float, step_frequency: float) -> np.ndarray:
    """deg, how far the left and the right thigh swing over a cycle."""
    joints = world_joints(actor.skeleton, poses(actor, speed, step_frequency, np.arange(128) / 128))
    bones = [
        joints[:, JOINTS.index(f"{side}LowerLeg")] - joints[:, JOINTS.index(f"{side}UpperLeg")]
        for side in ("left", "right")
    ]
    return np.array([np.ptp(np.degrees(np.arctan2(bone[:, 2], -bone[:, 1]))) for bone in bones])


def test_a_limping_walker_goes_at_the_wanted_speed_on_feet_that_stay():
    gait = delivered_gait(limping_actor(), SPEED, STEP_FREQUENCY)
    assert gait.speed == pytest.approx(SPEED, rel=1e-3)
    assert gait.step_frequency == pytest.approx(STEP_FREQUENCY, rel=1e-3)
    assert gait.step_length_left + gait.step_length_right == pytest.approx(2 * 60 * SPEED / STEP_FREQUENCY, rel=1e-3)
    assert gait.step_length_left - gait.step_length_right > 0.08  # m
    assert gait.left_strike > 0.53
    assert gait.slide_mean < 5.0
    assert gait.slide_peak < 10.0


def test_a_captured_limp_stays_a_limp(tmp_path):
    made = limping_actor()
    wanted = delivered_gait(made, SPEED, STEP_FREQUENCY)
    (cycle,) = imported(tmp_path).cycles
    actor = actor_of(imported_again(tmp_path))
    gait = delivered_gait(actor, cycle.speed, cycle.step_frequency)
    assert gait.speed == pytest.approx(cycle.speed, rel=1e-3)
    assert gait.step_frequency == pytest.approx(cycle.step_frequency, rel=1e-3)
    assert gait.left_strike == pytest.approx(wanted.left_strike, abs=0.01)
    assert gait.step_length_left == pytest.approx(wanted.step_length_left, abs=0.015)
    assert gait.step_length_right == pytest.approx(wanted.step_length_right, abs=0.015)
    left, right = thigh_ranges(actor, cycle.speed, cycle.step_frequency)
    assert right - left == pytest.approx(float(np.diff(thigh_ranges(made, SPEED, STEP_FREQUENCY))[0]), abs=2.0)
    assert gait.slide_mean < 5.0
    assert gait.slide_peak < 10.0
    assert gait.sole_lowest > -3.0
    assert gait.knee_least > 0.0


def imported_again(folder: Path) -> StoredActor:
    """As it comes back from the library."""
    from stimuli.actor_library import read_stored

    return read_stored("limping", folder / "library")


def test_symmetric_evens_a_limp_out(tmp_path):
    (cycle,) = imported(tmp_path, "symmetric: true\n").cycles
    gait = delivered_gait(actor_of(imported_again(tmp_path)), cycle.speed, cycle.step_frequency)
    assert cycle.walk.is_symmetric
    assert gait.left_strike == pytest.approx(0.5, abs=1e-6)
    assert gait.step_length_left == pytest.approx(gait.step_length_right, abs=1e-6)


def test_a_completed_actor_limps_near_the_captured_walk_and_less_far_from_it(tmp_path):
    actor = actor_of(imported(tmp_path, "complete: true\n"))
    near, far = (delivered_gait(actor, *place) for place in ((1.06, 97.0), (1.2, 120.0)))
    assert near.left_strike > 0.53
    assert 0.51 < far.left_strike < near.left_strike
    for gait in (near, far):
        assert gait.slide_mean < 5.0
        assert gait.slide_peak < 10.0
