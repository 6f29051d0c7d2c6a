"""Worst difference from R in every table of the reference files: `python -m analysis.check_reference FOLDER`.

The tests check the same values one by one; this prints how close they are.
"""

from __future__ import annotations

import json
import sys
import warnings
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from analysis.power.formulas import power_rm_anova
from analysis.statistics.aligned_ranks import art_anova
from analysis.statistics.comparisons import pairwise
from analysis.statistics.crossed_effects import mixed_model
from analysis.statistics.equivalence_tests import equivalence
from analysis.statistics.linear_regression import regression
from analysis.statistics.marginal_means import MODELS
from analysis.statistics.psychometric_functions import psychometric
from analysis.statistics.repeated_measures import anova
from analysis.statistics.student import t_tests

Found = Iterator[tuple[str, str, Any, Any]]  # what, "relative" or "absolute", ours, R's
ANOVA = {
    "SS, F, df, p": {"ss": "ss", "ss_error": "ss_error", "F": "F", "p": "p", "df2": "df_den"},
    "eta squared (partial, generalised)": {"eta_p2": "pes", "eta_g2": "ges"},
    "epsilon and p (GG, HF), Mauchly": {
        "epsilon_gg": "gg_eps_definition", "p_gg": "p_gg_definition", "epsilon_hf": "hf_eps", "p_hf": "p_hf",
        "mauchly_w": "mauchly_W", "mauchly_p": "mauchly_p",
    },
}  # fmt: skip
PAIRS = {"estimate": "estimate", "se": "se", "df": "df", "t": "t"}


def read(folder: Path, name: str) -> tuple[dict[str, Any], pd.DataFrame, dict[str, Any]]:
    """R's results, the data, and the arguments of `anova`."""
    reference = json.loads((folder / f"{name}.json").read_text(encoding="utf-8"))
    design = reference.get("design") or {}
    levels = {**design.get("within", {}), **design.get("between", {})}
    text = dict.fromkeys([design[key] for key in ("id", "item") if key in design] + list(levels), str)
    data = pd.read_csv(folder / f"{name}.csv", dtype=text)
    asked = {"dv": design.get("dv"), "subject": design.get("id"), "within": list(design.get("within", {})),
             "between": list(design.get("between", {})), "levels": levels}  # fmt: skip
    return reference, data, asked


def anovas(folder: Path) -> Found:
    """Every number of R's type III tables of the designs in a folder, beside ours."""
    for path in sorted(folder.glob("*.json")):
        if json.loads(path.read_text(encoding="utf-8")).get("kind") != "anova":
            continue
        reference, data, asked = read(folder, path.stem)
        wanted = {_named(row["effect"]): row for row in reference["anova_type3"]}
        for row in anova(data, **asked).to_dict("records"):
            theirs = wanted[_named(row["effect"])]
            for what, columns in ANOVA.items():
                for name, key in columns.items():
                    yield what, "relative", row[name], theirs.get(key)
            limits = theirs["pes_ci90"] or (None, None)
            yield "90 % limits of partial eta squared", "absolute", row["eta_p2_low"], limits[0]
            yield "90 % limits of partial eta squared", "absolute", row["eta_p2_high"], limits[1]
        yield from contrasts(reference, data, asked)


def contrasts(reference: Mapping[str, Any], data: pd.DataFrame, asked: Mapping[str, Any]) -> Found:
    """Every number of emmeans' pairwise contrasts of one design, beside ours."""
    for model in MODELS:
        for block in reference.get("posthoc", {}).get(model, []):
            ours = pairwise(data, **asked, factors=block["factors"], model=model)
            pairs = {frozenset((row["a"], row["b"])): row for row in ours.to_dict("records")}
            for wanted in block["contrasts"]:
                names = [" × ".join(wanted[side][factor] for factor in block["factors"]) for side in ("a", "b")]
                row = pairs[frozenset(names)]
                sign = 1 if row["a"] == names[0] else -1
                for mine, theirs in PAIRS.items():
                    value = row[mine] * sign if mine in ("estimate", "t") else row[mine]
                    yield f"contrasts, {model}", "relative", value, wanted[theirs]
                yield "Tukey p", "absolute", row["p"], wanted["p_tukey"]


def _named(effect: str) -> frozenset[str]:
    return frozenset(effect.split(":"))


def ranks(folder: Path) -> Found:
    """The F of ARTool's aligned rank transforms, beside ours."""
    for name in ("11_art_5x3_percent", "12_art_mixed_likert"):
        reference, data, asked = read(folder, name)
        ours = {_named(row["effect"]): row for row in art_anova(data, **asked, strata="full").to_dict("records")}
        for wanted in reference["art_anova"]:
            full = wanted.get("full_strata") or {}
            yield "aligned ranks, F", "relative", ours[_named(wanted["effect"])]["F"], full.get("F")


