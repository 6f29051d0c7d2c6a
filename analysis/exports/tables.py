"""What was recorded, as tables: participants, runs, trials, events, the course of the adjustment, frames."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any

from analysis.exports.runs import ExportedRun, Timed
from analysis.exports.table import Row, Table, table_of
from analysis.exports.trace import courses

TRIAL_FIRST = ("participant", "run", "trial", "practice", "block", "repetition", "attempt", "counts")
BY_FRAME = ("frames", "gaze")
"""Kinds of records that hold lists with a place for every frame."""

MARKS = {"begin", "trial", "key", "page", "pause", "resume", "continue", "end", "consent", "answer", *BY_FRAME}
SINGULAR = {"poses": "pose", "regions": "region", "joints": "joint", "walkers": "walker"}


def participants(runs: Sequence[ExportedRun]) -> Table:
    """One row a participant: ID, place in the order of arrival, every answer of the first run, number of runs."""
    rows: dict[str, dict[str, Any]] = {}
    for run in runs:
        if run.participant in rows:
            rows[run.participant]["runs"] += 1
            continue
        rows[run.participant] = {
            "participant": run.participant, "participant_number": run.header["participant_number"],
            **run.answers, "runs": 1,
        }  # fmt: skip
    return table_of("participants", rows.values())


def runs_table(runs: Sequence[ExportedRun]) -> Table:
    """One row a run: when, with which study file, seed and keys, how it ended."""
    return table_of("runs", (run_row(run) for run in runs))


def run_row(run: ExportedRun) -> dict[str, Any]:
    """What is to be said about a whole run."""
    header = run.header
    done = [t for t in run.of("trial") if not t.record["practice"]]
    return {
        "participant": run.participant, "run": run.number, "kind": run.kind, "started": header["started"],
        "sittings": run.sittings, "ended": run.ended, "trials": len({t.record["number"] for t in done}),
        "study_hash": header["study_hash"], "seed": header["seed"],
        **{f"key_{name}": key for name, key in header["keys"].items()},
        "walks": "; ".join(f"{actor}: {source}" for actor, source in header.get("walkers", {}).items()),
        "last_line_cut_off": run.torn,
    }  # fmt: skip


def trials(run: ExportedRun) -> Table:
    """One row an attempt that was finished; `counts` is true for the last record of each trial, which analyses take."""
    done = run.of("trial")
    last = {(t.record["practice"], t.record["number"]): place for place, t in enumerate(done)}
    counting = set(last.values())
    return table_of("trials", (_trial(run, t, place in counting) for place, t in enumerate(done)), TRIAL_FIRST)


def _trial(run: ExportedRun, timed: Timed, counts: bool) -> Row:
    record = dict(timed.record)
    row: dict[str, Any] = {"participant": run.participant, "run": run.number, "sitting": timed.sitting}
    row["trial"] = record.pop("number")
    row |= {name: record.pop(name) for name in ("practice", "block", "repetition", "attempt") if name in record}
    row["counts"] = counts
    del record["kind"]
    record["onset"] = timed.on_run_clock(float(record["onset"]))
    record["confirmed"] = timed.on_run_clock(float(record.pop("time")))
    for name in ("factors", "response"):
        for key, value in dict(record.pop(name, {})).items():
            row[key if key not in row else f"{name}_{key}"] = value
    for name, value in record.items():
        values = value if isinstance(value, Mapping) else {"": value}
        row |= {f"{name}_{key}".rstrip("_"): inner for key, inner in values.items()}
    return row


def events(run: ExportedRun) -> Table:
    """Everything that happened, by onset (s since the run began): trials, keys, pages, pauses, sittings."""
    rows = sorted(_events(run), key=lambda row: row["onset"])
    first = (
        "participant",
        "run",
        "onset",
        "duration",
        "event",
        "trial",
        "practice",
        "attempt",
        "key",
        "page",
        "why",
        "sitting",
    )
    whose = {"participant": run.participant, "run": run.number}
    return table_of("events", ({**row, **whose} for row in rows), first)


def _events(run: ExportedRun) -> Iterator[dict[str, Any]]:
    for place, timed in enumerate(run.records):
        record, kind = timed.record, timed.record["kind"]
        row: dict[str, Any] = {"onset": timed.onset, "duration": None, "event": kind, "sitting": timed.sitting}
        if kind == "begin":
            end = _next(run.records, place, lambda r: r["kind"] in ("trial", "end", "continue", "begin"))
            whole = end is not None and end.record["kind"] == "trial"
            row |= {"event": "trial" if whole else "trial_interrupted", "trial": record["number"]}
            row |= {"practice": record["practice"], "attempt": record["attempt"]}
            row["duration"] = round(end.onset - timed.onset, 6) if whole and end else None
        elif kind == "key":
            if not record["down"] and record["key"] != "focus":
                continue  # the event is the press; how long the key was held is its duration
            row |= {"event": "focus_lost" if record["key"] == "focus" else "key", "trial": record["trial"]}
            row |= {"practice": record["practice"]}
            row |= {} if record["key"] == "focus" else {"key": record["key"]}
            row["duration"] = _held(run.records, place)
            row |= {name: record[name] for name in ("source", "uncertainty_ms") if name in record}
        elif kind == "page":
            row |= {"onset": timed.on_run_clock(record["shown"]), "page": record["page"]}
            row["duration"] = round(record["time"] - record["shown"], 6)
        elif kind == "pause":
            end = _next(run.records, place, lambda r: r["kind"] in ("resume", "end", "continue"))
            row |= {"why": record["why"]}
            row["duration"] = round(end.onset - timed.onset, 6) if end and end.record["kind"] == "resume" else None
        elif kind in ("continue", "end"):
            row |= {"event": "continued" if kind == "continue" else "end"}
            row |= {"why": record.get("interrupted" if kind == "continue" else "reason")}
        elif kind in MARKS or "time" not in record:
            continue
        else:  # a record of a later version, or of a device
            known = {name: record[name] for name in ("trial", "practice", "attempt", "target") if name in record}
            left = record.keys() - {"kind", "time", *known}
            more = {name: record[name] for name in record if name in left and not isinstance(record[name], list)}
            row |= known | ({"details": more} if more else {})
        yield row


def _next(records: Sequence[Timed], place: int, wanted: Any) -> Timed | None:
    return next((timed for timed in records[place + 1 :] if wanted(timed.record)), None)


def _held(records: Sequence[Timed], place: int) -> float | None:
    """s until the key is let go, or until the trial no longer hears it; None when neither was recorded."""
    pressed = records[place].record
    if pressed["key"] == "focus":
        return 0.0
    for timed in records[place + 1 :]:
        record = timed.record
        let_go = record["kind"] == "key" and not record["down"] and record["key"] in (pressed["key"], "focus")
        if let_go or record["kind"] in ("trial", "pause"):
            return round(timed.onset - records[place].onset, 6)
        if record["kind"] in ("end", "continue", "begin"):
            return None
    return None


def trace(run: ExportedRun) -> Table:
    """The corners of step frequency over time; between two rows of a stretch it moves in a straight line."""
    rows = [
        {"participant": run.participant, "run": run.number, "trial": course.number, "practice": course.practice,
         "attempt": course.attempt, "stretch": stretch, "time": time, "step_frequency": frequency}
        for course in courses(run)
        for stretch, corners in enumerate(course.stretches, start=1)
        for time, frequency in corners
    ]  # fmt: skip
    return table_of("trace", rows)


def frames(run: ExportedRun) -> Table:
    """One row a frame of every trial that was drawn: when it was seen (s since the run began), and what was noted."""
    return _by_frame(run, "frames")


def gaze(run: ExportedRun) -> Table:
    """One row a frame of every trial whose gaze was recorded: where it was on the picture, and on what."""
    return _by_frame(run, "gaze")


def _by_frame(run: ExportedRun, kind: str) -> Table:
    whose = {"participant": run.participant, "run": run.number}
    return table_of(kind, ({**whose, **row} for timed in run.of(kind) for row in _frames_of(timed)))


def _frames_of(timed: Timed) -> Iterable[Row]:
    record = timed.record
    trial = {"trial": record["number"], "practice": record["practice"], "attempt": record["attempt"]}
    if "flips" not in record:  # journals of earlier versions hold intervals only
        for number, interval in enumerate(record.get("intervals_ms", []), start=1):
            yield {**trial, "frame": number, "interval_ms": interval}
        return
    count = len(record["flips"])
    lists = {name: values for name, values in record.items() if isinstance(values, list) and len(values) == count}
    marked = {
        name: set(values)
        for name, values in record.items()
        if name in ("late", "stretches") and isinstance(values, list)
    }
    for number in range(count):
        row: dict[str, Any] = {**trial, "frame": number}
        for name, values in lists.items():
            if name in ("flips", "predicted"):
                row["time" if name == "flips" else "predicted"] = timed.on_run_clock(values[number])
            elif name not in marked:
                row[SINGULAR.get(name, name)] = values[number]
        if marked:
            row["late"] = number in marked.get("late", ())
            row["begins_stretch"] = number in marked.get("stretches", ())
        yield row
