"""Power by simulation: the study's own design, trials and planned analysis, many times over.

The three conventions of power formulas differ by a factor of five in participants; simulation has none.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from scipy import special, stats

from analysis.errors import AnalysisError, check_share
from analysis.planned.plan import AnalysisPlan
from analysis.planned.plan_parts import TTestPlan
from analysis.power.simulated_experiments import ExperimentModel, cell_means_of, experiment_model
from analysis.statistics.columns import numeric_label
from analysis.statistics.linear_fit import NO_VARIANCE
from analysis.statistics.many_anovas import many_anovas

CHUNK = 250  # experiments at a time: about 10 MB


def power_by_simulation(
    study: Mapping[str, Any] | str | Path,
    *,
    experiments: int = 10_000,
    participants: int | None = None,
    seed: int = 1,
    shard: tuple[int, int] = (1, 1),
    alpha: float = 0.05,
    workers: int = 1,
    client: Any = None,
    progress: Callable[[Iterable[np.ndarray], int], Iterable[np.ndarray]] = lambda parts, _: parts,
) -> pd.DataFrame:
    """How often each test of the planned analysis is significant, for the study's simulated observers.

    study: the study file as a dict, its path, or its text; participants: instead of the planned number;
    shard: (i, n) does the i-th of n parts, to be joined with `combine_power`; workers: processes;
    client: a dask.distributed Client (or anything with map and gather) to spread the work over.
    progress: wraps the iterable of parts of the work, given their number.
    Experiment k depends on the seed and k only, so any split gives the same counts.

    Returns one row per test with columns test ("anova", Greenhouse-Geisser, or "t"), name (effect, or
    level), significant, experiments, power, ci_low, ci_high (95 %, Wilson). A test of values without
    variance (everybody at the end of the scale) has no p, as in the analysis, and counts as not significant.
    Post hoc tests, further tests, exclusions and t tests of a factor outside the analysis of variance are
    not simulated. Raises AnalysisError.
    """
    check_share("alpha", alpha, 0.05)
    part, parts = shard
    if not 1 <= part <= parts:
        raise AnalysisError(f"The shard must be i/n with i from 1 to n, not {part}/{parts}.")
    model = experiment_model(as_dict(study), participants)
    first, last = experiments * (part - 1) // parts, experiments * part // parts
    chunks = [range(at, min(at + CHUNK, last)) for at in range(first, last, CHUNK)]
    jobs = [(model, seed, chunk, alpha) for chunk in chunks]
    if client is not None:
        counted = client.gather(client.map(_count, jobs))
    elif workers > 1:
        from concurrent.futures import ProcessPoolExecutor

        with ProcessPoolExecutor(workers) as pool:
            counted = list(progress(pool.map(_count, jobs), len(jobs)))
    else:
        counted = list(progress(map(_count, jobs), len(jobs)))
    names = _tests(model.plan)
    total = np.sum(counted, axis=0) if counted else np.zeros(len(names), dtype=int)
    return _table(pd.DataFrame(names, columns=["test", "name"]).assign(significant=total, experiments=last - first))


def combine_power(tables: Sequence[pd.DataFrame]) -> pd.DataFrame:
    """The table of all experiments from those of its shards, in any order."""
    if not tables:
        raise AnalysisError("There is no table to combine.")
    names = tables[0][["test", "name"]]
    if any(not names.equals(table[["test", "name"]]) for table in tables):
        raise AnalysisError("The tables are of different studies: their tests differ.")
    counts = {c: sum(table[c].to_numpy() for table in tables) for c in ("significant", "experiments")}
    return _table(names.assign(**counts))


def _table(counts: pd.DataFrame) -> pd.DataFrame:
    k, n = counts["significant"].to_numpy(dtype=float), counts["experiments"].to_numpy(dtype=float)
    z = stats.norm.ppf(0.975)
    with np.errstate(all="ignore"):
        share = k / n
        middle = (share + z**2 / (2 * n)) / (1 + z**2 / n)
        half = z * np.sqrt(share * (1 - share) / n + z**2 / (4 * n**2)) / (1 + z**2 / n)
    return counts.assign(power=share, ci_low=middle - half, ci_high=middle + half)


def as_dict(study: Mapping[str, Any] | str | Path) -> Mapping[str, Any]:
    """A study as its file's keys, from a dict, YAML text or a path; raises AnalysisError for what is no study."""
    if isinstance(study, Mapping):
        return study
    from ruamel.yaml import YAML
    from ruamel.yaml.error import YAMLError

    is_file = isinstance(study, Path) or "\n" not in study
    try:
        loaded = YAML(typ="safe", pure=True).load(Path(study) if is_file else study)
    except FileNotFoundError:
        raise AnalysisError(f"There is no study file {study}.") from None
    except YAMLError as error:
        raise AnalysisError(f"The study file is not YAML: {error}") from None
    if not isinstance(loaded, Mapping):
        raise AnalysisError("The study file is empty.")
    return loaded


def _tests(plan: AnalysisPlan) -> list[tuple[str, str]]:
    from analysis.statistics.contrasts import subsets

    effects = [("anova", ":".join(effect)) for effect in subsets((*plan.within, *plan.between))[1:]]
    return [*effects, *(("t", f"{t.each} {level}") for t in simulated_t_tests(plan) for level in t.against)]


def simulated_t_tests(plan: AnalysisPlan) -> list[TTestPlan]:
    """The t tests that rest on cells of the analysis of variance; the others are not simulated."""
    return [test for test in plan.t_tests if test.each in (*plan.within, *plan.between) and test.where is None]


def _count(job: tuple[ExperimentModel, int, range, float]) -> np.ndarray:
    """(tests,) how many of the experiments make each test significant."""
    model, seed, experiments, alpha = job
    values = cell_means_of(model, seed, experiments)
    counts = [int(np.sum(p < alpha)) for p in many_anovas(values, model.design).values()]
    for test in simulated_t_tests(model.plan):
        for level, against in test.against.items():
            counts.append(int(np.sum(_t_p(values, model, test.each, level, against) < alpha)))
    return np.array(counts)


def _t_p(values: np.ndarray, model: ExperimentModel, factor: str, level: str, against: float) -> np.ndarray:
    """(S,) p values of the one-sample t test of participants' means at one level; nan where all means are equal."""
    place = [numeric_label(name) for name in model.design.levels(factor)].index(numeric_label(level))
    if factor in model.design.within:
        names = list(model.design.within)
        shape = [len(levels) for levels in model.design.within.values()]
        cube = values.reshape(*values.shape[:2], *shape)
        taken = np.take(cube, place, axis=2 + names.index(factor))
        people = taken.reshape(*values.shape[:2], -1).mean(axis=2)
    else:
        column = list(model.design.between).index(factor)
        members = model.design.groups[:, column] == place
        people = values[:, members].mean(axis=2)
    n, spread = people.shape[1], people.std(axis=1, ddof=1)
    spread[spread**2 * (n - 1) <= NO_VARIANCE * np.sum(people**2, axis=1)] = np.nan
    t = (people.mean(axis=1) - against) / (spread / np.sqrt(n))
    return 2 * special.stdtr(n - 1, -np.abs(t))
