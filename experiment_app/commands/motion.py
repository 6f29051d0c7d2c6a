"""`gaitlab clip` and `gaitlab actor ...`: motion files and the actors made of them. Heavy imports stay inside."""

from __future__ import annotations

import json as json_format
import os
from pathlib import Path
from typing import Annotated

from cyclopts import App, Parameter

from experiment_app.commands.arguments import require_ending
from experiment_app.errors import UsageError
from experiment_app.terminal import out, progress_bar

actor_commands = App(name="actor", help="Actors: list, import from captures, check, look at, and take poses of.")

Name = Annotated[str, Parameter(help="Name of the actor, as F1.")]
Library = Annotated[
    Path | None, Parameter(help="Folder of imported actors; by default GAITLAB_ACTORS or that of your data.")
]
Speed = Annotated[float | None, Parameter(help="m/s; by default the actor's comfortable speed.")]
Frequency = Annotated[float | None, Parameter(help="steps/min; by default the actor's own at that speed.")]


def clip(
    file: Annotated[Path, Parameter(help="A motion file: BVH, C3D, MVNX or glTF.")],
    *,
    json: Annotated[bool, Parameter(negative="", help="As JSON.")] = False,
) -> int:
    """Show what the reader understood of a motion file: frames, joints, unit, axes, steps, speed, step frequency."""
    from stimuli.importing.clip_report import clip_lines, clip_report

    _refuse_missing(file)
    report = clip_report(file)
    if json:
        out.print(json_format.dumps(report, indent=2, ensure_ascii=False, allow_nan=False), markup=False)
    else:
        for line in clip_lines(report):
            out.print(line, markup=False)
    return 0


@actor_commands.command(name="list")
def list_actors(*, library: Library = None) -> int:
    """List all actors: who they are, how they walk at ease, what they cover, and where they come from."""
    from stimuli.actor_library import imported_names
    from stimuli.actors import people
    from stimuli.blend_tree import coverage

    _use(library)
    out.print("name            sex  age  height  speed  steps/min  walk ratio  speeds m/s  steps/min  provenance")
    for name in (*people(), *imported_names()):
        actor = _load(name)
        ranges = coverage(actor.tree)
        speeds = f"{ranges['speed'][0]:.2f}-{ranges['speed'][1]:.2f}"
        beats = "{:.0f}-{:.0f}".format(*ranges["step_frequency"]) if "step_frequency" in ranges else "follows"
        out.print(
            f"{name:15s} {actor.sex:3s} {actor.age:4.0f}  {actor.height:.2f} m  {actor.comfort_speed:5.2f}  "
            f"{actor.comfort_step_frequency:9.1f}  {actor.captured_walk_ratio:10.5f}  {speeds:10s}  {beats:9s}  "
            f"{actor.provenance}",
            markup=False,
        )
    return 0


@actor_commands.command(name="pose")
def pose(
    name: Name,
    *,
    speed: Speed = None,
    step_frequency: Frequency = None,
    seconds: Annotated[float, Parameter(help="How long, s.")] = 3.0,
    rate: Annotated[float, Parameter(help="Poses per second, Hz.")] = 120.0,
    out_file: Annotated[Path, Parameter(name="--out", help="The file to write (npz).")] = Path("poses.npz"),
    library: Library = None,
) -> int:
    """Write the walker's joints in the world as it would be drawn, travelling along +Z, Y up, in metres."""
    import numpy as np

    from stimuli.quality.travelling import travelling_joints
    from stimuli.skeleton import JOINTS, PARENTS

    require_ending("--out", out_file, "poses are an npz file", "poses.npz")
    if not 0.0 < seconds <= 3600.0 or not 1.0 <= rate <= 10_000.0:
        raise UsageError("--seconds must be more than 0 and at most 3600, --rate from 1 to 10000 Hz.")
    _use(library)
    actor = _load(name)
    speed, step_frequency = _gait(actor, speed, step_frequency)
    times, positions = travelling_joints(actor, speed, step_frequency, seconds, rate)
    with open(out_file, "wb") as stream:
        np.savez_compressed(
            stream,
            joints=np.array(JOINTS),
            parents=np.array(PARENTS),
            positions=positions,
            times=times,
            speed=speed,
            step_frequency=step_frequency,
            rate=rate,
            actor=name,
            provenance=actor.provenance,
        )
    out.print(
        f"{len(times)} poses of {name} at {speed:.3f} m/s and {step_frequency:.2f} steps/min in {out_file}",
        markup=False,
    )
    return 0


@actor_commands.command(name="check")
def check_actor(
    name: Name,
    *,
    picture: Annotated[Path | None, Parameter(help="The page of pictures (PNG); by default NAME-quality.png.")] = None,
    speeds: Annotated[int, Parameter(help="How many speeds to measure.")] = 5,
    step_frequencies: Annotated[int, Parameter(help="How many step frequencies to measure.")] = 9,
    library: Library = None,
) -> int:
    """Measure what an actor delivers over its coverage, as a table and a page of pictures.

    Exit status 1 when something is beyond the limits.
    """
    from experiment_app.pictures.actor_pages import quality_page, table_lines
    from stimuli.quality.delivery import quality_table

    require_ending("--picture", picture, "the page is a PNG", "page.png")
    if not (1 <= speeds <= 100 and 1 <= step_frequencies <= 100):
        raise UsageError("--speeds and --step-frequencies must be from 1 to 100.")
    _use(library)
    actor = _load(name)
    with out.status(f"Measuring {name}"):
        rows = quality_table(actor, speeds, step_frequencies)
        page = picture or Path(f"{name}-quality.png")
        quality_page(actor, rows, page)
    for line in table_lines(actor, rows):
        out.print(line, markup=False)
    out.print(f"Page of pictures: {page}", markup=False)
    return 1 if any(row.faults for row in rows) else 0


