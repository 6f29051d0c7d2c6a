"""The pose of a skeleton that fits all markers best, many frames at a time. Knows joints and points; no label, no file.

Global optimisation (Lu & O'Connor, J. Biomech. 32, 1999), solved joint by joint from the limbs to the root: with all
else held, the best rotation of one segment maximises tr(R^T A) for a covariance A of what it carries (Kabsch, Acta
Cryst. A32, 1976), and what hangs on it counts as one heavy marker at the next joint. The first sweep takes the maximum
by singular values, later ones by one step of Newton's method from where the joint is, which is as good and ten times
as fast. A long recording is solved for every STRIDE-th frame first; the others start between their neighbours.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields

import numpy as np
from numpy.typing import NDArray

from stimuli.rotations import continuous, from_matrix, normalise, to_matrix

Floats = NDArray[np.floating]

CENTRE_WEIGHT = 1.0  # a joint centre counts like one marker
HOLD = 1e-3  # m²: how weakly a segment is held to its first guess, which decides only what no marker tells
SWEEPS = 60
STILL = 6e-5  # m: sweeps end when no joint moves more; joints are then within 0.1 mm on average of where they would end
STRIDE = 6  # frames, at most 0.06 s in a recording of 100 Hz
LONG = 10 * STRIDE  # frames from which it is worth the trouble


@dataclass(frozen=True, eq=False)
class Body:
    """Joints with their markers, parents before children.

    offsets: (J, 3) m from the parent; local[j]: (m, 3) m, markers in the joint's axes
    """

    parents: tuple[int, ...]
    offsets: Floats
    local: tuple[Floats, ...]

    @property
    def levels(self) -> tuple[NDArray[np.intp], ...]:
        """Joints by their depth below the root, the root first."""
        depth: list[int] = []
        for parent in self.parents:
            depth.append(0 if parent < 0 else depth[parent] + 1)
        return tuple(np.flatnonzero(np.equal(depth, level)) for level in range(max(depth) + 1))

    def sorted(self) -> tuple[Body, NDArray[np.intp]]:
        """The same body with its joints level by level, and their order."""
        order = np.concatenate(self.levels)
        rank = np.argsort(order)
        parents = tuple(-1 if self.parents[joint] < 0 else int(rank[self.parents[joint]]) for joint in order)
        return Body(parents, self.offsets[order], tuple(self.local[joint] for joint in order)), order


@dataclass(frozen=True, eq=False)
class Wanted:
    """Where a body's parts should be, over T frames.

    centres: (J, 3, T) m, joint centres
    guess:   (J, 3, 3, T) axes of each joint to begin with
    Sums over a joint's seen markers of
    seen:    (J, T) 1
    target:  (J, 3, T) m, their place in the world
    place:   (J, 3, T) m, their place in the joint's axes
    product: (J, 3, 3, T) m², the one times the other
    """

    centres: Floats
    guess: Floats
    seen: Floats
    target: Floats
    place: Floats
    product: Floats

    @classmethod
    def of(cls, body: Body, targets: Sequence[Floats | None], centres: Floats, guess: Floats) -> Wanted:
        """targets: per joint (T, m, 3) m, NaN where not seen; centres (T, J, 3); guess (T, J, 3, 3)."""
        sums: tuple[list[Floats], ...] = ([], [], [], [])
        for local, target in zip(body.local, targets, strict=True):
            points = np.zeros((len(centres), 0, 3)) if target is None else target
            seen = np.asarray(np.all(np.isfinite(points), axis=-1), dtype=float)
            points = np.where(seen[..., None] > 0, points, 0.0)
            sums[0].append(seen.sum(axis=1))
            sums[1].append(points.sum(axis=1).T)
            sums[2].append(np.einsum("tm,mi->it", seen, local))
            sums[3].append(np.einsum("tmi,mj->ijt", points, local))
        last = (np.ascontiguousarray(np.moveaxis(values, 0, -1)) for values in (centres, guess))
        return cls(*last, *(np.array(values) for values in sums))

    def frames(self, chosen: NDArray[np.intp]) -> Wanted:
        """Of some of the frames."""
        return Wanted(*(getattr(self, field.name)[..., chosen] for field in fields(self)))


def fitted(body: Body, targets: Sequence[Floats | None], centres: Floats, guess: Floats) -> tuple[Floats, Floats]:
    """World rotations (T, J, 3, 3) of the joints and the root's path (T, 3) m; arguments as in Wanted.of."""
    level, order = body.sorted()
    wanted = Wanted.of(level, [targets[joint] for joint in order], centres[:, order], guess[:, order])
    count = len(centres)
    turns, root = wanted.guess, wanted.centres[0]
    if count >= LONG:
        coarse = np.unique(np.append(np.arange(0, count, STRIDE), count - 1))
        few = wanted.frames(coarse)
        turns, root = _swept(level, few, few.guess, few.centres[0], first=True)
        turns, root = _between(turns, root, coarse, count)
    turns, root = _swept(level, wanted, turns, root, first=count < LONG)
    rotations = np.empty((count, len(order), 3, 3))
    rotations[:, order] = np.moveaxis(turns, -1, 0)
    return rotations, root.T


