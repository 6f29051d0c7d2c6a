"""Experiments of a study drawn by the thousand, without sessions, and reduced to the cells of its analysis."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import product
from typing import Any

import numpy as np

from analysis.errors import AnalysisError
from analysis.planned.plan import AnalysisPlan, plan_of
from analysis.power import simulated_adjusters
from analysis.power.simulated_adjusters import Adjusters, adjusters
from analysis.power.simulated_answers import Choosers, Raters, choosers, raters
from analysis.statistics.cells import CellMeans
from analysis.statistics.columns import numeric_label
from protocols.study import Simulation

MEASURES: Mapping[str, tuple[str, ...]] = {
    "adjustment": simulated_adjusters.MEASURES,
    "choice": ("confusion_rate", "correct", "response_time"),
    "rating": ("rating",),
}
"""Kind of task to the measures whose answers can be drawn without a session."""


@dataclass(frozen=True)
class ExperimentModel:
    """What is needed to draw experiments of a study and reduce them to cell means."""

    plan: AnalysisPlan
    design: CellMeans  # N participants in groups, c within cells; its values are zeros
    cell: np.ndarray  # (trials, c) averaging weights of the trials in every within cell
    observers: Adjusters | Choosers | Raters


def experiment_model(study: Mapping[str, Any], participants: int | None = None) -> ExperimentModel:
    """The model in a study file (as a plain dict), for so many participants (planned, if not given)."""
    plan = plan_of(study)
    simulation = Simulation.model_validate(study.get("simulation") or {})
    kind = str((study.get("task") or {}).get("kind", "adjustment"))
    if plan.measure not in MEASURES.get(kind, ()):
        known = ", ".join(MEASURES.get(kind, ()))
        raise AnalysisError(f"Power of {kind} trials can be simulated for {known}, not for {plan.measure!r}.")
    if plan.adaptive is not None:
        raise AnalysisError(
            "Power cannot be simulated for an adaptive order, whose levels follow from the answers; simulate "
            "participants with `gaitlab simulate` instead."
        )
    n = plan.planned if participants is None else participants
    if n is None:
        raise AnalysisError("Say how many participants to simulate; the study file plans no number.")
    conditions = _conditions(study, plan)
    observers: Adjusters | Choosers | Raters
    if kind == "choice":
        observers = choosers(plan, conditions, simulation)
    elif kind == "rating":
        observers = raters(study, plan, conditions, simulation)
    else:
        observers = adjusters(study, plan, conditions, simulation)
    return ExperimentModel(plan, _design(plan, n), _weights(plan, conditions), observers)


def _conditions(study: Mapping[str, Any], plan: AnalysisPlan) -> list[dict[str, Any]]:
    """Every condition of the design, with the factors made of groups of levels."""
    levels = product(*(study["factors"][name] for name in plan.factors))
    conditions: list[dict[str, Any]] = [dict(zip(plan.factors, cell, strict=True)) for cell in levels]
    for name, made in plan.groups.items():
        for condition in conditions:
            condition[name] = made.group_of[numeric_label(condition[made.of])]
    return conditions


def cell_means_of(model: ExperimentModel, seed: int, experiments: range) -> np.ndarray:
    """(S, N, c) cell means of the numbered experiments; each depends on the seed and its number alone."""
    n = len(model.design.subjects)
    values = np.empty((len(experiments), n, model.cell.shape[1]))
    for place, number in enumerate(experiments):
        values[place] = model.observers.values(np.random.default_rng([seed, number]), n) @ model.cell
    return values


def _design(plan: AnalysisPlan, n: int) -> CellMeans:
    """n participants, assigned to the between groups in turn."""
    groups = list(product(*(range(len(plan.levels[name])) for name in plan.between)))
    within = {name: plan.levels[name] for name in plan.within}
    between = {name: plan.levels[name] for name in plan.between}
    cells = int(np.prod([len(levels) for levels in within.values()] or [1]))
    if n <= len(groups):
        raise AnalysisError(f"{n} participants are too few for {len(groups)} group(s).")
    places = np.array([groups[i % len(groups)] for i in range(n)], dtype=np.intp).reshape(n, len(between))
    names = tuple(f"{i + 1}" for i in range(n))
    return CellMeans(plan.measure, np.zeros((n, cells)), names, within, between, places, {}, ())


def _weights(plan: AnalysisPlan, conditions: Sequence[Mapping[str, Any]]) -> np.ndarray:
    """(trials, c) so that trials @ weights are the means of the within cells."""
    cell = np.zeros(len(conditions), dtype=np.intp)
    for name in plan.within:
        column = [str(condition[name]) for condition in conditions]
        levels = list(plan.groups[name].levels) if name in plan.groups else list(dict.fromkeys(column))
        cell = cell * len(levels) + np.array([levels.index(value) for value in column])
    cell = np.tile(cell, plan.repetitions)
    weights = (cell[:, None] == np.arange(cell.max() + 1)).astype(float)
    return weights / weights.sum(axis=0)