def tests_of_means(folder: Path) -> Found:
    """R's t tests and equivalence tests of one data set, beside ours."""
    reference, wide, _ = read(folder, "13_accuracy_chance")
    data = wide.melt(["id", "sex"], ["cond1", "cond2", "cond3", "cond4"], "condition", "accuracy")
    one = t_tests(data, "accuracy", "id", each="condition", against=50).to_dict("records")
    pairs = t_tests(data, "accuracy", "id", paired="condition").to_dict("records")
    bounds = {"factors": "condition", "bound": reference["tost_bound"]}
    same = equivalence(data, "accuracy", "id", "condition", **bounds).to_dict("records")
    for rows, wanted_rows, size in ((one, reference["one_sample"], "cohens_d"), (pairs, reference["paired"], "dz")):
        for row, wanted in zip(rows, wanted_rows, strict=True):
            for name in ("t", "p"):
                yield "t tests: t, p, d", "relative", row[name], wanted[name]
            yield "t tests: t, p, d", "relative", row["d"], wanted[size]["d"]
            yield "95 % limits of d", "absolute", row["d_low"], wanted[size]["ci95"][0]
            yield "JZS Bayes factor", "relative", row["bf10"], wanted["bf10_jzs_0707"]
            yield "Shapiro-Wilk", "absolute", row["shapiro_p"], wanted.get("shapiro_p")
    for row, wanted in zip(same, reference["paired"], strict=True):
        yield "TOST p", "relative", row["p"], wanted["tost"]["p_tost"]


def models(folder: Path) -> Found:
    """R's regression of actors and its crossed mixed model, beside ours."""
    reference, data, _ = read(folder, "14_regression_16")
    ours = regression(data, reference["y"], reference["x"])
    for name, theirs in {"r2_adjusted": "r2_adj", "rmse": "rmse_jamovi", "F": "F", "loo_rmse": "loo_rmse"}.items():
        yield "regression", "relative", ours.attrs["fit"][name], reference[theirs]
    reference, data, asked = read(folder, "16_crossed_lmm")
    fitted = mixed_model(data, "ratio", "id", "actor", ["speed", "sex"], levels=asked["levels"])
    for row, wanted in zip(fitted[fitted["part"] == "coefficient"].to_dict("records"), reference["fixed"], strict=True):
        yield "mixed model, coefficients", "relative", row["estimate"], wanted["estimate"]
        yield "mixed model, SE and Satterthwaite df", "relative", row["se"], wanted["se"]
        yield "mixed model, SE and Satterthwaite df", "relative", row["df2"], wanted["df_satterthwaite"]
    reference, data, _ = read(folder, "17_psychometric")
    for shape, link in (("logistic", "logit"), ("normal", "probit")):
        curve = psychometric(data, "level", "k", "n", shape=shape).iloc[0]
        yield "psychometric threshold", "relative", curve["threshold"], reference["pooled"][link]["pse"]
    for case in json.loads((folder / "15_power.json").read_text(encoding="utf-8"))["cases"]:
        if case["type"] in ("within", "between", "interaction"):
            row = power_rm_anova(
                effect=case["type"], measures=case["measures"], n=case["n_total"], f=case["f"], rho=case["rho"],
                groups=case["groups"], epsilon=case["epsilon"], alpha=case["alpha"], convention=case["convention"],
            ).iloc[0]  # fmt: skip
            yield "power", "absolute", row["power"], case["power"]


def worst_differences(folder: Path) -> pd.DataFrame:
    """Columns what, kind (relative or absolute), values compared, worst difference."""
    found: dict[tuple[str, str], list[float]] = {}
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        for part in (anovas, ranks, tests_of_means, models):
            for what, kind, mine, theirs in part(folder):
                if theirs is None or mine is None or not np.isfinite(mine) or not np.isfinite(float(theirs)):
                    continue
                size = max(abs(theirs), 1e-300) if kind == "relative" else 1.0
                found.setdefault((what, kind), []).append(abs(mine - theirs) / size)
    rows = [(what, kind, len(values), max(values)) for (what, kind), values in found.items()]
    return pd.DataFrame(rows, columns=["what", "kind", "values", "worst"])


def main() -> None:
    """Prints the table for the folder named on the command line."""
    folder = Path(sys.argv[1] if len(sys.argv) > 1 else "../shared/stats-reference")
    if not (folder / "15_power.json").is_file():
        sys.exit(f"{folder} holds no results of R; name the folder that does (stats-reference) after the command.")
    print("| what | values | worst difference from R |\n| --- | --: | --: |")
    for row in worst_differences(folder).itertuples():
        print(f"| {row.what} | {row.values} | {row.worst:.0e} {row.kind} |")


if __name__ == "__main__":
    main()
