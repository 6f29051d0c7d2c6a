"""How long it takes to make an actor of 25 clips of 10 s, as a metronome's grid of captures is."""

from __future__ import annotations

import shutil
import tempfile
from pathlib import Path

import numpy as np

from stimuli.importing.folder import import_folder
from tests.benchmarks.measuring import fastest, row
from tests.stimuli.limping import limping_actor, write_bvh

CLIPS, SECONDS, LIMIT = 25, 10.0, 5.0
ABOUT = "height: {}\nweight: 70\nage: 30\nlicence: made\nsource: made\ncomplete: true\nsex: {}\n"
CAPTURE = Path(__file__).parents[2].parent / "shared/mocap/c3d/schreiber-moissenet/2014019_C4_05.c3d"


def importing() -> None:
    """Prints the CPU time of this thread of whole imports; of marker files only where the captures are at hand."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name) / "bvh"
        folder.mkdir()
        (folder / "actor.yaml").write_text(ABOUT.format(1.78, "male"))
        write_bvh(limping_actor(), 1.0, 96.0, folder / "w0.bvh", SECONDS)
        _imported(folder, "BVH")
        if CAPTURE.is_file():
            markers = Path(name) / "c3d"
            markers.mkdir()
            (markers / "actor.yaml").write_text(ABOUT.format(1.755, "female"))
            _write_long_c3d(markers / "w0.c3d")
            _imported(markers, "C3D, 52 markers at 100 Hz")


def _imported(folder: Path, what: str) -> None:
    (first,) = folder.glob("w0.*")
    for index in range(1, CLIPS):
        shutil.copyfile(first, folder / f"w{index}{first.suffix}")
    library = folder / "library"
    seconds = fastest(lambda: import_folder(folder, "many", library, replace=True), 3)
    row(f"import of {CLIPS} clips of {SECONDS:g} s, {what}", seconds, LIMIT)


def _write_long_c3d(path: Path) -> None:
    """One captured stride over and over, travelling on, for SECONDS."""
    import ezc3d

    content = ezc3d.c3d(str(CAPTURE))
    points, point = content["data"]["points"][:3], content["parameters"]["POINT"]
    first, last = 57, 166  # right foot strikes
    travel = np.nanmean(points[..., last] - points[..., first], axis=1) * [1.0, 1.0, 0.0]
    count = round(SECONDS * 100)
    strides = [points[..., first:last] + travel[:, None, None] * n for n in range(count // (last - first) + 1)]
    long = ezc3d.c3d()
    for key in ("LABELS", "UNITS", "RATE"):
        long["parameters"]["POINT"][key]["value"] = point[key]["value"]
    walked = np.concatenate(strides, axis=2)[..., :count]
    long["data"]["points"] = np.concatenate([walked, np.ones((1, *walked.shape[1:]))])
    long.write(str(path))
