"""How long the ways of making a walk take: a pose in a batch, a new speed, one person's preprocessing."""

from __future__ import annotations

import time

import numpy as np

from stimuli.actors import load_actor
from stimuli.methods.actor_walks import actor_speeds, actor_walk, actor_walks
from stimuli.methods.made import made_walk
from stimuli.methods.pca import pca_walk
from stimuli.methods.recipe import Making
from stimuli.poulaine.engine import poulaine_engine
from tests.benchmarks.measuring import fastest, row

WALKERS = 1000


def methods() -> None:
    """Prints the figures of the PCA engine and the poulaine (Glardon 2004: 800 µs a pose, 2 s a person)."""
    actor = load_actor("F2")
    begun = time.perf_counter()
    walks = actor_walks(actor, actor_speeds(actor))
    engine = pca_walk(walks)
    row("PCA: preprocessing of one person, from drawn walks (wall)", time.perf_counter() - begun, 1.0)
    begun = time.perf_counter()
    poulaine = poulaine_engine(actor_walk(actor, 1.06))
    row("poulaine: preprocessing of one person (wall)", time.perf_counter() - begun, 1.0)
    rng = np.random.default_rng(1)
    speeds, phases, legs = rng.uniform(0.8, 1.4, WALKERS), rng.random(WALKERS), rng.uniform(0.7, 1.0, WALKERS)
    row("PCA: one of 1000 poses, own speed and leg length", _each(lambda: engine.poses(speeds, phases, legs)), 20e-6)
    row("poulaine: one of 1000 poses, own speed and leg", _each(lambda: poulaine.poses(speeds, phases, legs)), 20e-6)
    made_walk(actor, Making("pca"), 1.0)
    asked = iter(np.linspace(0.9, 1.01, 10_000))
    row(
        "PCA: a walker's new speed in a scene",
        fastest(lambda: made_walk(actor, Making("pca"), next(asked)), 5, 20),
        4e-3,
    )
    row(
        "poulaine: a walker's new speed in a scene",
        fastest(lambda: made_walk(actor, Making("poulaine", source_speed=1.06), next(asked)), 5, 20),
        16e-3,
    )


def _each(batch) -> float:  # type: ignore[no-untyped-def]
    return fastest(batch, 9, 10) / WALKERS
