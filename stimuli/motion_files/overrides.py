"""What a person says about a motion file, in a short YAML file beside it, over what the reader would find.

`walk.bvh.yaml`, or `walk.yaml`, may hold: unit_to_m, up, rate, skip_frames, animation, and roles, e.g.

    unit_to_m: 0.01
    up: +Y
    roles:
      leftFoot: LeftAnkle
"""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from ruamel.yaml import YAML
from ruamel.yaml.error import YAMLError

from stimuli.motion_files.axes import LETTERS
from stimuli.motion_files.errors import MotionFileError
from stimuli.motion_files.yaml_reasons import yaml_reason
from stimuli.skeleton import JOINTS

KEYS = ("unit_to_m", "up", "rate", "skip_frames", "animation", "roles")


@dataclass(frozen=True)
class Overrides:
    """What is given; None, 0 or empty is found from the data."""

    unit_to_m: float | None = None
    up: str | None = None
    rate: float | None = None  # Hz
    skip_frames: int = 0
    animation: str | int | None = None
    roles: dict[str, str] = field(default_factory=dict)


def overrides_beside(path: Path) -> Overrides:
    """The overrides for a motion file, empty without a YAML file beside it. Raises MotionFileError."""
    for beside in (path.with_name(path.name + ".yaml"), path.with_suffix(".yaml")):
        if beside.is_file():
            return _checked(beside, _load(beside))
    return Overrides()


def _load(path: Path) -> dict[str, Any]:
    try:
        content = YAML(typ="safe", pure=True).load(path.read_text(encoding="utf-8"))
    except (YAMLError, OSError, ValueError) as error:
        raise MotionFileError(f"{path}{yaml_reason(error)}") from error
    if content is None:
        return {}
    if not isinstance(content, dict):
        raise MotionFileError(f"{path}: is no list of settings; write e.g. unit_to_m: 0.01")
    return content


def _checked(path: Path, content: dict[str, Any]) -> Overrides:
    unknown = [str(key) for key in content if key not in KEYS]
    if unknown:
        raise MotionFileError(f"{path}: {', '.join(unknown)} is no setting; the settings are {', '.join(KEYS)}")
    for key in ("unit_to_m", "rate"):
        value = content.get(key)
        if value is not None and (isinstance(value, bool) or not isinstance(value, int | float) or not value > 0):
            raise MotionFileError(f"{path}: {key}: {value!r} is not a positive number")
    skip = content.get("skip_frames", 0)
    if isinstance(skip, bool) or not isinstance(skip, int) or skip < 0:
        raise MotionFileError(f"{path}: skip_frames: {skip!r} is not a whole number of frames from 0")
    up = content.get("up")
    if up is not None and str(up).upper() not in (*LETTERS, "X", "Y", "Z"):
        raise MotionFileError(f"{path}: up: {up!r} is none of {', '.join(LETTERS)}")
    animation = content.get("animation")
    if animation is not None and (isinstance(animation, bool) or not isinstance(animation, int | str)):
        raise MotionFileError(f"{path}: animation: {animation!r} is neither a name nor a number")
    return Overrides(
        unit_to_m=content.get("unit_to_m"),
        up=None if up is None else ("+" + str(up))[-2:].upper(),
        rate=content.get("rate"),
        skip_frames=skip,
        animation=animation,
        roles=_roles(path, content.get("roles") or {}),
    )


def _roles(path: Path, roles: Any) -> dict[str, str]:
    if not isinstance(roles, dict):
        raise MotionFileError(f"{path}: roles: {roles!r} is no list of role: joint; write e.g. leftFoot: LeftAnkle")
    wrong = [str(role) for role in roles if role not in JOINTS]
    if wrong:
        raise MotionFileError(f"{path}: roles: {', '.join(wrong)} is no role; roles are {', '.join(JOINTS)}")
    return {role: str(joint) for role, joint in roles.items()}
