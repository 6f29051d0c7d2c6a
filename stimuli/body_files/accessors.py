"""glTF accessors as arrays: strides, integers that stand for fractions, sparse values, missing views (section 3.6)."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from stimuli.body_files.container import Container
from stimuli.body_files.errors import BodyError

Array = NDArray[Any]

_TYPES = {5120: np.int8, 5121: np.uint8, 5122: np.int16, 5123: np.uint16, 5125: np.uint32, 5126: np.float32}
_COMPONENTS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT4": 16}
MOST_ELEMENTS = 20_000_000


def read_accessor(container: Container, index: Any, where: str) -> Array:
    """(N, C) values of an accessor; normalised integers come back as fractions, other integers as they are."""
    accessor = item(container, "accessors", index, where)
    dtype, count, columns = _shape(accessor, where)
    if "bufferView" in accessor:
        start = whole(accessor.get("byteOffset", 0), where, "byteOffset")
        values = _view(container, accessor["bufferView"], start, dtype, count, columns, where)
    else:
        values = np.zeros((count, columns), dtype)
    if "sparse" in accessor:
        values = _with_sparse(container, accessor["sparse"], values, where)
    return _fractions(values) if accessor.get("normalized") is True else values


def item(container: Container, kind: str, index: Any, where: str) -> dict[str, Any]:
    """document[kind][index], or a sentence."""
    items = container.document.get(kind)
    if not isinstance(items, list) or not isinstance(index, int) or isinstance(index, bool):
        raise BodyError(f"{where}: a reference to {kind} is missing or is not a number")
    if not 0 <= index < len(items) or not isinstance(items[index], dict):
        raise BodyError(f"{where}: {kind}[{index}] does not exist")
    found: dict[str, Any] = items[index]
    return found


def whole(value: Any, where: str, what: str) -> int:
    """`value` as a whole number that is not negative, or a sentence."""
    if not isinstance(value, int) or isinstance(value, bool) or value < 0:
        raise BodyError(f"{where}: {what} is {value!r}, which is not a whole number of 0 or more")
    return value


def _shape(accessor: dict[str, Any], where: str) -> tuple[np.dtype[Any], int, int]:
    kind, component = accessor.get("type"), accessor.get("componentType")
    if not isinstance(kind, str) or kind not in _COMPONENTS:
        raise BodyError(f"{where}: an accessor has the unknown type {kind!r}")
    if not isinstance(component, int) or component not in _TYPES:
        raise BodyError(f"{where}: an accessor has the unknown componentType {component!r}")
    count = whole(accessor.get("count"), where, "an accessor's count")
    if count > MOST_ELEMENTS:
        raise BodyError(f"{where}: an accessor claims {count} elements, more than {MOST_ELEMENTS}")
    return np.dtype(_TYPES[component]).newbyteorder("<"), count, _COMPONENTS[kind]


def _view(
    container: Container, index: Any, start: int, dtype: np.dtype[Any], count: int, columns: int, where: str
) -> Array:
    view = item(container, "bufferViews", index, where)
    buffer = whole(view.get("buffer"), where, "a buffer view's buffer")
    if buffer >= len(container.buffers):
        raise BodyError(f"{where}: a buffer view points to buffer {buffer}, which does not exist")
    data = container.buffers[buffer]
    offset = whole(view.get("byteOffset", 0), where, "byteOffset")
    length = whole(view.get("byteLength"), where, "byteLength")
    row = dtype.itemsize * columns
    stride = whole(view.get("byteStride", row), where, "byteStride")
    end = start + (stride * (count - 1) + row if count else 0)
    if stride < row or end > length or offset + length > len(data):
        raise BodyError(f"{where}: an array runs past the end of its data; the file is damaged or cut short")
    if count == 0:
        return np.zeros((0, columns), dtype)
    raw = np.frombuffer(data, np.uint8, stride * (count - 1) + row, offset + start)
    rows = np.lib.stride_tricks.as_strided(raw, (count, row), (stride, 1))
    return np.ascontiguousarray(rows).view(dtype)


def _with_sparse(container: Container, sparse: Any, values: Array, where: str) -> Array:
    if not isinstance(sparse, dict) or not all(isinstance(sparse.get(k), dict) for k in ("indices", "values")):
        raise BodyError(f"{where}: a sparse accessor lacks its indices or values")
    count = whole(sparse.get("count"), where, "a sparse accessor's count")
    component = sparse["indices"].get("componentType")
    if component not in (5121, 5123, 5125):
        raise BodyError(f"{where}: a sparse accessor's indices have the unknown componentType {component!r}")
    offsets = [whole(sparse[k].get("byteOffset", 0), where, "byteOffset") for k in ("indices", "values")]
    dtype = np.dtype(_TYPES[component]).newbyteorder("<")
    rows = _view(container, sparse["indices"].get("bufferView"), offsets[0], dtype, count, 1, where).ravel()
    new = _view(container, sparse["values"].get("bufferView"), offsets[1], values.dtype, count, values.shape[1], where)
    if count and int(rows.max()) >= len(values):
        raise BodyError(f"{where}: a sparse accessor changes an element that does not exist")
    values = np.array(values)
    values[rows] = new
    return values


def _fractions(values: Array) -> Array:
    if values.dtype.kind == "f":
        return values
    return np.maximum(values.astype(np.float64) / np.iinfo(values.dtype).max, -1.0)
