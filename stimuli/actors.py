"""The default actors: people with a height, a sex and a comfortable way of walking, made by the gait model.

The sixteen actors of Niay (2022, table 4.1) and two for training. Who they are stands in actor_table.csv; how
they walk is the gait model at their sex, leg length and walk ratio plus a manner of their own: 0.8 of what one
captured person does differently from the average and 0.6 of another's (0.64 + 0.36 = 1 keeps the spread between
people; M1 is made of three). Of the mixtures of captured people those were chosen with which hip, knee and ankle, as
drawn at comfort speed, stay within two standard deviations of adults for 95 % of the cycle, and no two actors walk
alike. Their 25 cycles are made once when an actor is loaded. Knows no window, no clock.
"""

from __future__ import annotations

import csv
from collections.abc import Sequence
from dataclasses import dataclass
from difflib import get_close_matches
from functools import cache
from importlib.resources import files
from typing import TYPE_CHECKING

import numpy as np

from stimuli.blend import CycleTable, WalkCycle
from stimuli.blend_tree import Branch, Leaf, Tree
from stimuli.bodies.body import Body
from stimuli.bodies.known import load_body
from stimuli.gait_model import SIGNALS, GaitModel, Step, WalkCurves, load_gait_model
from stimuli.retarget import Figure, scaled, walk_cycle
from stimuli.skeleton import Floats, Skeleton

if TYPE_CHECKING:
    from stimuli.actor_library import StoredActor

METRONOME = (80.0, 90.0, 100.0, 110.0, 120.0)
"""Step frequencies of the cycles, steps/min, as imposed in Niay (2022, section 3.1.1)."""

CYCLE_SPEEDS = (0.70, 0.88, 1.06, 1.24, 1.42)
"""m/s; with the metronome they give the five step lengths from very small to very long at each step frequency."""

MODELLED = "modelled"
"""Provenance of the default actors: the gait model."""

POPULATION_WALK_RATIO = {"F": 0.00320, "M": 0.00327}
"""Walk ratio over height (min) at comfortable speed, means of the Schreiber & Moissenet women and men."""

LEG_SIGNALS = ("thigh", "shank", "foot", "foot_yaw", "knee_yaw", "foot_shift", "hips_shift")
"""Signals that follow the step's true length; the others follow how long it is for that person."""


EARLIER_OFF = 0.02
"""Share of the cycle by which the drawn shoe leaves the ground before the captured foot: its tip is stiffer than a
forefoot, so that at the captured toe-off it would hold the leg back (set on four captures and the default actors: the
drawn hip, knee and ankle are nearest to the captured ones from 0.02 to 0.03)."""


class ActorError(ValueError):
    """There is no such actor, or an actor cannot be made."""


@dataclass(frozen=True, eq=False)
class Actor:
    """A walker of a study.

    table: the actor's cycles; tree: which of them give a speed and a step frequency
    """

    name: str
    sex: str  # "F" or "M"
    age: float  # years
    height: float  # m
    weight: float  # kg
    comfort_speed: float  # m/s
    captured_walk_ratio: float  # m·min
    walk_ratio_source: str
    body: str  # "woman", "man", ...
    figure: Figure
    table: CycleTable
    tree: Tree
    provenance: str  # "modelled", or which cycles were captured, the licence and the source

    @property
    def skeleton(self) -> Skeleton:
        """The body's skeleton at the actor's height."""
        return self.figure.skeleton

    @property
    def comfort_step_frequency(self) -> float:
        """steps/min at the comfort speed and the captured walk ratio: SF = sqrt(60 v / WR)."""
        return float(np.sqrt(60.0 * self.comfort_speed / self.captured_walk_ratio))


@dataclass(frozen=True)
class Person:
    """A row of actor_table.csv."""

    name: str
    sex: str
    age: float
    height: float
    weight: float
    comfort_speed: float
    walk_ratio: float
    walk_ratio_source: str
    manner: tuple[tuple[str, float], ...]


@cache
def people() -> dict[str, Person]:
    """Name -> who the default actors are."""
    text = (files("stimuli") / "actor_table.csv").read_text(encoding="utf-8")
    found = {}
    for row in csv.DictReader(text.splitlines()):
        terms = (term.split() for term in row["manner"].split(" + "))
        found[row["name"]] = Person(
            row["name"],
            row["sex"],
            float(row["age_years"]),
            float(row["height_cm"]) / 100,
            float(row["weight_kg"]),
            float(row["comfort_speed_mps"]),
            float(row["walk_ratio_m_min"]),
            row["walk_ratio_source"],
            tuple((name, float(weight)) for weight, name in terms),
        )
    return found


def actor_names() -> tuple[str, ...]:
    """Names of the default actors, the sixteen of the study first, then those imported on this computer."""
    from stimuli.actor_library import imported_names

    return (*people(), *imported_names())


