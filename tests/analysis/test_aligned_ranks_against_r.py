"""The aligned rank transform agrees with R: ranks exactly, tests with ARTool's models."""

from __future__ import annotations

import numpy as np
import pytest
from scipy import stats

from analysis import art_anova, art_contrasts
from analysis.statistics.aligned_ranks import aligned_ranks
from analysis.statistics.cells import cell_means
from tests.analysis.reference import arguments, expected, table

SETS = ["11_art_5x3_percent", "12_art_mixed_likert", "18_higgins1990_table5", "19_higgins_abc"]


@pytest.mark.parametrize("name", SETS)
def test_ranks_are_exactly_those_of_r(name: str) -> None:
    reference = expected(name)
    design = reference["design"]
    data = table(name, design)
    means = cell_means(data, **arguments(design))
    codes = [data[f].map(list(levels).index) for f, levels in design["within"].items()]
    cell = np.ravel_multi_index(codes, [len(v) for v in design["within"].values()]) if codes else 0
    person = data[design["id"]].map(list(means.subjects).index)
    for effect, wanted in reference["ranks"].items():
        mine = aligned_ranks(means, effect.split(":"))[person, cell]
        assert mine.tolist() == wanted, effect


@pytest.mark.parametrize("strata", ["pooled", "full"])
@pytest.mark.parametrize("name", SETS)
def test_tests_of_aligned_ranks(name: str, strata: str) -> None:
    reference = expected(name)
    mine = art_anova(table(name, reference["design"]), **arguments(reference["design"]), strata=strata)
    rows = {frozenset(row["effect"].split(":")): row for row in mine.to_dict("records")}
    compared = 0
    for wanted in reference["art_anova"]:
        other = wanted["lmer_kr"] if strata == "pooled" else wanted["full_strata"]
        if not other or other.get("singular_fit"):
            continue
        row = rows[frozenset(wanted["effect"].split(":"))]
        relative = 1e-5 if strata == "pooled" else 1e-8
        assert row["df1"] == other["df_num"]
        assert row["df2"] == pytest.approx(other["df_den"], rel=1e-6)
        assert row["F"] == pytest.approx(other["F"], rel=relative)
        assert row["p"] == pytest.approx(other["p"], rel=relative, abs=1e-12)
        if strata == "full" and other["p_gg"] is not None:
            assert row["p_gg"] == pytest.approx(other["p_gg"], rel=1e-8)
        compared += 1
    if not compared:
        pytest.skip("every reference fit of this set is singular or absent")


@pytest.mark.parametrize("adjust", ["none", "bonferroni", "holm", "tukey"])
@pytest.mark.parametrize("name", SETS)
def test_contrasts_are_those_of_art_c(name: str, adjust: str) -> None:
    reference = expected(name)
    data, design = table(name, reference["design"]), arguments(reference["design"])
    for block in reference["art_c"]:
        if block["singular_fit"]:
            continue
        mine = art_contrasts(data, **design, factors=block["factors"], adjust=adjust)
        rows = {(r["a"], r["b"]): (1, r) for r in mine.to_dict("records")}
        rows |= {(b, a): (-1, r) for (a, b), (_, r) in rows.items()}
        for wanted in block["contrasts"]:
            first, second = (" × ".join(wanted[side][f] for f in block["factors"]) for side in "ab")
            sign, row = rows[first, second]
            assert sign * row["estimate"] == pytest.approx(wanted["estimate"], rel=1e-5, abs=1e-6)
            assert row["se"] == pytest.approx(wanted["se"], rel=1e-5)
            assert row["df"] == pytest.approx(wanted["df"], rel=1e-5)
            assert row["p"] == pytest.approx(wanted[f"p_{adjust}"], rel=1e-5, abs=1e-6)


def test_a_monotone_change_of_unit_changes_no_rank() -> None:
    reference = expected("12_art_mixed_likert")
    data, design = table("12_art_mixed_likert", reference["design"]), arguments(reference["design"])
    dv = design["dv"]
    small = art_anova(data.assign(**{dv: data[dv] * 1e-3}), **design)
    assert small["F"].to_list() == pytest.approx(art_anova(data, **design)["F"].to_list(), rel=1e-9)


def test_one_between_factor_alone_is_nearly_kruskal_wallis() -> None:
    rng = np.random.default_rng(5)
    import pandas as pd

    data = pd.DataFrame({"id": range(30), "group": list("abc") * 10, "y": rng.normal(size=30)})
    row = art_anova(data, "y", "id", between="group").iloc[0]
    h = stats.kruskal(*(part["y"] for _, part in data.groupby("group"))).statistic
    assert row["F"] == pytest.approx((h / 2) / ((29 - h) / 27), rel=1e-9)  # Conover & Iman 1981
