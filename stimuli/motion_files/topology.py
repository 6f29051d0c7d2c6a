"""Which joint plays which VRM humanoid role, told from the skeleton's shape alone. Knows no names.

Limbs are pairs of chains that leave one joint and have equal bones; the legs are the pair with the longest, the arms
the longest pair among the rest. Left and right are told by the
knees, which bend forward: left is where up x forward points.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from stimuli.motion_files.axes import knees_forward

Floats = NDArray[np.floating]

ALIKE = 0.75  # ratio of the two chains' long bones, below which they are no pair
LONG = 0.55  # of the longest bone of a limb: thigh and shank, upper and lower arm, but no collar, hand or foot


def roles_from_shape(parents: Sequence[int], positions: Floats, ends: frozenset[int] = frozenset()) -> dict[str, int]:
    """Role -> joint index, only what could be told; empty without legs or without toes.

    parents: (J,), parents before children; positions: (T, J, 3) posed, any unit and axes; ends: joints that only
    mark the end of a bone.
    """
    positions = positions[:: max(1, len(positions) // 60)]
    tree = _Tree(parents, positions)
    legs = tree.best_pair(set(range(len(parents))))
    if legs is None:
        return {}
    used = set(tree.below(legs[0][0])) | set(tree.below(legs[1][0]))
    arms = tree.best_pair(set(range(len(parents))) - used)
    hips = parents[legs[0][0]]
    limbs = [tree.limb(chain) for chain in legs]
    if any(len(limb) < 4 for limb in limbs):
        return {}
    trunk = [joint for joint in _trunk(tree, parents, hips, arms, used) if joint not in ends]
    top = positions[:, trunk[-1]] if len(trunk) > 1 else positions[:, hips]
    up = top - np.mean([positions[:, limb[2]] for limb in limbs], axis=0)
    forward = knees_forward(*(np.stack([positions[:, limb[k]] for limb in limbs]) for k in range(4)))
    roles = _trunk_roles(trunk, arms, parents)
    roles.update(_sided(limbs, ("UpperLeg", "LowerLeg", "Foot", "Toes"), positions, up, forward))
    if arms is not None:
        upper = [_arm(tree, chain) for chain in arms]
        roles.update(_sided(upper, ("Shoulder", "UpperArm", "LowerArm", "Hand"), positions, up, forward))
    return {role: joint for role, joint in roles.items() if joint >= 0}


class _Tree:
    """Children, bone lengths and limb chains of a skeleton."""

    def __init__(self, parents: Sequence[int], positions: Floats) -> None:
        self.children: list[list[int]] = [[] for _ in parents]
        self.length = np.zeros(len(parents))
        for joint, parent in enumerate(parents):
            if parent >= 0:
                self.children[parent].append(joint)
                bone = np.linalg.norm(positions[:, joint] - positions[:, parent], axis=1)
                self.length[joint] = np.median(bone)
        self.reach = np.zeros(len(parents))  # longest way down from each joint
        for joint in reversed(range(len(parents))):
            self.reach[joint] = max((self.length[c] + self.reach[c] for c in self.children[joint]), default=0.0)

    def below(self, joint: int) -> list[int]:
        """The joint and all under it."""
        found = [joint]
        for one in found:
            found += self.children[one]
        return found

    def chain(self, joint: int) -> list[int]:
        """The joint and the longest way down from it."""
        chain = [joint]
        while self.children[chain[-1]]:
            chain.append(max(self.children[chain[-1]], key=lambda c: self.length[c] + self.reach[c]))
        return chain

    def limb(self, chain: list[int]) -> list[int]:
        """Of a chain, the joint where its first long bone begins, the end of that and of the next, and one further."""
        bones = self.length[chain[1:]]
        long = np.flatnonzero(bones >= LONG * bones.max())
        first = int(long[0])
        after = [k for k in range(first + 1, len(bones)) if bones[k] > 0.02 * bones.max()]
        return [chain[first], chain[first + 1], *(chain[k + 1] for k in after[:2])]

    def best_pair(self, allowed: set[int]) -> tuple[list[int], list[int]] | None:
        """The two chains with a common parent and like bones whose two longest bones are longest."""
        best: tuple[float, tuple[list[int], list[int]]] | None = None
        for joint in sorted(allowed):
            starts = [child for child in self.children[joint] if child in allowed]
            for one, other in combinations(starts, 2):
                chains = self.chain(one), self.chain(other)
                if min(map(len, chains)) < 3:
                    continue
                sizes = [float(np.sum(np.sort(self.length[chain[1:]])[-2:])) for chain in chains]
                if min(sizes) > ALIKE * max(sizes) and (best is None or sum(sizes) > best[0]):
                    best = sum(sizes), chains
        return None if best is None else best[1]


def _trunk(
    tree: _Tree, parents: Sequence[int], hips: int, arms: tuple[list[int], list[int]] | None, legs: set[int]
) -> list[int]:
    """Joints from the hips to the head."""
    if arms is None:
        above = [child for child in tree.children[hips] if child not in legs]
        return [hips, *(tree.chain(max(above, key=lambda c: tree.reach[c])) if above else [])]
    chest = parents[arms[0][0]]
    way = [chest]
    while way[-1] != hips and parents[way[-1]] >= 0:
        way.append(parents[way[-1]])
    heads = [child for child in tree.children[chest] if child not in (arms[0][0], arms[1][0]) and child not in legs]
    head = tree.chain(max(heads, key=lambda c: tree.length[c] + tree.reach[c])) if heads else []
    return way[::-1] + head


def _trunk_roles(trunk: list[int], arms: tuple[list[int], list[int]] | None, parents: Sequence[int]) -> dict[str, int]:
    roles = {"hips": trunk[0]}
    chest = trunk.index(parents[arms[0][0]]) if arms is not None and parents[arms[0][0]] in trunk else 0
    if chest > 1:
        roles["spine"] = trunk[1]
    if chest > 0:
        roles["chest" if chest > 1 else "spine"] = trunk[chest]
    above = trunk[chest + 1 :]
    if len(above) > 1:
        roles["neck"] = above[0]
    if above:
        roles["head"] = above[-1]
    return roles


def _arm(tree: _Tree, chain: list[int]) -> list[int]:
    """Collar (-1 without one), upper arm, lower arm and hand; a first bone shorter than the next is a collar's."""
    bones = tree.length[chain[1:]]
    if len(bones) > 2 and bones[0] < 0.98 * bones[1]:
        return chain[:4]
    return [-1, *chain[:3]]


def _sided(
    limbs: list[list[int]], parts: tuple[str, ...], positions: Floats, up: Floats, forward: Floats
) -> dict[str, int]:
    """Roles of two limbs, the left one told by up x forward."""
    place = parts.index("UpperArm") if "UpperArm" in parts else 0  # collars may lie in one point
    apart = positions[:, limbs[0][place]] - positions[:, limbs[1][place]]
    side = float(np.median(np.sum(np.cross(up, forward) * apart, axis=-1)))
    if side == 0.0:
        return {}
    names = ("left", "right") if side > 0 else ("right", "left")
    return {
        name + part: joint
        for name, limb in zip(names, limbs, strict=True)
        for part, joint in zip(parts, limb, strict=False)
    }
