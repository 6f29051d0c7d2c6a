"""Crowds in study files: what may be written, and which crowd a trial shows."""

from collections import Counter

import pytest

from protocols.mistakes.consistency import inconsistencies
from protocols.plan import TrialStep, make_plan, walks_of
from protocols.study_file import StudyFileError, parse_study, read_study


def shown(seed):
    """Trial to the crowds it shows, by alternative."""
    study = read_study("crowd_variety").study
    steps = [step for step in make_plan(study, seed, 1).steps if isinstance(step, TrialStep)]
    return {step.id: (step, {name: walk.crowd for name, walk in walks_of(study, step).items()}) for step in steps}


def test_every_trial_shows_a_crowd_of_different_walks_beside_one_that_shares_them():
    for step, crowds in shown(7).values():
        assert set(crowds) == {"everybody_different", "shared"}
        assert crowds["everybody_different"].variation == "1:1"
        assert crowds["shared"].variation == step.trial.values["variation"]
        assert {crowd.size for crowd in crowds.values()} == {step.trial.values["size"]}


def test_both_crowds_of_a_trial_walk_the_same_paths_and_every_trial_has_its_own():
    pairs = [tuple(crowds.values()) for _, crowds in shown(7).values()]
    assert all(first.seed == second.seed for first, second in pairs)
    assert max(Counter(first.seed for first, _ in pairs).values()) == 1


def test_a_run_has_one_pool_of_walks_and_another_run_another():
    pools = [{crowd.pool for _, crowds in shown(seed).values() for crowd in crowds.values()} for seed in (7, 8)]
    assert len(pools[0]) == len(pools[1]) == 1
    assert pools[0] != pools[1]


def test_the_same_seed_shows_the_same_crowds():
    assert shown(7) == shown(7)


@pytest.mark.parametrize(
    ("old", "new", "says"),
    [
        ("variation: $variation}}\n  orig", 'variation: "2:1"}}\n  orig', "variation"),
        ('["1:2", "1:5"', '["1:2", "many"', "many"),
        ("size: [250, 500, 1000]", "size: [250, 500, 100000]", "4000"),
        ("size: $size,", "size: $sise,", "did you mean $size?"),
        ("  ground: street\n", "  ground: treadmill\n", "ground that is walked along"),
        ("{view: elevated, place: [0, 0], distance", "{view: front, distance", "follows one walker"),
        ("  crowd: {size: $size,", "  actor: F1\n  crowd: {size: $size,", "a crowd has its own people"),
        ('  crowd: {size: $size, variation: "1:1", palette: varied}\n', "  actor: F1\n", "speed is missing"),
        ("palette: varied", "palette: grey", "equal_luminance"),
    ],
)
def test_mistakes_about_crowds_are_named(old, new, says):
    text = read_study("crowd_variety").text
    assert old in text
    try:
        file = parse_study("s.yaml", text.replace(old, new, 1))
        found = str(file.error(inconsistencies(file.study)))
    except StudyFileError as error:
        found = str(error)
    assert says in found


def test_one_motion_per_sex_may_be_written_as_a_number():
    text = read_study("crowd_variety").text.replace('"1:25", "1"]', '"1:25", 1]').replace('"1": 0.4', "1: 0.4")
    text = text.replace('variation: "1", size: 250', "variation: 1, size: 250")
    assert inconsistencies(parse_study("s.yaml", text).study) == []


def test_two_crowds_are_searched_for_the_28_s_they_walk_and_two_walkers_are_told_apart_sooner():
    crowds, walkers = (read_study(name).study for name in ("crowd_variety", "poulaine_reconstruction"))
    assert crowds.task.seconds(crowds.stimulus) == 28.0  # Niay 2022, section 6.1
    assert crowds.task.seconds(walkers.stimulus) == 14.0
