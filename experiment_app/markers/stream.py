"""Markers of what happens in a run, for other recorders, over Lab Streaming Layer: each with the time it was seen."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

from experiment_app.loop import Recorder
from experiment_app.markers.lsl import clock_offset, import_pylsl
from experiment_app.run_folder import Run
from protocols.record import Ended, Paused, Record, Resumed, TrialBegun, TrialRecord

CODES = {"begin": 1, "trial": 2, "pause": 3, "resume": 4, "end": 5}
"""Kind of record to the number in its marker, the same that a trigger line would carry."""


def marker(record: Record) -> str | None:
    """The marker of a record as compact JSON with kind, code and what identifies it; None for one without a marker."""
    code = CODES.get(record.kind)
    if code is None:
        return None
    values: dict[str, Any] = {"kind": record.kind, "code": code}
    if isinstance(record, (TrialBegun, TrialRecord)):
        values |= {"trial": record.number, "practice": record.practice, "attempt": record.attempt}
    if isinstance(record, TrialBegun):
        values["factors"] = dict(record.factors)
    if isinstance(record, TrialRecord):
        values["response"] = dict(record.response)
    if isinstance(record, Paused):
        values["why"] = record.why
    if isinstance(record, Resumed):
        values["paused"] = record.paused
    if isinstance(record, Ended):
        values["reason"] = record.reason
    return json.dumps(values, ensure_ascii=False, separators=(",", ":"))


class MarkerStream:
    """A recorder that passes records on to the journal and announces them on a stream of type `Markers`.

    Every marker carries the time of what it announces (a trial's begin: the flip of its first frame), not the time of
    sending. offset: s from the run's clock to Lab Streaming Layer's. Use as a context manager.
    """

    def __init__(self, journal: Recorder, run: Run, study_hash: str, offset: float) -> None:
        pylsl = import_pylsl()
        self._journal, self._offset = journal, offset
        name = f"gaitlab {run.study}"
        source = f"gaitlab/{run.study}/{run.participant}/{run.number}"
        info = pylsl.StreamInfo(name, "Markers", 1, pylsl.IRREGULAR_RATE, pylsl.cf_string, source)
        about = info.desc()
        for key, value in (
            ("study_hash", study_hash),
            ("participant", run.participant),
            ("run", str(run.number)),
            ("format", "JSON: kind, code and what identifies the event; stamped with its time on the screen"),
        ):
            about.append_child_value(key, value)
        self._outlet = pylsl.StreamOutlet(info)

    def __enter__(self) -> MarkerStream:
        return self

    def __exit__(self, *_: object) -> None:
        self._outlet = None

    def write(self, records: list[Record]) -> None:
        """Writes the records to the journal and announces those that have a marker."""
        self._journal.write(records)
        for record in records:
            text = marker(record)
            if text is not None and self._outlet is not None:
                self._outlet.push_sample([text], getattr(record, "time", 0.0) + self._offset)

    @property
    def saved(self) -> bool:
        """True when the journal has everything."""
        return self._journal.saved


@contextmanager
def announcing(journal: Recorder, on: bool, run: Run, study_hash: str, now: Callable[[], float]) -> Iterator[Recorder]:
    """The recorder itself when not `on`, else one that also announces; now: the time on the run's clock (s)."""
    if not on:
        yield journal
        return
    with MarkerStream(journal, run, study_hash, clock_offset(now())) as stream:
        yield stream
