"""Crowds: nobody comes near anybody, motions are shared as 1:N says, and paths do not depend on motions."""

from collections import Counter

import numpy as np
import pytest
from scipy.spatial import cKDTree

from stimuli.crowds.motions import LONGEST, SHORTEST, Style, motion_of
from stimuli.crowds.plan import LANE, NEAREST, SWERVE, CrowdError, motions_per_sex, plan_crowd

WIDTH, LENGTH = 18.0, 110.0
APART = 0.55
"""m between the middles of two people; the 95th percentile of men's shoulder breadth is 0.51 m (Pheasant 1996)."""


def plan(size=250, variation="1:25", seed=1, pool=0):
    return plan_crowd(size, variation, seed, pool, WIDTH, LENGTH)


@pytest.mark.parametrize("size", [250, 500, 1000])
@pytest.mark.parametrize("seed", [1, 2, 3])
def test_nobody_comes_near_anybody_in_two_minutes(size, seed):
    crowd = plan(size, "1:25", seed)
    nearest = []
    for seconds in np.arange(0.0, 120.0, 0.4):  # neighbours come 0.2 m nearer at most in between
        places = crowd.places(seconds)
        again = np.concatenate([places, places + np.array([0.0, crowd.length])])  # the end meets the beginning
        nearest.append(cKDTree(again).query(again, k=2)[0][:, 1].min())
    assert min(nearest) >= APART


def test_and_never_will_because_lanes_lie_apart_and_a_lane_has_one_speed():
    crowd = plan(1000)
    lanes = np.round((crowd.aside - crowd.aside.min()) / LANE).astype(int)
    offsets = crowd.aside - (lanes - lanes.max() / 2) * LANE
    assert np.abs(offsets).max() <= SWERVE + 1e-9
    assert LANE - 2 * SWERVE >= APART
    for lane in range(lanes.max() + 1):
        own = lanes == lane
        assert np.ptp(crowd.speed[own]) == 0.0
        start = np.sort(crowd.start[own])
        assert np.diff(np.append(start, start[0] + crowd.length)).min() >= NEAREST - 1e-9
    assert np.abs(crowd.aside).max() < WIDTH / 2 - 0.3


def test_everybody_walks_the_same_way_at_their_own_speed():
    crowd = plan()
    moved = (crowd.places(10.5) - crowd.places(10.0)) % [1e9, crowd.length]
    np.testing.assert_allclose(moved[:, 0], 0.0)
    np.testing.assert_allclose(moved[:, 1], 0.5 * crowd.speed, atol=1e-9)
    turned = (crowd.phases(10.5) - crowd.phases(10.0)) % 1.0
    np.testing.assert_allclose(turned, crowd.step_frequency * 0.5 / 120.0, atol=1e-9)


@pytest.mark.parametrize(("variation", "motions"), [("1:2", 125), ("1:5", 50), ("1:10", 25), ("1:25", 10), ("1", 2)])
def test_one_motion_is_shared_by_as_many_as_the_variation_says(variation, motions):
    crowd = plan(250, variation)
    assert len(crowd.motions) == len(set(crowd.motions)) == motions
    assert crowd.women.sum() == 125
    shared = Counter(crowd.motion.tolist())
    for sex in (True, False):
        counts = [n for motion, n in shared.items() if (crowd.motions[motion].sex == "F") == sex]
        assert max(counts) - min(counts) <= 1
        assert sum(counts) == 125


def test_an_odd_motion_goes_to_women_as_often_as_to_men():
    more = [motions_per_sex(250, "1:10", seed)[0] - motions_per_sex(250, "1:10", seed)[1] for seed in range(400)]
    assert set(more) == {-1, 1}
    assert abs(sum(more)) < 80  # 4 SD of a fair coin


def test_paths_and_sizes_are_the_same_whatever_the_variation():
    paths = [
        sorted(zip(c.aside, c.start, c.speed, strict=True))
        for c in (plan(250, v, seed=4) for v in ("1:2", "1:25", "1"))
    ]
    assert paths[0] == paths[1] == paths[2]
    assert paths[0] != sorted(zip(*(getattr(plan(250, "1", 5), n) for n in ("aside", "start", "speed")), strict=True))


@pytest.mark.slow
def test_step_lengths_of_a_thousand_are_those_of_the_thesis():
    lengths = np.array([motion_of(Style(sex, number)).step_length for sex in "FM" for number in range(500)])
    assert lengths.mean() == pytest.approx(0.77, abs=4 * 0.06 / np.sqrt(1000))
    assert lengths.std() == pytest.approx(0.06, abs=4 * 0.06 / np.sqrt(2000))
    assert lengths.min() >= SHORTEST
    assert lengths.max() <= LONGEST


def test_nobody_hurries_or_dawdles():
    crowd = plan(250, "1:2")
    assert crowd.step_frequency.min() > 85.0
    assert crowd.step_frequency.max() < 155.0
    own = np.array([motion_of(style).step_frequency for style in crowd.motions])[crowd.motion]
    assert np.std(crowd.step_frequency / own) < 0.09


def test_a_crowd_that_cannot_be_is_refused():
    for size, variation, message in (
        (1, "1:1", "2 to 4000"),
        (250, "1/2", "1:N"),
        (250, "2:1", "1:N"),
        (250, "1:0", "1:N"),
        (250, "", "1:N"),
    ):
        with pytest.raises(CrowdError, match=message):
            plan(size, variation)
    with pytest.raises(CrowdError, match="no room"):
        plan_crowd(250, "1", 1, 0, 1.0, LENGTH)


def test_more_walkers_than_fit_make_the_stretch_longer():
    assert plan(3000).length > LENGTH
