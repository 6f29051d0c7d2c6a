"""Who was captured, from the `actor.yaml` of a folder of clips.

sex: female            # or male: decides the body
height: 1.72           # m
weight: 65             # kg
age: 31                # years
licence: CC BY 4.0     # optional: what others may do with these captures; else "not stated"
source: our laboratory, 2025  # optional: else "not stated"
complete: true         # fill the grid of speed and step frequency with the gait model
comfort_speed: 1.25    # m/s, optional: else the median speed of the clips
symmetric: true        # optional: left and right are averaged; else a limp stays a limp
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ruamel.yaml import YAML
from ruamel.yaml.error import YAMLError

from stimuli.importing.errors import ImportingError
from stimuli.motion_files.yaml_reasons import yaml_reason

SEXES = {"female": "F", "woman": "F", "f": "F", "male": "M", "man": "M", "m": "M"}
RANGES = {"height": (1.0, 2.3, "m"), "weight": (20.0, 250.0, "kg"), "age": (5.0, 110.0, "years")}
NOT_STATED = "not stated"
KEYS = ("sex", *RANGES, "licence", "source", "complete", "comfort_speed", "symmetric")


@dataclass(frozen=True)
class Description:
    """A captured person. sex "F" or "M"; height m; weight kg; age years; comfort_speed m/s or None."""

    sex: str
    height: float
    weight: float
    age: float
    licence: str
    source: str
    complete: bool = False
    comfort_speed: float | None = None
    symmetric: bool = False


def read_description(folder: Path) -> Description:
    """The description in a folder's actor.yaml. Raises ImportingError naming what is missing or wrong."""
    path = folder / "actor.yaml"
    if not folder.is_dir():
        found = "is a file" if folder.exists() else "does not exist"
        raise ImportingError(f"{folder} {found}; name the folder with one person's clips and actor.yaml")
    if not path.is_file():
        raise ImportingError(f"{path} is missing; it says who was captured: {', '.join(KEYS[:-3])}")
    try:
        content = YAML(typ="safe", pure=True).load(path.read_text(encoding="utf-8"))
    except (YAMLError, OSError, ValueError) as error:
        raise ImportingError(f"{path}{yaml_reason(error)}") from error
    if not isinstance(content, dict):
        raise ImportingError(f"{path} is no list of settings; write e.g. height: 1.72")
    unknown = [str(key) for key in content if key not in KEYS]
    if unknown:
        raise ImportingError(f"{path}: {', '.join(unknown)} is no setting; the settings are {', '.join(KEYS)}")
    missing = [key for key in ("sex", *RANGES) if key not in content]
    if missing:
        raise ImportingError(f"{path}: {', '.join(missing)} {'is' if len(missing) == 1 else 'are'} missing")
    sex = str(content["sex"]).lower()
    if sex not in SEXES:
        raise ImportingError(f"{path}: sex: {content['sex']!r} is neither female nor male, which decides the body")
    numbers = {key: _number(path, key, content[key], *bounds) for key, bounds in RANGES.items()}
    speed = content.get("comfort_speed")
    return Description(
        sex=SEXES[sex],
        licence=_text(path, "licence", content),
        source=_text(path, "source", content),
        complete=_flag(path, "complete", content),
        symmetric=_flag(path, "symmetric", content),
        comfort_speed=None if speed is None else _number(path, "comfort_speed", speed, 0.3, 2.5, "m/s"),
        **numbers,
    )


def _flag(path: Path, key: str, content: dict[str, Any]) -> bool:
    value = content.get(key, False)
    if not isinstance(value, bool):
        raise ImportingError(f"{path}: {key}: {value!r} is neither true nor false")
    return value


def _number(path: Path, key: str, value: Any, low: float, high: float, unit: str) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float) or not low <= value <= high:
        raise ImportingError(f"{path}: {key}: {value!r} is no number from {low:g} to {high:g} {unit}")
    return float(value)


def _text(path: Path, key: str, content: dict[str, Any]) -> str:
    if key not in content:
        return NOT_STATED
    value = content[key]
    text = " ".join(str(value).split()) if value is not None else ""
    if not text:
        raise ImportingError(f"{path}: {key} is empty; leave the line out if it is not known")
    return text
