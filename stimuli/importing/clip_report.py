"""What a reader understood of one motion file, as plain values and as lines to read. Knows no actor."""

from __future__ import annotations

import math
from dataclasses import asdict
from pathlib import Path
from typing import Any

from stimuli.clip import Clip, FootEvent, world_positions
from stimuli.events import SIDES, GaitError, events_of, foot_paths
from stimuli.gait_measures import GaitMeasures, measure_paths, path_speed
from stimuli.motion_files.axes import leg_length
from stimuli.motion_files.reading import read_clip


def clip_report(path: Path) -> dict[str, Any]:
    """Everything known of a clip under the names of `gaitlab clip --json`.

    Frames are those of the file, times in s from its first frame. What a motion does not hold is None, and a warning
    says why. Raises MotionFileError when the file cannot be read.
    """
    clip = read_clip(path)
    events, measures, warnings = _measured(clip)
    source = clip.source
    frames, start = clip.frame_count + sum(source.left_out), source.left_out[0] / clip.rate
    return {
        "file": str(path),
        "format": source.format,
        "frames": frames,
        "rate": clip.rate,
        "duration_s": round((frames - 1) / clip.rate, 6),
        "joints": len(clip.joints),
        "joint_names": list(clip.joints),
        "roles": {role: clip.joints[index] for role, index in clip.roles.items()},
        "names": source.names,
        "unit_to_m": source.unit_to_m,
        "up": source.up,
        "forward": source.forward,
        "heel_strikes": _times(events, "strike", start),
        "toe_offs": _times(events, "off", start),
        "steps_used": measures.steps_used if measures else 0,
        "speed_m_s": _number(measures.speed if measures else _speed_of_one_step(clip, events)),
        "step_frequency_steps_min": _number(measures.gait.step_frequency if measures else None),
        "step_length_m": _number(measures.gait.step_length if measures else None),
        "walk_ratio_m_min": _number(measures.gait.walk_ratio if measures else None),
        "step_length_left_m": _number(measures.step_length_left if measures else None),
        "step_length_right_m": _number(measures.step_length_right if measures else None),
        "step_width_m": _number(measures.step_width if measures else None),
        "stance_share": {
            "left": _number(measures.stance_share_left if measures else None),
            "right": _number(measures.stance_share_right if measures else None),
        },
        "normalised": {
            "leg_length": _normalised(measures, leg_length(world_positions(clip), clip.roles)),
            "height": _normalised(measures, clip.subject.height),
        },
        "marker_residual_mm": _number(1e3 * source.residual),
        "warnings": warnings,
    }


def clip_lines(report: dict[str, Any]) -> list[str]:
    """The report as a person reads it."""
    lines = [
        f"{report['file']}: {report['format']}, {report['frames']} frames at {report['rate']:g} Hz "
        f"({report['duration_s']:.2f} s)",
        f"  joints        {report['joints']}, {len(report['roles'])} of them understood ({report['names']})",
        f"  unit, axes    {report['unit_to_m']:g} m, up {report['up']}, forward {report['forward'] or 'unknown'}",
    ]
    for title, key in (("heel strikes", "heel_strikes"), ("toe-offs", "toe_offs")):
        for side in ("left", "right"):
            times = "  ".join(f"{time:.3f}" for time in report[key][side]) or "none"
            lines.append(f"  {title + ',':13s} {side:5s}  {times} s")
    if report["speed_m_s"] is not None:
        lines += [
            f"  speed         {report['speed_m_s']:.3f} m/s "
            + (f"over {report['steps_used']} steps" if report["steps_used"] else "over all frames"),
        ]
    if report["step_length_m"] is not None:
        lines += [
            f"  step          {report['step_length_m']:.3f} m at {report['step_frequency_steps_min']:.1f} steps/min",
            f"  walk ratio    {report['walk_ratio_m_min']:.5f} m·min",
        ]
    for body, gait in report["normalised"].items():
        if gait:
            over = f"over {body.replace('_', ' ')} {gait['length_m']:.2f} m"
            names = ("speed", "step_length", "step_frequency", "walk_ratio")
            lines.append(f"  {over} (Hof 1996): " + ", ".join(f"{n.replace('_', ' ')} {gait[n]:.3f}" for n in names))
    if report["marker_residual_mm"] is not None:
        lines.append(f"  markers       {report['marker_residual_mm']:.1f} mm from the skeleton (root mean square)")
    return lines + [f"  Note: {warning}" for warning in report["warnings"]]


def _measured(clip: Clip) -> tuple[tuple[FootEvent, ...], GaitMeasures | None, list[str]]:
    """Events, measures and warnings; a motion without a walk has no measures and one warning more."""
    warnings = list(clip.warnings)
    events: tuple[FootEvent, ...] = clip.events
    try:
        paths = foot_paths(clip)
        events = events_of(clip)
        measures = measure_paths(paths, events, clip.name)
        if clip.events and events != clip.events:
            warnings.append("the events that the file marks hold no whole stride, so all were found in the motion")
    except GaitError as error:
        return events, None, [*warnings, str(error)]
    if not measures.steady and measures.steps_used > 2:
        warnings.append("no two strides are alike: speed and step frequency are of one foot's and mean little")
    elif not measures.steady:
        warnings.append("only one stride could be used, so the step frequency is good to about 2 per cent")
    if measures.on_the_spot:
        warnings.append("the walker stays on the spot; the speed is that of the standing feet, as on a treadmill")
    return events, measures, warnings


def _speed_of_one_step(clip: Clip, events: tuple[FootEvent, ...]) -> float | None:
    """m/s along the path of a clip that holds one step and no whole stride; None of any other motion without a gait."""
    if sorted(event.side for event in events if event.kind == "strike") != list(SIDES):
        return None
    return path_speed(foot_paths(clip))


def _normalised(measures: GaitMeasures | None, length: float | None) -> dict[str, float | None] | None:
    """The gait over a body length (m) without units (Hof 1996); None where either is not known."""
    if measures is None or length is None or not length > 0:
        return None
    gait = measures.gait.normalised(length)
    return {"length_m": _number(length)} | {key: _number(value) for key, value in asdict(gait).items()}


def _times(events: tuple[FootEvent, ...], kind: str, start: float) -> dict[str, list[float]]:
    return {
        side: [round(event.time + start, 4) for event in events if event.side == side and event.kind == kind]
        for side in ("left", "right")
    }


def _number(value: float | None) -> float | None:
    return None if value is None or not math.isfinite(value) else round(float(value), 6)
