"""The foot's contact with the ground: pivots stay put, clocks run on, the swing leaves and lands smoothly."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from stimuli.legs import contact, one_foot
from stimuli.legs.contact import Sole

SOLE = Sole(ankle_height=0.085, heel=0.055, ball=0.135, ball_height=0.024, tip=0.195)


def chain(pitch, bend):
    """Heel, toe joint and tip of a planted foot, (forward, up), by turning the rest shape."""
    forward, up = contact.planted(SOLE, pitch, bend)

    def turned(ahead, above, angle):
        return np.array([ahead * np.cos(angle) - above * np.sin(angle), above * np.cos(angle) + ahead * np.sin(angle)])

    ankle = np.array([float(forward), float(up)])
    heel = ankle + turned(-SOLE.heel, -SOLE.ankle_height, pitch)
    joint = ankle + turned(SOLE.ball, SOLE.ball_height - SOLE.ankle_height, pitch)
    return heel, joint, joint + turned(SOLE.tip - SOLE.ball, -SOLE.ball_height, pitch + bend)


def test_a_flat_foot_has_its_ankle_above_its_ground_point():
    assert [float(value) for value in contact.planted(SOLE, 0.0, 0.0)] == pytest.approx([0.0, 0.085])


@given(st.floats(0.0, 0.6))
def test_toes_up_the_heel_stays_where_it_stood(pitch):
    np.testing.assert_allclose(chain(pitch, 0.0)[0], [-SOLE.heel, 0.0], atol=1e-12)


@given(st.floats(-1.3, -0.001))
def test_heel_up_the_tip_stays_where_it_stood(pitch):
    heel, joint, tip = chain(pitch, float(contact.toe_bend(pitch, 0.0)))
    np.testing.assert_allclose(tip, [SOLE.tip, 0.0], atol=1e-12)
    assert heel[1] > 0.0
    assert joint[1] >= SOLE.ball_height - 1e-6


def test_the_toes_stay_flat_until_they_are_bent_as_far_as_they_go():
    assert float(contact.toe_bend(np.radians(-20.0), 0.0)) == pytest.approx(np.radians(20.0), abs=np.radians(0.1))
    assert float(contact.toe_bend(np.radians(-80.0), 0.0)) == pytest.approx(contact.TOE_BEND_LIMIT, abs=1e-3)


@given(st.floats(0.0, 0.9999), st.floats(0.56, 0.7))
def test_the_clock_runs_back_and_forth(phase, stance):
    assert float(contact.phase_of(contact.clock(phase, stance), stance)) == pytest.approx(phase, abs=1e-12)


@pytest.mark.parametrize("stance", [0.58, 0.62, 0.66])
def test_a_standing_footprint_moves_with_the_ground_and_comes_back_one_stride_ahead(stance):
    phases = np.linspace(0.0, stance - 1e-9, 50)
    np.testing.assert_allclose(contact.footprint_travel(phases, stance), -phases, atol=1e-12)
    assert float(contact.footprint_travel(1.0 - 1e-12, stance)) == pytest.approx(0.0, abs=1e-9)


def test_the_swing_begins_and_ends_at_the_speed_of_the_ground():
    phases = np.linspace(0.5, 1.2, 70001)
    path = contact.footprint_travel(np.where(phases >= 1.0, phases - 1.0, phases), 0.62)
    velocity = np.diff(np.where(phases >= 1.0, path, path)) / np.diff(phases)
    assert np.abs(np.diff(velocity)).max() < 0.01


def test_the_flat_zone_can_be_undone():
    pitch = np.radians(np.linspace(-70, 30, 101))
    np.testing.assert_allclose(contact.flattened(contact.wanted_pitch(pitch)), pitch, atol=1e-9)


@given(st.floats(0.0, 0.9999), st.floats(0.56, 0.7), st.floats(-1.3, 0.6))
def test_one_foot_in_plain_numbers_is_as_many_feet(phase, stance, pitch):
    clock = one_foot.clock(phase, stance)
    swing = one_foot.swing_progress(clock)
    bend = one_foot.toe_bend(pitch, swing)
    assert clock == pytest.approx(float(contact.clock(phase, stance)), abs=1e-14)
    assert swing == pytest.approx(float(contact.swing_progress(clock)), abs=1e-14)
    travel = float(contact.footprint_travel(phase, stance))
    assert one_foot.footprint_travel(phase, stance) == pytest.approx(travel, abs=1e-14)
    assert bend == pytest.approx(float(contact.toe_bend(pitch, swing)), abs=1e-14)
    expected = [float(value) for value in contact.planted(SOLE, pitch, bend)]
    assert one_foot.planted(SOLE, pitch, bend) == pytest.approx(expected, abs=1e-14)
