"""The first look at a C3D file, before ezc3d gets it: is it one, whose numbers are these, is it whole.

Layout of the 512-byte header and of the processor byte: the C3D file format user guide, www.c3d.org.
"""

from __future__ import annotations

import struct
from pathlib import Path

from stimuli.motion_files.errors import MotionFileError

BLOCK = 512  # bytes
KEY = 0x50
PROCESSORS = {84: "Intel", 85: "DEC", 86: "SGI/MIPS"}


def check_header(path: Path) -> None:
    """Raises MotionFileError unless this is a whole C3D file in a number format ezc3d can read."""
    try:
        data = path.read_bytes()
    except OSError as error:
        raise MotionFileError(f"{path}: cannot be read ({error.strerror or error})") from error
    if len(data) < 2 * BLOCK or data[1] != KEY:
        raise MotionFileError(f"{path}: is no C3D file, whose second byte is {KEY} and which has 1024 bytes or more")
    parameters = (data[0] - 1) * BLOCK
    if data[0] < 2 or parameters + 4 > len(data):
        raise MotionFileError(f"{path}: its parameters would begin in block {data[0]}, outside it; export it again")
    processor = data[parameters + 3]
    if processor == 86:
        raise MotionFileError(
            f"{path}: is written in SGI/MIPS byte order, which ezc3d does not read; save it as Intel (PC) C3D, "
            f"for instance with Mokka, and import that"
        )
    if processor not in PROCESSORS:
        raise MotionFileError(f"{path}: its number format {processor} is none of 84 (Intel), 85 (DEC), 86 (SGI/MIPS)")
    _check_size(path, data, parameters, big=False)


def _check_size(path: Path, data: bytes, parameters: int, big: bool) -> None:
    """Frames times points must fit the file: a cut-off file is refused before memory is asked for it."""
    order = ">" if big else "<"
    points, analogue, first, last = struct.unpack(f"{order}4H", data[2:10])
    scale_bytes, data_block = data[12:16], struct.unpack(f"{order}H", data[16:18])[0]
    negative = scale_bytes[1 if data[parameters + 3] == 85 else 3] & 0x80  # DEC floats have their words swapped
    size = 4 if negative else 2
    frames = max(last - first + 1, 0)
    if last == 65535 or first > last:
        return  # long recordings keep their true length in TRIAL or POINT:FRAMES, which ezc3d reads
    needed = (data_block - 1) * BLOCK + frames * (points * 4 + analogue) * size
    if data_block < 3 or needed > len(data):
        raise MotionFileError(
            f"{path}: {frames} frames of {points} points and {analogue} analogue values need {needed} bytes but the "
            f"file has {len(data)}; it is cut off or garbled, export it again"
        )
