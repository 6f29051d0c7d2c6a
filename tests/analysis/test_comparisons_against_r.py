"""Marginal means and pairwise comparisons agree with R's emmeans."""

from __future__ import annotations

import math
import warnings
from typing import Any

import numpy as np
import pytest
from scipy import stats

from analysis import emmeans, pairwise
from analysis.statistics.studentized_range import critical_value, survival
from tests.analysis.reference import arguments, expected, table
from tests.analysis.test_anova_against_r import SETS, close

MODELS = ["multivariate", "univariate"]


def blocks(reference: dict[str, Any], model: str) -> list[tuple[list[str], list[str], dict[str, Any]]]:
    """(factors, by, block) of every block of one model, simple effects included."""
    found = []
    for kind in (model, f"simple_{model}"):
        for block in reference["posthoc"].get(kind, []):
            by = block["by"] or []
            by = [by] if isinstance(by, str) else by
            found.append(([f for f in block["factors"] if f not in by], by, block))
    return found


@pytest.fixture(autouse=True)
def _quiet() -> Any:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        yield


@pytest.mark.parametrize("model", MODELS)
@pytest.mark.parametrize("name", SETS)
def test_marginal_means_are_those_of_emmeans(name: str, model: str) -> None:
    reference = expected(name)
    data, design = table(name, reference["design"]), arguments(reference["design"])
    for factors, by, block in blocks(reference, model):
        if not block["means_usable"]:
            continue
        mine = emmeans(data, **design, factors=[*by, *factors], model=model)
        rows = {tuple(row[f] for f in (*by, *factors)): row for row in mine.to_dict("records")}
        for wanted in block["means"]:
            row = rows[tuple(wanted["levels"][f] for f in (*by, *factors))]
            for column in ("emmean", "se", "df"):
                assert close(row[column], wanted[column]), (block["factors"], column)
            assert (row["ci_low"], row["ci_high"]) == pytest.approx(wanted["ci95"], rel=1e-8)


@pytest.mark.parametrize("adjust", ["tukey", "bonferroni", "holm", "none"])
@pytest.mark.parametrize("model", MODELS)
@pytest.mark.parametrize("name", SETS)
def test_contrasts_are_those_of_emmeans(name: str, model: str, adjust: str) -> None:
    reference = expected(name)
    data, design = table(name, reference["design"]), arguments(reference["design"])
    for factors, by, block in blocks(reference, model):
        mine = pairwise(data, **design, factors=factors, by=by, model=model, adjust=adjust)
        rows = {}
        for row in mine.to_dict("records"):
            family = tuple(row[f] for f in by)
            rows[family, row["a"], row["b"]] = 1, row
            rows[family, row["b"], row["a"]] = -1, row
        assert len(mine) == len(block["contrasts"])
        scale = max(abs(c["estimate"]) for c in block["contrasts"])
        for wanted in block["contrasts"]:
            first, second = (" × ".join(wanted[side][f] for f in factors) for side in "ab")
            sign, row = rows[tuple(wanted["a"][f] for f in by), first, second]
            assert sign * row["estimate"] == pytest.approx(wanted["estimate"], rel=1e-8, abs=1e-11 * scale)
            assert close(row["se"], wanted["se"])
            assert close(row["df"], wanted["df"])
            if wanted["t"] is None:
                assert math.isnan(row["t"])
                assert math.isnan(row["p"])
                continue
            assert sign * row["t"] == pytest.approx(wanted["t"], rel=1e-8, abs=1e-10)
            tolerance = {"abs": 1e-6} if adjust == "tukey" else {"rel": 1e-8}
            assert row["p"] == pytest.approx(wanted[f"p_{adjust}"], **tolerance)


@pytest.mark.parametrize("df", [1, 3, 5, 20, 60.5, 500, 5000])
@pytest.mark.parametrize("means", [2, 3, 12, 24, 100])
def test_the_studentized_range_is_scipys_many_values_at_once(means: int, df: float) -> None:
    q = np.array([0.05, 1.0, 2.5, 4.0, 7.0, 15.0])
    wanted = [stats.studentized_range.sf(x, means, df) for x in q[1::2]]
    assert survival(q, means, df)[1::2] == pytest.approx(wanted, abs=1e-11)


def test_the_range_of_two_means_is_a_t_test() -> None:
    t = np.array([0.1, 1.0, 2.0, 5.0, 12.0])
    assert survival(t * np.sqrt(2), 2, 20) == pytest.approx(2 * stats.t.sf(t, 20), rel=1e-9, abs=1e-14)


def test_critical_values_are_those_of_the_printed_tables() -> None:
    # Studentized range table, upper 5 %: 3 means and 10 df; 5 means and 20 df; 10 means and 60 df.
    assert critical_value(0.05, 3, 10) == pytest.approx(3.88, abs=0.005)
    assert critical_value(0.05, 5, 20) == pytest.approx(4.23, abs=0.005)
    assert critical_value(0.05, 10, 60) == pytest.approx(4.65, abs=0.005)


def test_tukey_limits_exclude_zero_exactly_when_p_is_below_five_percent() -> None:
    reference = expected("01_mixed_4x3x2_sex")
    data, design = table("01_mixed_4x3x2_sex", reference["design"]), arguments(reference["design"])
    pairs = pairwise(data, **design, factors=["actor", "speed"])
    outside = (pairs["ci_low"] > 0) | (pairs["ci_high"] < 0)
    assert (outside == (pairs["p"] < 0.05)).all()
    assert outside.any()
