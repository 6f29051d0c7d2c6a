"""What every column means: from the study file where the experimenter said it, from here where gaitlab did."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

from analysis.exports.runs import ExportedRun
from analysis.exports.table import Table, cell


@dataclass(frozen=True)
class Column:
    """What a column holds; levels: value to what it stands for, empty for what is not one of a few."""

    description: str
    unit: str = ""
    levels: Mapping[str, str] = field(default_factory=dict)


STEP_FREQUENCY, STEP_LENGTH = "Step frequency (cadence)", "Step length: heel strike to the other foot's heel strike"
WALK_RATIO = "Walk ratio: step length divided by step frequency (Sekiya et al. 1996)"

KNOWN = {
    "participant": Column("The participant's code."),
    "participant_id": Column("The participant's code, after sub-."),
    "participant_number": Column("Place in the order of arrival, from 1; decides counterbalanced keys."),
    "runs": Column("How many runs were recorded of the participant."),
    "run": Column("Number of the run of this participant, from 1."),
    "kind": Column("real, pilot or simulated.", levels={"real": "", "pilot": "", "simulated": ""}),
    "started": Column("When the run began, UTC by the computer's clock."),
    "sittings": Column("How often the run was opened: 1, and 1 more each time it was continued."),
    "sitting": Column("In which sitting of the run, from 1."),
    "ended": Column("Why the run is over, else why its last sitting ended; missing when no end was recorded."),
    "trials": Column("How many trials were finished, training left out."),
    "study_hash": Column("SHA-256 of the study file the run was recorded with."),
    "seed": Column("Seed of the order of trials."),
    "walks": Column("Where each actor's walk (and each style) came from: captured, modelled, or how much of each."),
    "last_line_cut_off": Column("Whether the journal's last line was cut off while being written."),
    "trial": Column("Number of the trial in the run, from 1; training trials are numbered among themselves."),
    "practice": Column("Whether the trial was training.", levels={"true": "training", "false": "experiment"}),
    "block": Column("Block of the design, from 1; 0 in training."),
    "repetition": Column("How often this condition had been shown, this time included."),
    "attempt": Column("How often the trial had been begun, this time included; more than 1 after an interruption."),
    "counts": Column(
        "Whether this is the trial's last finished attempt, the one analyses take.",
        levels={"true": "taken", "false": "done again later"},
    ),
    "onset": Column("First frame of the trial, or begin of the event, since the run began.", "s"),
    "confirmed": Column("When the response was given, since the run began.", "s"),
    "duration": Column("How long the event lasted; missing where it was cut short.", "s"),
    "response_time": Column("Time of looking from the first frame to the response, pauses left out.", "s"),
    "key_presses": Column("Presses of the keys that change the walk."),
    "reversals": Column("Presses in the direction opposite to the press before."),
    "early_confirms": Column("Presses of the confirm key before it was accepted."),
    "pauses": Column("Pauses and breaks within the trial."),
    "frames": Column("Frames shown in the trial."),
    "late_frames": Column("Frames shown more than 1.5 refresh periods after the one before."),
    "step_frequency": Column(f"{STEP_FREQUENCY}.", "steps/min"),
    "step_length": Column(f"{STEP_LENGTH}.", "m"),
    "walk_ratio": Column(f"{WALK_RATIO}.", "m·min"),
    "measured_step_frequency": Column(f"{STEP_FREQUENCY}, measured from the walker as drawn.", "steps/min"),
    "measured_step_length": Column(f"{STEP_LENGTH}, measured from the walker as drawn.", "m"),
    "measured_walk_ratio": Column(f"{WALK_RATIO}, measured from the walker as drawn.", "m·min"),
    "measured_speed": Column("Walking speed, measured from the walker as drawn.", "m/s"),
    "event": Column(
        "What happened.",
        levels={
            "trial": "from its first frame to the response",
            "trial_interrupted": "begun, never finished",
            "key": "a key of the task was held",
            "focus_lost": "the window lost the keyboard",
            "click": "something that answers was clicked",
            "page": "a page was read",
            "pause": "a pause or a break",
            "continued": "the run was opened again",
            "trigger": "a code was sent on the trigger line",
            "end": "the sitting ended",
        },
    ),
    "key": Column("Name of the key."),
    "page": Column("Name of the page."),
    "target": Column("What was clicked."),
    "track": Column("Of an adaptive order, the track whose answers placed the level; 0 without one."),
    "track_reversals": Column("Of a staircase, how often its track has turned, this answer included."),
    "track_end": Column("Why this was the last trial of its track: its reversals, or its trials; empty otherwise."),
    "why": Column("Reason of a pause, of an end, or of the interruption before."),
    "source": Column("What gave the key's time: the X server, a keyboard queue, its arrival, a simulation."),
    "uncertainty_ms": Column("How far the key's time may be off.", "ms"),
    "details": Column("What else was recorded, as JSON."),
    "time": Column("Time since the run began.", "s"),
    "stretch": Column("Stretch of looking between pauses of the trial, from 1."),
    "frame": Column("Number of the frame in its trial, from 0."),
    "predicted": Column("For which moment the frame was drawn, since the run began.", "s"),
    "interval_ms": Column("Time since the frame before was seen.", "ms"),
    "cpu_ms": Column("Processor time spent on drawing the frame.", "ms"),
    "pose": Column("Checksum of the joint matrices that were drawn."),
    "x": Column("Where the gaze was on the picture, 0 at its left edge, 1 at its right; missing without a gaze."),
    "y": Column("Where the gaze was on the picture, 0 at its upper edge, 1 at its lower; missing without a gaze."),
    "region": Column("What the gaze was on: legs, arms, torso, head, elsewhere, or unknown without a gaze."),
    "joint": Column("The finer part the gaze was on, a VRM joint name."),
    "walker": Column("Which walker of the scene the gaze was on, from 0; -1 elsewhere."),
    "late": Column("Whether the frame was seen more than 1.5 refresh periods after the one before."),
    "begins_stretch": Column("Whether the frame begins the trial or goes on with it after a pause."),
}


def dictionary(tables: Iterable[Table], runs: Sequence[ExportedRun]) -> dict[str, Column]:
    """Every column of the tables and what it means, in their order; levels are completed by what the rows hold."""
    from_studies: dict[str, Column] = {}
    for run in runs:
        for name, column in of_study(run.study).items():
            from_studies.setdefault(name, column)
    described: dict[str, Column] = {}
    for table in tables:
        for name in table.columns:
            described[name] = _completed(described.get(name) or describe(name, from_studies), name, table)
    return described


def _completed(column: Column, name: str, table: Table) -> Column:
    """The column with levels that only the rows have: those of training trials, or of an older study file."""
    if not column.levels:
        return column
    found = dict.fromkeys(cell(row.get(name)) for row in table.rows if row.get(name) is not None)
    more = {
        level: "only in training, or in another version of the study file"
        for level in found
        if level not in column.levels
    }
    return replace(column, levels={**column.levels, **more}) if more else column


def describe(column: str, from_studies: Mapping[str, Column]) -> Column:
    """What one column means."""
    if column in from_studies:
        return from_studies[column]
    if column in KNOWN:
        return KNOWN[column]
    if column.startswith("key_"):
        return Column(f"The key that was {column[4:]!r} for this participant.")
    if column.startswith("measured_"):
        return Column(f"{_words(column[9:])}, measured from what was drawn.")
    return Column(f"{_words(column)}, as recorded in the journal.")


def of_study(study: Mapping[str, Any]) -> dict[str, Column]:
    """Factors and questions of a study file, by column."""
    found = {}
    for name, levels in (study.get("factors") or {}).items():
        same, decides = _uses(study, str(name))
        unit = "m/s" if "stimulus.speed" in same else "steps/min" if "task.start" in same else ""
        where = f"; it is {' and '.join(same)}" if same else ""
        where += f"; it decides {' and '.join(decides)}" if decides else ""
        found[str(name)] = Column(
            f"Factor {name} of the design{where}.", unit, {cell(level): "" for level in levels or ()}
        )
    for name in (study.get("participants") or {}).get("assigned") or ():
        found[str(name)] = Column(f"Group of factor {name} that the program assigned the participant to.")
    for question in (study.get("participants") or {}).get("questions") or ():
        options = {str(value): str(text) for value, text in (question.get("options") or {}).items()}
        found[str(question["id"])] = Column(f"Answer to: {' '.join(str(question['prompt']).split())}", levels=options)
    return found


def _uses(study: Mapping[str, Any], factor: str) -> tuple[list[str], list[str]]:
    """Places of the stimulus and the task whose value is a factor's level, and those where a table looks it up."""
    parts = {part: dict(study.get(part) or {}) for part in ("stimulus", "task")}
    parts["stimulus.camera"] = parts["stimulus"].pop("camera", None) or {}
    settings = [(f"{part}.{name}", value) for part, given in parts.items() for name, value in given.items()]
    same = [place for place, value in settings if value == f"${factor}"]
    return same, [place for place, value in settings if isinstance(value, Mapping) and _looks_up(value, f"${factor}")]


def _looks_up(table: Mapping[str, Any], factor: str) -> bool:
    inner = [value for value in table.values() if isinstance(value, Mapping)]
    return factor in table or any(_looks_up(value, factor) for value in inner)


def _words(column: str) -> str:
    text = column.replace("_", " ").strip()
    return text[:1].upper() + text[1:]


def dictionary_table(columns: Mapping[str, Column]) -> Table:
    """The dictionary as a table: column, description, unit, levels."""
    rows = tuple(
        {"column": name, "description": c.description, "unit": c.unit, "levels": "; ".join(_levels(c.levels))}
        for name, c in columns.items()
    )
    return Table("data_dictionary", ("column", "description", "unit", "levels"), rows)


def _levels(levels: Mapping[str, str]) -> list[str]:
    return [f"{value}: {text}" if text else value for value, text in levels.items()]
