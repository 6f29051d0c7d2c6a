"""What a laboratory should know of its character though it can be drawn: sentences, each with the way out."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

from stimuli.body_files.materials import Material
from stimuli.body_files.meshes import TRIANGULAR, Primitive


def notes_on_skeleton(elsewhere: int, swapped: bool) -> tuple[str, ...]:
    """Sentences about meshes that hang on another skeleton than the person's, and about swapped sides."""
    found = []
    if elsewhere:
        found.append(
            f"{elsewhere} {_meshes(elsewhere)} left out: the person's skeleton does not move them. Export one person "
            "per file to use another."
        )
    if swapped:
        found.append(
            "its feet point backwards for what it calls left and right (a mirrored export does that); both were "
            "swapped, so that it walks ahead. Check in the picture that it is not mirrored."
        )
    return tuple(found)


def notes_on_meshes(worn: Sequence[Primitive], material: Callable[[int | None], Material]) -> tuple[str, ...]:
    """Sentences about what the drawn meshes lack, or hold that is not drawn, each once."""
    found: list[str] = []
    weightless = sum(p.weightless for p in worn)
    if weightless:
        total = sum(len(p.positions) for p in worn)
        found.append(
            f"{weightless} of {total} vertices have no joint weights; they move with the nearest vertex of their mesh "
            "that has some. Check them in the picture, or weight them and export again."
        )
    coloured = sum(p.coloured for p in worn)
    if coloured:
        found.append(
            f"{coloured} {_meshes(coloured)} painted vertex by vertex, which is not drawn; what is drawn is the "
            "material's colour and picture. Bake the paint into a picture to see it."
        )
    for primitive in worn:
        worn_material = material(primitive.material)
        found.append(worn_material.problem)
        if worn_material.picture is not None and worn_material.texture_set >= len(primitive.texture_places):
            found.append(
                f"the material {worn_material.name!r} has a picture, but a mesh that wears it does not say where on "
                f"it (TEXCOORD_{worn_material.texture_set}); its plain colour is drawn. Export it with its UV map."
            )
    return tuple(dict.fromkeys(sentence for sentence in found if sentence))


def notes_on_document(document: dict[str, Any]) -> tuple[str, ...]:
    """Sentences about what a whole file holds that is not drawn."""
    primitives = [p for mesh in document.get("meshes", []) for p in mesh["primitives"]]
    lines = sum(p.get("mode", 4) not in TRIANGULAR for p in primitives)
    shaped = sum(any(mesh.get("weights", ())) for mesh in document.get("meshes", []))
    found = []
    if lines:
        found.append(f"{lines} {_meshes(lines)} made of points or lines, which are not drawn.")
    if shaped:
        found.append(
            f"{shaped} {_meshes(shaped)} shaped by morph targets at rest, which are not applied. Apply the shape keys "
            "and export again."
        )
    return tuple(found)


def _meshes(count: int) -> str:
    return "mesh is" if count == 1 else "meshes are"
