"""The planned analysis of a study, taken from the study file that every run carries with it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from io import StringIO
from typing import Any

from analysis.errors import AnalysisError, listed
from analysis.planned.plan_parts import (
    AdaptivePlan,
    ComparisonPlan,
    DPrimePlan,
    EquivalencePlan,
    Exclusion,
    FigurePlan,
    GroupsPlan,
    MixedModelPlan,
    PairsPlan,
    ProportionsPlan,
    PsychometricPlan,
    RankTransformPlan,
    RegressionPlan,
    TTestPlan,
)
from analysis.statistics.columns import label, level_names, numeric_label
from protocols.gaze import REGIONS

GAZE_SHARE = "gaze_share"  # % of looking time; has the within factor region


@dataclass(frozen=True)
class AnalysisPlan:
    """What is computed of one measure, named in advance."""

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
    actor: str = ""  # who walks: a name, or $factor
    heights: Mapping[str, float] | None = None  # of every actor, m
    equivalence: tuple[EquivalencePlan, ...] = field(default=())
    regression: RegressionPlan | None = None
    rank_transform: RankTransformPlan | None = None
    mixed_model: MixedModelPlan | None = None
    comparisons: tuple[ComparisonPlan, ...] = field(default=())
    pairs: tuple[PairsPlan, ...] = field(default=())
    proportions: tuple[ProportionsPlan, ...] = field(default=())
    d_prime: DPrimePlan | None = None
    psychometric: PsychometricPlan | None = None
    adaptive: AdaptivePlan | None = None
    groups: Mapping[str, GroupsPlan] = field(default_factory=dict)  # factors made of groups of another's levels
    also: tuple[AnalysisPlan, ...] = field(default=())  # of further measures


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
    shared = {"exclusions": analysis.get("exclusions") or (), "groups": analysis.get("groups") or {}}
    also = tuple(_one_plan(study, {**further, **shared}, (), where) for further in analysis.get("also") or ())
    plan = _one_plan(study, analysis, also, where)
    plan = replace(plan, adaptive=_adaptive(study.get("order"), study.get("factors") or {}))
    names = [plan.measure, *(further.measure for further in also)]
    twice = sorted({name for name in names if names.count(name) > 1})
    if twice:
        raise AnalysisError(f"{where}: {listed(twice)} is analysed twice; put all its tests into one analysis.")
    return plan


def _one_plan(
    study: Mapping[str, Any], analysis: Mapping[str, Any], also: tuple[AnalysisPlan, ...], where: str
) -> AnalysisPlan:
    if not analysis.get("measure"):
        raise AnalysisError(f"{where}: analysis.measure must name the column to analyse, as walk_ratio.")
    participants = study.get("participants") or {}
    between, factors = participants.get("between") or {}, study.get("factors") or {}
    anova = analysis.get("anova") or {}
    post_hoc = analysis.get("post_hoc") if "post_hoc" in analysis else {}
    questions = _questions(participants.get("questions"))
    heights = analysis.get("heights")
    groups = {str(name): _groups(part) for name, part in (analysis.get("groups") or {}).items()}
    made = {name: list(part.levels) for name, part in groups.items()}
    regions = {"region": list(REGIONS)} if analysis["measure"] == GAZE_SHARE else {}
    levels = {name: level_names(of) for name, of in {**factors, **made, **regions, **between}.items()}
    tests = [test for test in analysis.get("t_tests") or () if isinstance(test, Mapping)]
    plan = AnalysisPlan(
        study=str(study.get("study", "")),
        title=str(study.get("title", study.get("study", "Study"))),
        about=" ".join(str(study.get("about", "")).split()),
        measure=str(analysis["measure"]),
        label=str(analysis.get("label", analysis["measure"])),
        unit=str(analysis.get("unit", "")),
        within=tuple(anova.get("within") or ()),
        between=tuple(anova.get("between") or ()),
        levels=levels,
        adjust=None if post_hoc is None else str(post_hoc.get("adjust", "tukey")),
        model=str((post_hoc or {}).get("model", "multivariate")),
        t_tests=_told_apart([_against(test, levels) for test in tests if _by_levels(test)]),
        comparisons=tuple(_comparison(test) for test in tests if not _by_levels(test)),
        pairs=tuple(
            PairsPlan(
                _names(p["factors"]),
                _names(p.get("by")),
                str(p.get("adjust", "tukey")),
                str(p.get("model", "multivariate")),
            )
            for p in analysis.get("pairs") or ()
        ),
        proportions=tuple(
            ProportionsPlan(
                str(p["success"]),
                _names(p.get("each")),
                float(p.get("chance", 0.5)),
                str(p.get("label", "Proportion")),
            )
            for p in analysis.get("proportions") or ()
        ),
        d_prime=_d_prime(analysis.get("d_prime")),
        psychometric=_psychometric(analysis.get("psychometric")),
        normality=analysis.get("normality", "shapiro_wilk") is not None,
        figures=tuple(
            FigurePlan(str(f["kind"]), f.get("x"), f.get("lines"), f.get("reference"), f.get("panels"))
            for f in analysis.get("figures") or ()
        ),
        exclusions=tuple(Exclusion(str(e["where"]), str(e["reason"])) for e in analysis.get("exclusions") or ()),
        planned=participants.get("planned"),
        free_text=frozenset(name for name, kind in questions.items() if kind == "text"),
        factors=tuple(factors),
        repetitions=int(study.get("repetitions", 1)),
        questions=tuple(questions),
        start=_start_factor(study, factors),
        actor=str((study.get("stimulus") or {}).get("actor", "")),
        heights=None if heights is None else _by_level(heights),
        equivalence=tuple(
            EquivalencePlan(str(e["factor"]), float(e["bound"]), e.get("by")) for e in analysis.get("equivalence") or ()
        ),
        regression=_regression(analysis.get("regression")),
        rank_transform=_rank_transform(analysis.get("aligned_rank_transform")),
        mixed_model=_mixed_model(analysis.get("mixed_model")),
        groups=groups,
        also=also,
    )
    unknown = sorted({name for name in _factors_named(plan) if name is not None} - set(plan.levels))
    if unknown:
        raise AnalysisError(
            f"{where}: the planned analysis names {listed(map(repr, unknown))}, which is no factor of the study; "
            f"its factors are {listed(plan.levels)}."
        )
    return plan


def _factors_named(plan: AnalysisPlan) -> Iterator[str | None]:
    yield from (*plan.within, *plan.between, *(test.each for test in plan.t_tests))
    for figure in plan.figures:
        yield from (figure.x, figure.lines, figure.panels)
    for same in plan.equivalence:
        yield from (same.factor, same.by)
    for comparison in plan.comparisons:
        yield from (comparison.factor, comparison.each)
    for pairs in plan.pairs:
        yield from (*pairs.factors, *pairs.by)
    for proportion in plan.proportions:
        yield from proportion.each
    if plan.d_prime is not None:
        yield from plan.d_prime.each
    if plan.psychometric is not None:
        yield from (plan.psychometric.level, *plan.psychometric.each)
    if plan.regression is not None:
        yield plan.regression.of
    if plan.rank_transform is not None:
        yield from (*plan.rank_transform.within, *plan.rank_transform.between)
    if plan.mixed_model is not None:
        yield from (plan.mixed_model.stimulus, *plan.mixed_model.factors)


def _names(value: Any) -> tuple[str, ...]:
    """One name or a list of names."""
    return () if value is None else (value,) if isinstance(value, str) else tuple(map(str, value))


def _by_levels(test: Mapping[str, Any]) -> bool:
    """Whether a t test is against a value in every level of a factor; the others are comparisons."""
    return test.get("each") is not None and test.get("against") is not None


def _against(test: Mapping[str, Any], levels: Mapping[str, tuple[str, ...]]) -> TTestPlan:
    each, against = str(test["each"]), test["against"]
    if not isinstance(against, Mapping):
        against = dict.fromkeys(levels.get(each, ()), against)
    values = _by_level(against)
    if each in levels:  # values of levels that are not shown (a copied study with fewer actors) test nothing
        shown = {numeric_label(level) for level in levels[each]}
        values = {level: value for level, value in values.items() if numeric_label(level) in shown}
    return TTestPlan(each, values, str(test.get("label", "reference value")), test.get("where"))


def _told_apart(tests: Sequence[TTestPlan]) -> tuple[TTestPlan, ...]:
    """The tests, a label that an earlier one of the same factor has with other trials made longer by which trials."""
    known: dict[tuple[str, str], TTestPlan] = {}
    named = []
    for test in tests:
        first = known.setdefault((test.each, test.label), test)
        same = first.where == test.where
        named.append(test if same else replace(test, label=f"{test.label} ({test.trials})"))
    return tuple(named)


def _comparison(test: Mapping[str, Any]) -> ComparisonPlan:
    kind = next((name for name in ("paired", "independent") if test.get(name) is not None), "against")
    factor = None if kind == "against" else str(test[kind])
    against = float(test["against"]) if kind == "against" else None
    label = str(test.get("label", "reference value"))
    return ComparisonPlan(kind, factor, test.get("each"), against, label, test.get("where"))


def _adaptive(order: Any, factors: Mapping[str, Any]) -> AdaptivePlan | None:
    if not isinstance(order, Mapping) or order.get("kind") != "adaptive":
        return None
    return AdaptivePlan(order, tuple(float(level) for level in factors.get(str(order.get("of")), ())))


def _d_prime(part: Mapping[str, Any] | None) -> DPrimePlan | None:
    return DPrimePlan(str(part["signal"]), str(part["answer"]), _names(part.get("each"))) if part else None


def _psychometric(part: Mapping[str, Any] | None) -> PsychometricPlan | None:
    if not part:
        return None
    lapse = part.get("lapse", 0.0)
    return PsychometricPlan(
        str(part["level"]), str(part["success"]), _names(part.get("each")), str(part.get("shape", "logistic")),
        float(part.get("guess", 0.0)), None if lapse == "estimated" else float(lapse), int(part.get("bootstrap", 200)),
    )  # fmt: skip


def _by_level(values: Mapping[Any, Any]) -> dict[str, float]:
    """Values by the text of their level, as a study file maps them."""
    return {label(level): float(value) for level, value in values.items()}


def _groups(part: Mapping[str, Any]) -> GroupsPlan:
    members = {str(group): tuple(numeric_label(level) for level in levels) for group, levels in part["levels"].items()}
    return GroupsPlan(str(part["of"]), members)


def _regression(part: Mapping[str, Any] | None) -> RegressionPlan | None:
    if not part:
        return None
    on = {
        str(name): {numeric_label(level): float(v) for level, v in values.items()}
        for name, values in part["on"].items()
    }
    units = {str(name): str(unit) for name, unit in part.get("units", {}).items()}
    return RegressionPlan(str(part["of"]), on, units)


def _rank_transform(part: Mapping[str, Any] | None) -> RankTransformPlan | None:
    return RankTransformPlan(tuple(part.get("within") or ()), tuple(part.get("between") or ())) if part else None


def _mixed_model(part: Mapping[str, Any] | None) -> MixedModelPlan | None:
    return MixedModelPlan(str(part["stimulus"]), tuple(part.get("factors") or ())) if part else None


def _start_factor(study: Mapping[str, Any], factors: Mapping[str, Any]) -> str | None:
    setting = (study.get("task") or {}).get("start")
    name = setting[1:] if isinstance(setting, str) and setting.startswith("$") else None
    return name if name in factors else None


def _questions(questions: Any) -> dict[str, str]:
    if isinstance(questions, Mapping):
        return {str(name): str((q or {}).get("kind", "")) for name, q in questions.items()}
    return {str(q["id"]): str(q.get("kind", "")) for q in questions or () if isinstance(q, Mapping) and "id" in q}
