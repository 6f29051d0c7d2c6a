"""The street of the crowds: pavements behind kerbs and rows of houses, one stretch of it. Pure arithmetic.

The stretch repeats along the street; its houses differ in width, height and tone, all pale, so that nothing there
draws the eye. Windows are painted by the shader, averaged over a pixel, so that they neither crawl nor flicker.
"""

from __future__ import annotations

from random import Random

import numpy as np

from experiment_app.scene import STREET_HALF_WIDTH

VERTEX = np.dtype([("position", "3f4"), ("normal", "3f4"), ("paint", "4f4"), ("wall", "4f4")])
"""paint: linear rgb and a kind (PAVEMENT, KERB, FRONT or PLAIN_WALL); wall: m along and up a house's front, width
of its bays, height of its floors."""

PAVEMENT, KERB, FRONT, PLAIN_WALL = 0.0, 1.0, 2.0, 3.0
STRETCH = 240.0  # m after which the houses repeat
KERB_HEIGHT = 0.12
KERB_WIDTH = 0.18
HOUSES_AT = STREET_HALF_WIDTH + 3.5  # m from the middle of the street
DEPTH = 12.0  # m of a house, behind its front

FLOORS = 4  # of every house; a bare wall above a low neighbour's roof would catch the eye

STONE = (0.330, 0.322, 0.308)
GRANITE = (0.420, 0.415, 0.405)
ROOF = (0.210, 0.205, 0.200)
PLASTERS = (
    (0.500, 0.440, 0.345),
    (0.540, 0.515, 0.460),
    (0.460, 0.375, 0.300),
    (0.400, 0.420, 0.410),
    (0.530, 0.470, 0.385),
    (0.390, 0.365, 0.340),
)


def street_side() -> np.ndarray:
    """(N,) of VERTEX: triangles of the side at +X of one stretch from z = 0; the other side is its mirror."""
    kerb, end = STREET_HALF_WIDTH, HOUSES_AT
    along, up, toward_road = (0.0, 0.0, STRETCH), (0.0, KERB_HEIGHT, 0.0), (-1.0, 0.0, 0.0)
    parts = [
        _quad((kerb, 0.0, 0.0), along, up, toward_road, (*GRANITE, KERB)),
        _quad((kerb, KERB_HEIGHT, 0.0), along, (KERB_WIDTH, 0.0, 0.0), (0.0, 1.0, 0.0), (*GRANITE, KERB)),
        _quad(
            (kerb + KERB_WIDTH, KERB_HEIGHT, 0.0),
            along,
            (end - kerb - KERB_WIDTH, 0.0, 0.0),
            (0.0, 1.0, 0.0),
            (*STONE, PAVEMENT),
        ),
    ]
    for start, width, height, tone, bays, floors in _houses():
        front = (0.0, 0.0, width), (0.0, height, 0.0)
        corner = (end, KERB_HEIGHT, start)
        far = (end, KERB_HEIGHT, start + width)
        deep = (DEPTH, 0.0, 0.0)
        parts.append(_quad(corner, *front, toward_road, (*tone, FRONT), (width / bays, height / floors)))
        parts.append(_quad(corner, deep, front[1], (0.0, 0.0, -1.0), (*tone, PLAIN_WALL)))
        parts.append(_quad(far, deep, front[1], (0.0, 0.0, 1.0), (*tone, PLAIN_WALL)))
        top = (end, KERB_HEIGHT + height, start)
        parts.append(_quad(top, front[0], deep, (0.0, 1.0, 0.0), (*ROOF, PLAIN_WALL)))
    return np.concatenate(parts)


def _houses() -> list[tuple[float, float, float, tuple[float, float, float], int, int]]:
    """Start (m), width, height, tone, bays and floors of every house of a stretch; always the same ones."""
    rng = Random("the street")
    houses = []
    start, before = 0.0, -1
    while start < STRETCH - 1e-9:
        bays = rng.choice((4, 5, 6, 7))
        width = bays * rng.uniform(2.5, 3.1)
        if STRETCH - start - width < 9.0:
            width = STRETCH - start
            bays = round(width / 2.8)
        tone = rng.choice([i for i in range(len(PLASTERS)) if i != before])
        before = tone
        houses.append((start, width, FLOORS * rng.uniform(3.15, 3.40) + 0.7, PLASTERS[tone], bays, FLOORS))
        start += width
    return houses


def _quad(
    corner: tuple[float, float, float],
    along: tuple[float, float, float],
    up: tuple[float, float, float],
    normal: tuple[float, float, float],
    paint: tuple[float, float, float, float],
    cells: tuple[float, float] = (1.0, 1.0),
) -> np.ndarray:
    """Two triangles, counter-clockwise when seen from where the normal points; cells: m, of bays and floors."""
    u, v = np.array(along), np.array(up)
    places = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 0.0), (1.0, 1.0), (0.0, 1.0)]
    if np.dot(np.cross(u, v), normal) < 0.0:
        places = places[::-1]
    quad = np.zeros(6, VERTEX)
    for vertex, (a, b) in zip(quad, places, strict=True):
        vertex["position"] = np.array(corner) + a * u + b * v
        vertex["wall"] = np.array([a * np.linalg.norm(u), b * np.linalg.norm(v), *cells])
    quad["normal"], quad["paint"] = normal, paint
    return quad
