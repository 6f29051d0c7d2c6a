"""What was understood of a character from another program, as plain values and in words. Heavy imports stay inside."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from experiment_app.errors import UsageError

if TYPE_CHECKING:
    from stimuli.body_files.shown import ShownFile

NAMED = 12
"""Animations of a file that are told by name."""


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
        "walks": True,
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


def shown_report(file: ShownFile, why_not: str) -> dict[str, Any]:
    """What a file shows that cannot walk, as plain values; why_not: the sentence that refuses it."""
    import numpy as np

    from stimuli.body_files.placing import placed_primitives

    seen = placed_primitives(file.scene)
    points = np.concatenate([placed.points for placed in seen])
    return {
        "file": file.name,
        "walks": False,
        "why_not": why_not,
        "joints_in_file": max((len(skin.joints) for skin in file.scene.skins), default=0),
        "nodes": len(file.scene.nodes),
        "vertices": len(points),
        "triangles": sum(len(placed.primitive.triangles) for placed in seen),
        "materials": [
            {"name": m.name, "picture": list(m.picture.shape[1::-1]) if m.picture is not None else None,
             "alpha": m.alpha, "colour": [round(float(c), 4) for c in m.colour[:3]]}
            for m in file.materials.values()
        ],
        "animations": [animation.name for animation in file.animations],
        "box_in_file": {
            "low": [round(float(v), 5) for v in points.min(axis=0)],
            "high": [round(float(v), 5) for v in points.max(axis=0)],
        },
        "problems": list(file.problems),
    }  # fmt: skip


def shown_lines(report: dict[str, Any]) -> list[str]:
    """The report on a file that cannot walk, in words."""
    box = ["  ".join(f"{v:.3f}" for v in report["box_in_file"][end]) for end in ("low", "high")]
    skin = f"a skin of {report['joints_in_file']} joints" if report["joints_in_file"] else "no skin"
    named = ", ".join(name or "(unnamed)" for name in report["animations"][:NAMED])
    more = f" and {len(report['animations']) - NAMED} more" if len(report["animations"]) > NAMED else ""
    return [
        f"{report['file']}: a model that cannot walk, {report['vertices']} vertices, {report['triangles']} triangles, "
        f"{report['nodes']} nodes, {skin}",
        f"Box at rest (the file's units; x, y, z): {box[0]}  to  {box[1]}",
        f"Animations: {named + more or 'none'}",
        "Materials:",
        *(_material_line(material) for material in report["materials"]),
        *(f"Note: {sentence}" for sentence in report["problems"]),
    ]


def _material_line(material: dict[str, Any]) -> str:
    picture = "{}x{} picture".format(*material["picture"]) if material["picture"] else "plain colour"
    return f"  {material['name'] or '(none)'}: {picture}, {material['alpha']}"


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
    lines += [_material_line(material) for material in report["materials"]]
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
