"""The planned analysis of a study, taken from the study file that every run carries with it."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from io import StringIO
from typing import Any

import pandas as pd

from analysis.columns import label, level_names
from analysis.errors import AnalysisError, listed


@dataclass(frozen=True)
class TTestPlan:
    """A one-sample t test in each level of a factor, against a value of its own."""

    each: str
    against: Mapping[str, float]
    label: str


@dataclass(frozen=True)
class FigurePlan:
    """kind: means or interaction; reference: label of the t tests whose values are drawn too."""

    kind: str
    x: str
    lines: str | None = None
    reference: str | None = None


@dataclass(frozen=True)
class Exclusion:
    """Trials left out, by a condition on one column, and why."""

    where: str
    reason: str


@dataclass(frozen=True)
class AnalysisPlan:
    """What is computed, named in advance."""

    study: str
    title: str
    about: str
    measure: str
    label: str
    unit: str
    within: tuple[str, ...]
    between: tuple[str, ...]
    levels: Mapping[str, tuple[str, ...]]  # of every factor, in the order of the study file
    adjust: str | None
    model: str
    t_tests: tuple[TTestPlan, ...]
    normality: bool
    figures: tuple[FigurePlan, ...]
    exclusions: tuple[Exclusion, ...]
    planned: int | None
    free_text: frozenset[str]  # questions whose answers stay out of the tables
    factors: tuple[str, ...] = field(default=())  # every within factor of the design
    repetitions: int = 1
    questions: tuple[str, ...] = field(default=())
    start: str | None = None  # the factor that sets where an adjustment starts


def read_plan(study_text: str, where: str) -> AnalysisPlan:
    """The plan in a study file's text; `where` is named when the text cannot be used."""
    from ruamel.yaml import YAML
    from ruamel.yaml.error import YAMLError

    try:
        study = YAML(typ="safe", pure=True).load(StringIO(study_text))
    except YAMLError as error:
        raise AnalysisError(f"{where}: the study file stored in it is not YAML: {error}") from None
    if not isinstance(study, dict):
        raise AnalysisError(f"{where}: the study file stored in it is empty.")
    return plan_of(study, where)


def plan_of(study: Mapping[str, Any], where: str = "study file") -> AnalysisPlan:
    """The plan in a study file that is already a plain dict. Raises AnalysisError for what is missing."""
    analysis = study.get("analysis")
    if not isinstance(analysis, Mapping):
        raise AnalysisError(f"{where}: the study has no `analysis:` section, so there is no analysis to run.")
    if not analysis.get("measure"):
        raise AnalysisError(f"{where}: analysis.measure must name the column to analyse, as walk_ratio.")
    participants = study.get("participants") or {}
    between = participants.get("between") or {}
    factors = study.get("factors") or {}
    anova = analysis.get("anova") or {}
    post_hoc = analysis.get("post_hoc") if "post_hoc" in analysis else {}
    questions = _questions(participants.get("questions"))
    plan = AnalysisPlan(
        study=str(study.get("study", "")),
        title=str(study.get("title", study.get("study", "Study"))),
        about=" ".join(str(study.get("about", "")).split()),
        measure=str(analysis["measure"]),
        label=str(analysis.get("label", analysis["measure"])),
        unit=str(analysis.get("unit", "")),
        within=tuple(anova.get("within") or ()),
        between=tuple(anova.get("between") or ()),
        levels={name: level_names(levels) for name, levels in {**factors, **between}.items()},
        adjust=None if post_hoc is None else str(post_hoc.get("adjust", "tukey")),
        model=str((post_hoc or {}).get("model", "multivariate")),
        t_tests=tuple(
            TTestPlan(
                str(test["each"]),
                {label(level): float(value) for level, value in test["against"].items()},
                str(test.get("label", "reference value")),
            )
            for test in analysis.get("t_tests") or ()
        ),
        normality=analysis.get("normality", "shapiro_wilk") is not None,
        figures=tuple(
            FigurePlan(str(f["kind"]), str(f["x"]), f.get("lines"), f.get("reference"))
            for f in analysis.get("figures") or ()
        ),
        exclusions=tuple(Exclusion(str(e["where"]), str(e["reason"])) for e in analysis.get("exclusions") or ()),
        planned=participants.get("planned"),
        free_text=frozenset(name for name, kind in questions.items() if kind == "text"),
        factors=tuple(factors),
        repetitions=int(study.get("repetitions", 1)),
        questions=tuple(questions),
        start=_start_factor(study, factors),
    )
    used = {*plan.within, *plan.between, *(t.each for t in plan.t_tests), *(f.x for f in plan.figures)}
    unknown = sorted(used - set(plan.levels))
    if unknown:
        raise AnalysisError(
            f"{where}: the planned analysis names {listed(map(repr, unknown))}, which is no factor of "
            f"the study; "
            f"its factors are {listed(plan.levels)}."
        )
    return plan


def _start_factor(study: Mapping[str, Any], factors: Mapping[str, Any]) -> str | None:
    setting = (study.get("task") or {}).get("start")
    name = setting[1:] if isinstance(setting, str) and setting.startswith("$") else None
    return name if name in factors else None


def _questions(questions: Any) -> dict[str, str]:
    if isinstance(questions, Mapping):
        return {str(name): str((q or {}).get("kind", "")) for name, q in questions.items()}
    return {str(q["id"]): str(q.get("kind", "")) for q in questions or () if isinstance(q, Mapping) and "id" in q}


_CONDITION = re.compile(r"\s*(\w+)\s*(<=|>=|==|!=|<|>)\s*(.+?)\s*")
_COMPARE: dict[str, Callable[[Any, Any], Any]] = {
    "<": lambda a, b: a < b, ">": lambda a, b: a > b, "<=": lambda a, b: a <= b,
    ">=": lambda a, b: a >= b, "==": lambda a, b: a == b, "!=": lambda a, b: a != b,
}  # fmt: skip


def matching(trials: pd.DataFrame, where: str) -> pd.Series:
    """Which trials meet a condition such as `late_frames > 5 and response_time < 0.2`.

    A condition compares one column with a number or a word; several are joined by `and`. A missing
    value meets no condition.
    """
    chosen = pd.Series(True, index=trials.index)
    for part in where.split(" and "):
        match = _CONDITION.fullmatch(part)
        if match is None or match[1] not in trials.columns:
            raise AnalysisError(
                f"The exclusion {where!r} cannot be read; write a column, a comparison and a value, "
                f"as `late_frames > 5`. The columns are {listed(map(str, trials.columns), 40)}."
            )
        column, value = trials[match[1]], match[3].strip("'\"")
        if pd.api.types.is_numeric_dtype(column):
            try:
                number = float(value)
            except ValueError:
                raise AnalysisError(f"The exclusion {where!r}: {value!r} is not a number.") from None
            chosen &= _COMPARE[match[2]](column, number) & column.notna()
        else:
            if match[2] not in ("==", "!="):
                raise AnalysisError(f"The exclusion {where!r}: {match[1]} holds words; use == or !=.")
            chosen &= _COMPARE[match[2]](column.map(label), value) & column.notna()
    return chosen
