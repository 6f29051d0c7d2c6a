"""Which joint of a capture plays which VRM humanoid role: by tables of names, one per source of captures.

One table must fit as a whole, because the same word means different joints in different tables: LeftShoulder is a
collar bone in MotionBuilder and the upper arm in a 3ds Max release. Knows names and parents, no positions.
Sources of the names: the files and vendors' manuals named at each table, as collected in the project's notes.
"""

from __future__ import annotations

import re
from collections.abc import Sequence

TRUNK = ("hips", "spine", "chest", "neck", "head")
SIDED = ("Shoulder", "UpperArm", "LowerArm", "Hand", "UpperLeg", "LowerLeg", "Foot", "Toes")
NEEDED = ("hips", "leftUpperLeg", "leftLowerLeg", "leftFoot", "rightUpperLeg", "rightLowerLeg", "rightFoot")
"""Roles without which a clip is no walker."""


def _table(trunk: str, sided: str, left: str = "left{}", right: str = "right{}") -> dict[str, tuple[str, ...]]:
    """Role -> normalised names, the first present wins; "|" parts names of one role, "-" says there is none."""
    names = {role: tuple(word.split("|")) for role, word in zip(TRUNK, trunk.split(), strict=True)}
    for side, pattern in (("left", left), ("right", right)):
        for role, word in zip(SIDED, sided.split(), strict=True):
            names[side + role] = tuple(pattern.format(part) for part in word.split("|"))
    return names


TABLES: dict[str, dict[str, tuple[str, ...]]] = {
    "VRM": _table(
        "hips spine chest|upperchest neck head",
        "shoulder upperarm lowerarm hand upperleg lowerleg foot toes|toebase",
    ),
    # CMU graphics laboratory, ASF skeleton as MotionBuilder names it; LowerBack tells it from MotionBuilder.
    "CMU": _table(
        "hips lowerback spine1 neck head",
        "shoulder arm forearm hand upleg leg foot toebase",
    ),
    "Vicon/MotionBuilder": _table(
        "hips|reference spine spine3|spine2|spine1|chest neck head",
        "shoulder|collar arm forearm hand upleg leg foot toebase|toe",
    ),
    # Mixamo has MotionBuilder's words; only its name prefix differs, see `normalise`.
    "Mixamo": _table("hips spine spine2|spine1 neck head", "shoulder arm forearm hand upleg leg foot toebase"),
    # CMU's 3ds Max release, Xsens MVN's and most other BVH exports: joints named after anatomical joints.
    "3ds Max BVH": _table(
        "hips|hip lowerback|abdomen|spine|chest chest2|chest lowerneck|neck head",
        "collar shoulder elbow wrist|hand hip knee ankle|foot toe|toes",
    ),
    "Xsens BVH": _table(
        "hips chest chest4|chest3|chest2 neck head",
        "collar shoulder elbow wrist hip knee ankle toe|toes",
    ),
    "Xsens MVNX": _table(
        "pelvis l5 t8 neck head",
        "shoulder upperarm forearm hand upperleg lowerleg foot toe",
    ),
    "Bandai Namco": _table(
        "hips spine chest neck head",
        "shoulder upperarm lowerarm hand upperleg lowerleg foot toes",
        "{}l",
        "{}r",
    ),
    "3ds Max Biped": _table(
        "pelvis spine spine3|spine2|spine1 neck head",
        "clavicle upperarm forearm hand thigh calf foot toe0",
        "l{}",
        "r{}",
    ),
    "Unreal": _table(
        "pelvis spine01 spine03|spine02 neck01 head",
        "clavicle upperarm lowerarm hand thigh calf foot ball",
        "{}l",
        "{}r",
    ),
    "Acclaim": _table(
        "root lowerback thorax lowerneck head",
        "clavicle humerus radius wrist|hand femur tibia foot toes",
        "l{}",
        "r{}",
    ),
    "OptiTrack": _table(
        "hip|hips ab|spine chest neck head",
        "shoulder uarm farm hand thigh shin foot toe",
        "l{}",
        "r{}",
    ),
    "Rokoko": _table(
        "hips spine spine4|spine3|spine2 neck head",
        "shoulder arm|upperarm forearm hand thigh shin foot toe",
    ),
    # As Bandai Namco's, but without neck and shoulders, and a hand hangs on a wrist.
    "KayKit": _table(
        "hips spine chest - head",
        "- upperarm lowerarm wrist|hand upperleg lowerleg foot toes",
        "{}l",
        "{}r",
    ),
}
"""Source of captures -> VRM role -> the names it goes by there, normalised."""


def normalise(name: str) -> str:
    """A name without name space, vendor's prefix, case, blanks and punctuation: "mixamorig:LeftArm" -> "leftarm"."""
    name = re.split(r"[:|]", name)[-1].strip()
    name = re.sub(r"^(mixamorig\d*|bip\d+|j_bip_[clr]|character\d*|reference)[ _]+", "", name, flags=re.IGNORECASE)
    name = re.sub(r"^mixamorig\d*(?=[A-Z])", "", name)
    return re.sub(r"[ _.\-]", "", name).lower()


def roles_from_names(joints: Sequence[str], parents: Sequence[int]) -> tuple[str, dict[str, int]]:
    """The table that gives most joints a role, and the roles it gives (role -> index into joints).

    Of tables that give as many, the one with the more usual names counts, then the one that lacks fewest of its joints.
    Of joints whose normalised names are equal the first counts. A role whose parent role does not lie above it
    in the tree is dropped, so a like-named prop or twist joint does not become a limb.
    """
    where: dict[str, int] = {}
    for index, joint in enumerate(joints):
        where.setdefault(normalise(joint), index)
    ranked: list[tuple[int, int, int, str, dict[str, int]]] = []
    for name, table in TABLES.items():
        roles: dict[str, int] = {}
        for role, words in table.items():
            found = [where[word] for word in words if word in where]
            if found and found[0] not in roles.values():
                roles[role] = found[0]
        roles = _within_one_tree(roles, parents)
        preferred = sum(normalise(joints[joint]) == table[role][0] for role, joint in roles.items())
        lacking = sum("-" not in words[0] for words in table.values()) - len(roles)
        ranked.append((len(roles), preferred + (name == "Mixamo" and _mixamo(joints)), -lacking, name, roles))
    count, _, _, name, roles = max(ranked, key=lambda rank: rank[:3])
    return (name, roles) if count else ("", {})


def ancestors(joint: int, parents: Sequence[int]) -> list[int]:
    """The joints above `joint`, nearest first."""
    chain = []
    while parents[joint] >= 0:
        joint = parents[joint]
        chain.append(joint)
    return chain


def _mixamo(joints: Sequence[str]) -> bool:
    return any(joint.lower().startswith("mixamorig") for joint in joints)


def _within_one_tree(roles: dict[str, int], parents: Sequence[int]) -> dict[str, int]:
    chains = [
        (side + upper, side + lower)
        for side in ("left", "right")
        for upper, lower in (
            ("UpperArm", "LowerArm"),
            ("LowerArm", "Hand"),
            ("UpperLeg", "LowerLeg"),
            ("LowerLeg", "Foot"),
            ("Foot", "Toes"),
        )
    ]
    kept = dict(roles)
    for upper, lower in chains:
        if upper in kept and lower in kept and kept[upper] not in ancestors(kept[lower], parents):
            del kept[lower]
    return kept
