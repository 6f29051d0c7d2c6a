"""A swinging leg is smoothed without leaving its reach, the ground or its ends."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from stimuli.actors import load_actor
from stimuli.legs.swing import calm_curve, calm_swing

LEG = load_actor("M1").figure.legs[1]
N = 256
CLOCK = np.arange(N) / N
SWINGING = CLOCK > 0.62
HIP = np.column_stack([np.full(N, 0.92 * LEG.length), np.zeros(N)])


def swung(height=0.12, reach=0.25, twitch=0.0):
    """(N, 2) m: an ankle that goes back on the ground and forward through the air, with a twitch in mid air."""
    share = np.clip((CLOCK - 0.62) / 0.38, 0.0, 1.0)
    there = np.interp(CLOCK, [0.0, 0.62], [reach, -reach])
    slope = -2.0 * reach / 0.62 * 0.38  # as on the ground, at toe-off and at the strike
    rise = 2.0 * reach * share**2 * (3.0 - 2.0 * share) + slope * share * (1.0 - share) * (1.0 - 2.0 * share)
    forward = np.where(SWINGING, -reach + rise, there)
    up = height * np.sin(np.pi * share) ** 2 + twitch * (np.abs(share - 0.5) < 0.02)
    return np.column_stack([up, forward])


def knee(path):
    """(N,) degrees, knee flexion by the law of cosines."""
    distance = np.linalg.norm(path - HIP, axis=1)
    cosine = (LEG.thigh**2 + LEG.shank**2 - distance**2) / (2.0 * LEG.thigh * LEG.shank)
    return 180.0 - np.degrees(np.arccos(np.clip(cosine, -1.0, 1.0)))


def calm(path, lowest=-1.0):
    return calm_swing(LEG, HIP, np.zeros(N), path, np.full(N, lowest), SWINGING)


def test_a_smooth_swing_stays_as_it_is():
    path = swung()
    assert np.abs(calm(path) - path).max() < 0.004


def test_a_twitch_is_taken_out_and_stance_is_left_alone():
    path = swung(twitch=0.03)
    found = calm(path)
    assert np.array_equal(found[~SWINGING], path[~SWINGING])
    before, after = (np.abs(np.diff(knee(p), 2))[SWINGING[2:]].max() for p in (path, found))
    assert after < 0.2 * before


@given(st.floats(0.0, 0.2), st.floats(0.1, 0.36), st.floats(-0.05, 0.05))
def test_a_swinging_leg_is_never_asked_for_more_than_it_has(height, reach, twitch):
    found = calm(swung(height, reach, twitch))[SWINGING]
    assert np.linalg.norm(found - HIP[SWINGING], axis=1).max() <= LEG.length * np.cos(np.radians(1.49))


@given(st.floats(0.03, 0.2), st.floats(-0.04, 0.0))
def test_smoothing_does_not_press_the_foot_into_the_ground(height, twitch):
    inner = SWINGING & (CLOCK > 0.66) & (CLOCK < 0.96)
    lowest = 0.2 * height
    path = swung(height, 0.3, twitch)
    assert calm(path, lowest)[inner & (path[:, 0] > lowest), 0].min() > lowest - 0.003


def test_a_curve_keeps_its_stance_and_comes_to_its_strike():
    values = np.where(SWINGING, 1.0, 0.0)
    found = calm_curve(values, SWINGING)
    assert np.array_equal(found[~SWINGING], values[~SWINGING])
    assert 0.0 < found[-1] < 0.5
    assert np.abs(np.diff(np.append(found, found[0]), 2)).max() < 0.2  # 1 before
