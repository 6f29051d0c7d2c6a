"""One step of Newton's method for the pose of a body that fits its markers, in time linear in its joints.

The cost of a small shift x of a joint and a small turn w of its segment (rad, about the world's axes) is, to second
order,

    slope.x + x.S x / 2 + x.M w - spin.w + w.I w / 2.

From the limbs to the root, each joint's turn is answered by its shift, w = I^-1 (spin - M^T x), and with that its cost
is one of x alone, which the parent's shift and turn decide: as in the articulated-body algorithm (R. Featherstone,
Int. J. Robotics Res. 2, 1983). From the root back to the limbs the answers are then carried out.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from stimuli.motion_files.marked_body import Body, Wanted

Floats = NDArray[np.floating]

EYE = np.eye(3)[:, :, None]


@dataclass(frozen=True, eq=False)
class _Cost:
    """The cost about a pose to second order, per joint; arrays change as what hangs on a joint is added to it.

    slope: (J, 3, T) m; stiffness S: (J, 3, 3, T) 1; mixed M: (J, 3, 3, T) m
    product: (J, 3, 3, T) m², targets times levers, which gives the spin and the turn's own part of I
    inertia: (J, 3, 3, T) m², the rest of I
    """

    slope: Floats
    stiffness: Floats
    mixed: Floats
    product: Floats
    inertia: Floats

    @classmethod
    def of(cls, wanted: Wanted, turns: Floats, there: Floats, damping: Floats) -> _Cost:
        """Of each joint's own markers; damping (T,) m² resists every turn."""
        lever = np.einsum("jikt,jkt->jit", turns, wanted.place)
        product = wanted.product - there[:, :, None] * wanted.place[:, None]
        return cls(
            slope=wanted.weight[:, None] * there + lever - wanted.target,
            stiffness=wanted.weight[:, None, None] * EYE,
            mixed=_cross(lever[:, None], np.broadcast_to(EYE, (*product.shape[:3], 1)), axis=2),
            product=np.einsum("jikt,jlkt->jilt", product, turns),
            inertia=np.broadcast_to(damping * EYE, product.shape).copy(),
        )

    def answered(self, level: slice) -> tuple[Floats, Floats, NDArray[np.bool_]]:
        """The best turns of a level's segments, rest - answer x, and where (T,) they are; leaves their cost as of x.

        rest: (n, 3, T) rad; answer: (n, 3, 3, T) rad/m
        """
        a, mixed = self.product[level], self.mixed[level]
        spin = np.stack([a[:, 2, 1] - a[:, 1, 2], a[:, 0, 2] - a[:, 2, 0], a[:, 1, 0] - a[:, 0, 1]], axis=1)
        own = np.einsum("niit->nt", a)[:, None, None] * EYE - 0.5 * (a + np.swapaxes(a, 1, 2))
        inverse, convex = _inverse(self.inertia[level] + own)
        rest = np.einsum("nikt,nkt->nit", inverse, spin)
        answer = np.einsum("nikt,nlkt->nilt", inverse, mixed)
        self.slope[level] += np.einsum("nikt,nkt->nit", mixed, rest)
        self.stiffness[level] -= np.einsum("nikt,nklt->nilt", mixed, answer)
        return rest, answer, np.asarray(convex.all(axis=0))

    def carry(self, joint: int, parent: int, arm: Floats) -> None:
        """Adds an answered joint to its parent, from which it is away by an arm (3, T) m."""
        self.slope[parent] += self.slope[joint]
        self.stiffness[parent] += self.stiffness[joint]
        pulled = _cross(arm[None], self.stiffness[joint], axis=1)
        self.mixed[parent] += pulled
        self.inertia[parent] += _cross(arm[:, None], pulled, axis=0)
        self.product[parent] -= self.slope[joint][:, None] * arm[None]


