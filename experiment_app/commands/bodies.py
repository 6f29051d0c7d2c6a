"""`gaitlab body ...`: a laboratory's own characters: check, import, list. Heavy imports stay inside."""

from __future__ import annotations

import json as json_format
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Any

from cyclopts import App, Parameter

from experiment_app.commands.arguments import require_ending
from experiment_app.terminal import out

body_commands = App(name="body", help="Bodies: check a character from another program, import it, list them all.")

File = Annotated[Path, Parameter(help="A skinned humanoid in glTF 2.0: .glb, .gltf or .vrm.")]


@body_commands.command(name="check")
def check_body(
    file: File,
    *,
    json: Annotated[bool, Parameter(negative="", help="As JSON, without a picture.")] = False,
    picture: Annotated[Path | None, Parameter(help="Where to draw it; by default NAME-check.png here.")] = None,
) -> int:
    """Show what was understood of a character: joints, height, vertices, materials, box; and draw it walking.

    A model that cannot walk is drawn as the file shows it, at rest and in its animation, with why it cannot.
    """
    from experiment_app.checking.bodies import body_report, report_lines, shown_lines, shown_report
    from stimuli.body_files.errors import BodyError
    from stimuli.body_files.shown import read_shown

    require_ending("--picture", picture, "the picture is a PNG", "anna.png")
    path = None if json else picture or Path(f"{file.stem}-check.png")
    try:
        report = body_report(file)
    except BodyError as reason:
        try:
            shown = read_shown(file)
        except BodyError:  # nothing of it can be seen, so the reason is all there is to say
            raise reason from None
        report = shown_report(shown, str(reason))
        _tell(report, shown_lines(report), file, path)
        raise
    _tell(report, report_lines(report), file, path)
    return 0


def _tell(report: dict[str, Any], lines: Sequence[str], file: Path, picture: Path | None) -> None:
    """Prints the report in words and draws the file, or prints it as JSON when there is to be no picture."""
    if picture is None:
        out.print(json_format.dumps(report, indent=2, ensure_ascii=False, allow_nan=False), markup=False)
        return
    from experiment_app.pictures.body_check import draw_check

    for line in lines:
        out.print(line, markup=False)
    for line in draw_check(file, picture, walking=bool(report["walks"])):
        out.print(line, markup=False)


@body_commands.command(name="import")
def import_file(
    file: File,
    *,
    name: Annotated[str, Parameter(help="The name that study files use, as lab7_anna.")],
    replace: Annotated[bool, Parameter(negative="", help="Replace an imported body of this name.")] = False,
) -> int:
    """Check a character and keep it in the library of bodies (GAITLAB_BODIES), under a name for study files."""
    from experiment_app.checking.bodies import body_report
    from stimuli.bodies.imported_bodies import stored
    from stimuli.body_files.container import open_container
    from stimuli.body_files.packing import packed

    report = body_report(file)
    path = stored(packed(open_container(file), file), name, replace)
    for sentence in report["problems"]:
        out.print(f"Note: {sentence}", markup=False)
    out.print(f"{name} is kept in {path}. In a study file: stimulus: {{body: {name}}}", markup=False)
    return 0


@body_commands.command(name="list")
def list_bodies() -> int:
    """List every name that a study's `body` can have."""
    from stimuli.bodies.imported_bodies import MATCHED, MISMATCHED, OWN_BUILD, imported_names
    from stimuli.bodies.known import haircut_names, load_body, shipped_names, variant_names
    from stimuli.bodies.point_light import FIGURES

    ours = (*shipped_names(), *haircut_names(), *variant_names())
    for name in (*ours, *imported_names()):
        body = load_body(name)
        counts = " / ".join(str(sum(len(s.triangles) for s in level)) for level in body.levels)
        kind = "comes with gaitlab" if name in ours else "imported"
        out.print(f"{name:24}{body.stature:.2f} m  {counts} triangles  {kind}", markup=False)
    for name, whose in ((MATCHED, "the actor's sex"), (MISMATCHED, "the other sex")):
        out.print(f"{name:24}the body that comes with gaitlab of {whose}", markup=False)
    out.print(f"{OWN_BUILD:24}the matched body, as stout or slim as the actor's weight and height say", markup=False)
    for name in FIGURES:
        out.print(f"{name:24}drawn without a body, on the actor's own joints", markup=False)
    return 0
