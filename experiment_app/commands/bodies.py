"""`gaitlab body ...`: a laboratory's own characters: check, import, list. Heavy imports stay inside."""

from __future__ import annotations

import json as json_format
from pathlib import Path
from typing import Annotated, Any

from cyclopts import App, Parameter

from experiment_app.errors import UsageError
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
    """Show what was understood of a character: joints, height, vertices, materials, box; and draw it walking."""
    report = body_report(file)
    if json:
        out.print(json_format.dumps(report, indent=2, ensure_ascii=False, allow_nan=False), markup=False)
        return 0
    for line in report_lines(report):
        out.print(line, markup=False)
    path = picture or Path(f"{file.stem}-check.png")
    draw_check(file, path)
    out.print(f"Picture: {path}", markup=False)
    return 0


@body_commands.command(name="import")
def import_file(
    file: File,
    *,
    name: Annotated[str, Parameter(help="The name that study files use, as lab7_anna.")],
    replace: Annotated[bool, Parameter(negative="", help="Replace an imported body of this name.")] = False,
) -> int:
    """Check a character and keep it in the library of bodies (GAITLAB_BODIES), under a name for study files."""
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


def body_report(file: Path) -> dict[str, Any]:
    """What was understood of a character, as plain values; raises BodyError for one that can't be shown."""
    import numpy as np

    from stimuli.actors import load_actor
    from stimuli.bodies.known import scaled
    from stimuli.bodies.retarget import longest_step, on_its_own_soles, sole_gaps
    from stimuli.body_files.imported import bounding_box, import_and_explain
    from stimuli.skeleton import JOINTS

    if not file.exists():
        raise UsageError(f"{file} does not exist.")
    body, explained = import_and_explain(file)
    low, high = bounding_box(file)
    points = np.concatenate([s.positions for s in body.levels[0]])
    actor = load_actor("M1", body)
    grown = scaled(body, actor.height)
    walker = on_its_own_soles(actor, grown)
    lowest, highest = sole_gaps(walker, grown)
    made, asked = longest_step(walker)
    return {
        "file": file.name,
        "joints_told_by": explained.source,
        "joints_in_file": explained.joints_in_file,
        "joints": {role: explained.joints.get(role) for role in JOINTS},
        "height_m": round(body.stature, 4),
        "vertices": len(points),
        "triangles": sum(len(s.triangles) for s in body.levels[0]),
        "materials": [
            {"name": s.name, "picture": list(s.picture.shape[1::-1]) if s.picture is not None else None,
             "alpha": s.alpha, "colour": [round(float(c), 4) for c in s.colour]}
            for s in body.levels[0]
        ],
        "props_left_out": explained.props,
        "box_in_file": {"low": [round(float(v), 5) for v in low], "high": [round(float(v), 5) for v in high]},
        "box_m": {
            "low": [round(float(v), 5) for v in points.min(axis=0)],
            "high": [round(float(v), 5) for v in points.max(axis=0)],
        },
        "soles_mm": {"lowest": round(lowest, 2), "highest": round(highest, 2)},
        "longest_step_m": {"without_a_slide": round(made, 3), "asked_of_it": round(asked, 3)},
        "problems": list(explained.problems),
    }  # fmt: skip


def report_lines(report: dict[str, Any]) -> list[str]:
    """The report in words."""
    joints = report["joints"]
    told = {"VRM": "the file's VRM list", "shape": "the skeleton's shape (no known names)"}
    box = ["  ".join(f"{v:.3f}" for v in report["box_m"][end]) for end in ("low", "high")]
    lines = [
        f"{report['file']}: a person {report['height_m']:.3f} m tall, {report['vertices']} vertices, "
        f"{report['triangles']} triangles",
        f"Joints: {sum(j is not None for j in joints.values())} of {len(joints)} roles found among "
        f"{report['joints_in_file']}, by {told.get(report['joints_told_by'], report['joints_told_by'] + ' names')}",
        *(f"  {role:16}{name if name is not None else '-- (stands between its neighbours)'}"
          for role, name in joints.items()),
        f"Box in the bind pose (m; left, up, forward): {box[0]}  to  {box[1]}",
        "Materials:",
    ]  # fmt: skip
    for material in report["materials"]:
        picture = "{}x{} picture".format(*material["picture"]) if material["picture"] else "plain colour"
        lines.append(f"  {material['name']}: {picture}, {material['alpha']}")
    if report["props_left_out"]:
        lines.append(f"{report['props_left_out']} meshes hang on no skin (props) and are left out.")
    soles = report["soles_mm"]
    lines.append(
        f"Walking as M1 its standing soles are {soles['lowest']:z.1f} to {soles['highest']:z.1f} mm from the ground."
    )
    if max(abs(soles["lowest"]), abs(soles["highest"])) > 5:
        lines.append("Note: that is more than 5 mm; the feet will be seen to float or sink.")
    steps = report["longest_step_m"]
    if steps["without_a_slide"] < steps["asked_of_it"]:
        lines.append(
            f"Note: its legs are too short for steps of more than {steps['without_a_slide']:.2f} m at M1's height; in "
            f"longer ones (actors make up to {steps['asked_of_it']:.2f} m) its feet slide."
        )
    return [*lines, *(f"Note: {sentence}" for sentence in report["problems"])]


def draw_check(file: Path, path: Path) -> None:
    """A picture of a character from the front and side, walking: frontal, three-quarter, side, legs."""
    import numpy as np

    from experiment_app.pictures.film import save_picture
    from experiment_app.render.drawn import DrawnWalker
    from experiment_app.render.renderer import Renderer
    from experiment_app.scene import Camera, Scene, View, Walker
    from experiment_app.windows.offscreen import offscreen_context
    from stimuli.actors import load_actor
    from stimuli.bodies.known import scaled
    from stimuli.bodies.retarget import on_its_own_soles
    from stimuli.body_files.imported import import_body
    from stimuli.walker import drawn_pose, skin_matrices

    body = import_body(file)
    actor = load_actor("M1", body)
    grown = scaled(body, actor.height)
    actor = on_its_own_soles(actor, grown)
    size = (400, 480)
    context = offscreen_context()
    target = context.simple_framebuffer(size)
    renderer = Renderer(context, size, 1.0, 4)
    views: tuple[tuple[View, float], ...] = (("front", 0.0), ("three_quarter", 0.3), ("side", 0.0), ("legs", 0.6))
    pictures = []
    for view, phase in views:
        scene = Scene((Walker("M1", 1.2, 105.0, phase),), Camera(view, 4.6, 1.2, 28.0))
        drawn = DrawnWalker(grown, skin_matrices(actor, drawn_pose(actor, 1.2, 105.0, phase)))
        renderer.draw(scene, (drawn,), target)
        pictures.append(renderer.read_pixels(target))
    renderer.release()
    context.release()
    save_picture(np.hstack(pictures), path)
