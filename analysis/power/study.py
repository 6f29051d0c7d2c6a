"""Power of a study over several numbers of participants: in one go, in parts on many machines, and joined again."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from typing import Any

import pandas as pd

from analysis.errors import AnalysisError, listed
from analysis.planned.further_tests import planned_tests
from analysis.planned.plan import plan_of
from analysis.power.simulated_adjusters import Adjusters
from analysis.power.simulated_experiments import experiment_model
from analysis.power.simulation import as_dict, combine_power, power_by_simulation, simulated_t_tests
from analysis.writing import write_bytes

CLIPPING = 0.02  # share of trials at the edge of the range above which one is told


@dataclass(frozen=True)
class PowerPart:
    """Part `shard` of a simulation: its table has the columns of `power_by_simulation`, and participants."""

    study: str
    study_hash: str  # SHA-256 of what the study file says, comments apart
    seed: int
    experiments: int  # of all parts together
    shard: tuple[int, int]
    table: pd.DataFrame


def simulate_power(
    study: Mapping[str, Any] | str | Path, participants: Sequence[int] = (), *, experiments: int = 10_000,
    seed: int = 1, shard: tuple[int, int] = (1, 1), workers: int = 1, client: Any = None,
    progress: Callable[..., Any] = lambda parts, _: parts,
) -> PowerPart:  # fmt: skip
    """Power for each number of participants (the planned one if none is given). Raises AnalysisError."""
    if experiments < 1:
        raise AnalysisError(f"{experiments} experiments cannot be simulated; at least 1 is needed.")
    loaded = as_dict(study)
    counts: list[int | None] = [*dict.fromkeys(participants)] or [plan_of(loaded).planned]
    tables = [
        power_by_simulation(
            loaded, experiments=experiments, participants=n, seed=seed, shard=shard, workers=workers, client=client,
            progress=progress,
        ).assign(participants=n)
        for n in counts
    ]  # fmt: skip
    digest = hashlib.sha256(json.dumps(_in_order(loaded), default=str).encode()).hexdigest()
    table = pd.concat(tables, ignore_index=True)
    return PowerPart(str(loaded.get("study", "")), digest, seed, experiments, shard, table)


def _in_order(value: Any) -> Any:
    """The same with the keys of every mapping in order: numbers first, as a factor may have levels 2 and slow."""
    if isinstance(value, Mapping):
        return {key: _in_order(value[key]) for key in sorted(value, key=lambda key: (isinstance(key, str), key))}
    return [_in_order(one) for one in value] if isinstance(value, list | tuple) else value


def write_part(path: Path, part: PowerPart) -> Path:
    """One part as a JSON file, to be joined with the others later."""
    content = {
        "kind": "gaitlab power", "format": 1, "study": part.study, "study_hash": part.study_hash, "seed": part.seed,
        "experiments": part.experiments, "shard": list(part.shard),
        "tests": part.table[["participants", "test", "name", "significant", "experiments"]].to_dict("records"),
    }  # fmt: skip
    return write_bytes(path, (json.dumps(content, indent=1, ensure_ascii=False) + "\n").encode("utf-8"))


def read_part(path: Path) -> PowerPart:
    """A part written by `write_part`; raises AnalysisError for any other file."""
    try:
        content = json.loads(path.read_text(encoding="utf-8"))
        if content["kind"] != "gaitlab power" or content["format"] != 1:
            raise KeyError("kind")
        i, n = content["shard"]
        table = combine_power([pd.DataFrame(content["tests"])[["test", "name", "significant", "experiments"]]])
        table["participants"] = [row["participants"] for row in content["tests"]]
        return PowerPart(
            content["study"], content["study_hash"], int(content["seed"]), int(content["experiments"]),
            (int(i), int(n)), table,
        )  # fmt: skip
    except (OSError, ValueError, KeyError, TypeError) as error:
        reason = error.strerror if isinstance(error, OSError) else "it is no part of a power simulation"
        raise AnalysisError(f"{path} cannot be read: {reason}.") from None


def join_parts(parts: Sequence[PowerPart]) -> tuple[PowerPart, list[str]]:
    """All parts as one, and sentences of warning. Raises AnalysisError for parts that do not belong together."""
    first = parts[0]
    for name in ("study_hash", "seed", "experiments"):
        if len({getattr(part, name) for part in parts}) > 1:
            what = {"study_hash": "study files", "seed": "seeds", "experiments": "numbers of experiments"}[name]
            raise AnalysisError(f"The parts have different {what}, so they cannot be joined.")
    totals, done = {part.shard[1] for part in parts}, [part.shard[0] for part in parts]
    twice = sorted({i for i in done if done.count(i) > 1})
    if len(totals) > 1 or twice:
        reason = f"part {listed(twice)} is there twice" if twice else "they come from different splits"
        raise AnalysisError(f"The parts cannot be joined: {reason}.")
    joined = []
    for n in dict.fromkeys(first.table["participants"]):
        tables = [part.table[part.table["participants"] == n].reset_index(drop=True) for part in parts]
        joined.append(combine_power(tables).assign(participants=n))
    missing = [i for i in range(1, first.shard[1] + 1) if i not in done]
    gap = f"Part {listed(missing)} of {first.shard[1]} is missing; the table rests on the others."
    whole = PowerPart(
        first.study, first.study_hash, first.seed, first.experiments, (1, 1), pd.concat(joined, ignore_index=True)
    )
    return whole, [gap] if missing else []


def power_notes(study: Mapping[str, Any] | str | Path) -> list[str]:
    """What a reader of the table must know: where the range of the task cuts answers off, what is not simulated."""
    loaded = as_dict(study)
    model = experiment_model(loaded)
    others = [name.removeprefix("The ").replace("t tests", "other t tests") for name, _ in planned_tests(model.plan)]
    others += [f"the tests of {plan.measure}" for plan in model.plan.also]
    notes = [
        f"Only the ANOVA and the t tests against values are simulated, not {listed(['post hoc tests', *others])}; "
        "nothing is excluded, and a test of values without variance counts as not significant."
    ]
    left = [test.each for test in model.plan.t_tests if test not in simulated_t_tests(model.plan)]
    if left:
        notes.append(
            f"The t tests of every {listed(left)} are not simulated: the analysis of variance has no cell of it."
        )
    if isinstance(model.observers, Adjusters):
        names = list(dict.fromkeys(map(str, loaded["factors"].get(model.plan.actor[1:], [model.plan.actor]))))
        notes = [*_clipping(model.observers, names, len(model.design.subjects)), *notes]
    return notes


def _clipping(observers: Adjusters, names: Sequence[str], people: int) -> list[str]:
    shares = observers.clipped_shares(people)
    high = shares[shares["share"] > CLIPPING].sort_values("share", ascending=False)
    if not len(high):
        return []
    found = [f"{names[int(r.actor)]} at {r.speed:g} m/s ({100 * r.share:.0f} %)" for r in high.itertuples()]
    return [
        f"The range of {observers.lowest:g} to {observers.highest:g} steps/min cuts off answers: {listed(found)}. Such "
        "answers cannot follow the observers' preference, which makes effects of speed that nobody has; widen "
        "task.range or change the speeds."
    ]


def dask_client(address: str) -> Any:
    """A client of the dask scheduler at `address`; raises AnalysisError when dask is missing or nobody answers."""
    try:
        client = import_module("dask.distributed").Client
    except ImportError:
        raise AnalysisError(
            "dask is not installed, so the work cannot go to a cluster: pip install distributed, or split it with "
            "--shard 1/8 to 8/8 and join the parts with --combine."
        ) from None
    try:
        return client(address, timeout=10)
    except (OSError, TimeoutError, ValueError) as error:
        raise AnalysisError(f"No dask scheduler answers at {address}: {error}.") from None


def power_figure(path: Path, part: PowerPart) -> Path:
    """Power of every test against the number of participants, with 95 % limits, as a PNG."""
    from analysis.figures.drawing import COLOURS, MARKERS, canvas, saved, settings

    with settings():
        drawing, axes = canvas(7.4, 4.6)
        for place, ((test, name), rows) in enumerate(part.table.groupby(["test", "name"], sort=False)):
            look = {"color": COLOURS[place % 6], "marker": MARKERS[place // 6 % 6], "markersize": 5}
            n, share = rows["participants"], rows["power"]
            error = [(share - rows["ci_low"]).clip(lower=0), (rows["ci_high"] - share).clip(lower=0)]
            label = f"t: {name}" if test == "t" else str(name).replace(":", " × ")
            axes.errorbar(n, share, yerr=error, capsize=3, label=label, linewidth=1.3, **look)
        axes.axhline(0.8, color="#718096", linewidth=1, linestyle="--", zorder=1)
        axes.set_ylim(0, 1.03)
        axes.set_xticks(sorted(set(part.table["participants"])))
        axes.set_xlabel("participants")
        axes.set_ylabel("power")
        axes.legend(loc="center left", bbox_to_anchor=(1.0, 0.5), fontsize=7.5)
        return write_bytes(path, saved(drawing, "power", f"Power of {part.study}", "").png)
