"""A crowd is posed as its walkers alone are: the same matrices, whatever the company, with or without numba."""

import importlib.util
import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from stimuli.actors import load_actor
from stimuli.blend_tree import Branch, CoverageError, Leaf, blend_weights, many_weights
from stimuli.bodies.known import load_body, scaled
from stimuli.bodies.retarget import on_its_own_soles
from stimuli.crowds import poses as crowd_poses
from stimuli.crowds import posing as crowd_posing
from stimuli.crowds.table import WalkTable, mixed
from stimuli.legs.contact import Sole
from stimuli.retarget import Figure
from stimuli.walker import drawn_pose, skin_matrices
from tests.stimuli.short_legs import short_legged
from tests.stimuli.transforms import as_matrices

SAME = 1e-4
"""Of each element of a matrix; the turns have no unit, the places are in metres."""

ways = pytest.mark.parametrize(
    "way",
    [
        "planes",
        pytest.param(
            "compiled", marks=pytest.mark.skipif(importlib.util.find_spec("numba") is None, reason="without numba")
        ),
    ],
)


def many_transforms(way):
    if way == "planes":
        return crowd_poses.many_transforms
    from stimuli.crowds import compiled_poses as crowd_poses_compiled

    return crowd_poses_compiled.many_transforms


@pytest.fixture(scope="module")
def people():
    names = ("F1", "F2", "M1", "M2")
    actors = [load_actor(name) for name in names]
    actors.append(on_its_own_soles(actors[2], scaled(load_body("man"), actors[2].height)))
    actors.append(replace(actors[0], figure=_odd_soled(actors[0].figure)))
    actors.append(replace(actors[2], table=_limping(actors[2].table)))
    actors.append(load_actor("F2", short_legged(load_body("woman"))))
    return actors, WalkTable.of([(actor.figure, actor.table, actor.tree) for actor in actors])


def _limping(table):
    """Footprints, stance shares and heel strikes of both sides made different."""
    return replace(table, contacts=table.contacts + np.array([0.02, -0.03, 0.04, -0.01, 0.06]))


def _odd_soled(figure):
    class Odd(Figure):
        sole = Sole(0.1, 0.05, 0.11, 0.0, 0.2)

    return Odd(figure.skeleton)


walks = st.lists(
    st.tuples(
        st.integers(0, 7),
        st.one_of(st.floats(0.7, 1.42), st.sampled_from((0.7, 0.88, 1.06, 1.42))),
        st.one_of(st.floats(80.0, 120.0), st.sampled_from((80.0, 100.0, 120.0))),
        st.floats(-3.0, 3.0),
    ),
    min_size=1,
    max_size=40,
)


@ways
@given(walks=walks)
@settings(max_examples=60, deadline=None)
def test_a_crowd_is_posed_as_each_of_its_walkers_alone(people, way, walks):
    actors, table = people
    who, speed, frequency, phase = (np.array(column) for column in zip(*walks, strict=True))
    together = as_matrices(many_transforms(way)(mixed(table, who, speed, frequency), phase))
    for matrices, walk in zip(together, walks, strict=True):
        actor = actors[walk[0]]
        alone = skin_matrices(actor, drawn_pose(actor, *walk[1:]))
        np.testing.assert_allclose(matrices, alone, atol=SAME)


@ways
def test_who_walks_beside_does_not_matter(people, way):
    _, table = people
    rng = np.random.default_rng(3)
    who, phase = rng.integers(0, 8, 50), rng.random(50)
    mix = mixed(table, who, rng.uniform(0.8, 1.2, 50), rng.uniform(80.0, 120.0, 50))
    order = rng.permutation(50)
    whole = many_transforms(way)(mix, phase)
    shuffled = many_transforms(way)(mix.part(order), phase[order])
    np.testing.assert_allclose(shuffled, whole[order], atol=2e-6)


