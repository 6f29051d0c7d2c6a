"""glTF animations sampled at one time (glTF 2.0, section 3.11 and appendix C). Knows no meshes and no clock."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from stimuli.body_files.accessors import item, read_accessor
from stimuli.body_files.container import Container
from stimuli.body_files.errors import BodyError
from stimuli.body_files.scene import Node
from stimuli.skeleton import Floats

_PATHS = ("translation", "rotation", "scale")


@dataclass(frozen=True, eq=False)
class Channel:
    """One moved property of one node: times (K,) s; values (K, C), or (3 K, C) in-tangent, value, out-tangent."""

    node: int
    path: str
    interpolation: str
    times: Floats
    values: Floats


@dataclass(frozen=True, eq=False)
class Animation:
    """One animation of a glTF file: what moves which node, over time in s."""

    name: str
    channels: tuple[Channel, ...]


def read_animations(container: Container, where: str) -> tuple[Animation, ...]:
    """All animations of a file; morph targets are left out."""
    found = []
    for raw in container.document.get("animations", []):
        channels = [_channel(container, raw, channel, where) for channel in raw.get("channels", [])]
        found.append(Animation(str(raw.get("name", "")), tuple(c for c in channels if c is not None)))
    return tuple(found)


def moved_nodes(nodes: tuple[Node, ...], animation: Animation, time: float) -> tuple[Node, ...]:
    """The nodes as they are `time` seconds into an animation; before its first key and after its last it stands."""
    moved = list(nodes)
    for channel in animation.channels:
        node, value = moved[channel.node], value_at(channel, time)
        if channel.path == "translation":
            moved[channel.node] = replace(node, translation=value)
        elif channel.path == "rotation":
            moved[channel.node] = replace(node, rotation=value)
        else:
            moved[channel.node] = replace(node, scale=value)
    return tuple(moved)


def value_at(channel: Channel, time: float) -> Floats:
    """(C,) the property at a time (s)."""
    times, cubic = channel.times, channel.interpolation == "CUBICSPLINE"
    keys = channel.values[1::3] if cubic else channel.values
    if time <= times[0] or len(times) == 1:
        return keys[0]
    if time >= times[-1]:
        return keys[-1]
    k = int(np.searchsorted(times, time, side="right")) - 1
    step = times[k + 1] - times[k]
    t = (time - times[k]) / step
    if channel.interpolation == "STEP":
        return keys[k]
    if cubic:
        leaving, arriving = channel.values[3 * k + 2], channel.values[3 * (k + 1)]
        value = (
            (2 * t**3 - 3 * t**2 + 1) * keys[k]
            + step * (t**3 - 2 * t**2 + t) * leaving
            + (3 * t**2 - 2 * t**3) * keys[k + 1]
            + step * (t**3 - t**2) * arriving
        )
        return _unit(value) if channel.path == "rotation" else value
    if channel.path == "rotation":
        return _turned(keys[k], keys[k + 1], float(t))
    return (1 - t) * keys[k] + t * keys[k + 1]


def _turned(start: Floats, end: Floats, t: float) -> Floats:
    """Spherical interpolation along the shorter arc."""
    start, end = _unit(start), _unit(end)
    cosine = float(start @ end)
    if cosine < 0:
        end, cosine = -end, -cosine
    if cosine > 0.9995:
        return _unit((1 - t) * start + t * end)
    angle = np.arccos(np.clip(cosine, -1, 1))
    found: Floats = (np.sin((1 - t) * angle) * start + np.sin(t * angle) * end) / np.sin(angle)
    return found


def _unit(quaternion: Floats) -> Floats:
    found: Floats = quaternion / max(float(np.linalg.norm(quaternion)), 1e-12)
    return found


def _channel(container: Container, raw: dict[str, Any], channel: dict[str, Any], where: str) -> Channel | None:
    target = channel.get("target", {})
    node, path = target.get("node"), target.get("path")
    if node is None or path not in _PATHS:
        return None
    item(container, "nodes", node, where)
    try:
        sampler = raw["samplers"][channel["sampler"]]
        times = read_accessor(container, sampler["input"], where).ravel().astype(np.float64)
        values = read_accessor(container, sampler["output"], where).astype(np.float64)
    except (KeyError, IndexError, TypeError) as error:
        raise BodyError(f"{where}: an animation lacks its sampler") from error
    interpolation = str(sampler.get("interpolation", "LINEAR"))
    expected = len(times) * (3 if interpolation == "CUBICSPLINE" else 1)
    if len(times) == 0 or len(values) != expected or values.shape[1] != (4 if path == "rotation" else 3):
        raise BodyError(f"{where}: an animation's keys and values do not match")
    if not np.all(np.diff(times) > 0) or not np.all(np.isfinite(times)) or not np.all(np.isfinite(values)):
        raise BodyError(f"{where}: an animation's times do not grow, or its values are not finite")
    return Channel(int(node), str(path), interpolation, times, values)
