"""The timing certificate: what it says of displays and runs whose timing is known by construction."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from experiment_app.command import run
from experiment_app.loop import run_session
from experiment_app.opening import open_new
from experiment_app.run_folder import journal_lines
from experiment_app.simulated.observer import SimulatedParticipant, draw_observer
from experiment_app.timing.certificate import markdown, methods_paragraph, rows, verdict
from experiment_app.timing.facts import Timing, timing_of_run
from experiment_app.timing.page import write_certificate
from protocols.session import begin
from tests.experiment_app.test_loop import PERIOD, Display
from tests.protocols.studies import short

LABORATORY = {
    "window": "desktop", "pixels": [1920, 1080], "full_screen": True, "monitor": "VG248", "monitors": 1,
    "platform": "X11", "compositor": "none", "screen_pixels": [1920, 1080], "screen_mm": [531, 299],
    "screen_scale": 1.0, "reported_refresh_hz": 60, "period_s": 1 / 60, "swap_waits_for_display": True,
    "bare_swaps_ms": [16.67] * 18, "gl_renderer": "A card", "gl_vendor": "Maker", "gl_version": "4.6", "samples": 4,
    "keyboard": {"source": "x-server", "clock_offset_between_ms": [-0.03, 0.6]}, "clock_resolution_ns": 1.0,
}  # fmt: skip


def timing(**about: object) -> Timing:
    """A thousand frames in time on a good laboratory display, with what is to differ."""
    return Timing(
        what="run", about={**LABORATORY, **about}, intervals=(1 / 60,) * 999, period=1 / 60, errors=(0.0002,) * 1000,
        cpu_ms=(0.9,) * 1000, trials=5, sources={"x-server": 20}, uncertainties=(0.5,) * 20,
    )  # fmt: skip


def test_frames_in_time_on_a_synchronised_display_are_publishable():
    judged = verdict(timing())
    assert (judged.level, judged.reasons) == ("publishable", ())
    assert dict(rows(timing()))["VSYNC"].startswith("proven")
    assert "60.000 Hz measured, 60 Hz reported" in dict(rows(timing()))["Refresh"]
    assert "53.1 x 29.9 cm" in dict(rows(timing()))["Display"]


@pytest.mark.parametrize(
    ("about", "reason"),
    [
        ({"swap_waits_for_display": False, "reported_refresh_hz": 0}, "Not synchronised"),
        ({"gl_renderer": "llvmpipe (LLVM 15)"}, "The processor draws"),
        ({"window": "off-screen"}, "drawn off-screen"),
        ({"window": "undrawn"}, "drawn undrawn"),
    ],
)
def test_what_cannot_be_published_says_why(about, reason):
    judged = verdict(timing(**about))
    assert judged.level == "not publishable"
    assert any(reason in sentence for sentence in judged.reasons)


@pytest.mark.parametrize(
    ("about", "reason"),
    [
        ({"compositor": "GNOME"}, "A compositor (GNOME)"),
        ({"full_screen": False}, "in a window"),
        ({"reported_refresh_hz": 75}, "reports 75 Hz but refreshes at 60.00 Hz"),
    ],
)
def test_what_may_delay_frames_is_a_caveat(about, reason):
    judged = verdict(timing(**about))
    assert judged.level == "publishable with caveats"
    assert any(reason in sentence for sentence in judged.reasons)


@pytest.mark.parametrize(
    ("late", "level"), [(0, "publishable"), (5, "publishable with caveats"), (11, "not publishable")]
)
def test_late_frames_count_by_their_share(late, level):
    judged = verdict(replace(timing(), late=(("3", late),) if late else ()))
    assert judged.level == level
    assert bool(judged.reasons) == bool(late)


def test_coarse_key_times_are_a_caveat():
    judged = verdict(replace(timing(), uncertainties=(0.5,) * 15 + (12.0,) * 5, sources={"arrival": 20}))
    assert judged.level == "publishable with caveats"
    assert "uncertain by 12.0 ms" in judged.reasons[0]


def test_the_methods_paragraph_holds_the_numbers_of_the_run():
    said = methods_paragraph(replace(timing(), late=(("2", 1),)))
    for part in ("1920 x 1080", "A card", "16.667 ms", "1 of 1000 frames were late", "x-server", "not measured"):
        assert part in said


def played(tmp_path: Path, **stall: float):
    """A run of the short study on a display made of numbers, in a real journal."""
    study = short()
    opened = open_new(study, "P01", tmp_path, display=LABORATORY, simulated=False)
    person = SimulatedParticipant(opened.plan.study, draw_observer(opened.plan.study, 1, 1), 1)
    with opened.journal as journal:
        run_session(begin(opened.plan), WaitingDisplay(person, journal.wait, **stall), journal)
    return opened.run


class WaitingDisplay(Display):
    """The display of the loop's tests, which also waits for the disk where its clock would run ahead of it."""

    def __init__(self, person: SimulatedParticipant, wait, **stall: float) -> None:
        super().__init__(person, 0.004, **stall)  # type: ignore[arg-type]
        self.wait = wait

    def poll(self, session):
        self.wait()
        return super().poll(session)


def test_a_stall_of_40_ms_is_on_the_certificate_with_its_trial(tmp_path):
    undisturbed = timing_of_run(journal_lines(played(tmp_path / "a").journal)[0])
    assert (undisturbed.late, undisturbed.trials) == ((), 6)
    assert undisturbed.intervals == pytest.approx([PERIOD] * len(undisturbed.intervals), abs=2e-6)
    onsets = [line for line in journal_lines(played(tmp_path / "a2").journal)[0] if line["kind"] == "begin"]
    frame = round((onsets[3]["time"] + 1.0) / PERIOD)
    stalled = timing_of_run(journal_lines(played(tmp_path / "b", stall_at=frame, stall=0.040).journal)[0])
    assert stalled.late == ((str(onsets[3]["number"]), 1),)
    assert f"1 of {stalled.frames} in 1 of 6 trials: {onsets[3]['number']} (1)" in dict(rows(stalled))["Late frames"]


def test_a_pause_is_no_late_frame():
    log = {"kind": "frames", "number": 1, "practice": False, "attempt": 1, "period": 0.1, "late": [],
           "flips": [0.0, 0.1, 9.0, 9.1], "predicted": [0.0, 0.1, 9.0, 9.1], "cpu_ms": [1] * 4,
           "stretches": [0, 2]}  # fmt: skip
    header = {"kind": "header", "study": "s", "participant": "P", "run": 1, "display": LABORATORY}
    assert timing_of_run([header, log]).intervals == pytest.approx([0.1, 0.1])


def test_the_certificate_is_a_file_beside_the_journal_and_the_command_prints_the_same(tmp_path, capfd):
    recorded = played(tmp_path)
    assert "see" in write_certificate(recorded)
    text = (recorded.folder / "timing.md").read_text(encoding="utf-8")
    assert text == markdown(timing_of_run(journal_lines(recorded.journal)[0]))
    assert run(["certificate", str(recorded.folder)]) == 0
    assert capfd.readouterr().out == text
    assert run(["certificate", str(tmp_path)]) == 2
    assert "holds no journal" in capfd.readouterr().err
