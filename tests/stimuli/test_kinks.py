"""Where two blends meet: how sharply joints turn away when the step frequency passes a row of cycles.

Between rows a pose is a straight blend, so it bends at the rows. A person sums up motion over 0.10 to 0.14 s
(Werkhoven, Snippe & Toet 1992, Vision Research 32: 2313-2329). A held key moves the step frequency by 1.4 steps/min in
that time (10 steps/min per s, the adjustment's default), and a bend rounded over it differs from the sharp one by an
eighth of the change of slope times 1.4 steps/min. The limit: a pixel of the default camera (5 m, 30 degrees) at 1080p.
"""

import math

import numpy as np
import pytest

from stimuli.actors import load_actor
from stimuli.importing.folder import import_folder
from stimuli.measure import poses
from stimuli.walker import world_joints
from tests.stimuli.test_importing import captured, needs_captures

SUMMED = 0.14 * 10.0  # steps/min
PIXEL = 2.0 * 5.0 * math.tan(math.radians(15.0)) / 1080.0  # m
PHASES = np.arange(50) / 50


def change_of_slope(actor, speed, step_frequency, step=0.02):
    """m per step/min, largest over joints and phases: slope of a joint's place after a step frequency, less before."""
    before, at, after = (
        world_joints(actor.skeleton, poses(actor, speed, step_frequency + d, PHASES)) for d in (-step, 0.0, step)
    )
    return float(np.linalg.norm(after - 2.0 * at + before, axis=-1).max()) / step


@pytest.mark.parametrize("name", ["F1", "F5", "M4", "M5"])  # the three sharpest of eighteen, and one
@pytest.mark.parametrize("row", [90.0, 100.0, 110.0])
def test_a_default_actor_bends_by_less_than_a_pixel_where_two_blends_meet(name, row):
    actor = load_actor(name)
    for speed in (0.8, 1.0, 1.2):
        assert 0.0 < change_of_slope(actor, speed, row) * SUMMED / 8.0 < PIXEL


def test_between_the_rows_there_is_no_bend():
    for step_frequency in (95.0, 105.0):
        bends = [change_of_slope(load_actor("M4"), 1.2, f) for f in (90.0, step_frequency)]
        assert bends[1] < 0.01 * bends[0]


@needs_captures
def test_an_imported_actor_bends_by_less_than_two_pixels_where_two_blends_meet(tmp_path, monkeypatch):
    """A captured clip in the grid makes a row of its own, from which the model's rows beside it turn more sharply."""
    monkeypatch.setenv("GAITLAB_ACTORS", str(tmp_path / "library"))
    import_folder(captured(tmp_path / "in", "07_01", "07_03", "07_08", "07_10", complete=True), "anna")
    actor = load_actor("anna")
    bends = {row: change_of_slope(actor, 1.0, row) * SUMMED / 8.0 for row in actor.tree.places[1:-1]}
    assert all(0.0 < bend < 2.0 * PIXEL for bend in bends.values())
    assert max(bends[row] for row in (90.0, 100.0)) < PIXEL
