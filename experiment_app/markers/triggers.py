"""Trigger pulses to other machines (EEG, motion capture) over a serial or parallel line, at the moment of a record.

A record is handed on as soon as it is known, a trial's begin right after the flip of its first frame; the code is the
one that the record's marker on Lab Streaming Layer carries. The journal keeps when each pulse was sent.
"""

from __future__ import annotations

import os
import struct
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any, Protocol

from experiment_app.errors import RunError, UsageError
from experiment_app.loop import Recorder
from experiment_app.markers.stream import CODES
from protocols.record import Record, TriggerSent

PULSE = 0.005
"""s after which a parallel line goes back to 0; long enough for amplifiers that sample at 500 Hz or faster."""

BAUD = 115200
"""Bits per second of a serial line: a byte is there 0.09 ms after it was sent."""

PPCLAIM, PPRELEASE, PPWDATA = 0x708B, 0x708C, 0x40017086
"""Requests of Linux's user-space parallel port driver (linux/ppdev.h)."""


class Line(Protocol):
    """A line that can carry a code from 1 to 255."""

    def send(self, code: int) -> None:
        """Sends the code; raises OSError when the line is gone."""

    def close(self) -> None:
        """Gives the line back."""


class SerialLine:
    """One byte per code on a serial port, as USB trigger boxes take it."""

    def __init__(self, port: str) -> None:
        try:
            import serial
        except ImportError:
            raise UsageError("--trigger serial needs pyserial: pip install 'gaitlab[serial]'.") from None
        self._port: Any = serial.Serial(port, BAUD, write_timeout=0.1)

    def send(self, code: int) -> None:
        """Sends the code as one byte."""
        self._port.write(bytes([code]))

    def close(self) -> None:
        """Closes the port."""
        self._port.close()


class ParallelLine:
    """The code on the eight data pins of a parallel port (Linux, /dev/parport0), back to 0 after PULSE."""

    def __init__(self, port: str) -> None:
        if not sys.platform.startswith("linux"):
            raise UsageError("--trigger parallel works on Linux; elsewhere use a serial trigger box.")
        self._file = os.open(port, os.O_RDWR)
        try:
            self._request(PPCLAIM)
            self._data(0)
        except OSError:
            os.close(self._file)
            raise
        self._back: threading.Timer | None = None

    def send(self, code: int) -> None:
        """Sets the pins, and clears them a moment later from another thread."""
        if self._back is not None:
            self._back.cancel()
        self._data(code)
        self._back = threading.Timer(PULSE, self._data, (0,))
        self._back.daemon = True
        self._back.start()

    def close(self) -> None:
        """Clears the pins and closes the port."""
        if self._back is not None:
            self._back.cancel()
        self._data(0)
        self._request(PPRELEASE)
        os.close(self._file)

    def _data(self, code: int) -> None:
        self._request(PPWDATA, struct.pack("B", code))

    def _request(self, request: int, argument: bytes = b"") -> None:
        import fcntl

        fcntl.ioctl(self._file, request, argument)


LINES: dict[str, Callable[[str], Line]] = {"serial": SerialLine, "parallel": ParallelLine}


def open_line(text: str) -> Line:
    """The line that `serial:/dev/ttyUSB0` or `parallel:/dev/parport0` names; raises UsageError."""
    kind, _, port = text.partition(":")
    if kind not in LINES or not port:
        raise UsageError(f"--trigger {text}: write serial:PORT or parallel:PORT, as serial:/dev/ttyUSB0.")
    try:
        return LINES[kind](port)
    except OSError as error:
        reason = error.strerror or str(error)
        raise UsageError(
            f"--trigger {text}: the port cannot be opened ({reason}); check its name and rights."
        ) from None


class Triggering:
    """A recorder that sends each record's code on the line before it passes the record on.

    now: the time on the run's clock (s).
    """

    def __init__(self, journal: Recorder, line: Line, name: str, now: Callable[[], float]) -> None:
        self._journal, self._line, self._name, self._now = journal, line, name, now

    def write(self, records: list[Record]) -> None:
        """Sends and records the codes; raises RunError when the line is gone, after the records were kept."""
        whole: list[Record] = []
        failure = None
        for record in records:
            whole.append(record)
            code = CODES.get(record.kind)
            if code is None or failure is not None:
                continue
            try:
                self._line.send(code)
                whole.append(TriggerSent(self._now(), code, record.kind, self._name))
            except OSError as error:
                failure = error
        self._journal.write(whole)
        if failure is not None:
            reason = failure.strerror or str(failure)
            raise RunError(
                f"the trigger line {self._name} is gone ({reason}); everything recorded is kept. Plug it in."
            )

    @property
    def saved(self) -> bool:
        """True when the journal has everything."""
        return self._journal.saved


@contextmanager
def trigger_line(text: str) -> Iterator[Line | None]:
    """The line that `text` names, open; None when `text` is empty. Raises UsageError, so open it before a run is."""
    line = open_line(text) if text else None
    try:
        yield line
    finally:
        if line is not None:
            line.close()


def triggering(journal: Recorder, line: Line | None, name: str, now: Callable[[], float]) -> Recorder:
    """The recorder itself when there is no line, else one that also triggers on it."""
    return journal if line is None else Triggering(journal, line, name, now)
