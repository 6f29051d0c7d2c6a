"""Timing in the real window: injected keys, holds of known length, a stall, start-up, processor time.

`python -m tests.benchmarks timing [PRESSES]` prints the figures of docs/trust.md for this machine; it needs an X
server (Xvfb will do) and libXtst. PsychoPy and Psychtoolbox are measured beside, in the same run, where
GAITLAB_RIVALS names a Python that has them (by default this one).
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from statistics import median

from experiment_app.loop import run_session
from experiment_app.scene import Scene, Walker
from experiment_app.timing.facts import percentile_90
from experiment_app.timing.injected_keys import NOBODY, KeyErrors, matched, measure_keys
from experiment_app.timing.key_injector import Injector, can_inject
from experiment_app.windows.desktop import DesktopWindow
from experiment_app.windows.window import Flip
from protocols.plan import Plan, TrialStep, make_plan
from protocols.record import FrameLog, Key, Record, TrialRecord
from protocols.session import begin
from protocols.study_file import read_study
from tests.benchmarks.measuring import row

SIZE = (640, 360)
RIVALS = Path(__file__).with_name("rival_keyboards.py")
CONTROL_R = 105
"""The keycode of the right Control key under X."""

LEFT, RIGHT, RETURN = 0xFF51, 0xFF53, 0xFF0D


def timing(presses: int = 300) -> None:
    """Every timing figure; without an X server only those that need none."""
    own_work_per_frame()
    if not can_inject():
        print("no X server with libXtst here: keys, holds, the stall and the first frame are not measured")
        return
    first_frame()
    key_times(presses)
    holds()
    stall()


def window(size: tuple[int, int] = SIZE, **settings: object) -> DesktopWindow:
    """A small window, so that the software renderer can keep 60 frames/s."""
    return DesktopWindow(full_screen=False, size=size, samples=1, **settings)  # type: ignore[arg-type]


def scene(seconds: float) -> Scene:
    """A walker at 105 steps/min."""
    return Scene((Walker("F1", 1.2, 105.0, 0.875 * seconds % 1.0, distance=1.2 * seconds),))


# Keys


def key_times(presses: int) -> None:
    """Stamps of injected presses: gaitlab's sources one after the other, rivals listening beside the first."""
    print(f"\nkey times, {presses} injected presses each, a walker drawn meanwhile: stamp minus injection, ms")
    print(f"{'':<40}{'median':>9}{'p90 of size':>13}{'lost':>6}{'doubled':>9}{'frames/s':>10}")
    for keyboard in ("auto", "arrival"):
        rivals = [rival for rival in map(Rival, ("psychopy", "psychtoolbox")) if rival.listens] * (keyboard == "auto")
        errors, rate = keys_in_a_window(keyboard, presses)
        key_row(f"gaitlab, {errors.source}", errors.presses, errors.lost, errors.doubled, rate)
        if keyboard == "auto":
            key_row("a program that asks once per frame", errors.once_per_frame, errors.lost, errors.doubled, rate)
            row("  median key time error, its size", abs(median(errors.presses)) / 1e3, 0.0005)
            row("  90th percentile of its size", percentile_90([abs(e) for e in errors.presses]) / 1e3, 0.002)
            assert (errors.lost, errors.doubled) == (0, 0), "presses were lost or doubled"
        for rival in rivals:
            rival.print_beside(errors)


def keys_in_a_window(keyboard: str, presses: int) -> tuple[KeyErrors, float]:
    """The errors of one source of key times, and frames per second meanwhile."""
    with window(keyboard=keyboard) as shown:
        frames: list[float] = []

        def show() -> None:
            frames.append(shown.show(scene(shown.next_display_time())).time)

        for _ in range(30):
            shown.poll(NOBODY)
            show()
        frames.clear()
        errors = measure_keys(shown, show, presses)
    return errors, (len(frames) - 1) / (frames[-1] - frames[0])


def key_row(name: str, errors: Sequence[float], lost: int, doubled: int, rate: float | None = None) -> None:
    """One line of the table."""
    p90 = percentile_90([abs(error) for error in errors])
    speed = f"{rate:10.1f}" if rate else ""
    print(f"{name:<40}{median(errors):9.3f}{p90:13.3f}{lost:6d}{doubled:9d}{speed}", flush=True)


