"""Eleven named styles of walking, made from the gait model, and an actor who walks in one of them.

The names are those of the eleven styles of the Mockey database that Tilmanne & Dutoit analysed; that database cannot be
shipped, so these are made, not captured: each changes the mean posture and the range of some signals of the gait model
by the amounts of styles.csv, and the legs follow by the same inverse kinematics as any walk. They stand for styles of
different content (posture, range, width, tempo), not for what an actor performs; like every walk of the model the left
step mirrors the right one, so the drunken style has no two different steps. Captured ones can be imported.
"""

from __future__ import annotations

import csv
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cache, lru_cache
from importlib.resources import files
from pathlib import Path

import numpy as np

from stimuli.actor_library import DAMAGE, NAME, imported_names, library_folder, read_stored, write_whole
from stimuli.actors import CYCLE_SPEEDS, METRONOME, Actor, people, walk_coefficients
from stimuli.blend import CycleTable
from stimuli.file_names import same_file, why_no_file
from stimuli.gait_model import COEFFICIENTS, SIGNALS, WalkCurves, load_gait_model
from stimuli.methods.errors import MethodError
from stimuli.retarget import walk_cycle
from stimuli.skeleton import Floats


@dataclass(frozen=True, eq=False)
class Style:
    """A way of walking as a change of any walk of the gait model.

    gain:           (S,) by which each signal's harmonics are multiplied
    shift:          (2, S, C) rad or leg lengths added to the coefficients of the left and the right side's signals
    step_frequency: times the actor's own at the same speed
    left_strike:    share of the cycle by which the left foot strikes later than in the actor's own walk
    provenance:     "made from the gait model", or of which captures it is, with licence and source
    """

    name: str
    gain: Floats
    shift: Floats
    step_frequency: float = 1.0
    left_strike: float = 0.0
    provenance: str = "made from the gait model"

    def applied(self, walk: WalkCurves) -> WalkCurves:
        """The walk in this style."""
        changed = walk.sides * self.gain[:, None]
        changed[..., 0] = walk.sides[..., 0]
        return replace(walk, sides=changed + self.shift, left_strike=walk.left_strike + self.left_strike)


_SIDES = {"": slice(None), "left": slice(0, 1), "right": slice(1, 2)}


@cache
def default_styles() -> dict[str, Style]:
    """Name -> style, as styles.csv lists them."""
    text = (files("stimuli.methods") / "styles.csv").read_text(encoding="utf-8")
    found: dict[str, Style] = {}
    for row in csv.DictReader(line for line in text.splitlines() if not line.startswith("#")):
        name = row["style"]
        style = found.setdefault(name, Style(name, np.ones(len(SIGNALS)), np.zeros((2, len(SIGNALS), COEFFICIENTS))))
        if row["signal"] == "step_frequency":
            found[name] = replace(style, step_frequency=float(row["gain"]))
            continue
        if row["signal"] == "left_strike":
            found[name] = replace(style, left_strike=float(row["shift"]))
            continue
        for signal in _signals(row["signal"]):
            style.shift[_SIDES[row["side"]], signal, 0] += float(row["shift"] or 0.0)
            style.gain[signal] *= float(row["gain"] or 1.0)
    return found


def style_names() -> tuple[str, ...]:
    """The styles there are, the default ones first, then those imported on this computer."""
    return (*default_styles(), *imported_styles())


def style_named(name: str) -> Style:
    """A default or imported style. Raises MethodError for one that is not known."""
    if name in default_styles():
        return default_styles()[name]
    if name in imported_styles():
        return read_style(name)
    raise MethodError(f"style: there is no {name!r}; there are {', '.join(style_names())}")


def imported_styles() -> tuple[str, ...]:
    """Names of imported styles, in order; none where there is no library."""
    return tuple(sorted(path.stem for path in _folder().glob("*.npz")))


def read_style(name: str) -> Style:
    """An imported style. Raises MethodError when its file is damaged."""
    path = path_of(name)
    try:
        with np.load(path, allow_pickle=False) as content:
            shift = content["shift"].astype(np.float64)
            if shift.shape != (2, len(SIGNALS), COEFFICIENTS) or not np.isfinite(shift).all():
                raise ValueError(f"coefficients of shape {shift.shape}")
            tempo, late = float(content["step_frequency"]), float(content["left_strike"])
            provenance = str(content["provenance"])
    except DAMAGE as error:
        raise MethodError(f"{path} is damaged or of another version of gaitlab ({error}); import it again") from None
    return Style(name, np.ones(len(SIGNALS)), shift, tempo, late, provenance)


def store_style(style: Style, replace_old: bool = False) -> Path:
    """Keeps a captured style in the user's library. Raises MethodError for a name it cannot have."""
    if style.name in default_styles():
        raise MethodError(f"{style.name} is a style that comes with gaitlab; choose another name, as lab7_{style.name}")
    if not NAME.fullmatch(style.name):
        raise MethodError(f"{style.name!r} is no name for a new style; use letters, digits, - and _, as lab7_sad")
    if why := why_no_file(style.name):
        raise MethodError(why)
    if not replace_old and (taken := same_file(style.name, imported_styles())):
        raise MethodError(f"there is a style {taken} already; choose another name, or say --replace")
    path = path_of(style.name)
    write_whole(
        path,
        shift=style.shift,
        step_frequency=style.step_frequency,
        left_strike=style.left_strike,
        provenance=np.array(style.provenance),
    )
    return path


def path_of(name: str) -> Path:
    """The file of an imported style."""
    return _folder() / f"{name}.npz"


def _folder() -> Path:
    return library_folder() / "styles"


@lru_cache(maxsize=64)
def styled(actor: Actor, name: str) -> Actor:
    """The actor walking in a style, on the same body, at the same speeds and step frequencies.

    Raises MethodError for a style that is not known.
    """
    style = style_named(name)
    captured = actor.name in imported_names() or name in imported_styles()
    cycles = [
        walk_cycle(actor.figure, style.applied(walk), speed, frequency, calm=captured)
        for walk, speed, frequency in _ingredients(actor)
    ]
    return replace(
        actor, table=CycleTable.of(cycles), provenance=f"{actor.provenance}; {name} style {style.provenance}"
    )


def _ingredients(actor: Actor) -> Iterator[tuple[WalkCurves, float, float]]:
    """The walk, speed and step frequency of every cycle of the actor's table, in its order."""
    if actor.name in imported_names():
        for cycle in read_stored(actor.name).cycles:
            yield cycle.walk, cycle.speed, cycle.step_frequency
        return
    person, model = people()[actor.name], load_gait_model()
    manner = model.manner(dict(person.manner))
    for frequency in METRONOME:
        for speed in CYCLE_SPEEDS:
            coefficients, stance = walk_coefficients(model, person, manner, actor.figure.leg_length, speed, frequency)
            yield WalkCurves.symmetric(coefficients, stance), speed, frequency


def _signals(pattern: str) -> list[int]:
    """Indices of a signal, or of all three axes of a segment."""
    found = [index for index, name in enumerate(SIGNALS) if name == pattern or name[:-2] == pattern]
    if not found:
        raise ValueError(f"styles.csv: the gait model has no signal {pattern!r}")
    return found
