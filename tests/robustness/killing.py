"""Kills sessions at random moments, in many ways, and looks at what is left; used by a test and by a benchmark."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path
from random import Random

from experiment_app.run_folder import participant_runs
from tests.protocols.studies import shipped_text

WAYS = (signal.SIGKILL, signal.SIGKILL, signal.SIGSEGV, signal.SIGABRT, signal.SIGTERM)

CHILD = """
import sys
from pathlib import Path
from experiment_app.crash_note import crash_note
from experiment_app.run_folder import study_folder
from protocols.study_file import parse_study
from tests.experiment_app.sessions import opened, play
import time
run = opened(Path(sys.argv[1]), study=parse_study("s.yaml", Path(sys.argv[2]).read_text()))
acknowledged = open(sys.argv[3], "a")
wait = run.journal.wait
def said():
    wait()
    trials = run.journal.path.read_bytes().count(b'"kind":"trial"')
    acknowledged.write(f"{trials}\\n"); acknowledged.flush()
    time.sleep(0.002)
run.journal.wait = said
with crash_note(run.run.folder, run.run.sittings + 1):
    print("ready", flush=True)
    play(run)
"""


@dataclass
class Toll:
    """What many kills left behind.

    lost: acknowledged trials that were not in the journal; wrong_designs: finished runs with a cell missing or
    doubled; unmarked: repeated trials without a new attempt; torn: lines cut off and set aside.
    """

    kills: int = 0
    finished: int = 0
    lost: int = 0
    wrong_designs: int = 0
    unmarked: int = 0
    torn: int = 0
    reasons: Counter[str] = field(default_factory=Counter)

    @property
    def good(self) -> bool:
        """True when nothing was lost, doubled or left unmarked."""
        return not (self.lost or self.wrong_designs or self.unmarked)


def kill_sessions(folder: Path, kills: int, seed: int = 0) -> Toll:
    """Plays the shipped study of 96 trials over and over, killed `kills` times at random moments and resumed."""
    study = folder / "study.yaml"
    study.write_text(shipped_text(), encoding="utf-8")
    rng, toll = Random(seed), Toll()
    while toll.kills < kills:
        _one(folder, study, rng, toll, kill=True)
    while (_finished(folder, toll)) is False:
        _one(folder, study, rng, toll, kill=False)
    return toll


def _one(folder: Path, study: Path, rng: Random, toll: Toll, kill: bool) -> None:
    data, said = folder / f"data-{toll.finished}", folder / f"said-{toll.finished}"
    environment = {**os.environ, "PYTHONPATH": str(Path(__file__).parents[2])}
    child = subprocess.Popen(
        [sys.executable, "-c", CHILD, str(data), str(study), str(said)], stdout=subprocess.PIPE, env=environment
    )
    assert child.stdout is not None
    child.stdout.readline()
    if kill:
        time.sleep(rng.uniform(0.0, 0.25))
        child.send_signal(rng.choice(WAYS))
        toll.kills += 1
    child.communicate()
    acknowledged = _last_number(said)
    run = participant_runs(data, "walk_ratio", "P01")[-1]
    recorded = [line for line in run.lines if line["kind"] == "trial"]
    toll.lost += max(acknowledged - len(recorded), 0)
    if run.end == "finished":
        _count_design(run.lines, toll)
        toll.finished += 1
    else:
        toll.reasons[run.interruption] += 1


def _finished(folder: Path, toll: Toll) -> bool:
    """Whether the run that the last kill left unfinished has been played to its end meanwhile."""
    return not (folder / f"data-{toll.finished}").exists()


def _last_number(said: Path) -> int:
    lines = said.read_text().split("\n")[:-1] if said.exists() else []
    return int(lines[-1]) if lines else 0


def _count_design(lines: tuple[dict, ...], toll: Toll) -> None:
    trials = [line for line in lines if line["kind"] == "trial" and not line["practice"]]
    cells = Counter(tuple(line["factors"].values()) for line in trials)
    whole = sorted(line["number"] for line in trials) == list(range(1, 97))
    toll.wrong_designs += not (whole and len(cells) == 24 and set(cells.values()) == {4})
    begun = Counter((line["number"], line["practice"]) for line in lines if line["kind"] == "begin")
    toll.unmarked += sum(
        line["attempt"] != begun[line["number"], line["practice"]] for line in lines if line["kind"] == "trial"
    )
    toll.torn += sum(line["torn_bytes"] > 0 for line in lines if line["kind"] == "continue")
