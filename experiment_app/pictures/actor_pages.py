"""Pages about an actor: the quality table, one page of pictures, a film strip, a window to look at the walker."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from stimuli.actors import Actor
from stimuli.gait import Gait
from stimuli.quality.angles import ANGLES, BAND, drawn_angles, normative_band, share_in_band
from stimuli.quality.delivery import QualityRow, TableCell, comfort, follows

STRIP_FRAMES = 8
STRIP_SIZE = (900, 720)


def table_lines(actor: Actor, rows: Sequence[QualityRow]) -> list[str]:
    """The quality table as lines of text, worst figures last."""
    done = [row.delivered for row in rows]
    lines = [
        f"{actor.name}: {actor.provenance}",
        "wanted             delivered             error %          slide mm     sole mm  knee",
        "  m/s  steps/min     m/s    steps/min   speed  steps   mean  peak    lowest   deg",
    ]
    for row in rows:
        wanted, gait = row.wanted, row.delivered
        lines.append(
            f"{wanted.speed:5.2f}  {wanted.step_frequency:9.2f}  {gait.speed:7.4f}  {gait.step_frequency:9.3f}  "
            f"{row.speed_error:z6.3f} {row.frequency_error:z6.3f}  {gait.slide_mean:5.2f} {gait.slide_peak:5.2f}  "
            f"{gait.sole_lowest:z8.2f}  {gait.knee_least:5.1f}"
            + (f"  beyond the limits: {', '.join(row.faults)}" if row.faults else "")
        )
    lines.append(
        f"worst: speed {max(abs(row.speed_error) for row in rows):.3f} %, "
        f"step frequency {max(abs(row.frequency_error) for row in rows):.3f} %, "
        f"mean slide {max(gait.slide_mean for gait in done):.2f} mm, "
        f"peak {max(gait.slide_peak for gait in done):.2f} mm, "
        f"sole {min(gait.sole_lowest for gait in done):z.2f} mm, knee {min(gait.knee_least for gait in done):.1f} deg"
    )
    return lines


def delivered_lines(cells: Sequence[TableCell]) -> list[str]:
    """The table over actors in Markdown: a line per step frequency, a column per target speed."""
    speeds = sorted({round(cell.target.speed, 6) for cell in cells})
    frequencies = sorted({cell.target.step_frequency for cell in cells})
    lines = [
        f"Delivered speed in m/s, mean ± SD over {cells[0].actors} actors, measured on the drawn walker:",
        "",
        "| steps/min | " + " | ".join(f"{speed:.1f} m/s" for speed in speeds) + " | delivered steps/min | slide mm |",
        "|---" * (len(speeds) + 3) + "|",
    ]
    for frequency in frequencies:
        row = [cell for cell in cells if cell.target.step_frequency == frequency]
        values = " | ".join("{:.4f} ± {:.4f}".format(*cell.speed) for cell in row)
        beat, spread = np.mean([cell.step_frequency for cell in row], axis=0)
        slide = np.mean([cell.slide[0] for cell in row])
        lines.append(f"| {frequency:.0f} | {values} | {beat:.3f} ± {spread:.3f} | {slide:.2f} |")
    return lines


def quality_page(actor: Actor, rows: Sequence[QualityRow], path: Path) -> None:
    """One page of pictures: coverage, slide, joint angles, loop seam, foot trace. PNG."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    gait = comfort(actor)
    figure = Figure(figsize=(15, 9.2), layout="constrained")
    FigureCanvasAgg(figure)
    axes = figure.subplots(2, 4)
    _draw_coverage(axes[0, 0], actor, rows)
    _draw_slide(axes[0, 1], figure, actor, rows)
    _draw_seam(axes[0, 2], actor, gait)
    _draw_feet(axes[0, 3], actor, gait)
    _draw_angles(axes[1, :3], actor, gait)
    _draw_numbers(axes[1, 3], actor, rows)
    figure.suptitle(
        f"{actor.name}  ({'woman' if actor.sex == 'F' else 'man'}, {actor.height:.2f} m)   {actor.provenance}",
        fontsize=11,
        wrap=True,
    )
    figure.savefig(path, dpi=100, format="png")


