"""The console on a terminal: a panel that is drawn anew four times a second, and three keys."""

from __future__ import annotations

import os
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from rich.console import Console, Group
from rich.live import Live
from rich.panel import Panel
from rich.progress_bar import ProgressBar
from rich.table import Table
from rich.text import Text

from experiment_app.console.asking import Word, ask
from experiment_app.console.progress import Watched
from experiment_app.console.watching import Watching

EVERY = 0.25
"""s between two looks at the journal."""

SILENT = 60.0
"""s without a new line in a journal after which the console says so: the participant rests, or the run is gone."""

KEYS: dict[str, Word] = {"p": "pause", "r": "resume", "s": "stop"}


def panel(watching: Watching, watched: Watched, silent: float, told: str) -> Panel:
    """What the experimenter sees; silent: s since the journal grew last, told: what was asked last."""
    header = watching.run.header
    kind = "simulated, " if header.get("simulated") else "PILOT, " if header.get("pilot") else ""
    left = watched.minutes_left
    facts = Table.grid(padding=(0, 2))
    facts.add_row("Trials", Text(f"{len(watched.done)} of {watched.total}", style="bold"))
    facts.add_row("", ProgressBar(total=max(watched.total, 1), completed=len(watched.done), width=48))
    facts.add_row("Time left", "-" if left is None else f"about {left:.0f} min")
    facts.add_row("Now", _now(watched, silent))
    share = f"{100.0 * watched.late / watched.frames:.2f} %" if watched.frames else "none drawn yet"
    late = Text(f"{watched.late} of {watched.frames} ({share}); {watched.late_now} in the last trial")
    facts.add_row("Late frames", Text.assemble(("● ", "red" if watched.late_now else "green"), late))
    responses = Text("\n".join(watched.responses) or "none yet")
    hint = told or "p pause   r go on   s stop   q leave the console (the run goes on)"
    title = f"{watching.title}: participant {watching.run.participant}, {kind}run {watching.run.number}"
    return Panel(
        Group(facts, Text("\nLast responses", style="bold"), responses, Text(f"\n{hint}", style="dim")),
        title=Text(title),
    )


def _now(watched: Watched, silent: float) -> Text:
    if watched.ended:
        return Text(f"ended: {watched.ended}", style="bold")
    if watched.paused:
        return Text(f"paused ({watched.paused})", style="yellow")
    quiet = f"; nothing new for {silent / 60.0:.0f} min" if silent > SILENT else ""
    return Text(f"{watched.doing}{quiet}", style="red" if quiet else "")


def show(watching: Watching, terminal: Console) -> None:
    """Shows a run until it has ended or `q` is pressed; keys ask the run to pause, to go on, to stop."""
    told, sure_until, grown, size = "", 0.0, time.monotonic(), -1
    with pressed_keys() as key, Live(console=terminal, refresh_per_second=4, screen=False) as live:
        while True:
            watched, now = watching.look(), time.monotonic()
            bytes_now = watching.run.journal.stat().st_size
            grown, size = (now, bytes_now) if bytes_now != size else (grown, size)
            pressed = key()
            if pressed == "q":
                return
            if pressed == "s" and now > sure_until:
                told, sure_until = "Stop the session? Press s again within 5 s.", now + 5.0
            elif pressed in KEYS:
                ask(watching.run.folder, KEYS[pressed])
                told = f"Asked to {KEYS[pressed]}."
            live.update(panel(watching, watched, now - grown, told))
            if watched.ended:
                return
            time.sleep(EVERY)


@contextmanager
def pressed_keys() -> Iterator[Callable[[], str]]:
    """A function that returns the key pressed since the last call, "" when there is none or no keyboard."""
    if not sys.stdin.isatty():
        yield lambda: ""
    elif os.name == "nt":  # pragma: no cover - exercised on Windows only
        import msvcrt

        yield lambda: msvcrt.getwch() if msvcrt.kbhit() else ""  # type: ignore[attr-defined]
    else:
        import select
        import termios
        import tty

        before = termios.tcgetattr(sys.stdin)
        tty.setcbreak(sys.stdin)
        try:
            yield lambda: os.read(0, 1).decode("utf-8", "replace") if select.select([0], [], [], 0)[0] else ""
        finally:
            termios.tcsetattr(sys.stdin, termios.TCSADRAIN, before)
