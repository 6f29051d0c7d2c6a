"""What of a study was imported on this computer (actors, bodies, styles), and whether a run showed the same.

A name means a file in this user's library, and another computer may have another file of that name, or none.
"""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from pathlib import Path

from protocols.mistakes.consistency import shown_walks
from protocols.stimulus import Walk
from protocols.study import Study


def imported(study: Study) -> dict[str, str]:
    """Kind and name, as `actor anna`, to the SHA-256 of its file, for everything imported that the study shows."""
    return {name: hashlib.sha256(path.read_bytes()).hexdigest() for name, path in sorted(_files(study).items())}


def other_imports(then: Mapping[str, str], study: Study) -> list[str]:
    """Sentences on what is another file here than in a run, or missing; then: what the run's header holds."""
    now = imported(study)
    return [
        f"{name} is another here than the one that was shown then (its file differs)"
        if name in now
        else f"{name}, which was imported then, is not on this computer"
        for name, sha256 in then.items()
        if now.get(name) != sha256
    ]


def _files(study: Study) -> dict[str, Path]:
    from stimuli import actor_library
    from stimuli.bodies import imported_bodies
    from stimuli.methods import styles

    walks = [walk for walk in shown_walks(study) if walk.crowd is None]
    shown = {(kind, name) for walk in walks for kind, name in _named(walk)}
    return {
        f"{kind} {name}": path_of(name)
        for kind, known, path_of in (
            ("actor", actor_library.imported_names(), actor_library.path_of),
            ("body", imported_bodies.imported_names(), imported_bodies.path_of),
            ("style", styles.imported_styles(), styles.path_of),
        )
        for name in known
        if (kind, name) in shown
    }


def _named(walk: Walk) -> tuple[tuple[str, str | None], ...]:
    return ("actor", walk.actor), ("body", walk.body), ("style", walk.making.style)