def _draw_coverage(axis: Any, actor: Actor, rows: Sequence[QualityRow]) -> None:
    from stimuli.blend_tree import Branch

    tree = actor.tree
    if isinstance(tree, Branch) and tree.follows:
        axis.plot(tree.places, tree.follows, "-", color="0.75", lw=6, label="covered", zorder=0)
    elif isinstance(tree, Branch):
        for frequency, child in zip(tree.places, tree.children, strict=True):
            if isinstance(child, Branch):
                axis.plot(child.places, [frequency] * len(child.places), "-s", color="0.8", ms=4, zorder=0)
    captured = _captured_places(actor)
    if captured:
        axis.plot(*np.array(captured).T, "*", color="tab:green", ms=11, label="captured cycle")
    wanted = np.array([[row.wanted.speed, row.wanted.step_frequency] for row in rows])
    delivered = np.array([[row.delivered.speed, row.delivered.step_frequency] for row in rows])
    axis.plot(*wanted.T, "o", mfc="none", mec="tab:blue", ms=8, label="target")
    axis.plot(*delivered.T, "x", color="tab:red", ms=6, label="delivered")
    worst = max(abs(row.speed_error) for row in rows)
    axis.set(title=f"Coverage; largest error {worst:.3f} %", xlabel="speed (m/s)", ylabel="step frequency (steps/min)")
    axis.legend(fontsize=8, loc="lower right")


def _captured_places(actor: Actor) -> list[tuple[float, float]]:
    """Speed and step frequency of every captured cycle of an imported actor."""
    from stimuli.actor_library import imported_names, read_stored

    if actor.name not in imported_names():
        return []
    return [(cycle.speed, cycle.step_frequency) for cycle in read_stored(actor.name).cycles if cycle.files]


def _draw_slide(axis: Any, figure: Any, actor: Actor, rows: Sequence[QualityRow]) -> None:
    speeds = sorted({round(row.wanted.speed, 6) for row in rows})
    beats = sorted({round(row.wanted.step_frequency, 6) for row in rows})
    slide = [row.delivered.slide_mean for row in rows]
    if follows(actor) or len(speeds) * len(beats) != len(rows) or min(len(speeds), len(beats)) < 2:
        axis.plot([row.wanted.speed for row in rows], slide, "-o", label="mean")
        axis.plot([row.wanted.speed for row in rows], [row.delivered.slide_peak for row in rows], "-^", label="peak")
        axis.set(title="Stance slide", xlabel="speed (m/s)", ylabel="slide (mm)", ylim=(0, 10))
        axis.legend(fontsize=8)
        return
    grid = np.array(slide).reshape(len(beats), len(speeds))
    drawn = axis.pcolormesh(speeds, beats, grid, shading="nearest", cmap="viridis", vmin=0, vmax=5)
    figure.colorbar(drawn, ax=axis, label="mean slide per stance (mm)")
    axis.set(title=f"Stance slide; largest {max(slide):.2f} mm", xlabel="speed (m/s)", ylabel="steps/min")


def _draw_seam(axis: Any, actor: Actor, gait: Gait) -> None:
    """Hips and ankle height over a cycle and a half, so that the seam at 100 % lies inside the picture."""
    from stimuli.kinematics import world_joints
    from stimuli.measure import poses
    from stimuli.skeleton import JOINTS

    phases = np.linspace(0.5, 1.5, 401)
    places = world_joints(actor.skeleton, poses(actor, gait.speed, gait.step_frequency, phases))
    for name, joint in (("hips", "hips"), ("right ankle", "rightFoot"), ("left ankle", "leftFoot")):
        values = places[:, JOINTS.index(joint), 1] * 1e3
        axis.plot(100 * phases, values - values.mean(), label=name)
    axis.axvline(100, color="0.4", ls="--", lw=1)
    axis.set(title=f"Loop seam: gap {seam_gap(actor, gait):.3f} mm", xlabel="cycle (%)", ylabel="height (mm)")
    axis.legend(fontsize=8)


