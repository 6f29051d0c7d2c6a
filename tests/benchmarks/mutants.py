"""`python -m tests.benchmarks.mutants 10000`: that many spoiled study files, journals, motion files and bodies.

Each is accepted or refused in a sentence, a study file with its line and column; a traceback ends the run.
"""

from __future__ import annotations

import sys
import tempfile
import time
from collections import Counter
from collections.abc import Callable, Iterator
from importlib.resources import files
from pathlib import Path
from random import Random

from tests.protocols.studies import short
from tests.robustness.judging import journal_verdict, spoiled_files, spoiled_studies
from tests.robustness.mutation import spoiled_bytes


def main() -> None:
    """Spoils and prints how many of each kind were accepted and refused."""
    count = int(sys.argv[1]) if len(sys.argv) > 1 else 10_000
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        studies = folder / "studies"  # a YAML file beside a motion file would be taken for its settings
        studies.mkdir()
        told("study files", (verdict for _, _, verdict in spoiled_studies(short().text, studies, count)))
        told("journals", journals(folder, count // 20))
        for kind, path, read, refusals in samples(folder):
            told(kind, (verdict for _, verdict in spoiled_files(path, read, refusals, count // 20)))


def told(kind: str, verdicts: Iterator[str]) -> None:
    """One line: how many were spoiled, and what became of them."""
    begun = time.perf_counter()
    found = Counter("refused" if "refused" in verdict else "accepted" for verdict in verdicts)
    took = time.perf_counter() - begun
    print(
        f"{kind:<14}{found.total():6} spoiled: {found['refused']:6} refused, {found['accepted']:5} accepted, "
        f"0 tracebacks, {took:.0f} s",
        flush=True,
    )


def journals(folder: Path, count: int) -> Iterator[str]:
    """Verdicts on spoiled journals of one finished run."""
    from tests.experiment_app.sessions import opened, play

    run = opened(folder / "data")
    play(run)
    content = run.journal.path.read_bytes()
    for number in range(count):
        run.journal.path.write_bytes(spoiled_bytes(content, Random(f"journals/{number}")))
        yield journal_verdict(folder / "data", "walk_ratio", "P01", folder / "out")


SHARED = Path(__file__).parents[2].parent / "shared"

Sample = tuple[str, Path, Callable[[Path], object], tuple[type[Exception], ...]]


def samples(folder: Path) -> Iterator[Sample]:
    """One file of every kind that people bring, written into `folder`, with its reader and how it refuses.

    Captures and characters of others are taken from beside the checkout, where they are there.
    """
    from stimuli.body_files.baked import read_baked
    from stimuli.body_files.errors import BodyError
    from stimuli.body_files.imported import import_body
    from stimuli.motion_files.errors import MotionFileError
    from stimuli.motion_files.reading import read_clip

    shipped = files("stimuli").joinpath("data", "bodies", "woman.glb").read_bytes()
    (folder / "woman.glb").write_bytes(shipped)
    yield "body", folder / "woman.glb", lambda path: read_baked(path.read_bytes(), "woman"), (BodyError,)
    for kind, pattern, read, refusals in (
        ("BVH", "mocap/bvh/*/*.bvh", read_clip, (MotionFileError,)),
        ("C3D", "mocap/c3d/*/*.c3d", read_clip, (MotionFileError,)),
        ("MVNX", "mocap/mvnx/*.mvnx", read_clip, (MotionFileError,)),
        ("glTF motion", "gltf/RiggedSimple.glb", read_clip, (MotionFileError,)),
        ("character", "gltf/RiggedFigure.glb", import_body, (BodyError,)),
    ):
        for path in sorted(SHARED.glob(pattern), key=lambda path: path.stat().st_size)[:1]:
            copy = folder / path.name
            copy.write_bytes(path.read_bytes())
            read(copy)  # an unspoiled one is accepted
            yield kind, copy, read, refusals


if __name__ == "__main__":
    main()
