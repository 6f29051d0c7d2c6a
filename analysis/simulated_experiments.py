"""Simulated observers adjusting step frequency, by the thousand and without a session.

The same model as the observers of `gaitlab simulate` (preference per actor, noise per trial, anchoring,
the range of the task), without their key presses.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import product
from typing import Any

import numpy as np
import pandas as pd

from analysis.cells import CellMeans
from analysis.columns import numeric_label
from analysis.errors import AnalysisError
from analysis.gait_measures import GRAVITY
from analysis.plan import AnalysisPlan, plan_of
from protocols.setting import references, value_of
from protocols.study import Simulation

MEASURES = ("walk_ratio", "step_frequency", "step_length", "normalised_walk_ratio")


@dataclass(frozen=True)
class ExperimentModel:
    """What is needed to draw experiments of a study and reduce them to cell means."""

    plan: AnalysisPlan
    design: CellMeans  # N participants in groups, c within cells; its values are zeros
    actor: np.ndarray  # (trials,) index of the actor of every trial of a participant
    speed: np.ndarray  # (trials,) m/s
    start: np.ndarray  # (trials,) steps/min
    cell: np.ndarray  # (trials, c) averaging weights of the trials in every within cell
    mean: np.ndarray  # (actors,) m·min
    sd: np.ndarray
    shared: float
    trial_noise: float
    anchoring: float
    lowest: float  # steps/min
    highest: float
    height: np.ndarray  # (trials,) m, of the actor of every trial; nan where the plan gives none


def experiment_model(study: Mapping[str, Any], participants: int | None = None) -> ExperimentModel:
    """The model in a study file (as a plain dict), for so many participants (planned, if not given)."""
    plan = plan_of(study)
    simulation = Simulation.model_validate(study.get("simulation") or {}).model_dump()
    if plan.measure not in MEASURES:
        raise AnalysisError(f"Power can be simulated for {', '.join(MEASURES)}, not for {plan.measure!r}.")
    n = participants or plan.planned
    if not n:
        raise AnalysisError("Say how many participants to simulate; the study file plans no number.")
    conditions = list(product(*(study["factors"][name] for name in plan.factors)))
    columns = {name: [condition[i] for condition in conditions] for i, name in enumerate(plan.factors)}
    for name, made in plan.groups.items():
        columns[name] = [made.group_of[numeric_label(level)] for level in columns[made.of]]
    stimulus, task = study.get("stimulus") or {}, study.get("task") or {}
    actors = _values(stimulus.get("actor", ""), columns, len(conditions))
    population = simulation["preferred_walk_ratio"]
    names = list(dict.fromkeys(map(str, actors)))
    missing = [name for name in names if name not in population]
    if missing:
        raise AnalysisError(f"The study's simulation gives no preferred walk ratio for {', '.join(missing)}.")
    bounds = task.get("range") or {}
    return ExperimentModel(
        plan,
        _design(plan, n),
        np.tile([names.index(str(actor)) for actor in actors], plan.repetitions),
        np.tile(np.array(_values(stimulus.get("speed"), columns, len(conditions)), dtype=float), plan.repetitions),
        np.tile(np.array(_values(task.get("start"), columns, len(conditions)), dtype=float), plan.repetitions),
        _weights(plan, columns, len(conditions)),
        np.array([population[name]["mean"] for name in names], dtype=float),
        np.array([population[name]["sd"] for name in names], dtype=float),
        simulation["shared"],
        simulation["trial_noise"],
        simulation["anchoring"],
        float(bounds.get("minimum", 80.0)),
        float(bounds.get("maximum", 120.0)),
        np.tile([(plan.heights or {}).get(str(actor), np.nan) for actor in actors], plan.repetitions),
    )


def cell_means_of(model: ExperimentModel, seed: int, experiments: range) -> np.ndarray:
    """(S, N, c) cell means of the numbered experiments; each depends on the seed and its number alone."""
    n = len(model.design.subjects)
    values = np.empty((len(experiments), n, model.cell.shape[1]))
    for place, number in enumerate(experiments):
        values[place] = _measure(model, np.clip(_wanted(model, seed, number), model.lowest, model.highest)) @ model.cell
    return values


def _wanted(model: ExperimentModel, seed: int, number: int) -> np.ndarray:
    """(N, trials) step frequencies that one experiment's observers would choose if nothing limited them."""
    n, trials = len(model.design.subjects), len(model.actor)
    rng = np.random.default_rng([seed, number])
    own, apart = rng.standard_normal((n, 1)), rng.standard_normal((n, len(model.mean)))
    z = np.sqrt(model.shared) * own + np.sqrt(1 - model.shared) * apart
    preferred = np.maximum(model.mean + model.sd * z, model.mean / 4)
    wanted = preferred[:, model.actor] + model.trial_noise * rng.standard_normal((n, trials))
    frequency = np.sqrt(60 * model.speed / np.maximum(wanted, 1e-4))
    return frequency + model.anchoring * (model.start - frequency)


def clipped_shares(model: ExperimentModel, seed: int = 1, experiments: int = 20) -> pd.DataFrame:
    """How often the wanted step frequency lies outside the range of the task, so that the answer is its edge.

    Returns actor (index), speed (m/s) and share of trials, one row per combination.
    """
    outside = np.mean([_outside(model, seed, number) for number in range(experiments)], axis=0)
    table = pd.DataFrame({"actor": model.actor, "speed": model.speed, "share": outside})
    return table.groupby(["actor", "speed"], as_index=False)["share"].mean()


def _outside(model: ExperimentModel, seed: int, number: int) -> np.ndarray:
    wanted = _wanted(model, seed, number)
    return np.mean((wanted < model.lowest) | (wanted > model.highest), axis=0)


def _measure(model: ExperimentModel, frequency: np.ndarray) -> np.ndarray:
    if model.plan.measure == "step_frequency":
        return frequency
    length = 60 * model.speed / frequency
    if model.plan.measure == "step_length":
        return length
    ratio = length / frequency
    return ratio * 60 * np.sqrt(GRAVITY / model.height**3) if model.plan.measure == "normalised_walk_ratio" else ratio


def _values(setting: Any, columns: Mapping[str, list[Any]], count: int) -> list[Any]:
    """The value of a stimulus setting in every condition: `$factor`, a table by a factor's levels, or a constant."""
    if setting is None:
        raise AnalysisError("The study file does not say which actor, speed or start value is shown.")
    unknown = [name for name in references(setting) if name not in columns]
    if unknown:
        raise AnalysisError(f"The study file refers to {f'${unknown[0]}'!r}, which is no factor.")
    return [value_of(setting, {name: column[i] for name, column in columns.items()}) for i in range(count)]


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


def _weights(plan: AnalysisPlan, columns: Mapping[str, list[Any]], count: int) -> np.ndarray:
    """(trials, c) so that trials @ weights are the means of the within cells."""
    cell = np.zeros(count, dtype=np.intp)
    for name in plan.within:
        levels = list(plan.groups[name].levels) if name in plan.groups else list(dict.fromkeys(map(str, columns[name])))
        cell = cell * len(levels) + np.array([levels.index(str(value)) for value in columns[name]])
    cell = np.tile(cell, plan.repetitions)
    weights = (cell[:, None] == np.arange(cell.max() + 1)).astype(float)
    return weights / weights.sum(axis=0)
