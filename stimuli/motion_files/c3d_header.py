"""The first look at a C3D file, before ezc3d gets it: is it one, whose numbers are these, is it whole.

ezc3d trusts what a file says of its own sizes and can bring the whole program down on a garbled one, so every size is
checked here first. Layout of header and parameters: the C3D file format user guide, www.c3d.org.
"""

from __future__ import annotations

import struct
from pathlib import Path

from stimuli.motion_files.errors import MotionFileError

BLOCK = 512  # bytes
KEY = 0x50
INTEL, DEC, MIPS = 84, 85, 86
PROCESSORS = (INTEL, DEC, MIPS)
LARGEST = 1 << 29  # bytes
SIZES = {-1: 1, 1: 1, 2: 2, 4: 4}  # bytes of characters, bytes, integers and reals

Parameters = dict[str, tuple[int, tuple[int, ...], bytes]]


def check_header(path: Path) -> None:
    """Raises MotionFileError unless this is a whole C3D file in a number format ezc3d can read."""
    data = _read(path)
    start = (data[0] - 1) * BLOCK
    if data[0] < 2 or start + 4 > len(data):
        raise MotionFileError(f"{path}: its parameters would begin in block {data[0]}, outside it; export it again")
    processor = data[start + 3]
    if processor == MIPS:
        raise MotionFileError(
            f"{path}: is written in SGI/MIPS byte order, which ezc3d does not read; save it as Intel (PC) C3D, "
            f"for instance with Mokka, and import that"
        )
    if processor not in PROCESSORS:
        raise MotionFileError(f"{path}: its number format {processor} is none of 84 (Intel), 85 (DEC), 86 (SGI/MIPS)")
    parameters = _parameters(path, data, start)
    _check_sizes(path, data, parameters, processor == DEC)


def _read(path: Path) -> bytes:
    try:
        if path.stat().st_size > LARGEST:
            raise MotionFileError(f"{path}: larger than {LARGEST >> 20} MB; cut the recording into shorter trials")
        data = path.read_bytes()
    except OSError as error:
        raise MotionFileError(f"{path}: cannot be read ({error.strerror or error})") from error
    if len(data) < 2 * BLOCK or data[1] != KEY:
        raise MotionFileError(f"{path}: is no C3D file, whose second byte is {KEY} and which has 1024 bytes or more")
    return data


def _parameters(path: Path, data: bytes, start: int) -> Parameters:
    """ "GROUP:NAME" -> type, dimensions and bytes, from records that all lie inside the file."""
    groups: dict[int, str] = {}
    found: dict[tuple[int, str], tuple[int, tuple[int, ...], bytes]] = {}
    place = start + 4
    while True:
        if place + 2 > len(data):
            raise _garbled(path, place)
        length, group = struct.unpack_from("bb", data, place)
        if length == 0 or group == 0:
            break
        name_end = place + 2 + abs(length)
        name = data[place + 2 : name_end]
        if name_end + 3 > len(data) or not all(32 <= letter < 127 for letter in name):
            raise _garbled(path, place)
        to_next = struct.unpack_from("<H", data, name_end)[0]
        end = name_end + to_next if to_next else len(data)
        if end > len(data):
            raise _garbled(path, place)
        word = name.decode("ascii").upper().strip()
        if group < 0:
            if name_end + 3 + data[name_end + 2] > end:
                raise _garbled(path, place)
            groups[-group] = word
        else:
            found[group, word] = _value(path, data, name_end + 2, end, place)
        if to_next == 0:
            break
        place = end
    return {f"{groups.get(group, '')}:{word}": value for (group, word), value in found.items()}


def _value(path: Path, data: bytes, place: int, end: int, record: int) -> tuple[int, tuple[int, ...], bytes]:
    kind, count = struct.unpack_from("bB", data, place) if place + 2 <= end else (0, 0)
    dimensions = tuple(data[place + 2 : place + 2 + count])
    size = SIZES.get(kind, 0)
    for dimension in dimensions:
        size *= dimension
    first = place + 2 + count
    if kind not in SIZES or count > 7 or first + size + 1 > end or first + size + 1 + data[first + size] > end:
        raise _garbled(path, record)
    return kind, dimensions, data[first : first + size]


def _garbled(path: Path, place: int) -> MotionFileError:
    return MotionFileError(f"{path}: its parameters are garbled at byte {place}; export the file again")


def _check_sizes(path: Path, data: bytes, parameters: Parameters, dec: bool) -> None:
    """Frames times points must fit the file, in the header and in the parameters alike."""
    points, analogue, first, last = struct.unpack("<4H", data[2:10])
    data_block, per_frame = struct.unpack("<HH", data[16:20])
    if _integer(parameters, "POINT:USED") not in (None, points):
        raise MotionFileError(
            f"{path}: the header counts {points} points and POINT:USED {_integer(parameters, 'POINT:USED')}; it is "
            f"garbled, export it again"
        )
    channels = _integer(parameters, "ANALOG:USED") or 0
    if analogue != channels * per_frame or _integer(parameters, "POINT:DATA_START") not in (None, data_block):
        raise MotionFileError(
            f"{path}: header and parameters disagree on analogue values ({analogue} per frame, {channels} channels of "
            f"{per_frame} samples) or on where the data begin; it is garbled, export it again"
        )
    for name in ("ANALOG:SCALE", "ANALOG:OFFSET") if channels else ():
        kind, _, value = parameters.get(name, (0, (), b""))
        if kind not in (2, 4) or len(value) < kind * min(channels, 255):
            raise MotionFileError(
                f"{path}: {name} has no number for each of {channels} channels; it is garbled, export it again"
            )
    negative = data[12:16][1 if dec else 3] & 0x80  # DEC floats have their words swapped
    frames = last - first + 1 if first <= last < 0xFFFF else 1  # longer ones keep their length in parameters
    needed = (data_block - 1) * BLOCK + frames * (points * 4 + analogue) * (4 if negative else 2)
    if data_block < 3 or points < 1 or needed > len(data):
        raise MotionFileError(
            f"{path}: {frames} frames of {points} points and {analogue} analogue values need {needed} bytes but the "
            f"file has {len(data)}; it is cut off or garbled, export it again"
        )


def _integer(parameters: Parameters, name: str) -> int | None:
    kind, _, value = parameters.get(name, (0, (), b""))
    if kind == 2 and len(value) >= 2:
        return int(struct.unpack("<H", value[:2])[0])
    return value[0] if kind == 1 and value else None
