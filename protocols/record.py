"""What a run writes down: one record per thing that happened, and its line of text with a checksum.

The journal is a text file of such lines; this module knows the lines, not the file.
"""

from __future__ import annotations

import json
import zlib
from collections.abc import Mapping
from dataclasses import dataclass, field, fields
from functools import cache
from typing import Any, get_args

from pydantic import TypeAdapter, ValidationError

from protocols.study import Level

FORMAT = 2
"""Version of the journal's lines; raised when a reader of the old version could misread the new.

1: each line has a checksum of its own. 2: each line names the checksum of the line before it, too.
"""


@dataclass(frozen=True)
class Header:
    """The first line of a journal: what is needed to read, repeat and cite the run.

    participant_number: order of arrival, from 1, places given back first; keys: what each of the task's keys was for
    this participant.
    walkers: actor to where the walk comes from: captured, modelled, or how much of each; `style sad` to where that
    does.
    pilot: a trial run of the study itself, whose data must never stand among real ones.
    group: level of every between-participant factor that the program assigned.
    imported: SHA-256 of the file of every imported actor, body and style that is shown, by kind and name, as
    `actor anna`.
    """

    kind = "header"
    study: str
    study_hash: str
    study_text: str
    participant: str
    participant_number: int
    run: int
    seed: int
    simulated: bool
    keys: Mapping[str, str]
    versions: Mapping[str, str]
    display: Mapping[str, Any]
    started: str
    walkers: Mapping[str, str] = field(default_factory=dict)
    pilot: bool = False
    group: Mapping[str, str] = field(default_factory=dict)
    imported: Mapping[str, str] = field(default_factory=dict)
    format: int = FORMAT


@dataclass(frozen=True)
class Consented:
    """The participant agreed to take part."""

    kind = "consent"
    time: float
    agreed: bool


@dataclass(frozen=True)
class Answered:
    """An answer to a question; a later answer to the same question replaces it."""

    kind = "answer"
    time: float
    question: str
    value: str | int


@dataclass(frozen=True)
class PageShown:
    """A page the participant has read and left; time is when it was left."""

    kind = "page"
    time: float
    page: str
    shown: float


@dataclass(frozen=True)
class Key:
    """A key going down or up during a trial; time in s on the run's clock.

    source:         what gave the time: x-server, psychtoolbox, arrival, gamepad, mouse; simulated for a simulation.
    uncertainty_ms: how far the time may be from the moment the computer learned of the key, as measured in this run.
    frame:          number (from 0) of the first frame of the trial drawn with this key known.
    """

    kind = "key"
    time: float
    trial: int
    practice: bool
    key: str
    down: bool
    source: str = "simulated"
    uncertainty_ms: float = 0.0
    frame: int = 0


@dataclass(frozen=True)
class Click:
    """A click of the pointer during a trial on something that answers; target as `scale:3`.

    frame: number (from 0) of the first frame of the trial drawn with this click known.
    """

    kind = "click"
    time: float
    trial: int
    practice: bool
    target: str
    frame: int = 0


@dataclass(frozen=True)
class TrialBegun:
    """The first frame of a trial was shown."""

    kind = "begin"
    time: float
    number: int
    practice: bool
    attempt: int
    factors: Mapping[str, Level]


@dataclass(frozen=True)
class TrialRecord:
    """A finished trial.

    onset, time:   s on the run's clock: first frame and confirmation.
    response_time: s of looking between them, pauses excluded.
    response:      of an adjustment, step_frequency (steps/min), step_length (m), walk_ratio (m·min); of a choice,
                   chosen, side, which alternative was where, original, correct (1 or 0), views; of a rating, rating
                   and views.
    measured:      step_frequency, step_length, walk_ratio and speed (m/s) of the walker as drawn at the response;
                   those of the second of two are called beside_speed and so on; empty if undrawn.
    frames, late_frames: frames shown and those later than 1.5 refresh periods.
    track:         of an adaptive order, the track whose answers placed the level, from 1; else 0.
    track_reversals: of a staircase, how often its track has turned, this answer included; else 0.
    track_end:     why this was the track's last trial: reversals (as many as the study file wants) or trials; else "".
    """

    kind = "trial"
    time: float
    number: int
    practice: bool
    attempt: int
    block: int
    repetition: int
    factors: Mapping[str, Level]
    response: Mapping[str, Level]
    onset: float
    response_time: float
    key_presses: int
    reversals: int
    early_confirms: int
    pauses: int
    measured: Mapping[str, float] = field(default_factory=dict)
    frames: int = 0
    late_frames: int = 0
    track: int = 0
    track_reversals: int = 0
    track_end: str = ""


@dataclass(frozen=True)
class Paused:
    """The session was paused: by the participant (a break), a set break, the pause page or lost focus.

    frame: number (from 0) of the first frame of the trial drawn with it known; without a trial it means nothing.
    """

    kind = "pause"
    time: float
    why: str
    frame: int = 0


@dataclass(frozen=True)
class Resumed:
    """The session went on after a pause; frame as in Paused."""

    kind = "resume"
    time: float
    paused: float
    frame: int = 0


@dataclass(frozen=True)
class FrameLog:
    """Every frame of one trial, in the order they were seen; the first four lists are equally long.

    period:    s between refreshes of the display, as measured.
    flips:     s on the run's clock, read after the buffer swap and the driver's finish.
    predicted: s, when the frame was expected to be seen: the moment its poses were drawn for.
    cpu_ms:    ms of processor time of the drawing thread, from the scene to the last drawing call.
    poses:     a checksum of the joint matrices and places that were drawn, 8 hexadecimal digits.
    stretches: numbers (from 0) of the frames that begin the trial or go on with it after a pause.
    late:      numbers of the frames seen more than 1.5 periods after the one before in the same stretch.
    """

    kind = "frames"
    time: float
    number: int
    practice: bool
    attempt: int
    period: float
    flips: tuple[float, ...]
    predicted: tuple[float, ...]
    cpu_ms: tuple[float, ...]
    poses: tuple[str, ...]
    stretches: tuple[int, ...]
    late: tuple[int, ...]