@ways
def test_poses_are_written_into_a_part_of_a_larger_array(people, way):
    _, table = people
    mix = mixed(table, np.array([0, 3]), np.array([1.0, 1.1]), np.array([90.0, 101.0]))
    rows = np.full((2, 43, 4), 7.0, np.float32)
    many_transforms(way)(mix, np.array([0.1, 0.6]), rows[:, :42].reshape(2, 21, 2, 4))
    np.testing.assert_array_equal(rows[:, :42].reshape(2, 21, 2, 4), many_transforms(way)(mix, np.array([0.1, 0.6])))
    assert (rows[:, 42] == 7.0).all()


@ways
def test_walkers_are_made_larger_and_put_on_their_places(people, way):
    _, table = people
    mix = mixed(table, np.array([1, 4]), np.array([1.0, 1.1]), np.array([90.0, 101.0]))
    phase, sizes, places = np.array([0.1, 0.6]), np.array([0.9, 1.1]), np.array([[3.0, -7.0], [0.5, 20.0]])
    expected = sizes[:, None, None, None] * as_matrices(many_transforms(way)(mix, phase))
    expected[:, :, 0, 3] += places[:, :1]
    expected[:, :, 2, 3] += places[:, 1:]
    got = as_matrices(many_transforms(way)(mix, phase, None, sizes, places))
    np.testing.assert_allclose(got, expected, atol=5e-6)


def test_one_walker_is_the_same_by_the_short_way():
    actor = load_actor("M2")
    for phase in np.linspace(-0.5, 1.5, 21):
        alone = skin_matrices(actor, drawn_pose(actor, 1.1, 93.0, phase))
        np.testing.assert_allclose(crowd_posing.one_walker(actor, 1.1, 93.0, phase), alone, atol=SAME)
    with pytest.raises(CoverageError, match="outside"):
        crowd_posing.one_walker(actor, 1.1, 130.0, 0.0)


uneven = Branch(
    "step_frequency",
    "steps/min",
    (80.0, 100.0, 110.0),
    (
        Branch("speed", "m/s", (0.5, 1.0, 1.5), (Leaf(0), Leaf(1), Leaf(2))),
        Leaf(3),
        Branch("speed", "m/s", (0.9, 1.6), (Leaf(4), Leaf(5))),
    ),
)


@given(wanted=st.lists(st.tuples(st.floats(0.9, 1.5), st.floats(80.0, 110.0)), min_size=1, max_size=30))
def test_weights_of_many_are_the_weights_of_each(wanted):
    speeds, frequencies = (np.array(column) for column in zip(*wanted, strict=True))
    cycles, weights = many_weights(uneven, {"speed": speeds, "step_frequency": frequencies})
    for row, (speed, frequency) in enumerate(wanted):
        expected = blend_weights(uneven, {"speed": speed, "step_frequency": frequency})
        got = np.zeros(6)
        np.add.at(got, cycles[row], weights[row])
        np.testing.assert_allclose(got, [expected.get(cycle, 0.0) for cycle in range(6)], atol=1e-12)


def test_one_walker_outside_its_tree_is_refused_with_the_value():
    with pytest.raises(CoverageError, match=r"step_frequency 111 steps/min"):
        many_weights(uneven, {"speed": np.array([1.0, 1.0]), "step_frequency": np.array([90.0, 111.0])})
    captured = Branch("speed", "m/s", (0.8, 1.2), (Leaf(0), Leaf(1)), follows=(90.0, 110.0))
    many_weights(captured, {"speed": np.array([0.8, 1.0]), "step_frequency": np.array([90.0, 100.0])})
    with pytest.raises(CoverageError, match=r"step_frequency 97 steps/min was not captured"):
        many_weights(captured, {"speed": np.array([0.8, 1.0]), "step_frequency": np.array([90.0, 97.0])})


def test_a_numba_that_refuses_this_numpy_leaves_crowds_to_numpy(tmp_path):
    (tmp_path / "numba.py").write_text('raise ImportError("Numba needs NumPy 2.3 or less. Got NumPy 2.4.")')
    asked = f"""if True:
        import sys
        sys.path.insert(0, {str(tmp_path)!r})
        from stimuli.crowds import poses, posing
        assert posing.poser() is poses.many_transforms
    """
    said = subprocess.run([sys.executable, "-c", asked], capture_output=True, text=True)
    assert said.returncode == 0, said.stderr
