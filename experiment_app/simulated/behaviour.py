"""What a simulated observer does in a trial of each task: the keys it presses, and when.

It sees only what a person sees (the trial) and answers with the same events.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from random import Random
from typing import Any

from protocols.events import Event, KeyDown, KeyUp
from protocols.limited_scale import latent_mean
from protocols.parts import Level
from protocols.setting import value_of
from protocols.study import Simulation
from protocols.tasks.adjustment import AdjustmentTrial
from protocols.tasks.choice import ChoiceTrial
from protocols.tasks.rating import SWEEP, RatingTrial
from protocols.tasks.showing import Viewing

LOOKING = (0.6, 1.4)
"""s of looking before the first key and between keys, uniform."""

OVERSHOOT = 3.0
"""steps/min, s.d. of where the first, coarse adjustment ends around the target."""

RELEASE = 0.015
"""s, s.d. of the moment a key is let go in the fine adjustment."""

TAP = 0.08
"""s a key is down when it is only pressed."""

QUICKEST = 0.2
"""s, the shortest response time of a simulated observer."""


@dataclass(frozen=True)
class Observer:
    """One simulated participant.

    simulation:  the population it was drawn from.
    preferred:   actor to preferred walk ratio, m·min.
    leaning:     how far it is from the population's mean in what it confuses or how it rates, s.d.; pace: in time.
    answers:     question id to answer.
    """

    simulation: Simulation
    preferred: Mapping[str, float]
    leaning: float
    pace: float
    answers: Mapping[str, str]


def adjust(observer: Observer, trial: AdjustmentTrial, levels: Mapping[str, Level], rng: Random) -> list[Event]:
    """A coarse adjustment, a fine one, and the confirm key."""
    task, target = trial.task, _target(observer, trial, rng)
    coarse = min(max(target + rng.gauss(0.0, OVERSHOOT), task.minimum), task.maximum)
    time, setting = trial.onset, trial.start
    events: list[Event] = []
    for goal, slip in ((coarse, 0.0), (target, RELEASE)):
        time += rng.uniform(*LOOKING)
        if goal != setting:
            key = task.raise_key if goal > setting else task.lower_key
            held = max(abs(goal - setting) / task.rate + rng.gauss(0.0, slip), 0.0)
            events += [KeyDown(time, key), KeyUp(time + held, key)]
            time += held
        setting = goal
    time = max(time + rng.uniform(*LOOKING), trial.onset + task.minimum_looking_time + 0.1)
    return [*events, *_tapped(time, task.confirm_key)]


def _target(observer: Observer, trial: AdjustmentTrial, rng: Random) -> float:
    """steps/min at which this observer would stop: SF = sqrt(60 v / WR), from WR = SL / SF and v = SL SF / 60."""
    preferred, simulation = observer.preferred, observer.simulation
    middle = sum(preferred.values()) / len(preferred)
    noisy = preferred.get(trial.walk.actor, middle) + rng.gauss(0.0, simulation.trial_noise)
    target = math.sqrt(60.0 * trial.walk.speed / max(noisy, 1e-4))
    target += simulation.anchoring * (trial.start - target)
    return min(max(target, trial.task.minimum), trial.task.maximum)


def choose(observer: Observer, trial: ChoiceTrial, levels: Mapping[str, Level], rng: Random) -> list[Event]:
    """Confuses the original with the other as often as its population does in this condition, and takes its time."""
    chooser = observer.simulation.choice
    confusion = float(_known(chooser.confusion, levels, 0.5))
    first = next(iter(trial.viewing.walks))
    original = trial.task.original or first
    confused = rng.random() < _shifted(confusion, chooser.spread * observer.leaning)
    key = trial.keys["first" if (original == first) != confused else "second"]
    seconds = float(_known(chooser.response_time, levels, 3.0))
    own = math.exp(chooser.pace_spread * observer.pace + chooser.time_spread * rng.gauss(0.0, 1.0))
    time = max(seconds * own, QUICKEST, trial.task.minimum_looking_time + 0.01)
    return list(_tapped(trial.onset + _unseen(trial.viewing) + time, key))


def rate(observer: Observer, trial: RatingTrial, levels: Mapping[str, Level], rng: Random) -> list[Event]:
    """Moves the mark to what its population thinks of this condition, more or less, and confirms."""
    rater, scale = observer.simulation.rating, trial.task.scale
    middle = (scale.minimum + scale.maximum) / 2.0
    mean = middle if rater.rating is None else float(_known(rater.rating, levels, middle))
    felt = latent_mean(mean, math.hypot(rater.spread, rater.noise), scale.minimum, scale.maximum)
    felt += rater.spread * observer.leaning + rng.gauss(0.0, rater.noise)
    wanted = min(max(felt, scale.minimum), scale.maximum)
    pace = math.exp(rater.pace_spread * observer.pace + rater.time_spread * rng.gauss(0.0, 1.0))
    time = trial.onset + _unseen(trial.viewing) + max(rater.response_time * pace, QUICKEST)
    events: list[Event] = []
    if scale.step is None:
        key = trial.keys["raise" if wanted > middle else "lower"]
        held = abs(wanted - middle) / (SWEEP * (scale.maximum - scale.minimum))
        events += [KeyDown(time, key), KeyUp(time + held, key)]
        time += held
    else:
        for _ in range(round((wanted - scale.minimum) / scale.step) + 1):
            events += _tapped(time, trial.keys["raise"])
            time += 2.0 * TAP
    time = max(time + rng.uniform(*LOOKING), trial.onset + trial.task.minimum_looking_time + 0.01)
    return [*events, *_tapped(time, trial.keys["confirm"])]


BEHAVIOURS: Mapping[str, Callable[[Observer, Any, Mapping[str, Level], Random], list[Event]]] = {
    "adjustment": adjust,
    "choice": choose,
    "rating": rate,
}
"""Kind of task to what an observer does in one of its trials; the trial is of that task."""


def _tapped(time: float, key: str) -> tuple[Event, Event]:
    return KeyDown(time, key), KeyUp(time + TAP, key)


def _unseen(viewing: Viewing) -> float:
    """s from onset until every walk has appeared."""
    return viewing.start_of(-1)


def _known(setting: Any, levels: Mapping[str, Level], otherwise: float) -> Any:
    """A setting's value; a training trial may have levels for which the simulation says nothing."""
    try:
        return value_of(setting, levels)
    except KeyError:
        return otherwise


def _shifted(probability: float, by: float) -> float:
    """A probability moved on the logistic scale, so that it stays one."""
    if probability in (0.0, 1.0):
        return probability
    return 1.0 / (1.0 + math.exp(-math.log(probability / (1.0 - probability)) - by))
