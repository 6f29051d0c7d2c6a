"""What a body is gathered from: triangles of one material with all that is drawn of them."""

from __future__ import annotations

from dataclasses import dataclass

from stimuli.body_generator.polygons import Mesh
from stimuli.skeleton import Floats


@dataclass(frozen=True, eq=False)
class Piece:
    """Triangles in one material: mesh (cm, in the figure), normals (V, 3) and shade (V,), 1 under the open sky."""

    material: str
    mesh: Mesh
    normals: Floats
    shade: Floats
