"""The commands that draw off-screen: films of a condition, and the pictures of the documentation."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from experiment_app.commands.arguments import StudyArgument, frame_rate, picture_size
from experiment_app.errors import UsageError
from experiment_app.terminal import out, with_progress


def film(
    study: StudyArgument,
    *,
    condition: Annotated[
        list[str] | None,
        Parameter(
            negative="", consume_multiple=True, help="factor=level, as actor=F1 speed=1.0; left out: the first level."
        ),
    ] = None,
    seconds: Annotated[float, Parameter(help="Length of the film, s.")] = 4.0,
    rate: Annotated[str, Parameter(help="Frames per second, exactly; 60, 59.94 or 60000/1001.")] = "60",
    size: Annotated[str, Parameter(help="Size of the film; even numbers for videos.")] = "1280x720",
    lod: Annotated[int | None, Parameter(help="Level of detail for every frame, 0 the finest.")] = None,
    path: Annotated[
        Path, Parameter(name="--out", help="clip.mp4 (needs PyAV), clip.webp, or a folder for PNG pictures.")
    ] = Path("clip.mp4"),
) -> int:
    """Film a condition of a study off-screen at an exact frame rate; the frame times are read back and verified."""
    from experiment_app.checking.check import checked_study
    from experiment_app.pictures.film import condition_of, film_scenes, walking, write_film

    per_second = frame_rate(rate)
    if not 0 < seconds <= 3600:
        raise UsageError(f"--seconds {seconds:g}: a film lasts up to an hour.")
    width, height = picture_size(size)
    if path.suffix.lower() in (".mp4", ".mkv", ".mov", ".webm") and (width % 2 or height % 2):
        raise UsageError(f"--size {size}: videos need an even width and height.")
    read = checked_study(study).study
    trial = condition_of(read, condition or ())
    count = max(round(seconds * per_second), 1)
    scenes = (walking(read, trial, float(number / per_second), lod) for number in range(count))
    frames = with_progress(film_scenes(scenes, (width, height)), count, "Drawing")
    said = write_film(iter(frames), per_second, path)
    out.print(f"{path}: {said}", markup=False)
    return 0


def gallery(
    *, folder: Annotated[Path, Parameter(name="--out", help="Folder for the pictures.")] = Path("docs/images")
) -> int:
    """Make every picture of the documentation's gallery page."""
    from experiment_app.pictures.gallery import make_gallery

    for path in make_gallery(folder):
        out.print(f"  {path}", markup=False)
    return 0