def places(body: Body, rotations: Floats, root: Floats) -> Floats:
    """(T, J, 3) m: joints by forward kinematics from rotations (T, J, 3, 3) and root (T, 3)."""
    return np.moveaxis(_places(body, np.moveaxis(rotations, 0, -1), root.T), -1, 0)


def nearest_rotation(matrices: Floats) -> Floats:
    """(..., 3, 3) the rotations nearest to matrices in the least squares sense."""
    u, _, v = np.linalg.svd(matrices)
    u = u.copy()
    u[..., :, 2] *= np.where(np.linalg.det(u @ v) < 0, -1.0, 1.0)[..., None]
    return u @ v


def _swept(body: Body, wanted: Wanted, rotations: Floats, root: Floats, first: bool) -> tuple[Floats, Floats]:
    """Rotations (J, 3, 3, T) and root (3, T) after sweeps until nothing moves; first: by singular values at first."""
    rotations, root = np.array(rotations), np.array(root)
    moving = np.arange(root.shape[1])  # frames that are swept; the others are still
    turns, path, there = rotations, root, _places(body, rotations, root)
    for sweep in range(SWEEPS):
        pull, weight = _sweep(body, wanted, turns, there, whole=first and sweep == 0)
        path = path + pull / weight
        before, there = there, _places(body, turns, path)
        restless = np.max(np.abs(there - before), axis=(0, 1)) >= STILL
        if restless.mean() > 0.75:
            continue
        rotations[..., moving], root[:, moving] = turns, path
        if not restless.any():
            break
        moving, wanted = moving[restless], wanted.frames(np.flatnonzero(restless))
        turns, path, there = turns[..., restless], path[:, restless], there[..., restless]
    rotations[..., moving], root[:, moving] = turns, path
    return rotations, root


def _sweep(body: Body, wanted: Wanted, turns: Floats, there: Floats, whole: bool) -> tuple[Floats, Floats]:
    """Turns every joint once, from the limbs to the root, in place; the pull (3, T) on the root and its weight (T,).

    turns (J, 3, 3, T), there (J, 3, T) m. A joint's pull is the sum of target minus place over its own markers, its
    centre and all that hangs on it.
    """
    pulls = CENTRE_WEIGHT * (wanted.centres - there) + wanted.target - wanted.seen[:, None] * there
    weights = CENTRE_WEIGHT + wanted.seen
    covariances = HOLD * wanted.guess + wanted.product - there[:, :, None] * wanted.place[:, None]
    for joints in reversed(body.levels):
        level = slice(joints[0], joints[-1] + 1)
        turned = _whole_turns(covariances[level]) if whole else _newton_turns(turns[level], covariances[level])
        pulls[level] -= np.einsum("nijt,njt->nit", turned, wanted.place[level])
        moved = turned - turns[level]
        turns[level] = turned
        children = [child for child, parent in enumerate(body.parents) if level.start <= parent < level.stop]
        for child in children:
            parent = body.parents[child]
            carried = np.einsum("ijt,j->it", moved[parent - level.start], body.offsets[child])
            pulls[parent] += pulls[child] - weights[child] * carried
            weights[parent] += weights[child]
        for joint in joints if level.start else ():
            parent = body.parents[joint]
            arm = weights[joint] * (there[joint] - there[parent]) + pulls[joint]
            covariances[parent] += arm[:, None] * body.offsets[joint][None, :, None]
    return pulls[0], weights[0]


