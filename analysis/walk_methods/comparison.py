"""Report of `gaitlab compare-methods`: tables, the ANOVA of the poulaine's rebuilding, figures. Knows numbers only."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np
import pandas as pd

from analysis.derived_files import Derivation, write_derived
from analysis.errors import AnalysisError
from analysis.statistics.repeated_measures import anova
from analysis.walk_methods.figures import (
    Film,
    PointCloud,
    Rebuilt,
    error_figure,
    film_figure,
    points_figure,
    rebuilding_figure,
)

COMPARISON = Derivation("comparison", "ways of making a walk", alone=False)

ORDER = ("hermite", "pchip", "cubic")
"""Interpolations from the best to the worst as published (Niay 2022, section 5.2.1)."""


@dataclass(frozen=True)
class RebuildingError:
    """One poulaine rebuilt in one way: rmse in m, of one foot of one walk of one person."""

    person: str
    walk: str
    side: str
    points: int
    interpolation: str
    rmse: float


@dataclass(frozen=True)
class MethodRow:
    """One method at one speed: m/s, steps/min, mm, deg, shares."""

    person: str
    method: str
    speed: float
    delivered_speed: float
    step_frequency: float
    slide_mm: float
    knee_least_deg: float
    double_support: float
    legs_rmse_deg: float
    body_rmse_deg: float


@dataclass(frozen=True, eq=False)
class Comparison:
    """All that was computed. `whose` says which walks the rebuilding was tested on."""

    methods: tuple[MethodRow, ...]
    errors: tuple[RebuildingError, ...]
    whose: str
    clouds: tuple[PointCloud, ...] = ()
    rebuilt: tuple[Rebuilt, ...] = ()
    films: tuple[Film, ...] = ()
    pca: tuple[tuple[str, int, float, tuple[float, ...]], ...] = ()  # person, components, reduction, shares
    fourier: tuple[tuple[str, float], ...] = ()  # joint, mean share of its variance that two harmonics keep
    breaking: tuple[str, ...] = ()
    notes: tuple[str, ...] = ()


@dataclass(frozen=True, eq=False)
class ComparisonReport:
    """What was written, and its headlines."""

    headlines: tuple[str, ...]
    paths: tuple[Path, ...]


def rebuilding_anova(errors: Sequence[RebuildingError]) -> pd.DataFrame:
    """Two-way repeated-measures ANOVA, points x interpolation, of people's mean RMSE (m). Raises AnalysisError."""
    frame = pd.DataFrame([asdict(error) for error in errors])
    if frame.empty or frame["person"].nunique() < 3:
        raise AnalysisError("The ANOVA of rebuilding needs the walks of three people or more.")
    return anova(frame, dv="rmse", subject="person", within=["points", "interpolation"])


def published_order(errors: Sequence[RebuildingError], table: pd.DataFrame) -> list[str]:
    """Sentences saying whether these walks agree with the published order: 5 points better than 4, Hermite best."""
    frame = pd.DataFrame([asdict(error) for error in errors])
    people = frame.groupby(["person", "points", "interpolation"])["rmse"].mean().unstack([1, 2]) * 1e3
    p = table.set_index("effect")["p_gg"]
    count = people.T.groupby(level="points").mean().T
    way = people.T.groupby(level="interpolation").mean().T
    better = bool(count[5].mean() < count[4].mean() and p["points"] < 0.05)
    means = [float(way[name].mean()) for name in ORDER]
    sorted_ways = ", ".join(f"{name} {way[name].mean():.1f} mm" for name in way.mean().sort_values().index)
    ordered = bool(means[0] < means[1] < means[2] and p["interpolation"] < 0.05)
    both = float(p["points:interpolation"])
    share = float(np.mean(np.argmin(way[list(ORDER)].to_numpy(), axis=1) == 0))
    return [
        f"Five points against four: {count[5].mean():.1f} and {count[4].mean():.1f} mm; the data "
        f"{'agree' if better else 'DO NOT agree'} with the published result that five are better.",
        f"Interpolations from the best: {sorted_ways}; the data {'agree' if ordered else 'DO NOT agree'} with the "
        f"published order Hermite, PCHIP, cubic spline. Hermite is best for {100 * share:.0f} % of people.",
        f"Interaction of points and interpolation: published not significant (p = .237), here "
        f"p = {both:.3g}; the data {'agree' if both >= 0.05 else 'DO NOT agree'}.",
    ]


