"""The drawing of what an actor covers, in the message that refuses what lies outside."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from stimuli.actors import CYCLE_SPEEDS, METRONOME, load_actor, metronome_tree
from stimuli.blend_tree import Branch, CoverageError, Leaf, blend_weights, covers, many_weights
from stimuli.coverage_drawing import COLUMNS, ROWS, coverage_drawing
from stimuli.quality.delivery import delivered_table
from stimuli.walker import drawn_pose

GRID = metronome_tree(METRONOME, CYCLE_SPEEDS)
PATH = Branch("speed", "m/s", (0.9, 1.2, 1.5), (Leaf(0), Leaf(1), Leaf(2)), (96.0, 110.0, 121.0))


def map_of(drawing: str) -> list[str]:
    return [line.split("|")[1] for line in drawing.splitlines() if "|" in line]


def test_the_message_is_a_sentence_and_a_drawing_with_the_place_asked_for():
    with pytest.raises(CoverageError, match=r"speed 1.6 m/s is outside the cycles there are: 0.7 to 1.42 m/s") as error:
        drawn_pose(load_actor("F1"), 1.6, 100.0, 0.0)
    sentence, *drawing = str(error.value).splitlines()
    assert sentence == error.value.sentence
    rows = map_of("\n".join(drawing))
    assert len(rows) == ROWS
    assert {len(row) for row in rows} == {COLUMNS}
    assert rows[ROWS // 2][-1] == "X"  # 100 of 80 to 120 steps/min, and at the right, beyond the cycles
    assert sum(row.count("o") for row in rows) == 25


def test_a_path_is_drawn_where_the_captures_lie():
    rows = map_of(coverage_drawing(PATH, {"speed": 1.0, "step_frequency": 118.0}))
    assert sum(row.count("o") for row in rows) == 3
    assert rows[0].endswith("o")
    assert rows[-1].startswith("o")
    assert sum(row.count("X") for row in rows) == 1
    with pytest.raises(CoverageError, match=r"complete: true[\s\S]*asked for"):
        blend_weights(PATH, {"speed": 1.0, "step_frequency": 118.0})


def test_walkers_posed_all_at_once_are_refused_with_the_same_message_as_one():
    """Also where the walker outside is neither slowest nor fastest, but off the path that step frequency follows."""
    for tree, speeds, beats, outside in (
        (GRID, [1.0, 1.6, 1.2], [90.0, 100.0, 110.0], 1),
        (PATH, [0.9, 1.2, 1.5], [96.0, 97.0, 121.0], 1),
    ):
        with pytest.raises(CoverageError) as alone:
            blend_weights(tree, {"speed": speeds[outside], "step_frequency": beats[outside]})
        with pytest.raises(CoverageError) as together:
            many_weights(tree, {"speed": np.array(speeds), "step_frequency": np.array(beats)})
        assert str(together.value) == str(alone.value)
        assert sum(row.count("X") for row in map_of(str(together.value))) == 1


@given(st.floats(-5.0, 9.0), st.floats(0.0, 400.0))
def test_what_was_asked_is_always_in_the_drawing(speed, step_frequency):
    wanted = {"speed": speed, "step_frequency": step_frequency}
    drawing = coverage_drawing(GRID, wanted)
    assert sum(row.count("X") for row in map_of(drawing)) == 1
    assert covers(GRID, wanted) == (0.7 <= speed <= 1.42 and 80.0 <= step_frequency <= 120.0)


def test_trees_over_other_parameters_are_told_in_words_only():
    tree = Branch("sway", "", (0.0, 2.0), (Leaf(0), Leaf(1)))
    with pytest.raises(CoverageError) as error:
        blend_weights(tree, {"sway": 3.0})
    assert "\n" not in str(error.value)


def test_of_several_actors_the_one_that_does_not_reach_so_far_is_named():
    with pytest.raises(CoverageError, match=r"^F1: speed 1\.6 m/s is outside the cycles there are") as error:
        delivered_table(["F1", "M1"], speeds=(1.2, 1.6), frequencies=(100.0,))
    assert sum(row.count("X") for row in map_of(str(error.value))) == 1
