"""The NumPy reference for skinning."""

import numpy as np
import pytest

from stimuli.bodies.known import load_body
from stimuli.bodies.skinning import skin
from stimuli.skeleton import JOINTS

STILL = np.tile(np.eye(3, 4), (len(JOINTS), 1, 1))


@pytest.fixture(scope="module")
def trousers():
    return next(s for s in load_body("man").levels[1] if s.name == "trousers")


def test_joints_that_do_not_move_leave_the_skin_where_it_is(trousers):
    positions, normals = skin(trousers, STILL)
    assert np.allclose(positions, trousers.positions, atol=1e-12)
    assert np.allclose(normals, trousers.normals, atol=1e-12)


def test_joints_that_move_as_one_carry_the_skin_rigidly(trousers):
    quarter = np.array([[0, 0, 1.0, 0.3], [0, 1, 0, -0.2], [-1, 0, 0, 0.1]])
    positions, normals = skin(trousers, np.tile(quarter, (len(JOINTS), 1, 1)))
    assert np.allclose(positions, trousers.positions @ quarter[:, :3].T + quarter[:, 3], atol=1e-12)
    assert np.allclose(normals, trousers.normals @ quarter[:, :3].T, atol=1e-12)


def test_blending_is_the_weighted_sum_of_the_joints_one_by_one(trousers):
    rng = np.random.default_rng(5)
    matrices = rng.normal(size=(len(JOINTS), 3, 4))
    positions, normals = skin(trousers, matrices)
    for vertex in rng.integers(0, len(positions), 20):
        at = np.append(trousers.positions[vertex], 1)
        pairs = zip(trousers.weights[vertex], trousers.joints[vertex], strict=True)
        assert np.allclose(positions[vertex], sum(w * matrices[j] @ at for w, j in pairs))
    assert np.allclose(np.linalg.norm(normals, axis=1), 1)
