"""The pose that fits markers best, against SciPy's least squares."""

import numpy as np
import pytest
from scipy.optimize import least_squares

from stimuli.motion_files.marked_body import CENTRE_WEIGHT, HOLD, Body
from stimuli.motion_files.marker_fitting import fitted, places
from stimuli.rotations import from_exponential, to_matrix

PARENTS = (-1, 0, 1, 0, 3, 1)  # a trunk with two limbs of two segments and one of one
FRAMES = 12


@pytest.fixture(params=range(3))
def random(request):
    return np.random.default_rng(request.param)


def turned(random, size, *shape):
    """(..., 3, 3) random rotations, mostly by less than a size (rad)."""
    return to_matrix(from_exponential(random.normal(0, size / 2, (*shape, 3))))


def person(random):
    """A body with three markers on each segment but the last, which has none."""
    local = [random.normal(0, 0.1, (3, 3)) for _ in PARENTS[1:]] + [np.zeros((0, 3))]
    return Body(PARENTS, random.normal(0, 0.3, (len(PARENTS), 3)), tuple(local))


def seen(body, rotations, root):
    """Joint centres (T, J, 3) and markers, per joint (T, m, 3), of a pose."""
    centres = places(body, rotations, root)
    markers = [centres[:, j, None] + np.einsum("tik,mk->tmi", rotations[:, j], m) for j, m in enumerate(body.local)]
    return centres, [points if points.size else None for points in markers]


def walking(random, noise=0.01):
    """A body, its rotations, and the joint centres and markers seen of it, each off by a noise (m)."""
    body, rotations = person(random), turned(random, 1.5, FRAMES, len(PARENTS))
    centres, markers = seen(body, rotations, random.normal(0, 2.0, (FRAMES, 3)))
    noisy = [points if points is None else points + random.normal(0, noise, points.shape) for points in markers]
    return body, rotations, centres + random.normal(0, noise, centres.shape), noisy


@pytest.mark.parametrize("off", [0.0, 0.3, 0.8])
def test_scipy_finds_no_better_pose(random, off):
    """From guesses off by so much (rad), with noise of 1 cm and a marker that is unseen in every other frame."""
    body, rotations, centres, markers = walking(random)
    markers[2][::2, 1] = np.nan
    guess = turned(random, off, FRAMES, len(PARENTS)) @ rotations
    found, path = fitted(body, markers, centres, guess)
    for frame in range(3):

        def distances(turns, root, frame=frame):
            here, points = seen(body, turns[None], root[None])
            parts = [np.sqrt(CENTRE_WEIGHT) * (here[0] - centres[frame]), np.sqrt(HOLD) * (turns - guess[frame])]
            parts += [a[0] - b[frame] for a, b in zip(points, markers, strict=True) if a is not None]
            return np.nan_to_num(np.concatenate([part.ravel() for part in parts]))

        def of(free, frame=frame):
            turns = to_matrix(from_exponential(free[3:].reshape(-1, 3))) @ found[frame]
            return distances(turns, free[:3])

        start = np.concatenate([path[frame], np.zeros(3 * len(PARENTS))])
        best = least_squares(of, start, xtol=1e-12, ftol=1e-14, gtol=1e-12)
        assert np.sum(of(start) ** 2) == pytest.approx(2 * best.cost, abs=1e-8)
        np.testing.assert_allclose(path[frame], best.x[:3], atol=3e-5)
        np.testing.assert_allclose(best.x[3:], 0.0, atol=1e-3)


def test_a_kilometre_from_the_origin_the_pose_is_the_same(random):
    body, rotations, centres, markers = walking(random)
    away = np.array([1000.0, 0.0, -1000.0])
    here = fitted(body, markers, centres, rotations)
    there = fitted(body, [None if points is None else points + away for points in markers], centres + away, rotations)
    np.testing.assert_allclose(there[0], here[0], atol=1e-9)
    np.testing.assert_allclose(there[1] - away, here[1], atol=1e-9)


def test_from_any_guess_the_pose_is_better_than_the_guess(random):
    body, rotations, centres, markers = walking(random)
    guess = turned(random, 6.0, FRAMES, len(PARENTS)) @ rotations
    pose = fitted(body, markers, centres, guess)
    np.testing.assert_allclose(np.linalg.det(pose[0]), 1.0, atol=1e-9)
    misses = []
    for turns, root in ((guess, centres[:, 0]), pose):
        here, points = seen(body, turns, root)
        parts = [here - centres, np.sqrt(HOLD) * (turns - guess)]
        parts += [a - b for a, b in zip(points, markers, strict=True) if a is not None]
        misses.append(sum(np.sum(part.reshape(FRAMES, -1) ** 2, axis=1) for part in parts))
    assert np.all(misses[1] < 0.2 * misses[0])