@dataclass(frozen=True)
class GazeTrace:
    """What one trial's gaze was on, a place in each list per frame whose body-part map was drawn.

    flips:   s on the run's clock, when the frame was seen. x, y: the gaze on the picture, (0, 0) its top left and
             (1, 1) its bottom right, None without one.
    regions: legs, arms, torso, head, elsewhere, or unknown without a gaze. joints: the finer part, a VRM joint name.
    walkers: which walker of the scene, from 0; -1 elsewhere.
    """

    kind = "gaze"
    time: float
    number: int
    practice: bool
    attempt: int
    flips: tuple[float, ...]
    x: tuple[float | None, ...]
    y: tuple[float | None, ...]
    regions: tuple[str, ...]
    joints: tuple[str, ...]
    walkers: tuple[int, ...]


@dataclass(frozen=True)
class TriggerSent:
    """A code was sent on the trigger line; time: right after sending (s). of: kind of the record it announces."""

    kind = "trigger"
    time: float
    code: int
    of: str
    line: str


@dataclass(frozen=True)
class Continued:
    """An unfinished run was opened again; torn_bytes of an incomplete last line were set aside.

    interrupted: why the sitting before ended, as far as can be known.
    """

    kind = "continue"
    time: float
    started: str
    torn_bytes: int
    display: Mapping[str, Any]
    versions: Mapping[str, str]
    interrupted: str = ""


@dataclass(frozen=True)
class Ended:
    """The run stopped: finished, declined, stopped, or the reason the window went away."""

    kind = "end"
    time: float
    reason: str


@dataclass(frozen=True)
class Withdrawn:
    """All that is kept of a participant who withdrew: that a place in the order of arrival is free again."""

    kind = "withdrawn"
    participant_number: int


Record = (
    Header | Consented | Answered | PageShown | Key | Click | TrialBegun | TrialRecord
    | Paused | Resumed | FrameLog | GazeTrace | TriggerSent | Continued | Ended | Withdrawn
)  # fmt: skip


OPENINGS = (Header.kind, Continued.kind)
"""Kinds of the lines that begin a sitting."""


class DamagedLineError(ValueError):
    """A line of a journal that is not what was written."""


@dataclass(frozen=True)
class Line:
    """A whole line: its members, its checksum, and the checksum of the line it was written after (None: none named)."""

    values: dict[str, Any]
    checksum: str
    after: str | None


def encode_line(record: Record, after: str = "") -> str:
    """The record as one line of JSON without its newline; the last member is the CRC-32 of what precedes it.

    after: checksum of the line before, so that no whole line can go, come or move unnoticed; "" for a first line.
    """
    values: dict[str, Any] = {"kind": record.kind}
    values.update((f.name, getattr(record, f.name)) for f in fields(record))
    return sealed(values, after)


def sealed(values: Mapping[str, Any], after: str = "") -> str:
    """A line of these members, with the checksum of the line before (none when "") and its own."""
    members = {**values, "after": after} if after else values
    text = json.dumps(members, ensure_ascii=False, separators=(",", ":"), allow_nan=False, default=dict)
    return f'{text[:-1]},"crc":"{_checksum(text)}"}}'


def checksum_of(line: str) -> str:
    """The checksum at the end of a line that `encode_line` made."""
    return line[-10:-2]


def decode_line(line: str) -> dict[str, Any]:
    """The members of a line without its checksums; raises DamagedLineError when the line is torn or altered."""
    return read_line(line).values


def read_line(line: str) -> Line:
    """A line of a journal, looked at by itself; raises DamagedLineError when it is torn or altered."""
    head, mark, tail = line.rstrip("\r\n").rpartition(',"crc":"')
    if not mark or not tail.endswith('"}'):
        raise DamagedLineError("the line has no checksum; it was cut off while being written")
    text, checksum = head + "}", tail[:-2]
    if checksum != _checksum(text):
        raise DamagedLineError("the line does not match its checksum; it was altered or cut off")
    try:
        values = json.loads(text)
    except (ValueError, RecursionError) as error:
        raise DamagedLineError(f"the line is not JSON: {error}") from None
    _check_shape(values, text)
    after = values.pop("after", None)
    return Line(values, checksum, after if after is None else str(after))


def _check_shape(values: Any, text: str) -> None:
    """Raises DamagedLineError when a line of a kind that is known here lacks a member, or one has another type.

    Members and kinds that later versions may add are welcome.
    """
    kind = values.get("kind") if isinstance(values, dict) else None
    if not isinstance(kind, str):
        raise DamagedLineError("the line has no kind")
    if kind in _kinds():
        try:
            _kinds()[kind].validate_json(text, strict=True)
        except ValidationError as error:
            first = error.errors(include_url=False)[0]
            where = ".".join(map(str, first["loc"]))
            raise DamagedLineError(f"the {kind} line is not what gaitlab writes: {where}: {first['msg']}") from None


@cache
def _kinds() -> dict[str, TypeAdapter[Any]]:
    return {record.kind: TypeAdapter(record) for record in get_args(Record)}


def _checksum(text: str) -> str:
    return f"{zlib.crc32(text.encode('utf-8')):08x}"
