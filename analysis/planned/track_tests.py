"""What adaptive tracks settled at: every track followed again from its recorded levels and answers."""

from __future__ import annotations

from typing import Any

import pandas as pd
from pydantic import TypeAdapter

from analysis.errors import AnalysisError
from analysis.planned.choice_tests import threshold_rows
from analysis.planned.further_test import FurtherTest
from analysis.planned.plan import AnalysisPlan
from analysis.planned.plan_parts import AdaptivePlan
from analysis.recorded.answers import answers, cell_labels
from protocols.orders.adaptive import begin_placement
from protocols.orders.order import AdaptiveOrder, QuestPlusRule
from protocols.orders.quest_plus import QuestPlus
from protocols.orders.staircase import Staircase, reversal_mean

AT_END = "settled at the end of the thresholds"


def track_tests(used: pd.DataFrame, plan: AnalysisPlan, asked: AdaptivePlan) -> FurtherTest:
    """Thresholds of the tracks, over participants (`table`), and of every track (`more`).

    Of a staircase the threshold is the mean level of its reversals without the first two (Levitt 1971), an even
    number of them; of QUEST+ the mean of what it believes in the end, with its s.d., and whether its most probable
    threshold is the first or the last that it may believe in (at_end), beyond which the true one may lie. Tracks of
    one condition are averaged within a participant.
    """
    order = TypeAdapter(AdaptiveOrder).validate_python(dict(asked.order))
    others = tuple(name for name in plan.factors if name != order.of)
    if "track" not in used:
        raise AnalysisError("the trials do not say which track placed them; they were recorded by an older version.")
    data = used.assign(_yes=answers(used, order.yes), _cell=cell_labels(used, others, dict(plan.levels)))
    rows = []
    for (who, track), part in data.sort_values("trial").groupby(["participant", "track"], sort=True):
        head = {"participant": who, "track": int(track), "level": part["_cell"].iloc[0]}
        rows.append(head | _followed(part, order, asked.levels))
    tracks = pd.DataFrame(rows)
    tracks["level"] = pd.Categorical(tracks["level"], categories=data["_cell"].cat.categories) if others else ""
    known = tracks[tracks["threshold"].notna()]
    if not len(known):
        raise AnalysisError("no track has turned often enough; a threshold needs four reversals.")
    table = threshold_rows(known.groupby(["level", "participant"], observed=True)["threshold"].mean().reset_index())
    ended = tracks[tracks["at_end"]]
    for level, part in ended.groupby("level", observed=True, sort=True):
        every = int((tracks["level"] == level).sum())
        table.loc[table["level"] == str(level), "sentence"] += f"; {len(part)} of {every} track(s) {AT_END}"
    settled = [f"{len(ended)} of {len(tracks)} track(s) {AT_END}: {_ends(asked, order)}"] if len(ended) else []
    notes = (*settled, *_short_of(tracks, order))
    return FurtherTest("adaptive", table, tracks.astype({"level": str}), notes=notes)


def _short_of(tracks: pd.DataFrame, order: AdaptiveOrder) -> tuple[str, ...]:
    """A sentence on the tracks that had all their trials before they turned as often as the study wanted, if any."""
    if order.stops_after is None:
        return ()
    short = int((tracks["reversals"] < order.stops_after).sum())
    what = f"{short} of {len(tracks)} track(s) had all their trials before {order.stops_after} reversals"
    return (f"{what}; their thresholds rest on fewer.",) if short else ()


def _ends(asked: AdaptivePlan, order: AdaptiveOrder) -> str:
    assert isinstance(order.rule, QuestPlusRule)
    possible = sorted(order.rule.thresholds or asked.levels)
    return (
        f"QUEST+ could believe in thresholds from {possible[0]:g} to {possible[-1]:g} only, and the true one may lie "
        "beyond; their limits are too narrow. Give wider `thresholds` (and levels) in the next study."
    )


def _followed(part: pd.DataFrame, order: AdaptiveOrder, levels: tuple[float, ...]) -> dict[str, Any]:
    """rule, trials, threshold, sd, reversals and at_end of one track; part: its trials in order."""
    shown = pd.to_numeric(part[order.of]).to_numpy(dtype=float)
    placement = begin_placement(order.rule, levels, float(shown[0]))
    trials = 0
    for level, yes in zip(shown, part["_yes"], strict=True):
        trials += not placement.ended  # of a block done again, older answers may follow the end
        placement = placement.after(float(level), bool(yes))
    row: dict[str, Any] = {"rule": order.rule.kind, "trials": trials, "at_end": False}
    if isinstance(placement, QuestPlus):
        at_end = _ended_at_an_end(placement)
        return row | {"threshold": placement.mean()[0], "sd": placement.threshold_sd(), "at_end": at_end}
    assert isinstance(placement, Staircase)
    return row | {"threshold": reversal_mean(placement), "reversals": len(placement.reversals)}


def _ended_at_an_end(track: QuestPlus) -> bool:
    """Whether the most probable threshold is the lowest or the highest of those that it may believe in."""
    belief: dict[float, float] = {}
    for (threshold, _, _), probability in zip(track.parameters, track.belief, strict=True):
        belief[threshold] = belief.get(threshold, 0.0) + probability
    return max(belief, key=belief.__getitem__) in (min(belief), max(belief))