class Rival:
    """Another program's keyboard, listening in a process of its own while gaitlab's is measured."""

    def __init__(self, name: str) -> None:
        self.name = name
        python = os.environ.get("GAITLAB_RIVALS", sys.executable)
        self._process = subprocess.Popen(
            [python, str(RIVALS), name, str(CONTROL_R), "rctrl"],
            stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True,
        )  # fmt: skip
        assert self._process.stdout is not None
        line = self._process.stdout.readline()
        while line and line != "listening\n":
            line = self._process.stdout.readline()
        self.listens = bool(line)
        if not self.listens:
            print(f"{name} is not installed here, or does not run; it is not measured beside")

    def print_beside(self, errors: KeyErrors) -> None:
        """Stops it and prints its line."""
        said, _ = self._process.communicate("stop\n", timeout=30)
        stamps = json.loads(said.splitlines()[-1])
        found = matched(errors.pressed_at, stamps)
        own = [
            1e3 * (stamps[i] - at) for at, i in zip(errors.pressed_at, found, strict=True) if i is not None
        ]  # fmt: skip
        key_row(f"{self.name}, a process of its own", own, found.count(None), len(stamps) - len(set(found) - {None}))


# Trials in the real window


class Memory:
    """A recorder that keeps the records."""

    saved = True

    def __init__(self) -> None:
        self.records: list[Record] = []

    def write(self, records: list[Record]) -> None:
        """Keeps them."""
        self.records += records

    def of(self, kind: type) -> list:  # type: ignore[type-arg]
        """Those of a kind."""
        return [record for record in self.records if isinstance(record, kind)]


def trials(count: int) -> Plan:
    """A plan of the first trials of the walk ratio study alone."""
    plan = make_plan(read_study("walk_ratio").study, 1, 1)
    steps = [step for step in plan.steps if isinstance(step, TrialStep) and not step.trial.practice]
    return replace(plan, steps=tuple(steps[:count]))


class Driven:
    """A window whose participant is an injector: as each trial appears, the steps planned for it begin.

    stall: (trial, from 0; s) by which one frame of a trial is held up.
    """

    def __init__(self, shown: DesktopWindow, plans: Sequence[list[tuple[int, bool, float]]], stall=(-1, 0.0)) -> None:  # type: ignore[no-untyped-def]
        self._shown, self._plans, self._stall = shown, list(plans), stall
        self._trial, self._seen, self._frames = -1, None, 0
        self.injectors = [Injector() for _ in plans]

    @property
    def period(self) -> float:
        return self._shown.period

    def poll(self, session):  # type: ignore[no-untyped-def]
        now = session.shown if session.trial is not None else None
        if now is not None and now != self._seen:
            self._trial += 1
            self._frames = 0
            self.injectors[self._trial].begin(self._plans[self._trial])
        self._seen = now if now is not None else self._seen
        return self._shown.poll(session)

    def next_display_time(self) -> float:
        return self._shown.next_display_time()

    def show(self, scene: Scene) -> Flip:
        self._frames += 1
        if self._trial == self._stall[0] and self._frames == 30:
            time.sleep(self._stall[1])
        return self._shown.show(scene)

    def measure(self, scene: Scene) -> dict[str, float]:
        return {}


def holds(each: int = 4) -> None:
    """The change of an adjustment after holds of known length, at three frame rates, as s of holding."""
    print("\nholds of 0.30 to 0.90 s in adjustment trials: answer minus what the injected hold gives, as ms of holding")
    lengths = [0.3 + 0.2 * number for number in range(each)]
    for rate in (30.0, 60.0, 144.0):
        with window(refresh=rate) as shown:
            plan = trials(each)
            starts = [float(step.trial.levels["start"]) for step in plan.steps]  # type: ignore[union-attr]
            plans = [
                [(RIGHT if start < 100 else LEFT, down, later) for down, later in ((True, 0.3), (False, length))]
                + [(RETURN, True, 1.6), (RETURN, False, 0.05)]
                for start, length in zip(starts, lengths, strict=True)
            ]
            driven, kept = Driven(shown, plans), Memory()
            run_session(begin(plan), driven, kept)
            errors, against_stamps = [], []
            for injector, start, record in zip(driven.injectors, starts, kept.of(TrialRecord), strict=True):
                while (times := injector.times()) is None:
                    time.sleep(0.01)
                held = abs(record.response["step_frequency"] - start) / 10.0
                errors.append(1e3 * (held - (times[1] - times[0])))
                keys = [k for k in kept.of(Key) if k.trial == record.number and k.key in ("left", "right")]
                against_stamps.append(1e3 * abs(held - (keys[1].time - keys[0].time)))
        print(
            f"  {rate:5.0f} frames/s: off the injected times by {median(errors):+.3f} ms (median), between "
            f"{min(errors):+.3f} and {max(errors):+.3f} ms"
        )
        row(f"  at {rate:.0f} frames/s, off its key times by at most", max(against_stamps) / 1e3, 0.001)


