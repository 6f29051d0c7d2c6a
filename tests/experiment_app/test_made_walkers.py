"""Walks of every method, as the scene draws and measures them."""

import numpy as np
import pytest

from experiment_app import live
from experiment_app.scene import Scene, Walker
from experiment_app.walkers import drawn_walkers, measured_gait, walk_of
from protocols.plan import TrialStep, make_plan, walks_of
from stimuli.methods.recipe import Making
from tests.protocols.studies import study


def scene(making, speed=1.06, body="", phase=0.3, actor="F2"):
    frequency = walk_of(actor, body, making, speed).step_frequency
    return Scene((Walker(actor, speed, frequency, phase, body=body, making=making),))


def test_a_captured_making_is_drawn_like_the_actor():
    made = Scene((Walker("F2", 1.06, 100.0, 0.4, making=Making(step_frequency=100.0)),))
    plain = Scene((Walker("F2", 1.06, 100.0, 0.4),))
    # between the 128 samples of a cycle joints are half a millimetre off at most
    np.testing.assert_allclose(drawn_walkers(made)[0].matrices, drawn_walkers(plain)[0].matrices, atol=2e-3)


@pytest.mark.parametrize("method", ["captured", "blend", "timewarp", "pca", "poulaine"])
def test_what_is_drawn_is_measured(method):
    gait = measured_gait(scene(Making(method)))
    assert gait["speed"] == pytest.approx(1.06, rel=0.1)  # the poulaine from five points is furthest off
    assert gait["speed"] == pytest.approx(gait["step_length"] * gait["step_frequency"] / 60.0)
    assert gait["slide_peak_mm"] >= gait["slide_mean_mm"] >= 0.0


def test_a_walk_towards_a_taller_person_is_drawn_taller():
    def crown(height):
        (walker,) = drawn_walkers(scene(Making("pca", height=height)))
        head = max(walker.body.levels[0], key=lambda surface: surface.positions[:, 1].max())
        top = head.positions[np.argmax(head.positions[:, 1])]
        return (walker.matrices[4] @ [*top, 1.0])[1]

    assert crown(2.0) / crown(1.6) == pytest.approx(2.0 / 1.6, rel=0.02)


def test_a_made_walk_can_be_shown_as_a_point_light_and_on_another_body():
    (points,) = drawn_walkers(scene(Making("poulaine"), body="point_light"))
    assert points.lines is not None
    (worn,) = drawn_walkers(scene(Making("poulaine"), body="man"))
    assert worn.body.name == "man"


def test_who_is_shown_first_is_made_first(monkeypatch):
    made: list[tuple[str, float]] = []
    monkeypatch.setattr(live, "cast", lambda actor, body: None)
    monkeypatch.setattr(live, "own_step_frequency", lambda actor, body, making, speed: made.append((actor, speed)))
    plan = make_plan(study(), 1, 1)
    with live.preparing(plan, print):
        pass
    steps = [step for step in plan.steps if isinstance(step, TrialStep)]
    shown = [(walk.actor, walk.speed) for step in steps for walk in walks_of(plan.study, step).values()]
    assert made == list(dict.fromkeys(shown))
