"""What adaptive tracks settled at: every track followed again from its recorded levels and answers."""

from __future__ import annotations

from typing import Any

import pandas as pd
from pydantic import TypeAdapter

from analysis.answers import answers, cell_labels
from analysis.choice_tests import threshold_rows
from analysis.errors import AnalysisError
from analysis.further_test import FurtherTest
from analysis.plan import AnalysisPlan
from analysis.plan_parts import AdaptivePlan
from protocols.adaptive import begin_placement
from protocols.order import AdaptiveOrder
from protocols.quest_plus import QuestPlus
from protocols.staircase import Staircase, reversal_mean


def track_tests(used: pd.DataFrame, plan: AnalysisPlan, asked: AdaptivePlan) -> FurtherTest:
    """Thresholds of the tracks, over participants (`table`), and of every track (`more`).

    Of a staircase the threshold is the mean level of its reversals without the first two (Levitt 1971), an even
    number of them; of QUEST+ the mean of what it believes in the end, with its s.d. Tracks of one condition are
    averaged within a participant.
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
    return FurtherTest("adaptive", table, tracks.astype({"level": str}))


def _followed(part: pd.DataFrame, order: AdaptiveOrder, levels: tuple[float, ...]) -> dict[str, Any]:
    """rule, trials, threshold, sd and reversals of one track; part: its trials in order."""
    shown = pd.to_numeric(part[order.of]).to_numpy(dtype=float)
    placement = begin_placement(order.rule, levels, float(shown[0]))
    for level, yes in zip(shown, part["_yes"], strict=True):
        placement = placement.after(float(level), bool(yes))
    row: dict[str, Any] = {"rule": order.rule.kind, "trials": len(part)}
    if isinstance(placement, QuestPlus):
        return row | {"threshold": placement.mean()[0], "sd": placement.threshold_sd()}
    assert isinstance(placement, Staircase)
    return row | {"threshold": reversal_mean(placement), "reversals": len(placement.reversals)}
