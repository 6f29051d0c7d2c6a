"""python -m stimuli.body_generator woman --out woman.glb"""

from __future__ import annotations

import argparse
from importlib.util import find_spec
from pathlib import Path

from stimuli.body_files.baking import bake
from stimuli.body_generator.assemble import build
from stimuli.body_generator.figure import Figure
from stimuli.body_generator.tables_man import MAN
from stimuli.body_generator.tables_woman import WOMAN

FIGURES: dict[str, Figure] = {"woman": WOMAN, "man": MAN}


def main() -> None:
    """Generate one body and write it as a GLB file; the same code always writes the same bytes."""
    parser = argparse.ArgumentParser(prog="python -m stimuli.body_generator", description=main.__doc__)
    parser.add_argument("name", choices=sorted(FIGURES))
    parser.add_argument("--out", type=Path, required=True, help="the GLB file to write")
    parser.add_argument("--coarseness", type=float, default=1.0, help="above 1: wider grids, fewer triangles")
    chosen = parser.parse_args()
    missing = [library for library in ("skimage", "fast_simplification") if find_spec(library) is None]
    if missing:
        parser.error(f"making bodies needs {' and '.join(missing)}; install the extra `dev` (`sh setup.sh test` does)")
    body = build(FIGURES[chosen.name], chosen.coarseness, report=print)
    data = bake(body)
    chosen.out.write_bytes(data)
    counts = [sum(len(s.triangles) for s in level) for level in body.levels]
    print(f"{chosen.out}: {len(data)} bytes, {body.stature:.3f} m, triangles with all haircuts {counts}")


if __name__ == "__main__":
    main()