@actor_commands.command(name="table")
def table(
    *,
    actors: Annotated[
        list[str] | None, Parameter(negative="", consume_multiple=True, help="Names; by default all default actors.")
    ] = None,
    library: Library = None,
) -> int:
    """Write delivered speed per target speed over actors, mean and SD, as a Markdown table (as thesis table 3.2)."""
    from experiment_app.pictures.actor_pages import delivered_lines
    from stimuli.actors import people
    from stimuli.quality.delivery import delivered_table

    _use(library)
    names = actors or list(people())
    for name in names:
        _load(name)
    with out.status("Measuring"):
        rows = delivered_table(names)
    for line in delivered_lines(rows):
        out.print(line, markup=False)
    return 0


@actor_commands.command(name="show")
def show(
    name: Name,
    *,
    speed: Speed = None,
    step_frequency: Frequency = None,
    picture: Annotated[Path | None, Parameter(help="Write a film strip (PNG) instead of opening a window.")] = None,
    library: Library = None,
) -> int:
    """Look at an actor: a window with the keyboard, or a film strip where there is no screen."""
    from experiment_app.pictures.actor_pages import film_strip, walk_in_window
    from experiment_app.windows.screen import has_screen

    require_ending("--picture", picture, "the strip is a PNG", "strip.png")
    _use(library)
    actor = _load(name)
    speed, step_frequency = _gait(actor, speed, step_frequency)
    if picture is None and has_screen():
        walk_in_window(actor, speed, step_frequency)
        return 0
    path = picture or Path(f"{name}-strip.png")
    film_strip(actor, speed, step_frequency, path)
    out.print(
        f"Film strip of one gait cycle at {speed:.2f} m/s and {step_frequency:.1f} steps/min: {path}", markup=False
    )
    return 0


@actor_commands.command(name="import")
def import_actor(
    folder: Annotated[Path, Parameter(help="Folder of one person's clips and actor.yaml.")],
    *,
    name: Annotated[str, Parameter(help="Name of the new actor.")],
    library: Annotated[
        Path | None,
        Parameter(name=["--library", "--data-folder"], help="Folder of imported actors; by default that of your data."),
    ] = None,
    replace: Annotated[bool, Parameter(negative="", help="Take the place of an actor of that name.")] = False,
) -> int:
    """Make an actor of a folder of captured walks; speed and step frequency are found in the clips."""
    from stimuli.actor_library import library_folder
    from stimuli.importing.folder import import_folder

    _use(library)
    with progress_bar() as bar:
        task = bar.add_task("Reading clips", total=None)

        def told(done: int, of: int) -> None:
            bar.update(task, completed=done, total=of)

        actor = import_folder(folder, name, replace=replace, told=told, at_once=min(os.cpu_count() or 1, 8))
    out.print(f"{name}: {actor.provenance}", markup=False)
    for frequency, row in actor.rows:
        places = "  ".join(f"{cycle.speed:.2f}{'' if cycle.files else ' (modelled)'}" for cycle in row)
        title = "step frequency follows speed" if actor.follows else f"{frequency:5.1f} steps/min"
        out.print(f"  {title}: {places} m/s", markup=False)
    for cycle in actor.cycles:
        for file, gait in zip(cycle.files, cycle.captured, strict=True):
            out.print(f"  {file}: {gait.speed:.3f} m/s at {gait.step_frequency:.1f} steps/min", markup=False)
    for note in actor.notes:
        out.print(f"  Note: {note}", markup=False)
    out.print(f"Stored in {library_folder()}. Look at it with: gaitlab actor check {name}", markup=False)
    return 0


def _use(library: Path | None) -> None:
    """Makes a folder the library of this command."""
    import os

    if library is not None:
        os.environ["GAITLAB_ACTORS"] = str(library)


def _load(name: str):  # type: ignore[no-untyped-def]
    from stimuli.actors import load_actor

    return load_actor(name)


def _gait(actor, speed: float | None, step_frequency: float | None) -> tuple[float, float]:  # type: ignore[no-untyped-def]
    """The asked speed and step frequency, where nothing is asked the actor's own; CoverageError outside."""
    from stimuli.blend_tree import blend_weights, followed_step_frequency
    from stimuli.quality.delivery import comfort

    own = comfort(actor)
    speed = own.speed if speed is None else speed
    if step_frequency is None:
        followed = followed_step_frequency(actor.tree, speed)
        step_frequency = own.step_frequency if followed is None else followed
    blend_weights(actor.tree, {"speed": speed, "step_frequency": step_frequency})
    return speed, step_frequency


def _refuse_missing(path: Path) -> None:
    if path.is_dir():
        raise UsageError(f"{path} is a folder; name a motion file in it.")
    if not path.is_file():
        raise UsageError(f"there is no file {path}.")
