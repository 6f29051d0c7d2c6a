"""Imported actors: where they are kept, one file each, and how they become walkers. Knows no motion file.

A file holds the person, licence and source, and every cycle as Fourier coefficients with the clips it was captured
from, so that an actor can be put on any body. The folder is that of the user's data, or GAITLAB_ACTORS.
"""

from __future__ import annotations

import json
import re
import tokenize
import zipfile
import zlib
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

from stimuli.actors import Actor, ActorError, Person, actor_on, people
from stimuli.blend_tree import Branch, Leaf, Tree
from stimuli.bodies.body import Body
from stimuli.bodies.known import load_body
from stimuli.file_names import same_file, why_no_file
from stimuli.gait import Gait
from stimuli.gait_model import COEFFICIENTS, SIGNALS, WalkCurves
from stimuli.retarget import Figure, scaled, walk_cycle
from stimuli.skeleton import Floats
from stimuli.user_folder import make_user_folder, user_folder
from stimuli.whole_file import whole_file

VERSION = 2
NAME = re.compile(r"[A-Za-z][A-Za-z0-9_-]{0,39}")

DAMAGE = (
    *(OSError, ValueError, KeyError, TypeError, IndexError, EOFError, NotImplementedError),
    *(zipfile.BadZipFile, zlib.error, tokenize.TokenError),
)
"""What NumPy and zipfile raise over an npz file, depending on which of its bytes are wrong."""


@dataclass(frozen=True, eq=False)
class StoredCycle:
    """One cycle. files: the clips it was captured from, with the gait of each in `captured`; empty if modelled."""

    speed: float  # m/s, at which it stands in the tree
    step_frequency: float  # steps/min
    walk: WalkCurves
    files: tuple[str, ...] = ()
    captured: tuple[Gait, ...] = ()
    seam: float = 0.0  # m, gap of the captured loop before it became harmonics


@dataclass(frozen=True, eq=False)
class StoredActor:
    """An imported actor.

    rows: (step frequency, cycles in order of speed), in order of step frequency; a single row if step frequency
    `follows` speed. notes: sentences about the captures.
    """

    person: Person
    licence: str
    source: str
    rows: tuple[tuple[float, tuple[StoredCycle, ...]], ...]
    follows: bool
    notes: tuple[str, ...] = ()

    @property
    def cycles(self) -> tuple[StoredCycle, ...]:
        """All cycles, row by row, as the tree counts them."""
        return tuple(cycle for _, row in self.rows for cycle in row)

    @property
    def tree(self) -> Tree:
        """Which cycles give a speed and a step frequency."""
        branches: list[Branch] = []
        first = 0
        for _, row in self.rows:
            leaves = tuple(Leaf(first + index) for index in range(len(row)))
            follows = tuple(cycle.step_frequency for cycle in row) if self.follows else ()
            branches.append(Branch("speed", "m/s", tuple(cycle.speed for cycle in row), leaves, follows))
            first += len(row)
        if self.follows:
            return branches[0]
        return Branch("step_frequency", "steps/min", tuple(frequency for frequency, _ in self.rows), tuple(branches))

    @property
    def provenance(self) -> str:
        """How many cycles are captured and modelled, the licence and the source, for pages and journals."""
        captured = sum(bool(cycle.files) for cycle in self.cycles)
        modelled = len(self.cycles) - captured
        counts = f"{captured} cycle{'' if captured == 1 else 's'} captured"
        counts += f", {modelled} modelled" if modelled else ""
        return f"{counts}; licence: {self.licence}; source: {self.source}"


def library_folder() -> Path:
    """Where imported actors are kept: GAITLAB_ACTORS, or the folder of this user's data."""
    return user_folder("actors")


def imported_names(library: Path | None = None) -> tuple[str, ...]:
    """Names of imported actors, in order; none where there is no library."""
    folder = library or library_folder()
    try:
        found = sorted(path.stem for path in folder.glob("*.npz"))
    except OSError:
        return ()
    return tuple(name for name in found if NAME.fullmatch(name) and name not in people())


def path_of(name: str, library: Path | None = None) -> Path:
    """The file of an imported actor."""
    return (library or library_folder()) / f"{name}.npz"


