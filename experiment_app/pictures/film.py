"""Pictures and films from off-screen pixels: frames, strips, and films of a condition at an exact frame rate."""

from __future__ import annotations

import os
from collections.abc import Iterator, Sequence
from dataclasses import replace
from fractions import Fraction
from itertools import chain
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from experiment_app.errors import RunError, UsageError
from experiment_app.scene import Scene
from experiment_app.staging import view_scene
from protocols.events import Shown
from protocols.orders.design import Trial
from protocols.parts import Level
from protocols.plan import Plan, TrialStep
from protocols.study import Study

Pixels = NDArray[np.uint8]

BT709, LIMITED = 1, 1
"""Matrix, primaries and transfer of high-definition video, and the range of its codes, as FFmpeg numbers them."""


def save_picture(pixels: Pixels, path: Path) -> None:
    """One frame, (height, width, 3) uint8, as PNG."""
    Image.fromarray(pixels).save(path)


def save_strip(frames: Sequence[Pixels], path: Path, count: int = 8, share: float = 0.42) -> None:
    """`count` frames evenly spaced over the film, side by side, each the middle `share` of its width, as PNG."""
    chosen = [frames[round(i * (len(frames) - 1) / max(count - 1, 1))] for i in range(count)]
    width = chosen[0].shape[1]
    margin = int(width * (1.0 - share) / 2.0)
    Image.fromarray(np.hstack([frame[:, margin : width - margin] for frame in chosen])).save(path)


def save_film(frames: Sequence[Pixels], frame_rate: float, path: Path) -> None:
    """A film as animated WebP; every frame lasts the nearest whole number of milliseconds."""
    pictures = [Image.fromarray(frame) for frame in frames]
    duration = round(1000.0 / frame_rate)
    pictures[0].save(path, save_all=True, append_images=pictures[1:], duration=duration, loop=0, quality=80)


def condition_of(study: Study, given: Sequence[str]) -> Trial:
    """The trial of a condition written as factor=level; a factor that is not given takes its first level.

    Factors that the program assigns to participants may be given like those of the design.
    """
    group = {name: study.participants.between[name] for name in study.participants.assigned}
    known: dict[str, Sequence[Level]] = {**study.factors, **group}
    levels = {factor: choices[0] for factor, choices in known.items()}
    for text in given:
        factor, equals, wanted = text.partition("=")
        if not equals or factor not in levels:
            raise UsageError(f"--condition {text}: write factor=level; the factors are {', '.join(levels)}.")
        found = [level for level in known[factor] if _same(level, wanted)]
        if not found:
            listed = ", ".join(map(str, known[factor]))
            raise UsageError(f"--condition {text}: the levels of {factor} are {listed}.")
        levels[factor] = found[0]
    own = {factor: levels[factor] for factor in study.factors}
    return Trial(1, 1, 1, own, group={name: str(levels[name]) for name in group})


def walking(study: Study, trial: Trial, seconds: float, lod: int | None = None) -> Scene:
    """The scene of a condition so many seconds after its onset, nothing pressed; alternatives as in the file."""
    order = tuple(study.task.walks(study.stimulus, trial.values))
    begun = Plan(study, (), study.task.keys_for(1), 1).begin(TrialStep(trial, order))
    scene = view_scene(study, begun.handle(Shown(0.0)).advance(seconds).view, trial.values)
    return scene if lod is None else replace(scene, lod=lod)


def film_scenes(scenes: Iterator[Scene], size: tuple[int, int], samples: int = 4) -> Iterator[Pixels]:
    """The pixels of every scene, drawn off-screen."""
    from experiment_app.render.renderer import Renderer
    from experiment_app.walkers import drawn_walkers
    from experiment_app.windows.offscreen import offscreen_context

    context = offscreen_context()
    target = context.simple_framebuffer(size)
    renderer = Renderer(context, size, 1.0, samples)
    try:
        for scene in scenes:
            renderer.draw(scene, drawn_walkers(scene), target)
            yield renderer.read_pixels(target)
    finally:
        renderer.release()
        context.release()


def _refuse_place(path: Path) -> None:
    """Raises UsageError where no film can be written, before anything is drawn."""
    if path.suffix and path.is_dir():
        raise UsageError(f"{path} is a folder; name a film in it, as {path / 'clip.mp4'}.")
    if path.suffix and not (path.parent.is_dir() and os.access(path.parent, os.W_OK)):
        why = "cannot be written to" if path.parent.is_dir() else "is not there"
        raise UsageError(f"{path}: the folder {path.parent} {why}; make it, or name another.")


