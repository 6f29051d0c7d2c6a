"""Thresholds of adaptive tracks, followed by hand from recorded levels and answers."""

from __future__ import annotations

import math

import pandas as pd
import pytest

from analysis.errors import AnalysisError
from analysis.planned.computing import _checks
from analysis.planned.plan import plan_of
from analysis.planned.track_tests import track_tests

STAIRCASE = {"kind": "adaptive", "of": "level", "yes": "correct == 1", "rule": {"kind": "staircase", "down_after": 1}}
QUEST = {**STAIRCASE, "rule": {"kind": "quest_plus", "spreads": [1.0], "guess": 0.0, "lapses": [0.0]}}


def plan(order):
    return plan_of({
        "factors": {"actor": ["F1", "M1"], "level": [1, 2, 3, 4, 5]}, "order": order,
        "analysis": {"measure": "correct", "anova": {"within": ["actor"]}},
    })  # fmt: skip


def trials(levels, answers, who="P01", track=1, actor="F1"):
    return pd.DataFrame({
        "participant": who, "track": track, "actor": actor, "trial": range(1, len(levels) + 1), "level": levels,
        "correct": answers,
    })  # fmt: skip


def test_the_mean_of_the_reversals_without_the_first_two_by_hand():
    # down after one yes, up after one no: turns at 3, 4, 3, 5, 4, 5; without the first two: 3, 5, 4, 5, mean 4.25
    levels = [5, 4, 3, 4, 3, 4, 5, 4, 5]
    answers = [1, 1, 0, 1, 0, 0, 1, 0, 1]
    asked = plan(STAIRCASE)
    test = track_tests(trials(levels, answers), asked, asked.adaptive)
    assert test.more.loc[0, ["rule", "trials", "reversals"]].tolist() == ["staircase", 9, 6]
    assert test.more.loc[0, "threshold"] == pytest.approx((3 + 5 + 4 + 5) / 4)


def test_tracks_that_ran_out_of_trials_before_their_reversals_are_counted_and_answers_after_the_end_are_not():
    asked = plan({**STAIRCASE, "rule": {**STAIRCASE["rule"], "reversals": 6}})
    answers = [1, 1, 0, 1, 0, 0, 1, 0, 1]  # as above: turns six times, at the ninth answer
    whole = trials([5, 4, 3, 4, 3, 4, 5, 4, 5, 1, 1], [*answers, 1, 1])
    short = trials([5, 4, 3, 4, 3, 4, 5, 4], answers[:-1], track=2)
    test = track_tests(pd.concat([whole, short]), asked, asked.adaptive)
    assert test.more["trials"].tolist() == [9, 8]
    assert test.more["reversals"].tolist() == [6, 5]
    assert test.more.loc[0, "threshold"] == pytest.approx((3 + 5 + 4 + 5) / 4)
    assert test.notes == ("1 of 2 track(s) had all their trials before 6 reversals; their thresholds rest on fewer.",)


def test_two_tracks_of_a_participant_are_averaged_before_people_are():
    asked = plan(QUEST)
    up, down = [3] * 6, [3] * 6
    data = pd.concat([
        trials(up, [1] * 6, "P01", 1), trials(down, [0] * 6, "P01", 2), trials(up, [1] * 6, "P02", 1),
        trials(up, [1, 0] * 3, "P02", 2), trials(up, [1, 0] * 3, "P01", 3, "M1"),
        trials(up, [1, 0] * 3, "P02", 3, "M1"),
    ])  # fmt: skip
    test = track_tests(data, asked, asked.adaptive)
    more = test.more.set_index(["participant", "track"])["threshold"]
    # the levels are symmetric around 3, and so are always yes and always no
    assert more["P01", 1] + more["P01", 2] == pytest.approx(6.0)
    assert more["P01", 3] == pytest.approx(3.0, abs=0.1)
    mean = ((more["P01", 1] + more["P01", 2]) / 2 + (more["P02", 1] + more["P02", 2]) / 2) / 2
    assert test.table.set_index("level").loc["F1", "mean"] == pytest.approx(mean)
    assert list(test.table["level"]) == ["F1", "M1"]
    assert test.table["n"].tolist() == [2, 2]


def test_people_who_all_go_to_one_end_have_a_threshold_there():
    """Also when they differ by rounding only, as QUEST+ does that believes in its last threshold."""
    asked = plan(QUEST)
    data = [trials([5] * 40, [0] * (38 + i) + [1] * (2 - i), f"P{i}", 1) for i in range(3)]
    test = track_tests(pd.concat(data), asked, asked.adaptive)
    assert test.table["mean"].item() == pytest.approx(5.0, abs=0.05)


def test_thresholds_at_the_end_of_what_quest_plus_may_believe_in_are_said_to_be():
    asked = plan(QUEST)
    data = pd.concat([trials([3, 4, 5] * 6, [0] * 18, "P01"), trials([3, 2, 4] * 6, [0, 0, 1] * 6, "P02")])
    test = track_tests(data, asked, asked.adaptive)
    assert test.more.set_index("participant")["at_end"].to_dict() == {"P01": True, "P02": False}
    assert test.table["sentence"].item().endswith("1 of 2 track(s) settled at the end of the thresholds")
    assert "thresholds from 1 to 5 only" in test.notes[0]


def test_thresholds_inside_the_grid_carry_no_such_note():
    asked = plan(QUEST)
    test = track_tests(trials([2, 3, 4] * 6, [0, 1, 1] * 6), asked, asked.adaptive)
    assert not test.more["at_end"].any()
    assert test.notes == ()
    assert "settled" not in test.table["sentence"].item()


def test_a_track_that_never_turned_has_no_threshold_and_no_track_with_one_is_a_sentence():
    asked = plan(STAIRCASE)
    turned = trials([5, 4, 3, 4, 3, 4, 5, 4], [1, 1, 0, 1, 0, 0, 1, 0])
    straight = trials([5, 4, 3, 2], [1, 1, 1, 1], track=2)
    test = track_tests(pd.concat([turned, straight]), asked, asked.adaptive)
    assert math.isnan(test.more.set_index("track").loc[2, "threshold"])
    with pytest.raises(AnalysisError, match="turned often enough"):
        track_tests(straight, asked, asked.adaptive)
    with pytest.raises(AnalysisError, match="which track"):
        track_tests(straight.drop(columns="track"), asked, asked.adaptive)


def test_answers_that_drift_because_levels_follow_them_are_not_said_to_be_learning():
    data = pd.DataFrame(
        [(p, a, t, t % 3 + p * t) for p in range(4) for a in ("F1", "M1") for t in range(1, 7)],
        columns=["participant", "actor", "trial", "y"],
    )
    analysis = {"measure": "y", "anova": {"within": ["actor"]}}
    study = {"factors": {"actor": ["F1", "M1"], "level": [1, 2]}, "analysis": analysis}
    placed = {"order": STAIRCASE}
    assert "learning" in set(_checks(data, plan_of(study))["check"])
    assert "learning" not in set(_checks(data, plan_of(study | placed))["check"])