def newton_step(
    body: Body, wanted: Wanted, turns: Floats, there: Floats, damping: Floats
) -> tuple[Floats, Floats, NDArray[np.bool_]]:
    """Rotations (J, 3, 3, T) and places (J, 3, T) m one step on, and whether (T,) the cost is convex where they were.

    body: joints level by level; turns, there: where they are; damping: (T,) m², how much every turn is resisted
    """
    cost = _Cost.of(wanted, turns, there, damping)
    levels = [slice(joints[0], joints[-1] + 1) for joints in body.levels]
    answers, convex = [], np.ones(len(damping), dtype=bool)
    for level in reversed(levels):
        rest, answer, sound = cost.answered(level)
        answers.append((rest, answer))
        convex &= sound
        for joint in range(level.start, level.stop) if level.start else ():
            parent = body.parents[joint]
            cost.carry(joint, parent, there[joint] - there[parent])
    inverse, sound = _inverse(cost.stiffness[:1])
    moved = np.array(there)
    moved[0] -= np.einsum("ikt,kt->it", inverse[0], cost.slope[0])
    turned = np.empty_like(turns)
    for level, (rest, answer) in zip(levels, reversed(answers), strict=True):
        for joint in range(level.start, level.stop) if level.start else ():
            parent = body.parents[joint]
            moved[joint] = moved[parent] + np.einsum("ijt,j->it", turned[parent], body.offsets[joint])
        turn = rest - np.einsum("nikt,nkt->nit", answer, moved[level] - there[level])
        turned[level] = np.einsum("iknt,nklt->nilt", _cayley(*np.moveaxis(0.5 * turn, 1, 0)), turns[level])
    return turned, moved, convex & sound[0]


def _cross(first: Floats, second: Floats, axis: int) -> Floats:
    """Vector products along an axis; in a tenth of the calls that numpy.cross makes of its own."""
    a, b = np.moveaxis(first, axis, 0), np.moveaxis(second, axis, 0)
    return np.stack([a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]], axis=axis)


def _inverse(symmetric: Floats) -> tuple[Floats, NDArray[np.bool_]]:
    """(n, 3, 3, T) inverses of symmetric matrices, and (n, T) which are positive definite; 0 for the others."""
    xx, yy, zz = (symmetric[:, i, i] for i in range(3))
    xy, xz, yz = symmetric[:, 0, 1], symmetric[:, 0, 2], symmetric[:, 1, 2]
    inverse = np.empty_like(symmetric)
    inverse[:, 0, 0], inverse[:, 1, 1], inverse[:, 2, 2] = yy * zz - yz * yz, xx * zz - xz * xz, xx * yy - xy * xy
    inverse[:, 0, 1] = inverse[:, 1, 0] = xz * yz - xy * zz
    inverse[:, 0, 2] = inverse[:, 2, 0] = xy * yz - xz * yy
    inverse[:, 1, 2] = inverse[:, 2, 1] = xy * xz - xx * yz
    determinant = xx * inverse[:, 0, 0] + xy * inverse[:, 0, 1] + xz * inverse[:, 0, 2]
    convex = (xx > 0) & (inverse[:, 2, 2] > 0) & (determinant > 1e-12 * np.abs(xx * yy * zz))
    return inverse * np.divide(1.0, determinant, where=convex, out=np.zeros_like(xx))[:, None, None], convex


def _cayley(x: Floats, y: Floats, z: Floats) -> Floats:
    """(3, 3, ...) rotations by twice x, y, z (rad): right to second order, exactly orthogonal (Cayley)."""
    size = 2.0 / (1.0 + x * x + y * y + z * z)
    turn = np.empty((3, 3, *x.shape))
    turn[0, 0], turn[1, 1], turn[2, 2] = (1.0 - size * (p * p + q * q) for p, q in ((y, z), (x, z), (x, y)))
    turn[0, 1], turn[1, 0] = size * (x * y - z), size * (x * y + z)
    turn[0, 2], turn[2, 0] = size * (x * z + y), size * (x * z - y)
    turn[1, 2], turn[2, 1] = size * (y * z - x), size * (y * z + x)
    return turn
