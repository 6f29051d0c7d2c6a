"""The timing certificate: what was measured, a verdict with its reasons, and the paragraph for a Methods section.

Software sees when it swapped and when it learned of a key, never the light or the finger; the certificate says so.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from statistics import median, pstdev
from typing import Any, Literal

from experiment_app.timing.facts import Timing, percentile_90

MANY_LATE, SOME_LATE = 0.01, 0.001
"""Shares of late frames above which a run is not publishable, or only with caveats."""

COARSE = 4.0
"""ms: key times whose 90th percentile of uncertainty is larger are a caveat for response times."""

OFF_RATE = 0.01
"""Share by which the measured refresh may differ from the reported one."""

BARS = "▁▂▃▄▅▆▇█"

Level = Literal["publishable", "publishable with caveats", "not publishable"]


@dataclass(frozen=True)
class Verdict:
    """The judgement, and the sentences that give its reasons."""

    level: Level
    reasons: tuple[str, ...]


def verdict(timing: Timing) -> Verdict:
    """What the timing can be used for."""
    against, caveats = list(_against(timing)), list(_caveats(timing))
    level: Level = "not publishable" if against else "publishable with caveats" if caveats else "publishable"
    return Verdict(level, tuple(against + caveats))


def _against(timing: Timing) -> list[str]:
    reasons = []
    window = timing.about.get("window")
    if window != "desktop":
        reasons.append(f"Not synchronised: drawn {window}, nothing can be said about when frames would be seen.")
    elif not timing.synchronised:
        reasons.append(
            "Not synchronised: swaps do not wait for the display, so frames may tear and their times are estimates. "
            "Switch vertical synchronisation on in the driver's settings, and compositing off."
        )
    if timing.drawn_by_processor:
        reasons.append(
            "The processor draws, not a graphics card: fine for trying, films and tests, not for participants. "
            "Install the graphics card's driver."
        )
    if timing.late_frames > MANY_LATE * timing.frames:
        reasons.append(f"{_late(timing)}: close other programs, use a smaller window or fewer samples.")
    if timing.sources.get("simulated"):
        reasons.append("The participant was simulated.")
    return reasons


def _caveats(timing: Timing) -> list[str]:
    about = timing.about
    reasons = []
    if 0 < timing.late_frames <= MANY_LATE * timing.frames and timing.late_frames > SOME_LATE * timing.frames:
        reasons.append(f"{_late(timing)}; exclude the trials concerned, as with late_frames > 5.")
    reported = float(about.get("reported_refresh_hz") or 0.0)
    if timing.synchronised and reported and abs(timing.period * reported - 1.0) > OFF_RATE:
        reasons.append(f"The display reports {reported:g} Hz but refreshes at {1 / timing.period:.2f} Hz.")
    if about.get("window") == "desktop" and not about.get("full_screen", True):
        reasons.append("Shown in a window, not full screen: the desktop may hold every frame back by a refresh.")
    if about.get("compositor", "none") not in ("none", ""):
        reasons.append(f"A compositor ({about['compositor']}) was running: it may hold every frame back by a refresh.")
    if timing.uncertainties and percentile_90(timing.uncertainties) > COARSE:
        reasons.append(
            f"Key times are uncertain by {percentile_90(timing.uncertainties):.1f} ms (90th percentile): good for "
            "adjustment, coarse for response times."
        )
    if timing.keys and (timing.keys["lost"] or timing.keys["doubled"]):
        reasons.append(f"Of {timing.keys['presses']} injected keys {timing.keys['lost']} were lost.")
    return reasons


def _late(timing: Timing) -> str:
    share = 100.0 * timing.late_frames / max(timing.frames, 1)
    return f"{timing.late_frames} of {timing.frames} frames were late ({share:.2g} %)"


def rows(timing: Timing) -> list[tuple[str, str]]:
    """What was measured, as (name, words)."""
    about = timing.about
    said = [
        ("Renderer", f"{about.get('gl_renderer', 'none')}"),
        ("Driver", f"{about.get('gl_vendor', '')}, OpenGL {about.get('gl_version', '')}".strip(", ")),
        ("Samples", f"{about.get('samples', 0)} per pixel"),
        ("Display", _display(about)),
        ("Compositor", str(about.get("compositor", "none: nothing was shown"))),
        ("Refresh", _refresh(timing)),
        ("VSYNC", _vsync(timing)),
    ]
    if timing.intervals:
        said += [("Frames", _frames(timing)), ("Histogram", histogram(timing.intervals))]
    if timing.errors:
        said.append(("Prediction", _spread("flip minus the moment drawn for", [1e3 * e for e in timing.errors])))
    if timing.cpu_ms:
        said.append(("Processor", _spread("drawing thread per frame", timing.cpu_ms)))
    said.append(("Late frames", _late_trials(timing)))
    return [*said, ("Keys", _keys(timing)), ("Clock", _clock(about))]


def _display(about: Mapping[str, Any]) -> str:
    wide, tall = about.get("pixels") or (0, 0)
    picture = f"picture {wide}x{tall} pixels"
    if "monitor" not in about:
        return f"none used, {picture}"
    across, down = about.get("screen_mm") or (0, 0)
    size = f"{across / 10:.1f} x {down / 10:.1f} cm as it says" if across and down else "size not told"
    screen = "x".join(map(str, about.get("screen_pixels") or ["?"]))
    where = "full screen" if about.get("full_screen") else "in a window"
    scale = f"scale {about.get('screen_scale', 1):g}"
    name = f"{about['monitor'] or 'unnamed'} on {about.get('platform')}"
    return f"{name}, {screen} pixels, {size}, {scale}; {picture}, {where}"


def _refresh(timing: Timing) -> str:
    if timing.about.get("window") != "desktop":
        return "none"
    reported = timing.about.get("reported_refresh_hz")
    said = f"{reported:g} Hz reported" if reported else "nothing reported"
    if timing.synchronised:
        return f"{1 / timing.period:.3f} Hz measured, {said}"
    return f"not measurable, {said}; frames were paced at {1 / timing.period:.3f} Hz by gaitlab's own deadlines"


def _vsync(timing: Timing) -> str:
    swaps = timing.about.get("bare_swaps_ms") or []
    measured = f"bare swaps took {median(swaps):.2f} ms (median of {len(swaps)})" if swaps else "no swaps"
    return f"proven: {measured}" if timing.synchronised else f"not synchronised: {measured}"


def _frames(timing: Timing) -> str:
    ms = [1e3 * interval for interval in timing.intervals]
    middle = median(ms)
    return (
        f"{timing.frames} frames, {len(ms)} intervals: median {middle:.2f} ms ({1e3 / middle:.1f}/s), "
        f"SD {pstdev(ms):.2f} ms, shortest {min(ms):.2f}, longest {max(ms):.2f} ms"
    )


def _late_trials(timing: Timing) -> str:
    if not timing.late:
        return "none" if timing.intervals else "no frames"
    named = ", ".join(f"{trial} ({count})" for trial, count in timing.late[:12])
    more = f" and {len(timing.late) - 12} more" if len(timing.late) > 12 else ""
    where = f" in {len(timing.late)} of {timing.trials} trials: {named}{more}" if timing.trials else ""
    return f"{timing.late_frames} of {timing.frames}{where}"


def _keys(timing: Timing) -> str:
    keyboard = timing.about.get("keyboard") or {}
    said = [f"times from {keyboard.get('source', 'nothing')}"]
    if "clock_offset_between_ms" in keyboard:
        low, high = keyboard["clock_offset_between_ms"]
        said.append(f"its clock is between {low:g} and {high:g} ms from ours")
    if timing.sources:
        counts = ", ".join(f"{count} from {source}" for source, count in sorted(timing.sources.items()))
        said.append(f"{counts}; uncertainty {median(timing.uncertainties):.2f} ms (median), "
                    f"{percentile_90(timing.uncertainties):.2f} ms (90th percentile)")  # fmt: skip
    if timing.keys:
        keys = timing.keys
        said.append(
            f"{keys['presses']} injected presses: error {keys['median_ms']} ms (median), {keys['p90_ms']} ms (90th "
            f"percentile of its size), {keys['lost']} lost, {keys['doubled']} doubled"
        )
    return "; ".join(said)


def _clock(about: Mapping[str, Any]) -> str:
    resolution = about.get("clock_resolution_ns")
    return f"monotonic, resolution {resolution:g} ns" if resolution else "simulated"


def methods_paragraph(timing: Timing) -> str:
    """Sentences for a Methods section, with the numbers of this run."""
    about = timing.about
    if about.get("window") != "desktop" or not timing.intervals:
        return "Nothing was shown on a display, so there is no timing to report."
    wide, tall = about["pixels"]
    ms = [1e3 * interval for interval in timing.intervals]
    waited = "synchronised to" if timing.synchronised else "not synchronised to"
    said = (
        f"Stimuli were drawn in real time at {wide} x {tall} pixels ({about['gl_renderer']}) with gaitlab, "
        f"{waited} a display refreshed every {1e3 * timing.period:.3f} ms. Poses were computed for the predicted "
        f"moment of display; frames followed each other after {median(ms):.2f} ms (median, SD {pstdev(ms):.2f} ms), "
        f"and {timing.late_frames} of {timing.frames} frames were late by half a refresh or more."
    )
    if timing.uncertainties:
        source = max(timing.sources, key=lambda name: timing.sources[name])
        said += (
            f" Key presses were stamped independently of the frames (source: {source}; uncertainty "
            f"{median(timing.uncertainties):.2f} ms, median)."
        )
    return said + (
        " Times are those of buffer swaps and of the operating system's key events; the delays of the display and the "
        "keyboard themselves were not measured."
    )


def markdown(timing: Timing) -> str:
    """The certificate as a page of text that is readable as it is."""
    judged = verdict(timing)
    title = f"# Timing certificate: {timing.who}" if timing.who else "# Timing certificate"
    table = "\n".join(f"| {name} | {words} |" for name, words in rows(timing))
    reasons = "\n".join(f"- {reason}" for reason in judged.reasons) or "- Every check was passed."
    sittings = f"\n\nThe run had {timing.sittings} sittings; display and driver are those of the last." * (
        timing.sittings > 1
    )
    return (
        f"{title}\n\n**Verdict: {judged.level}.**\n\n{reasons}{sittings}\n\n| what | measured |\n|---|---|\n{table}\n\n"
        f"## For the Methods section\n\n{methods_paragraph(timing)}\n"
    )


def histogram(intervals: Sequence[float], bins: int = 24) -> str:
    """One line: how often each interval occurred, from the shortest to the longest but the rarest 1 %."""
    ordered = sorted(intervals)
    low, high = ordered[0], ordered[min(int(0.99 * len(ordered)), len(ordered) - 1)]
    width = max((high - low) / bins, 1e-5)
    counts = [0] * bins
    for interval in intervals:
        counts[min(int((interval - low) / width), bins - 1)] += 1
    most = max(counts)
    bars = "".join(" " if n == 0 else BARS[min(int(8 * n / most), 7)] for n in counts)
    return f"{low * 1e3:.2f} ms ▕{bars}▏ {(low + bins * width) * 1e3:.2f} ms and longer"


def _spread(what: str, ms: Sequence[float]) -> str:
    return f"{what}: median {median(ms):.2f} ms, 90th percentile {percentile_90(ms):.2f} ms"
