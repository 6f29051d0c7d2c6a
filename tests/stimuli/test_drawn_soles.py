"""Shoes of the default bodies, as drawn, on the ground: on default actors and on an imported one."""

import shutil
from pathlib import Path

import numpy as np
import pytest

from stimuli.actor_library import actor_of
from stimuli.actors import load_actor, people
from stimuli.blend_tree import followed_step_frequency
from stimuli.bodies.known import load_body, scaled
from stimuli.bodies.retarget import sole_gaps, sole_of
from stimuli.importing.folder import import_folder
from stimuli.legs.contact import Sole

CMU = Path(__file__).parents[2].parent / "shared" / "mocap" / "bvh" / "cmu"
BODIES = ("woman", "man")
GAITS = ((0.7, 80.0), (0.7, 120.0), (0.8, 120.0), (1.06, 100.0), (1.2, 80.0), (1.42, 80.0), (1.42, 120.0), None)
"""Corners, middle and a long slow step of what actors walk (speed in m/s, step frequency in steps/min); comfort."""


@pytest.mark.parametrize("name", BODIES)
def test_a_drawn_heel_turns_where_the_model_of_the_sole_turns(name):
    """Within 2 mm; heels that were flat to their end turned 4.4 mm further behind."""
    body = load_body(name)
    assert sole_of(body).heel == pytest.approx(Sole.of(body.skeleton).heel, abs=0.002)


@pytest.mark.parametrize("body", BODIES)
@pytest.mark.parametrize("name", people())
def test_drawn_shoes_stay_within_two_millimetres_of_the_ground(name, body):
    """Heels that were flat to their end sank by 2.97 mm."""
    worn = load_body(body)
    actor = load_actor(name, worn)
    gaps = [sole_gaps(actor, scaled(worn, actor.height), gait, phases=24) for gait in GAITS]
    assert -2.0 < min(low for low, _ in gaps) <= max(high for _, high in gaps) < 2.0


@pytest.mark.skipif(not CMU.is_dir(), reason="the shared captures are not beside the checkout")
def test_drawn_shoes_of_an_imported_actor_stay_within_two_millimetres_of_the_ground(tmp_path):
    """Subject 08 of CMU lands with the toes further up than any default actor; the heels sank by 3.5 mm."""
    (tmp_path / "in").mkdir()
    for clip in ("08_01", "08_04", "08_06"):
        shutil.copyfile(CMU / f"cmu_{clip}.bvh", tmp_path / "in" / f"cmu_{clip}.bvh")
    (tmp_path / "in" / "actor.yaml").write_text("sex: F\nheight: 1.68\nweight: 60\nage: 30\n", encoding="utf-8")
    imported = import_folder(tmp_path / "in", "fast", tmp_path / "library")
    for name in BODIES:
        actor = actor_of(imported, load_body(name))
        worn = scaled(load_body(name), actor.height)
        for speed in np.linspace(1.06, 1.74, 9):
            step_frequency = followed_step_frequency(actor.tree, float(speed))
            assert step_frequency is not None
            lowest, highest = sole_gaps(actor, worn, (float(speed), step_frequency))
            assert -2.0 < lowest <= highest < 2.0
