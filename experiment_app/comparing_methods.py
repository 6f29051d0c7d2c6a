"""Every way of making a walk beside the captured walk, measured; what the numbers say is analysis's part."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from analysis.walk_methods.comparison import Comparison, ComparisonReport, MethodRow, RebuildingError, write_report
from analysis.walk_methods.figures import Film, PointCloud, Rebuilt
from experiment_app.errors import UsageError
from experiment_app.terminal import ShowProgress, unseen
from stimuli.actors import ActorError, load_actor
from stimuli.cycle import Cycle, cycle_positions, extract_cycle
from stimuli.events import GaitError
from stimuli.methods.actor_walks import actor_speeds, actor_walks
from stimuli.methods.comparison import Compared, compared
from stimuli.methods.delivery import delivered
from stimuli.methods.fourier import fourier_walk, variance_kept
from stimuli.methods.making import MethodError, leg_length
from stimuli.methods.pca import PcaWalk, pca_walk
from stimuli.motion_files.errors import MotionFileError
from stimuli.motion_files.reading import ENDINGS, read_clip
from stimuli.poulaine.curve import PoulaineError, characteristic_points, poulaine_of
from stimuli.poulaine.rebuilding import INTERPOLATIONS, chosen_points, rebuilding_error, rebuilt
from stimuli.poulaine.walking import SIDES

SHARED = ("c3d/schreiber-moissenet", "bvh/cmu")
"""Folders of ../shared/mocap that are read where no captures are named: adults walking straight ahead."""

FRAMES = 8
KILOMETRES_PER_HOUR = range(11)


@dataclass(frozen=True, eq=False)
class PersonsWalk:
    """A captured cycle and whose it is."""

    person: str
    cycle: Cycle


def compared_methods(
    actors: Sequence[str],
    folder: Path,
    captures: Path | None,
    say: Callable[[str], None],
    progress: ShowProgress = unseen,
) -> ComparisonReport:
    """Compares the methods on actors (names, or folders of one person's captures) and writes the report.

    Raises UsageError with a sentence for what cannot be compared.
    """
    try:
        return _compared(actors, folder, captures, say, progress)
    except (MethodError, GaitError, MotionFileError, ActorError) as error:
        raise UsageError(str(error)) from None


def _compared(
    actors: Sequence[str], folder: Path, captures: Path | None, say: Callable[[str], None], progress: ShowProgress
) -> ComparisonReport:
    rows: list[Compared] = []
    notes: list[str] = []
    engines: list[tuple[str, PcaWalk]] = []
    own: list[PersonsWalk] = []
    kept: list[dict[str, float]] = []
    for name in progress(actors, len(actors), "Comparing methods"):
        walks = walks_named(name, notes)
        kept += [variance_kept(fourier_walk(cycle)) for cycle in walks]
        own += [PersonsWalk(name, cycle) for cycle in walks]
        made, problems = compared(Path(name).name, walks)
        rows += made
        notes += problems
        try:
            engines.append((Path(name).name, pca_walk(walks)))
        except MethodError as error:
            notes.append(f"{name}: {error}.")
    tested, whose = _rebuilding_walks(captures, own, notes, say, progress)
    errors, unclear = rebuilding_errors(tested)
    comparison = Comparison(
        methods=tuple(_method_row(row) for row in rows),
        errors=tuple(errors),
        whose=whose,
        clouds=tuple(_clouds(tested)),
        rebuilt=tuple(_six_ways(tested)),
        films=tuple(_film(row) for row in rows if row.person == rows[0].person),
        pca=tuple((name, len(e.components), e.reduction, tuple(map(float, e.variance))) for name, e in engines),
        fourier=_mean_kept(kept),
        breaking=tuple(line for name, engine in engines for line in breaking_lines(name, engine)),
        notes=(*notes, *unclear),
    )
    return write_report(comparison, folder)


def walks_named(name: str, notes: list[str]) -> list[Cycle]:
    """The walks of an actor at seven speeds, or the cycles of the motion files of a folder (or of one file)."""
    if Path(name).exists():
        return [walk.cycle for walk in walks_in(Path(name), notes)]
    actor = load_actor(name)
    notes.append(f"{name} is an actor ({actor.provenance}): its walks are drawn ones.")
    return list(actor_walks(actor, actor_speeds(actor)))


def walks_in(folder: Path, notes: list[str], progress: ShowProgress = unseen) -> list[PersonsWalk]:
    """One cycle of every motion file that holds a walk; the person is the file's name up to its first number."""
    if not folder.exists():
        raise UsageError(f"{folder}: there is no such folder of captures.")
    found = [folder] if folder.is_file() else sorted(folder.rglob("*"))
    files = [path for path in found if path.suffix.lower() in ENDINGS and not path.stem.endswith("_ST")]
    walks, left_out = [], []
    for path in progress(files, len(files), f"Reading {folder.name}"):
        try:
            walks.append(PersonsWalk(_person(path.stem), extract_cycle(read_clip(path))))
        except (GaitError, MotionFileError) as error:
            left_out.append((path.name, str(error)))
    if left_out:
        names, (_, first) = ", ".join(name for name, _ in left_out[:5]), left_out[0]
        notes.append(f"{len(left_out)} files of {folder} hold no usable walk ({names}); the first: {first}")
    if not walks:
        raise UsageError(f"{folder}: no motion file in it holds a walk.")
    return walks


def rebuilding_errors(walks: Sequence[PersonsWalk]) -> tuple[list[RebuildingError], list[str]]:
    """RMSE of both feet of every walk, rebuilt from 4 and 5 points in three ways, and which have no clear M."""
    errors: list[RebuildingError] = []
    unclear: list[str] = []
    for walk in walks:
        for side in SIDES:
            try:
                poulaine = poulaine_of(walk.cycle, side)
                made = [
                    RebuildingError(walk.person, walk.cycle.provenance.clip, side, count, way,
                                    rebuilding_error(poulaine, count, way))
                    for count in (4, 5) for way in INTERPOLATIONS
                ]  # fmt: skip
            except PoulaineError as error:
                unclear.append(f"left out: {error}.")
            else:
                errors += made
    return errors, unclear


def breaking_lines(name: str, engine: PcaWalk) -> list[str]:
    """Sentences saying where the PCA engine slides, overstretches a knee or loses double support, 0 to 10 km/h."""
    measured = [(speed, delivered(engine.cycle(speed / 3.6))) for speed in KILOMETRES_PER_HOUR if speed > 0]
    checks = (
        ("feet slide by more than 5 cm per stance", [s for s, m in measured if m.slide > 50.0]),
        ("a knee is overstretched", [s for s, m in measured if m.knee_least < -2.0]),
        ("double support falls below 10 % of the cycle", [s for s, m in measured if m.double_support < 0.10]),
    )
    return [
        f"{name}, PCA engine from 0 to 10 km/h: {what} at {', '.join(map(str, at))} km/h"
        if at
        else f"{name}, PCA engine from 0 to 10 km/h: {what} nowhere"
        for what, at in checks
    ]


def _rebuilding_walks(
    captures: Path | None,
    own: list[PersonsWalk],
    notes: list[str],
    say: Callable[[str], None],
    progress: ShowProgress,
) -> tuple[list[PersonsWalk], str]:
    if captures is not None:
        return walks_in(captures, notes, progress), f"captures in {captures}"
    shared = Path("..") / "shared" / "mocap"
    if all((shared / part).is_dir() for part in SHARED):
        say(f"Reading the captures in {shared} (--captures names others)")
        walks = [walk for part in SHARED for walk in walks_in(shared / part, notes, progress)]
        return walks, f"captures in {shared}: {', '.join(SHARED)}"
    notes.append("no captures were named or found; rebuilding was tested on the actors' own walks.")
    return own, "walks of the actors themselves"


def _mean_kept(kept: Sequence[dict[str, float]]) -> tuple[tuple[str, float], ...]:
    """Joint and mean share of its variance that two harmonics keep, the least kept first."""
    joints = {joint for walk in kept for joint in walk}
    means = {joint: float(np.mean([walk[joint] for walk in kept if joint in walk])) for joint in joints}
    return tuple(sorted(means.items(), key=lambda item: (item[1], item[0])))


def _person(stem: str) -> str:
    found = re.match(r".*?\d+", stem)
    return found.group(0) if found else stem


def _method_row(row: Compared) -> MethodRow:
    m = row.measured
    return MethodRow(
        row.person, row.method, row.speed, m.speed, m.step_frequency, m.slide, m.knee_least, m.double_support,
        row.legs, row.body,
    )  # fmt: skip


def _clouds(walks: Sequence[PersonsWalk]) -> list[PointCloud]:
    clouds = []
    for walk in walks:
        legs = leg_length(walk.cycle)
        for side, shift in (("right", 0), ("left", len(walk.cycle.hips) // 2)):
            poulaine = poulaine_of(walk.cycle, side)
            try:
                points = characteristic_points(poulaine)
            except PoulaineError:
                continue
            places = {name: points.of(name) / legs for name in points.names}
            clouds.append(PointCloud(np.roll(poulaine.xz, -shift, axis=0) / legs, places))
    return clouds


def _six_ways(walks: Sequence[PersonsWalk]) -> list[Rebuilt]:
    for walk in walks:
        poulaine = poulaine_of(walk.cycle, "right")
        try:
            return [
                Rebuilt(
                    count, way, poulaine.xz, rebuilt(chosen_points(poulaine, count), way, poulaine.phases),
                    chosen_points(poulaine, count).places, rebuilding_error(poulaine, count, way),
                )
                for count in (4, 5) for way in INTERPOLATIONS
            ]  # fmt: skip
        except PoulaineError:
            continue
    return []


def _film(row: Compared) -> Film:
    cycle = row.cycle
    positions = cycle_positions(cycle)
    frames = np.round(np.arange(FRAMES) * len(positions) / FRAMES).astype(int)
    flat = positions[frames][..., [2, 1]]
    pairs = [(joint, parent) for joint, parent in enumerate(cycle.parents) if parent >= 0]
    bones = np.stack([flat[:, [joint for joint, _ in pairs]], flat[:, [parent for _, parent in pairs]]], axis=2)
    near = np.array([not cycle.joints[joint].startswith("left") for joint, _ in pairs])
    m = row.measured
    label = (
        f"{row.method}, {row.speed:.2f} m/s: feet {m.speed:.2f} m/s, {m.step_frequency:.0f} steps/min, "
        f"slide {m.slide:.0f} mm" + ("" if row.method == "captured" else f", legs {row.legs:.1f}°")
    )
    paths = [poulaine_of(walk, "right").xz for walk in (cycle, row.captured)]
    return Film(row.method, row.speed, label, bones, near, paths[0], paths[1])
