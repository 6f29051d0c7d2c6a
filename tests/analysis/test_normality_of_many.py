"""Shapiro and Wilk's test of more values than its p is known for: all of the session is heard, and that is said."""

from __future__ import annotations

import warnings

import numpy as np
import pandas as pd
import pytest
from scipy import stats

from analysis import mixed_model
from analysis.statistics.normal_test import MOST, normal_test


def test_people_who_come_after_the_first_5000_trials_count_too():
    rng = np.random.default_rng(1)
    first, later = rng.normal(size=MOST), rng.exponential(size=MOST) - 1.0
    assert stats.shapiro(first).pvalue > 0.05
    assert normal_test(np.concatenate([first, later]))[1] < 1e-6


def test_a_condition_that_stands_in_every_second_row_is_heard_as_often_as_the_other():
    """As with two starts, the last factor of a design: every second of 10 000 rows would be one of them."""
    rng = np.random.default_rng(2)
    values = np.empty(2 * MOST)
    values[::2], values[1::2] = rng.normal(-3.0, 1.0, MOST), rng.normal(3.0, 1.0, MOST)
    assert stats.shapiro(values[::2]).pvalue > 0.05
    assert normal_test(values)[1] < 1e-6


def test_many_normal_values_are_normal_and_the_same_values_give_the_same_p():
    values = np.random.default_rng(3).normal(size=20_000)
    with warnings.catch_warnings():
        warnings.simplefilter("error")  # scipy's, that p may not be right above 5000 values
        w, p = normal_test(values)
    assert p > 0.05
    assert (w, p) == normal_test(values)


@pytest.mark.parametrize("count", [3, 50, MOST])
def test_up_to_5000_values_all_are_tested(count):
    values = np.random.default_rng(count).normal(size=count)
    assert normal_test(values) == pytest.approx(tuple(stats.shapiro(values)))


@pytest.mark.parametrize(("people", "said"), [(50, 0), (51, 1)])
def test_a_mixed_model_says_when_its_residuals_were_sampled(people, said):
    rng = np.random.default_rng(4)
    rows = [(f"P{p}", f"A{a}", s) for p in range(people) for a in range(10) for s in ("slow", "fast") for _ in range(5)]
    data = pd.DataFrame(rows, columns=["who", "actor", "speed"])
    data["y"] = rng.normal(size=len(data)) + rng.normal(size=10)[data["actor"].str[1:].astype(int)]
    fitted = mixed_model(data, "y", "who", "actor", "speed")
    notes = [note for note in fitted.attrs["notes"] if "Normality" in note]
    assert len(notes) == said
    assert all("on 5000 of the 5100, drawn at random" in note for note in notes)