def _whole_turns(covariances: Floats) -> Floats:
    """(..., 3, 3, T) rotations that maximise tr(R^T A)."""
    return np.moveaxis(nearest_rotation(np.moveaxis(covariances, -1, -3)), -3, -1)


def _newton_turns(turns: Floats, covariances: Floats) -> Floats:
    """(n, 3, 3, T) rotations nearer to the maximum of tr(R^T A), by one Newton step about the joints' own axes.

    For R exp(w) the second-order expansion is tr(B) + w.v - w.(tr(S) 1 - S)w / 2 with B = R^T A, S its symmetric
    part and v the vector of B - B^T. Where the bracket is not positive definite the maximum is taken whole.
    """
    b = np.moveaxis(np.einsum("njit,njkt->nikt", turns, covariances), 0, 2)
    v = (b[2, 1] - b[1, 2], b[0, 2] - b[2, 0], b[1, 0] - b[0, 1])
    xx, yy, zz = b[1, 1] + b[2, 2], b[0, 0] + b[2, 2], b[0, 0] + b[1, 1]
    xy, xz, yz = (-0.5 * (b[i, j] + b[j, i]) for i, j in ((0, 1), (0, 2), (1, 2)))
    cxx, cxy, cxz = yy * zz - yz * yz, xz * yz - xy * zz, xy * yz - xz * yy
    cyy, cyz, czz = xx * zz - xz * xz, xy * xz - xx * yz, xx * yy - xy * xy
    determinant = xx * cxx + xy * cxy + xz * cxz
    sound = (xx > 0) & (czz > 0) & (determinant > 1e-12 * np.abs(xx * yy * zz))
    scale = 0.5 / np.where(sound, determinant, 1.0)
    x = scale * (cxx * v[0] + cxy * v[1] + cxz * v[2])
    y = scale * (cxy * v[0] + cyy * v[1] + cyz * v[2])
    z = scale * (cxz * v[0] + cyz * v[1] + czz * v[2])
    turned = np.einsum("nijt,jknt->nikt", turns, _cayley(x, y, z))
    if not sound.all():
        joint, frame = np.nonzero(~sound)
        turned[joint, :, :, frame] = nearest_rotation(covariances[joint, :, :, frame])
    return turned


def _cayley(x: Floats, y: Floats, z: Floats) -> Floats:
    """(3, 3, ...) rotations by twice x, y, z (rad): right to second order, exactly orthogonal (Cayley)."""
    size = 2.0 / (1.0 + x * x + y * y + z * z)
    turn = np.empty((3, 3, *x.shape))
    turn[0, 0], turn[1, 1], turn[2, 2] = (1.0 - size * (p * p + q * q) for p, q in ((y, z), (x, z), (x, y)))
    turn[0, 1], turn[1, 0] = size * (x * y - z), size * (x * y + z)
    turn[0, 2], turn[2, 0] = size * (x * z + y), size * (x * z - y)
    turn[1, 2], turn[2, 1] = size * (y * z - x), size * (y * z + x)
    return turn


def _places(body: Body, rotations: Floats, root: Floats) -> Floats:
    """(J, 3, T) m from rotations (J, 3, 3, T) and root (3, T)."""
    there = np.empty((len(body.parents), *root.shape))
    for joint, parent in enumerate(body.parents):
        if parent < 0:
            there[joint] = root
        else:
            there[joint] = there[parent] + np.einsum("ijt,j->it", rotations[parent], body.offsets[joint])
    return there


def _between(rotations: Floats, root: Floats, frames: NDArray[np.intp], count: int) -> tuple[Floats, Floats]:
    """Rotations (J, 3, 3, count) and root (3, count) between those at some frames, the first and last among them."""
    from scipy.interpolate import CubicSpline  # here, because showing made cycles needs none of it

    turns = continuous(from_matrix(np.moveaxis(rotations, -1, 0)))
    all_turns = normalise(CubicSpline(frames, turns)(np.arange(count)))
    path = CubicSpline(frames, root, axis=1)(np.arange(count))
    return np.ascontiguousarray(np.moveaxis(to_matrix(all_turns), 0, -1)), path