def seam_gap(actor: Actor, gait: Gait) -> float:
    """mm: largest distance over joints of where the last poses of a cycle lead to and where the next begins."""
    from stimuli.kinematics import world_joints
    from stimuli.measure import poses

    before = 1.0 - np.array([3, 2, 1]) / 1000.0
    places = world_joints(actor.skeleton, poses(actor, gait.speed, gait.step_frequency, np.append(before, 1.0)))
    foretold = places[0] - 3 * places[1] + 3 * places[2]
    return float(np.linalg.norm(foretold - places[3], axis=1).max()) * 1e3


def _draw_feet(axis: Any, actor: Actor, gait: Gait) -> None:
    """Both soles in the world over two strides: where they touch, the traces must stand still on the ground."""
    from stimuli.kinematics import world_matrices
    from stimuli.measure import poses, sole_points

    phases = np.linspace(0.0, 2.0, 481)
    pose = poses(actor, gait.speed, gait.step_frequency, phases)
    soles = sole_points(actor.skeleton, actor.figure.sole, world_matrices(actor.skeleton, pose))
    ahead = gait.stride_length * phases
    for side, colour in ((0, "tab:orange"), (1, "tab:blue")):
        for point, style in ((0, "-"), (2, ":")):
            path = soles[:, side, point]
            axis.plot(path[:, 2] + ahead, 100 * path[:, 1], style, color=colour, lw=1.2)
    axis.axhline(0, color="0.5", lw=0.8)
    axis.set(title="Foot trace: heel, tip (dots)", xlabel="way (m)", ylabel="height (cm)")


def _draw_angles(axes: Any, actor: Actor, gait: Gait) -> None:
    drawn, band = drawn_angles(actor, gait.speed, gait.step_frequency), normative_band()
    percent = np.arange(101)
    for axis, angle in zip(axes, ANGLES, strict=True):
        mean, deviation = band[angle].T
        axis.fill_between(
            percent, mean - BAND * deviation, mean + BAND * deviation, color="0.85", label="adults ± 2 SD"
        )
        axis.plot(percent, mean, color="0.6", lw=1)
        axis.plot(percent, drawn[angle], color="tab:red", lw=1.8, label=f"{gait.speed:.2f} m/s")
        inside = 100 * share_in_band(drawn[angle], band[angle])
        axis.set(title=f"{angle}: {inside:.0f} % of the cycle inside", xlabel="cycle (%)", ylabel="degrees")
        axis.legend(fontsize=8)
    axes[0].annotate(
        "Schreiber & Moissenet 2019, Sci Data 6:111, comfortable speed, CC BY 4.0",
        (0, -0.2), xycoords="axes fraction", fontsize=7,
    )  # fmt: skip


def _draw_numbers(axis: Any, actor: Actor, rows: Sequence[QualityRow]) -> None:
    axis.axis("off")
    lines = [
        f"places measured      {len(rows)}",
        f"speed error          {max(abs(r.speed_error) for r in rows):.4f} %",
        f"step freq. error     {max(abs(r.frequency_error) for r in rows):.4f} %",
        f"mean slide, worst    {max(r.delivered.slide_mean for r in rows):.2f} mm",
        f"peak slide, worst    {max(r.delivered.slide_peak for r in rows):.2f} mm",
        f"sole, lowest         {min(r.delivered.sole_lowest for r in rows):z.2f} mm",
        f"knee, straightest    {min(r.delivered.knee_least for r in rows):.1f} deg",
        f"beyond limits        {sum(bool(r.faults) for r in rows)} places",
        "",
        f"comfort speed        {actor.comfort_speed:.2f} m/s",
        f"walk ratio           {actor.captured_walk_ratio:.5f} m·min",
        *textwrap.wrap(actor.walk_ratio_source, 34, initial_indent="  ", subsequent_indent="  "),
        *_capture_lines(actor),
    ]
    axis.text(0, 1, "\n".join(lines), va="top", family="monospace", fontsize=9)