def write_film(frames: Iterator[Pixels], rate: Fraction, path: Path) -> str:
    """Writes a film at exactly `rate` frames/s, reads its frame times back, and says what was verified.

    The name's ending decides: .mp4, .mkv, .mov or .webm (needs PyAV), .webp, or none for a folder of PNG pictures.
    """
    kind = path.suffix.lower()
    _refuse_place(path)
    if kind in (".mp4", ".mkv", ".mov", ".webm"):
        return _video(frames, rate, path)
    if kind == ".webp":
        return _webp(list(frames), rate, path)
    if kind:
        raise UsageError(f"{path}: films end in .mp4, .mkv, .mov, .webm or .webp; no ending is a folder of PNGs.")
    return _sequence(frames, rate, path)


def _video(frames: Iterator[Pixels], rate: Fraction, path: Path) -> str:
    try:
        import av
    except ImportError:
        raise UsageError(
            f"--out {path}: this needs PyAV (pip install 'gaitlab[video]'); without it write .webp or a folder of PNGs."
        ) from None
    first = next(frames)
    height, width = first.shape[:2]
    if width % 2 or height % 2:
        raise UsageError(f"{path}: pictures of {width}x{height} pixels are no video, which needs even numbers.")
    count = 0
    with av.open(str(path), "w") as file:
        stream = file.add_stream("libvpx-vp9" if path.suffix.lower() == ".webm" else "libx264", rate=rate)
        stream.pix_fmt = "yuv420p"
        stream.time_base = 1 / rate
        stream.options = {"crf": "16"}
        # said in the file, because players otherwise guess the matrix from the picture's size, and colours shift
        stream.codec_context.colorspace = stream.codec_context.color_primaries = stream.codec_context.color_trc = BT709
        stream.codec_context.color_range = LIMITED
        stream.height, stream.width = height, width
        for pixels in chain([first], frames):
            coloured = av.VideoFrame.from_ndarray(pixels, format="rgb24")
            frame = coloured.reformat(format="yuv420p", dst_colorspace=BT709, dst_color_range=LIMITED)
            frame.pts, frame.time_base = count, 1 / rate
            for packet in stream.encode(frame):
                file.mux(packet)
            count += 1
        for packet in stream.encode():
            file.mux(packet)
    with av.open(str(path)) as file:
        times = [f.pts * (f.time_base or 1 / rate) for f in file.decode(video=0) if f.pts is not None]
    if len(times) != count:
        raise RunError(f"{path}: {count} frames were written but {len(times)} are in the file.")
    worst = max((abs(time - times[0] - number / rate) for number, time in enumerate(times)), default=Fraction(0))
    # containers such as WebM count whole milliseconds, so a frame can stand half of one beside its time
    if worst > Fraction(1, 1800):
        raise RunError(f"{path}: a frame stands {float(worst) * 1e3:.3f} ms beside its time; use another frame rate.")
    exact = "every frame exactly at its time" if worst == 0 else f"every frame within {float(worst) * 1e6:.1f} µs"
    return f"{count} frames at {float(rate):g}/s, read back: {exact}"


def _webp(frames: Sequence[Pixels], rate: Fraction, path: Path) -> str:
    """Animated WebP counts milliseconds; their rounding does not add up over the film."""
    ends = [round(1000 * (number + 1) / rate) for number in range(len(frames))]
    durations = [end - start for start, end in zip([0, *ends], ends, strict=False)]
    pictures = [Image.fromarray(frame) for frame in frames]
    pictures[0].save(path, save_all=True, append_images=pictures[1:], duration=durations, loop=0, quality=85)
    with Image.open(path) as film:
        read = []
        for number in range(getattr(film, "n_frames", 1)):
            film.seek(number)
            film.load()
            read.append(film.info.get("duration"))
    if sum(filter(None, read)) != ends[-1]:
        raise RunError(f"{path}: the film lasts {sum(filter(None, read))} ms instead of {ends[-1]}.")
    return f"{len(frames)} frames at {float(rate):g}/s, read back: every frame within 0.5 ms of its time"


def _sequence(frames: Iterator[Pixels], rate: Fraction, folder: Path) -> str:
    if folder.exists() and any(folder.iterdir()):
        raise UsageError(f"--out {folder}: the folder is not empty; choose another.")
    folder.mkdir(parents=True, exist_ok=True)
    rows = ["file,time_s"]
    for number, pixels in enumerate(frames):
        name = f"frame-{number:05d}.png"
        save_picture(pixels, folder / name)
        rows.append(f"{name},{float(number / rate):.9f}")
    (folder / "frames.csv").write_text("\n".join(rows) + "\n", encoding="utf-8")
    return f"{len(rows) - 1} pictures for {float(rate):g}/s, times in frames.csv"


def _same(level: str | float, text: str) -> bool:
    try:
        return float(level) == float(text)
    except ValueError:
        return str(level) == text
