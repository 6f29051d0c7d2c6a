"""Adaptive placement: which level of the placed factor a trial shows, from the answers so far on its track.

begin_tracks / placed / after_response; what a track believes follows from the study and the recorded responses
alone, so a run that goes on after a crash goes on with the same levels.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from protocols.condition import read_condition
from protocols.orders.design import Trial, tracks
from protocols.orders.order import AdaptiveOrder, QuestPlusRule, StaircaseRule, WeightedRule
from protocols.orders.quest_plus import QuestPlus, quest_plus
from protocols.orders.staircase import Staircase
from protocols.study import Study

Placement = Staircase | QuestPlus
"""Either has `level`, what to show next, `after(level, yes)`, itself after an answer, and `ended`, no more trials."""

Tracks = Mapping[int, Placement]


def begin_tracks(study: Study) -> dict[int, Placement]:
    """Every track of the study before its first answer, by number; an empty dict where nothing is placed."""
    order = study.order
    if not isinstance(order, AdaptiveOrder):
        return {}
    return {
        number: begin_placement(order.rule, levels_of(study), float(condition[order.of]))
        for number, condition in enumerate(tracks(study), start=1)
    }


def levels_of(study: Study) -> tuple[float, ...]:
    """The levels that the placed factor can take, in the order of the file."""
    assert isinstance(study.order, AdaptiveOrder)
    return tuple(float(level) for level in study.factors[study.order.of])


def begin_placement(
    rule: StaircaseRule | WeightedRule | QuestPlusRule, levels: tuple[float, ...], start: float
) -> Placement:
    """A track of the rule before its first answer; QUEST+ chooses its first level itself."""
    if isinstance(rule, QuestPlusRule):
        thresholds = tuple(rule.thresholds) if rule.thresholds is not None else levels
        spreads, lapses = tuple(rule.spreads), tuple(rule.lapses)
        return quest_plus(levels, thresholds, spreads, function=rule.function, guess=rule.guess, lapses=lapses)
    place = levels.index(start)
    if isinstance(rule, WeightedRule):
        return Staircase(levels, place, 1, 1, down=rule.down, up=rule.up, stops_after=rule.reversals)
    steps = tuple(rule.steps)
    return Staircase(levels, place, rule.down_after, rule.up_after, steps=steps, stops_after=rule.reversals)


def placed(study: Study, on: Tracks, trial: Trial) -> Trial:
    """The trial with the level its track shows next; trials without a track are as they were."""
    order = study.order
    if not isinstance(order, AdaptiveOrder) or trial.track not in on:
        return trial
    # the level as the study file writes it, so that 5 stays 5 in the tables
    level = study.factors[order.of][levels_of(study).index(on[trial.track].level)]
    return replace(trial, levels={**trial.levels, order.of: level})


def after_response(study: Study, on: Tracks, track: int, columns: Mapping[str, object]) -> Tracks:
    """The tracks after a recorded trial; columns: its factors and response. Others than `track` are as they were."""
    order = study.order
    if not isinstance(order, AdaptiveOrder) or track not in on:
        return on
    condition = read_condition(order.yes)
    assert condition is not None  # gaitlab check refuses anything else
    level = columns[order.of]
    assert isinstance(level, (int, float)), level
    return {**on, track: on[track].after(float(level), condition.holds(columns))}


def ended(on: Tracks, trial: Trial) -> bool:
    """Whether a trial is not needed any more, because its track has turned as often as it is to."""
    return trial.track in on and on[trial.track].ended


def turns(on: Tracks, track: int) -> int:
    """How often a track has turned so far; 0 where there is no staircase."""
    return len(getattr(on.get(track), "reversals", ()))


def why_over(study: Study, on: Tracks, trial: Trial) -> str:
    """Why the trial just answered was the last of its track: its reversals, or its trials; "" when it was not."""
    if ended(on, trial):
        return "reversals"
    return "trials" if trial.track in on and trial.repetition == study.repetitions else ""
