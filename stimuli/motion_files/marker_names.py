"""Which label of a marker set means which place on the body. Knows labels only, no positions.

Sets: Plug-in-Gait (Vicon), Schreiber & Moissenet 2019 (Sci Data 6:111), Human Body Model 2 (HBM2), BMClab, and the
words of older laboratories. Where a set has no marker at a place, the place is missing.
"""

from __future__ import annotations

import re
from collections.abc import Sequence

_SIDED = {
    "asis": "_IAS ASI ASIS asis",
    "psis": "_IPS PSI PSIS",
    "trochanter": "_FTC",
    "thigh": "THI LTHI thigh",
    "lateral_knee": "_FLE KNE LEK knee",
    "medial_knee": "_FME KNM MEK KNEin",
    "shank": "TIB LSHA SHA",
    "lateral_ankle": "_FAL ANK LM mall",
    "medial_ankle": "_TAM MED MM ANKin",
    "heel": "_FCC HEE",
    "first_toe": "_FM1 MT1",
    "toe": "_FM2 TOE MT2 met",
    "fifth_toe": "_FM5 MT5",
    "fibula_head": "_FAX",
    "tibial_tuberosity": "_TTC",
    "shoulder": "_SAE SHO should",
    "lateral_elbow": "_HLE ELB LELB",
    "medial_elbow": "_HME ELBin",
    "thumb_wrist": "_RSP WRA WRI",
    "little_wrist": "_UHE WRB",
    "finger": "_HM2 FIN",
    "little_finger": "_HM5",
    "front_head": "FHD",
    "back_head": "BHD",
}
_MIDDLE = {
    "sacrum": "SACR VSAC sacrum",
    "c7": "CV7 C7 c7",
    "t10": "TV10 T10",
    "jugular": "SJN JN CLAV IJ",
    "xiphoid": "SXS XIPH STRN PX",
}


def _known_labels() -> dict[str, str]:
    known = {_normalise(word): place for place, words in _MIDDLE.items() for word in words.split()}
    for place, words in _SIDED.items():
        for word in words.split():
            for side, letter in (("left", "L"), ("right", "R")):
                known.setdefault(_normalise(letter + word), f"{side}_{place}")
    return known


def _normalise(label: str) -> str:
    return re.sub(r"[ _.\-]", "", label.split(":")[-1]).upper()


KNOWN: dict[str, str] = _known_labels()
"""Normalised label -> place, e.g. "LASI" -> "left_asis"."""


def places_of(labels: Sequence[str]) -> dict[str, int]:
    """Place -> index of the first label that means it. "AbcdeFghijk:RASI" is RASI."""
    found: dict[str, int] = {}
    for index, label in enumerate(labels):
        place = KNOWN.get(_normalise(label))
        if place is not None:
            found.setdefault(place, index)
    return found
