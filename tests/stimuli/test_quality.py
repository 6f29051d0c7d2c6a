"""Quality tables and angles of actors: what is delivered, and that the documentation's table is true."""

from pathlib import Path

import numpy as np
import pytest

from stimuli.actors import load_actor, people
from stimuli.quality.angles import ANGLES, drawn_angles, normative_band, share_in_band
from stimuli.quality.delivery import comfort, delivered_table, quality_table
from stimuli.quality.travelling import travelling_joints
from stimuli.skeleton import JOINTS

ROOT = Path(__file__).parents[2]
TABLES = ROOT.parent / "shared" / "gait-tables"


def test_the_knees_normal_peak_is_59_degrees_at_72_percent():
    """motion-files.md, section 5: C4 59 degrees at 72 %, C5 61 at 71 %."""
    knee = normative_band()["knee"][:, 0]
    assert knee.max() == pytest.approx(59, abs=1)
    assert int(np.argmax(knee)) in (72, 73)
    assert normative_band("C5")["knee"][:, 0].max() == pytest.approx(61, abs=1)


@pytest.mark.skipif(not TABLES.exists(), reason="the shared gait tables are not beside the checkout")
def test_the_committed_band_is_the_shared_table():
    from stimuli.fitting.tables import mean_curves

    shared = mean_curves(TABLES, "C4")
    for angle, quantity in zip(ANGLES, ("thigh_incl_deg", "knee_flex_deg", "ankle_dorsi_deg"), strict=True):
        np.testing.assert_allclose(normative_band()[angle], shared[quantity], atol=6e-4)


def test_a_default_actors_quality_table_is_within_the_limits():
    rows = quality_table(load_actor("F2"), speeds=3, frequencies=3)
    assert len(rows) == 9
    assert not [row for row in rows if row.faults]


@pytest.mark.parametrize("name", people())
def test_every_default_actor_walks_within_two_deviations_of_adults_at_comfort(name):
    """Hip, knee and ankle, as drawn, for 95 % of the cycle at least."""
    actor = load_actor(name)
    gait = comfort(actor)
    angles = drawn_angles(actor, gait.speed, gait.step_frequency)
    shares = {angle: share_in_band(angles[angle], normative_band()[angle]) for angle in ANGLES}
    assert min(shares.values()) >= 0.95, shares


def test_travelling_joints_go_at_the_wanted_speed_and_stance_feet_stay():
    actor = load_actor("M1")
    times, positions = travelling_joints(actor, 1.0, 85.0, 3.0, 120.0)
    assert positions.shape == (360, 21, 3)
    stride = round(120.0 / 85.0 * 120.0)
    hips = positions[:, 0]
    speed = (hips[stride, 2] - hips[0, 2]) / times[stride]
    assert speed == pytest.approx(1.0, rel=0.002)
    toes = positions[:, JOINTS.index("rightToes"), 2]
    flat = (times * 85.0 / 120.0 % 1.0 > 0.15) & (times * 85.0 / 120.0 < 0.4)
    assert np.ptp(toes[flat]) < 0.010  # m


@pytest.mark.slow
def test_the_documentations_table_is_what_the_command_measures():
    """The table of docs/actors.md, made by `gaitlab actor table`: every figure of two of its lines."""
    from experiment_app.pictures.actor_pages import delivered_lines

    lines = (ROOT / "docs" / "actors.md").read_text(encoding="utf-8").splitlines()
    made = delivered_lines(delivered_table(list(people()), frequencies=(80.0, 110.0)))
    for line in made[-2:]:
        assert line in lines