def _capture_lines(actor: Actor) -> list[str]:
    """For an imported actor: every captured cycle with its clip, place and loop seam."""
    from stimuli.actor_library import imported_names, read_stored

    if actor.name not in imported_names():
        return []
    cycles = [cycle for cycle in read_stored(actor.name).cycles if cycle.files]
    lines = ["", f"captured loops' seam  {max(cycle.seam for cycle in cycles) * 1e3:.2f} mm", "captured cycles"]
    for cycle in cycles[:12]:
        more = f" +{len(cycle.files) - 1}" if cycle.files[1:] else ""
        lines.append(f"  {cycle.speed:.2f} m/s {cycle.step_frequency:5.1f}  {cycle.files[0][: 24 - len(more)]}{more}")
    return lines + ([f"  and {len(cycles) - 12} more"] if len(cycles) > 12 else [])


def film_strip(actor: Actor, speed: float, step_frequency: float, path: Path) -> None:
    """One gait cycle as pictures side by side, drawn off-screen. PNG."""
    from experiment_app.pictures.film import save_strip
    from experiment_app.render.renderer import Renderer
    from experiment_app.walkers import drawn_walkers
    from experiment_app.windows.offscreen import offscreen_context

    context = offscreen_context()
    target = context.simple_framebuffer(STRIP_SIZE)
    renderer = Renderer(context, STRIP_SIZE, 1.0, 4)
    frames: list[NDArray[np.uint8]] = []
    try:
        for index in range(STRIP_FRAMES):
            scene = _scene(actor, speed, step_frequency, index / STRIP_FRAMES, 0.0, "side")
            renderer.draw(scene, drawn_walkers(scene), target)
            frames.append(renderer.read_pixels(target))
    finally:
        renderer.release()
        context.release()
    save_strip(frames, path, STRIP_FRAMES)


def walk_in_window(actor: Actor, speed: float, step_frequency: float) -> None:
    """A window to look at the walker: left and right step frequency, up and down speed, V the view, Esc the end."""
    from typing import cast

    from experiment_app.windows.desktop import DesktopWindow
    from protocols.events import Closed, KeyDown
    from protocols.session import Session
    from stimuli.blend_tree import CoverageError, blend_weights, followed_step_frequency

    views = ("three_quarter", "side", "front", "legs")
    view, phase, way = 0, 0.0, 0.0
    with DesktopWindow(title=f"gaitlab: {actor.name}", full_screen=False) as window:
        last, _ = window.poll(cast(Session, None))
        while True:
            now, events = window.poll(cast(Session, None))
            for event in events:
                if isinstance(event, Closed) or (isinstance(event, KeyDown) and event.key == "escape"):
                    return
                if not isinstance(event, KeyDown):
                    continue
                view = (view + 1) % len(views) if event.key == "v" else view
                wanted = _nudged(event.key, speed, step_frequency)
                try:
                    followed = followed_step_frequency(actor.tree, wanted[0])
                    wanted = wanted if followed is None else (wanted[0], followed)
                    blend_weights(actor.tree, {"speed": wanted[0], "step_frequency": wanted[1]})
                except CoverageError:
                    continue  # at the edge of what was captured the keys do nothing
                speed, step_frequency = wanted
            phase += (now - last) * step_frequency / 120.0
            way += (now - last) * speed
            last = now
            scene = _scene(actor, speed, step_frequency, phase % 1.0, way, views[view])
            window.show(scene)


def _nudged(key: str, speed: float, step_frequency: float) -> tuple[float, float]:
    """Speed and step frequency after one key."""
    change = {"up": (0.02, 0.0), "down": (-0.02, 0.0), "right": (0.0, 1.0), "left": (0.0, -1.0)}.get(key, (0.0, 0.0))
    return speed + change[0], step_frequency + change[1]


def _scene(actor: Actor, speed: float, step_frequency: float, phase: float, way: float, view: str) -> Any:
    from experiment_app.scene import Camera, Scene, Walker

    caption = f"{actor.name}   {speed:.2f} m/s   {step_frequency:.0f} steps/min" if view != "side" or way else ""
    walker = Walker(actor.name, speed, step_frequency, phase, way)
    return Scene((walker,), Camera(view=view, distance=4.0), caption=caption)  # type: ignore[arg-type]