def write_report(comparison: Comparison, folder: Path) -> ComparisonReport:
    """Writes tables, figures and report.md into `folder`, over those of an earlier comparison.

    Raises AnalysisError when a file is in the way that no comparison wrote, or that a person has changed since.
    """
    methods = pd.DataFrame([asdict(row) for row in comparison.methods])
    errors = pd.DataFrame([asdict(row) for row in comparison.errors])
    pictures = {
        "points": points_figure(comparison.clouds) if comparison.clouds else None,
        "rebuilding": rebuilding_figure(comparison.rebuilt) if comparison.rebuilt else None,
        "error": error_figure(_means(errors)) if len(errors) else None,
        "films": film_figure(comparison.films) if comparison.films else None,
    }
    headlines, anova_lines = _tested(comparison)
    text = "\n".join([*_text(comparison, methods, errors), *anova_lines, *_pictures(pictures)]) + "\n"
    files = [
        ("report.md", text.encode("utf-8")),
        ("methods.csv", _csv(methods, "%.5g")),
        ("rebuilding.csv", _csv(errors, "%.6g")),
        *((f"{name}.png", content) for name, content in pictures.items() if content is not None),
    ]
    return ComparisonReport(tuple(headlines), tuple(write_derived(folder, COMPARISON, files)))


def _csv(frame: pd.DataFrame, float_format: str) -> bytes:
    return str(frame.to_csv(index=False, float_format=float_format, lineterminator="\n")).encode("utf-8")


def _tested(comparison: Comparison) -> tuple[list[str], list[str]]:
    try:
        table = rebuilding_anova(comparison.errors)
    except AnalysisError as error:
        return [str(error)], [f"## ANOVA of rebuilding\n\n{error}\n"]
    sentences = published_order(comparison.errors, table)
    columns = ["effect", "df1", "df2", "F", "p", "epsilon_gg", "p_gg", "eta_p2"]
    published = {"points": ".532", "interpolation": ".686", "points:interpolation": ".213"}
    rows = table[columns].assign(published_eta_p2=[published[name] for name in table["effect"]])
    title = f"## ANOVA of rebuilding ({comparison.whose}; {table.attrs['n']} people)\n"
    return sentences, [title, _markdown(rows), "", *sentences, ""]


def _text(comparison: Comparison, methods: pd.DataFrame, errors: pd.DataFrame) -> list[str]:
    lines = ["# Ways of making a walk, compared\n"]
    if len(methods):
        lines += ["## Methods against the captured walk at the same speed\n", _markdown(methods), ""]
        grouped = methods.drop(columns=["person", "speed"]).groupby("method", sort=False).mean().reset_index()
        lines += ["Means over people and speeds:\n", _markdown(grouped), ""]
    if comparison.pca:
        lines.append("## PCA space of each person (as Glardon et al. 2004, table 1)\n")
        rows = [
            {"person": who, "components for 80 %": count, "reduction factor": factor,
             "variance of the first four (%)": ", ".join(f"{100 * share:.1f}" for share in shares[:4])}
            for who, count, factor, shares in comparison.pca
        ]  # fmt: skip
        lines += [_markdown(pd.DataFrame(rows)), "", *[f"- {line}" for line in comparison.breaking], ""]
    if comparison.fourier:
        kept = ", ".join(f"{joint} {100 * share:.0f} %" for joint, share in comparison.fourier)
        lines += ["## Variance of each joint's rotation that two harmonics keep (Fourier)\n", f"{kept}.\n"]
    if len(errors):
        lines += [f"## Rebuilding of the poulaine: RMSE in mm ({comparison.whose})\n", _markdown(_means(errors)), ""]
    return [*lines, *[f"Note: {note}" for note in comparison.notes], ""]


def _means(errors: pd.DataFrame) -> pd.DataFrame:
    """One row per points and interpolation: mean over people of their mean (mm), standard deviation, people."""
    people = errors.groupby(["person", "points", "interpolation"])["rmse"].mean().mul(1e3).reset_index()
    grouped = people.groupby(["points", "interpolation"])["rmse"].agg(["mean", "std", "count"]).reset_index()
    return grouped.rename(columns={"mean": "mean_mm", "std": "sd_mm", "count": "people"})


def _pictures(pictures: dict[str, bytes | None]) -> list[str]:
    captions = {
        "points": "Characteristic points and mean poulaine (as thesis figure 5.4)",
        "rebuilding": "One poulaine rebuilt in six ways (as figure 5.5)",
        "error": "RMSE by points and interpolation (as figure 5.6)",
        "films": "Every method beside the captured walk at three speeds",
    }
    return [f"![{captions[name]}]({name}.png)\n" for name, content in pictures.items() if content is not None]


def _markdown(frame: pd.DataFrame) -> str:
    def cell(value: object) -> str:
        return f"{value:.4g}" if isinstance(value, float) else str(value)

    head = ["| " + " | ".join(frame.columns) + " |", "|" + " --- |" * len(frame.columns)]
    return "\n".join(head + ["| " + " | ".join(cell(value) for value in row) + " |" for row in frame.itertuples(False)])
