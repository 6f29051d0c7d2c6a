"""Where two blends meet: how sharply joints turn away when the step frequency passes a row of cycles.

Between rows a pose is a straight blend, so it bends at the rows. A person sums up motion over 0.10 to 0.14 s
(Werkhoven, Snippe & Toet 1992, Vision Research 32: 2313-2329). A held key moves the step frequency by 1.4 steps/min in
that time (10 steps/min per s, the adjustment's default), and a bend rounded over it differs from the sharp one by an
eighth of the change of slope times 1.4 steps/min. The limit: a pixel of the default camera (5 m, 30 degrees) at 1080p.
"""

import math
from dataclasses import replace

import numpy as np
import pytest

from stimuli.actor_library import StoredActor, StoredCycle, actor_of
from stimuli.actors import Person, load_actor
from stimuli.blend_tree import coverage
from stimuli.gait import Gait
from stimuli.importing.arrangement import arrange
from stimuli.importing.folder import import_folder
from stimuli.importing.walks import read_walk
from stimuli.measure import delivered_gait, poses
from stimuli.walker import world_joints
from tests.stimuli.test_importing import CMU, captured, needs_captures

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
@pytest.mark.parametrize(
    "clips", [("07_01", "07_03", "07_08", "07_10"), ("16_15", "16_21", "16_47")], ids=["subject 07", "subject 16"]
)
def test_a_completed_actor_bends_by_less_than_a_pixel_where_two_blends_meet(clips, tmp_path, monkeypatch):
    """Also at the row of a lone captured clip, and where subject 16's smallest steps lie far from every capture."""
    actor = imported(tmp_path, monkeypatch, *clips, complete=True, height=1.65 if clips[0] == "07_01" else 1.70)
    for row in actor.tree.places[1:-1]:
        for speed in (0.8, 1.0, 1.2):
            assert 0.0 < change_of_slope(actor, speed, row) * SUMMED / 8.0 < PIXEL, (row, speed)


@needs_captures
@pytest.mark.parametrize("beats", [(80.2, 119.7), (82.0, 118.0), (79.9, 120.1)], ids=str)
def test_a_completed_grid_reaches_its_end_beats_without_a_bend_however_close_captured_rows_are(beats):
    """Nobody walks exactly to a metronome: a modelled row at 80 steps/min, 0.2 from a captured one, bent by 9 pixels.

    Not at 1.2 m/s, where steps of 0.9 m stretch the leg to its end and it bends at 80.2 whatever is done.
    """
    walks = [read_walk(CMU / f"cmu_35_{clip}.bvh") for clip in ("02", "08", "15")]
    placed = [
        replace(walk, file=f"{beat} {speed}", gait=Gait.at_speed(speed, beat))
        for beat in (*beats, 100.0)
        for walk, speed in zip(walks, (0.8, 1.0, 1.2), strict=True)
    ]
    person = Person("x", "M", 30.0, 1.75, 65.0, 1.0, 0.0065, "", ())
    arrangement = arrange(placed, person, walks[0].leg_length, complete=True)
    rows = tuple((f, tuple(StoredCycle(c.speed, f, c.walk, c.files) for c in row)) for f, row in arrangement.rows)
    actor = actor_of(StoredActor(person, "", "", rows, False))
    slowest, fastest = coverage(actor.tree)["step_frequency"]
    assert slowest <= 80.0 <= 120.0 <= fastest
    for row in actor.tree.places[1:-1]:
        for speed in (0.8, 1.0):
            assert change_of_slope(actor, speed, row) * SUMMED / 8.0 < PIXEL, (row, speed)


def jumps(actor, speed, step_frequency, samples=1000):
    """(N,) mm, largest over joints: where a pose is beside where the three before it lead to, a thousandth apart."""
    places = world_joints(actor.skeleton, poses(actor, speed, step_frequency, np.arange(samples) / samples))
    led = np.roll(places, 3, 0) - 3.0 * np.roll(places, 2, 0) + 3.0 * np.roll(places, 1, 0)
    return 1e3 * np.linalg.norm(led - places, axis=-1).max(axis=1)


@needs_captures
@pytest.mark.parametrize("clips", [("08_01", "08_04", "08_06"), ("07_01", "07_03", "07_10")], ids=["08", "07"])
def test_no_joint_of_a_captured_walk_jumps(clips, tmp_path, monkeypatch):
    """1 mm at the loop's seam and 2.5 mm in a millisecond elsewhere; within 1.5 % of a strike, where the leg meets the
    ground, 5.5 mm. Knees that snapped straight before the strike, and gave way again, made 12 mm of it."""
    actor = imported(tmp_path, monkeypatch, *clips, height=1.63)
    for speed, step_frequency in zip(actor.tree.places, actor.tree.follows, strict=True):
        found = jumps(actor, speed, step_frequency)
        phases = np.arange(len(found)) / len(found)
        left = delivered_gait(actor, speed, step_frequency).left_strike
        landing = np.min([np.abs((phases - strike + 0.5) % 1.0 - 0.5) for strike in (0.0, left)], axis=0) < 0.015
        assert found[0] < 1.0
        assert found[~landing].max() < 2.5
        assert found[landing].max() < 5.5


def imported(folder, monkeypatch, *clips, **about):
    monkeypatch.setenv("GAITLAB_ACTORS", str(folder / "library"))
    import_folder(captured(folder / "in", *clips, **about), "anna")
    return load_actor("anna")