def load_actor(name: str, body: Body | None = None) -> Actor:
    """A default or imported actor, on the body of their sex unless another is given, scaled to their height.

    Default actors on their own body are cached. Raises ActorError for a name that is not known.
    """
    from stimuli.actor_library import actor_of

    stored = _stored(name)
    if stored is not None:
        return actor_of(stored, body)
    if body is None:
        return _default_actor(name)
    return _make(people()[name], body)


def tree_of(name: str) -> Tree:
    """The blend tree of an actor, which says what the actor covers; no cycle is made for it.

    Raises ActorError for a name that is not known.
    """
    stored = _stored(name)
    return metronome_tree(METRONOME, CYCLE_SPEEDS) if stored is None else stored.tree


def person_of(name: str) -> Person:
    """Who a default or imported actor is; raises ActorError for a name that is not known."""
    stored = _stored(name)
    return people()[name] if stored is None else stored.person


def provenance_of(name: str) -> str:
    """Where an actor's walk comes from, as `Actor.provenance`; raises ActorError for a name that is not known."""
    stored = _stored(name)
    return MODELLED if stored is None else stored.provenance


def _stored(name: str) -> StoredActor | None:
    """An imported actor as the library has it, None for a default one; raises ActorError for a name that is not known.

    What needs no poses asks this: making an imported actor's cycles takes half a second.
    """
    from stimuli.actor_library import imported_names, read_stored

    if name in imported_names():
        return read_stored(name)
    if name not in people():
        near = get_close_matches(name.upper(), actor_names(), n=1, cutoff=0.5)
        hint = f" Did you mean {near[0]}?" if near else ""
        raise ActorError(f"There is no actor {name!r}.{hint} The actors are {', '.join(actor_names())}.")
    return None


def actor_on(
    body: Body, person: Person, figure: Figure, cycles: Sequence[WalkCycle], tree: Tree, provenance: str
) -> Actor:
    """A person as the walker of a study: the cycles made for the figure, which is the body at the person's height."""
    return Actor(
        name=person.name,
        sex=person.sex,
        age=person.age,
        height=person.height,
        weight=person.weight,
        comfort_speed=person.comfort_speed,
        captured_walk_ratio=person.walk_ratio,
        walk_ratio_source=person.walk_ratio_source,
        body=body.name,
        figure=figure,
        table=CycleTable.of(cycles),
        tree=tree,
        provenance=provenance,
    )


@cache
def _default_actor(name: str) -> Actor:
    person = people()[name]
    return _make(person, load_body("woman" if person.sex == "F" else "man"))


def _make(person: Person, body: Body) -> Actor:
    figure = Figure(scaled(body.skeleton, person.height / body.stature))
    model = load_gait_model()
    manner = model.manner(dict(person.manner))
    cycles = [
        _cycle(figure, model, person, manner, speed, frequency) for frequency in METRONOME for speed in CYCLE_SPEEDS
    ]
    return actor_on(body, person, figure, cycles, metronome_tree(METRONOME, CYCLE_SPEEDS), MODELLED)


def _cycle(
    figure: Figure, model: GaitModel, person: Person, manner: Floats, speed: float, frequency: float
) -> WalkCycle:
    coefficients, stance = walk_coefficients(model, person, manner, figure.leg_length, speed, frequency)
    return walk_cycle(figure, WalkCurves.symmetric(coefficients, stance), speed, frequency)


def walk_coefficients(
    model: GaitModel, person: Person, manner: Floats, leg_length: float, speed: float, step_frequency: float
) -> tuple[Floats, float]:
    """Fourier coefficients (S, C) and drawn stance share of a person at a speed (m/s) and step frequency (steps/min).

    Legs follow the true step. Trunk and arms follow the step relative to the person's own: at their captured walk
    ratio they move as the average person does at the average walk ratio (step length = sqrt(60 v WR), so the step
    frequency is scaled by the root of the two ratios' quotient).
    """
    sex = 0.5 if person.sex == "F" else -0.5
    own = np.sqrt(person.walk_ratio / (POPULATION_WALK_RATIO[person.sex] * person.height))
    step = Step.of(speed, step_frequency, leg_length)
    coefficients = model.coefficients(Step.of(speed, step_frequency * own, leg_length), sex, manner)
    legs = [SIGNALS.index(name) for name in LEG_SIGNALS]
    coefficients[legs] = model.coefficients(step, sex, manner)[legs]
    return coefficients, model.stance_share(step, sex) - EARLIER_OFF


def metronome_tree(frequencies: tuple[float, ...], speeds: tuple[float, ...]) -> Tree:
    """A main branch over step frequency, each child a branch over speed; cycles counted speed first."""
    return Branch(
        "step_frequency",
        "steps/min",
        frequencies,
        tuple(
            Branch("speed", "m/s", speeds, tuple(Leaf(row * len(speeds) + column) for column in range(len(speeds))))
            for row in range(len(frequencies))
        ),
    )