def stall(seconds: float = 0.040) -> None:
    """Late frames of five trials at 20 frames/s, one frame of the third held up."""
    counts = {}
    for held_up in (0.0, seconds):
        with window((320, 200), refresh=20.0) as shown:
            plans = [[(RETURN, True, 2.2), (RETURN, False, 0.05)]] * 5
            driven, kept = Driven(shown, plans, stall=(2, held_up)), Memory()
            run_session(begin(trials(5)), driven, kept)
            for injector in driven.injectors:
                injector.__exit__()
        counts[held_up] = [len(log.late) for log in kept.of(FrameLog)]
    print(
        f"\nlate frames of five trials: {counts[0.0]}; the third held up by {1e3 * seconds:.0f} ms: {counts[seconds]}"
    )


# Start-up and processor time

FIRST_FRAME = """
import os, sys, time
from experiment_app.windows.desktop import DesktopWindow
show = DesktopWindow.show
def once(self, scene):
    show(self, scene)
    print(time.perf_counter() - float(sys.argv[1]), time.process_time(), flush=True)
    os._exit(0)
DesktopWindow.show = once
from experiment_app.command import run
run(sys.argv[2:])
"""


def first_frame() -> None:
    """From the command to the first frame of the shipped study, as a whole process."""
    rounds = []
    for _ in range(4):
        with tempfile.TemporaryDirectory() as data:
            arguments = ["run", "walk_ratio", "--participant", "P1", "--data", data, "--window", "--size", "640x360"]
            command = [sys.executable, "-c", FIRST_FRAME, str(time.perf_counter()), *arguments]
            said = subprocess.run(command, check=True, capture_output=True, text=True).stdout.split()[-2:]
            rounds.append((float(said[0]), float(said[1])))
    row("first frame after the command (wall)", min(wall for wall, _ in rounds), 1.5)
    print(f"  of which processor time {min(cpu for _, cpu in rounds):.2f} s", flush=True)


OWN_WORK = """
import time
from dataclasses import replace
from experiment_app.render.renderer import Renderer
from experiment_app.staging import stage
from experiment_app.walkers import drawn_walkers, pose_checksum
from experiment_app.windows.offscreen import offscreen_context
from protocols.events import Shown
from protocols.plan import TrialStep, make_plan
from protocols.session import advance, begin, handle
from protocols.study_file import read_study
context = offscreen_context()
target = context.simple_framebuffer((1280, 720))
renderer = Renderer(context, (1280, 720), 1.0, 4)
plan = make_plan(read_study("walk_ratio").study, 1, 1)
step = next(step for step in plan.steps if isinstance(step, TrialStep))
session = handle(begin(replace(plan, steps=(step,))), Shown(0.0))
costs = []
for number in range(600):
    begun = time.thread_time()
    scene = stage(advance(session, number / 60))
    walkers = drawn_walkers(scene)
    renderer.draw(scene, walkers, target)
    pose_checksum(walkers)
    costs.append(time.thread_time() - begun)
costs = sorted(costs[60:])
print(context.info["GL_RENDERER"])
print(costs[len(costs) // 2], costs[len(costs) * 9 // 10])
"""


def own_work_per_frame() -> None:
    """Processor time of one frame of an adjustment trial, from session to last drawing call.

    Mesa's switch GALLIUM_NOOP makes its driver do nothing, which leaves our own work and the calls themselves.
    """
    for name, more in (("driver left out", {"GALLIUM_NOOP": "1"}), ("with the driver", {})):
        command = [sys.executable, "-c", OWN_WORK]
        said = subprocess.run(command, check=True, capture_output=True, text=True, env={**os.environ, **more})
        renderer, figures = said.stdout.splitlines()[-2:]
        middle, p90 = map(float, figures.split())
        what = f"CPU per frame of a trial at 720p, {name} ({renderer.split('(')[0].strip()}), median"
        if more:
            row(what, middle, 0.001)
        else:
            print(f"{what:<64}{1e3 * middle:9.3f} ms  (p90 {1e3 * p90:.3f} ms)", flush=True)
