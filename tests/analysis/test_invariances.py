"""What changes nothing about an experiment changes nothing about its analysis."""

from __future__ import annotations

from itertools import product

import numpy as np
import pandas as pd
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from analysis import anova, assumptions, pairwise, t_tests

TESTS = [
    "df1",
    "df2",
    "F",
    "p",
    "eta_p2",
    "eta_g2",
    "epsilon_gg",
    "epsilon_hf",
    "p_gg",
    "p_hf",
    "mauchly_w",
    "mauchly_p",
]
NEAR = {"rtol": 1e-6, "atol": 1e-9}


def experiment(seed: int) -> pd.DataFrame:
    rng = np.random.default_rng(seed)
    rows = [
        (f"P{p:02d}", actor, speed, ("f", "m")[p % 3 == 0])
        for p, actor, speed in product(range(11), ("A", "B", "C"), ("slow", "fast"))
    ]
    data = pd.DataFrame(rows, columns=["who", "actor", "speed", "sex"])
    return data.assign(y=rng.normal(size=len(data)) + (data["actor"] == "B") * 0.5)


def analysed(data: pd.DataFrame) -> pd.DataFrame:
    return anova(data, "y", "who", ["actor", "speed"], "sex").set_index("effect")


def same(one: pd.DataFrame, other: pd.DataFrame) -> None:
    np.testing.assert_allclose(one[TESTS].to_numpy(float), other[TESTS].to_numpy(float), **NEAR)


seeds = st.integers(0, 10**6)
quick = settings(max_examples=15, deadline=None)


@quick
@given(seeds, st.floats(1e-4, 1e4), st.floats(-1e3, 1e3))
def test_unit_and_origin_of_the_measure(seed: int, scale: float, origin: float) -> None:
    data = experiment(seed)
    moved = data.assign(y=data["y"] * scale + origin * scale)
    same(analysed(data), analysed(moved))
    one, other = (pairwise(d, "y", "who", ["actor", "speed"], "sex", factors="actor") for d in (data, moved))
    np.testing.assert_allclose(one["t"], other["t"], **NEAR)
    np.testing.assert_allclose(one["estimate"] * scale, other["estimate"], rtol=1e-6, atol=1e-9 * scale)


@quick
@given(seeds, st.randoms(use_true_random=False))
def test_order_of_the_rows(seed: int, random: object) -> None:
    data = experiment(seed)
    order = list(range(len(data)))
    random.shuffle(order)  # type: ignore[attr-defined]
    pd.testing.assert_frame_equal(analysed(data), analysed(data.iloc[order]), rtol=1e-12)


@quick
@given(seeds)
def test_names_of_levels_and_participants(seed: int) -> None:
    data = experiment(seed)
    renamed = data.replace(
        {
            "actor": {"A": "zoë", "B": "m n", "C": "1"},
            "sex": {"f": "2", "m": "1"},
            "speed": {"slow": "a:b", "fast": "é"},
        }
    ).assign(who=data["who"].map(lambda who: f"x{99 - int(who[1:])}"))
    same(analysed(data), analysed(renamed))


@quick
@given(seeds, st.lists(st.floats(-100, 100), min_size=11, max_size=11))
def test_a_constant_per_participant_leaves_within_effects_alone(seed: int, constants: list[float]) -> None:
    data = experiment(seed)
    shift = dict(zip(sorted(data["who"].unique()), constants, strict=True))
    shifted = analysed(data.assign(y=data["y"] + data["who"].map(shift)))
    inside = ["actor", "speed", "actor:speed", "actor:sex", "speed:sex", "actor:speed:sex"]
    columns = [name for name in TESTS if name != "eta_g2"]
    np.testing.assert_allclose(
        shifted.loc[inside, columns].to_numpy(float),
        analysed(data).loc[inside, columns].to_numpy(float),
        **NEAR,
    )


@quick
@given(seeds)
def test_sums_of_squares_of_a_balanced_design_add_up(seed: int) -> None:
    data = experiment(seed)
    data = data[data["who"] < "P10"].assign(sex=lambda d: np.where(d["who"] < "P05", "f", "m"))
    result = analysed(data)
    errors = result.drop_duplicates("ss_error")["ss_error"].sum()
    total = float(((data["y"] - data["y"].mean()) ** 2).sum())
    assert result["ss"].sum() + errors == pytest.approx(total, rel=1e-9)


@pytest.mark.parametrize("scale", [1e-9, 1e9])
def test_ranks_and_slopes_have_no_unit(scale: float) -> None:
    data = experiment(5).assign(y=lambda d: d["y"].round(2) + 5, start=np.arange(66) % 7 * 10.0 + 80)
    data = pd.concat([data, data.assign(y=data["y"].to_numpy()[::-1], start=data["start"].to_numpy()[::-1])])
    other = data.assign(y=data["y"] * scale, start=data["start"] * scale)
    ranks = [t_tests(d, "y", "who", paired="actor")[["rank_statistic", "rank_p"]] for d in (data, other)]
    pd.testing.assert_frame_equal(*ranks)
    slopes = [assumptions(d, "y", "who", ["actor", "speed"], start="start").iloc[-1] for d in (data, other)]
    assert slopes[0]["check"] == "anchoring"
    assert slopes[1]["statistic"] == pytest.approx(slopes[0]["statistic"], rel=1e-9)


def test_two_levels_are_a_paired_t_test() -> None:
    from scipy import stats

    data = experiment(3)
    data = data[data["actor"] == "A"]
    wide = data.pivot(index="who", columns="speed", values="y")
    t = stats.ttest_rel(wide["fast"], wide["slow"])
    row = anova(data, "y", "who", "speed").iloc[0]
    assert (row["F"], row["p"]) == pytest.approx((t.statistic**2, t.pvalue), rel=1e-9)