def check_name(name: str, library: Path | None = None, replace: bool = False) -> None:
    """Raises ActorError if a new actor cannot have this name."""
    if not NAME.fullmatch(name):
        raise ActorError(f"{name!r} is no name for an actor; use letters, digits, - and _, as lab7_anna")
    if why := why_no_file(name):
        raise ActorError(why)
    if name in people():
        raise ActorError(f"{name} is a default actor; choose another name")
    if not replace and (taken := same_file(name, imported_names(library))):
        raise ActorError(f"there is an actor {taken} already; choose another name, or say --replace")


def stored(actor: StoredActor, library: Path | None = None) -> Path:
    """Writes an actor into the library, whole or not at all, and returns the file."""
    path = path_of(actor.person.name, library)
    write_whole(
        path,
        about=np.array(json.dumps(_about(actor), ensure_ascii=False)),
        coefficients=np.array([cycle.walk.sides for cycle in actor.cycles], dtype=np.float32),
    )
    return path


def write_whole(path: Path, **arrays: Any) -> None:
    """Writes arrays into an npz file that is there whole or not at all, even if the power fails."""
    make_user_folder(path.parent, "actors")
    with whole_file(path) as stream:
        np.savez_compressed(stream, **arrays)


def read_stored(name: str, library: Path | None = None) -> StoredActor:
    """An actor of the library. Raises ActorError when there is none or its file is damaged."""
    path = path_of(name, library)
    if name not in imported_names(library):
        raise ActorError(f"there is no imported actor {name!r} in {path.parent}")
    try:
        with np.load(path, allow_pickle=False) as content:
            return _read(json.loads(str(content["about"])), content["coefficients"].astype(np.float64))
    except DAMAGE as error:
        raise ActorError(
            f"{path} is damaged or of another version of gaitlab ({error}); import the actor again"
        ) from None


def actor_of(stored_actor: StoredActor, body: Body | None = None) -> Actor:
    """The walker of an imported actor, on the body of their sex unless another is given."""
    person = stored_actor.person
    worn = body or load_body("woman" if person.sex == "F" else "man")
    figure = Figure(scaled(worn.skeleton, person.height / worn.stature))
    cycles = [
        walk_cycle(figure, cycle.walk, cycle.speed, cycle.step_frequency, calm=True) for cycle in stored_actor.cycles
    ]
    return actor_on(worn, person, figure, cycles, stored_actor.tree, stored_actor.provenance)


def _about(actor: StoredActor) -> dict[str, Any]:
    return {
        "version": VERSION,
        "person": asdict(actor.person),
        "licence": actor.licence,
        "source": actor.source,
        "follows": actor.follows,
        "notes": actor.notes,
        "signals": SIGNALS,
        "rows": [
            {
                "step_frequency": frequency,
                "cycles": [
                    {
                        "speed": cycle.speed,
                        "step_frequency": cycle.step_frequency,
                        "stance": [float(share) for share in cycle.walk.stance],
                        "left_strike": cycle.walk.left_strike,
                        "files": cycle.files,
                        "captured": [[gait.step_length, gait.step_frequency] for gait in cycle.captured],
                        "seam": cycle.seam,
                    }
                    for cycle in row
                ],
            }
            for frequency, row in actor.rows
        ],
    }


def _read(about: dict[str, Any], coefficients: Floats) -> StoredActor:
    if about["version"] != VERSION or tuple(about["signals"]) != SIGNALS:
        raise ValueError(f"version {about['version']}")
    count = sum(len(row["cycles"]) for row in about["rows"])
    if coefficients.shape != (count, 2, len(SIGNALS), COEFFICIENTS) or not np.isfinite(coefficients).all():
        raise ValueError(f"coefficients of shape {coefficients.shape}")
    left = iter(coefficients)
    rows = tuple(
        (float(row["step_frequency"]), tuple(_read_cycle(cycle, next(left)) for cycle in row["cycles"]))
        for row in about["rows"]
    )
    person = Person(**{**about["person"], "manner": ()})
    return StoredActor(person, about["licence"], about["source"], rows, bool(about["follows"]), tuple(about["notes"]))


def _read_cycle(cycle: dict[str, Any], coefficients: Floats) -> StoredCycle:
    return StoredCycle(
        speed=float(cycle["speed"]),
        step_frequency=float(cycle["step_frequency"]),
        walk=WalkCurves(coefficients, np.array(cycle["stance"], dtype=float), float(cycle["left_strike"])),
        files=tuple(cycle["files"]),
        captured=tuple(Gait(*gait) for gait in cycle["captured"]),
        seam=float(cycle["seam"]),
    )
