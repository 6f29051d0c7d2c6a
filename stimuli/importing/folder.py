"""From a folder of clips and actor.yaml to an actor in the library. Nothing is stored before everything is checked."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np

from stimuli.actor_library import StoredActor, StoredCycle, actor_of, check_name, stored
from stimuli.actors import Person
from stimuli.blend_tree import CoverageError
from stimuli.bodies.known import load_body
from stimuli.gait import Gait
from stimuli.gait_model import SIGNALS
from stimuli.importing.arrangement import ArrangedCycle, arrange
from stimuli.importing.description import Description, read_description
from stimuli.importing.errors import ImportingError
from stimuli.importing.walks import CapturedWalk, check_height, height_note, read_walks
from stimuli.measure import delivered_gait
from stimuli.retarget import Figure, scaled

SPEED_ERROR = 0.001
"""Share by which the delivered speed and step frequency may miss."""

SAMPLES = 120
"""Poses per cycle of the check at import; `gaitlab actor check` draws more."""

SLIDE = 5.0
"""mm, largest mean slide per stance."""


def import_folder(
    folder: Path,
    name: str,
    library: Path | None = None,
    replace: bool = False,
    complete: bool | None = None,
    told: Callable[[int, int], None] | None = None,
    at_once: int = 1,
) -> StoredActor:
    """Imports the captures of a folder as the actor `name` and stores it; returns what was stored.

    complete: overrides what actor.yaml says; told: called with the number of files read so far and of all;
    at_once: how many are read at the same time. Raises MotionFileError or ActorError; then nothing was stored.
    """
    check_name(name, library, replace)
    description = read_description(folder)
    walks = read_walks(folder, told, at_once)
    check_height(walks, description.height, folder)
    actor = _actor(name, description, walks, description.complete if complete is None else complete)
    _check_delivery(actor, folder)
    stored(actor, library)
    return actor


def _actor(name: str, description: Description, walks: list[CapturedWalk], complete: bool) -> StoredActor:
    comfort = description.comfort_speed or float(np.median([walk.gait.speed for walk in walks]))
    nearest = _comfortable(walks, comfort)
    person = Person(
        name=name,
        sex=description.sex,
        age=description.age,
        height=description.height,
        weight=description.weight,
        comfort_speed=comfort,
        walk_ratio=nearest.gait.walk_ratio,
        walk_ratio_source=f"captured, {nearest.file}",
        manner=(),
    )
    body = load_body("woman" if person.sex == "F" else "man")
    leg = Figure(scaled(body.skeleton, person.height / body.stature)).leg_length
    arrangement = arrange(walks, person, leg, complete, description.symmetric)
    return StoredActor(
        person=person,
        licence=description.licence,
        source=description.source,
        rows=tuple((frequency, tuple(_stored(cycle, walks) for cycle in row)) for frequency, row in arrangement.rows),
        follows=arrangement.follows,
        notes=(*height_note(walks, description.height), *_notes(walks)),
    )


def _comfortable(walks: list[CapturedWalk], comfort: float) -> CapturedWalk:
    """The walk nearest to a speed (m/s); of equally near ones that of the most usual walk ratio, then the slower.

    The median of an even number of clips lies midway between two, one of which may have been walked in long steps.
    """
    usual = float(np.median([walk.gait.walk_ratio for walk in walks]))
    return min(
        walks,
        key=lambda walk: (
            round(abs(walk.gait.speed - comfort), 2),
            round(abs(walk.gait.walk_ratio - usual), 5),
            walk.gait.speed,
        ),
    )


def _stored(cycle: ArrangedCycle, walks: list[CapturedWalk]) -> StoredCycle:
    sources = [walk for walk in walks if walk.file in cycle.files]
    return StoredCycle(
        speed=cycle.speed,
        step_frequency=cycle.step_frequency,
        walk=cycle.walk,
        files=tuple(walk.file for walk in sources),
        captured=tuple(walk.gait for walk in sources),
        seam=max((walk.seam for walk in sources), default=0.0),
    )


def _notes(walks: list[CapturedWalk]) -> tuple[str, ...]:
    notes = [f"{walk.file}: {warning}" for walk in walks for warning in walk.warnings]
    notes += [f"{walk.file}: no two strides alike to choose from" for walk in walks if not walk.measured.steady]
    absent = sorted({part for walk in walks for part in _absent(walk)})
    if absent:
        notes.append(f"{', '.join(absent)}: not in the captures, taken from the gait model")
    return tuple(notes)


def _absent(walk: CapturedWalk) -> list[str]:
    return [
        name.split("_")[0]
        for index, name in enumerate(SIGNALS)
        if np.isnan(walk.curves.sides[:, index, 0]).any() and not name.endswith(("_y", "_z"))
    ]


def _check_delivery(actor: StoredActor, folder: Path) -> None:
    """Draws the actor at the corners and the middle of what it covers. Raises ImportingError where it fails."""
    drawn = actor_of(actor)
    for gait in probes(actor):
        try:
            delivered = delivered_gait(drawn, gait.speed, gait.step_frequency, samples=SAMPLES)
        except ValueError as error:
            reason = error.sentence if isinstance(error, CoverageError) else error
            raise ImportingError(
                f"{folder}: no walk at {gait.speed:.2f} m/s and {gait.step_frequency:.0f} steps/min: {reason}"
            ) from error
        missed = max(abs(delivered.speed / gait.speed - 1.0), abs(delivered.step_frequency / gait.step_frequency - 1.0))
        if missed > SPEED_ERROR or delivered.slide_mean > SLIDE:
            raise ImportingError(
                f"{folder}: at {gait.speed:.2f} m/s and {gait.step_frequency:.0f} steps/min the walker drawn from "
                f"these clips misses by {100 * missed:.2f} per cent and slides {delivered.slide_mean:.1f} mm"
            )


def probes(actor: StoredActor) -> list[Gait]:
    """Corners and middle of what an actor covers; on a path its ends and middle."""
    if actor.follows:
        row = actor.rows[0][1]
        chosen = sorted({0, len(row) // 2, len(row) - 1})
        return [Gait.at_speed(row[i].speed, row[i].step_frequency) for i in chosen]
    low = max(row[0].speed for _, row in actor.rows)
    high = min(row[-1].speed for _, row in actor.rows)
    slow, fast = actor.rows[0][0], actor.rows[-1][0]
    middle = (0.5 * (low + high), 0.5 * (slow + fast))
    return [Gait.at_speed(*place) for place in ((low, slow), (high, slow), (low, fast), (high, fast), middle)]
