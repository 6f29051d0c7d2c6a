"""A run with adaptive placement, from the study file to the journal and on after an interruption."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import pytest

from experiment_app.checking.balance import order_in_words
from experiment_app.checking.check import summary
from experiment_app.run_folder import journal_lines, participant_runs
from protocols.events import Closed
from protocols.mistakes.consistency import inconsistencies
from protocols.orders.adaptive import after_response, begin_tracks
from protocols.record import TrialRecord
from protocols.session import answer_columns, handle
from protocols.study_file import StudyFile, parse_study
from tests.experiment_app.sessions import opened, play
from tests.protocols.studies import changed

RULES = {
    "staircase": "{kind: staircase, start: [120, 80], steps: [2, 1]}",
    "weighted": "{kind: weighted, up: 2}",
    "quest_plus": "{kind: quest_plus, guess: 0.0, spreads: [2, 8]}",
}


def adaptive(rule: str) -> StudyFile:
    """Two actors whose start is placed by whether the walk ratio is above 0.006; 12 trials per track."""
    file = parse_study(
        "adaptive.yaml",
        changed(
            ("actor: [F1, F2, M1, M2]  ", "actor: [F1, M1]"),
            ("speed: [0.8, 1.0, 1.2]  ", "speed: [1.0]"),
            ("start: [80, 120]  ", "start: [80, 90, 100, 110, 120]"),
            ("repetitions: 4  ", "repetitions: 12"),
            ("order: random", f"order: {{kind: adaptive, of: start, yes: walk_ratio >= 0.006, rule: {RULES[rule]}}}"),
            ("within: [actor, speed, start]", "within: [actor, start]"),
            ("{factor: speed, bound: 0.0003}", "{factor: actor, bound: 0.0003}"),
            ("F1: 0.00690, F2: 0.00560, M1: 0.00700, M2: 0.00700", "F1: 0.00690, M1: 0.00700"),
            ("{kind: interaction, x: actor, lines: speed}", "{kind: interaction, x: actor, lines: start}"),
        ),
    )
    assert inconsistencies(file.study) == []
    return file


@pytest.mark.parametrize(
    ("rule", "settling"),  # Levitt (1971), table I: 70.7 %; Kaernbach (1991), equation 1: 2 / (2 + 1)
    [("staircase", ", settling at 71 % yes"), ("weighted", ", settling at 67 % yes"), ("quest_plus", "")],
)
def test_check_says_where_a_staircase_settles(rule, settling):
    assert order_in_words(adaptive(rule).study).endswith(f"yes where walk_ratio >= 0.006{settling}")


def trials(run):
    lines = journal_lines(run.journal)[0]
    return [line for line in lines if line["kind"] == "trial" and not line["practice"]]


@pytest.mark.parametrize("rule", RULES)
def test_every_level_shown_follows_from_the_answers_before_it(rule, tmp_path):
    file = adaptive(rule)
    run = opened(tmp_path, study=file)
    play(run)
    shown = trials(run.run)
    assert len(shown) == (48 if rule == "staircase" else 24)
    tracks = begin_tracks(file.study)
    for trial in shown:
        assert trial["factors"]["start"] == tracks[trial["track"]].level
        tracks = after_response(file.study, tracks, trial["track"], {**trial["factors"], **trial["response"]})
    begun = {
        line["number"]: line["factors"]
        for line in journal_lines(run.run.journal)[0]
        if line["kind"] == "begin" and not line["practice"]
    }
    assert begun == {trial["number"]: trial["factors"] for trial in shown}


@pytest.mark.parametrize("rule", RULES)
def test_after_an_interruption_the_levels_go_on_as_if_there_had_been_none(rule, tmp_path, monkeypatch):
    import experiment_app.loop as loop

    file = adaptive(rule)
    finished = 0

    def stopping(session, event):
        """Closes the window in the middle of the eighth trial."""
        nonlocal finished
        before = len(session.emitted)
        session = handle(session, event)
        finished += sum(isinstance(r, TrialRecord) and not r.practice for r in session.emitted[before:])
        return handle(session, Closed(event.time, "window closed")) if finished == 8 else session

    monkeypatch.setattr(loop, "handle", stopping)
    first = opened(tmp_path, study=file)
    play(first)
    monkeypatch.setattr(loop, "handle", handle)
    assert len(trials(first.run)) == 8
    again = opened(tmp_path, study=file)
    assert again.continued
    play(again)
    tracks = begin_tracks(file.study)
    for trial in trials(again.run):
        assert trial["factors"]["start"] == tracks[trial["track"]].level
        tracks = after_response(file.study, tracks, trial["track"], {**trial["factors"], **trial["response"]})
    assert [t["number"] for t in trials(again.run)] == list(range(1, len(trials(again.run)) + 1))
    assert any(line["kind"] == "continue" for line in journal_lines(again.run.journal)[0])


def test_a_block_that_is_done_again_counts_with_its_second_answers(tmp_path, monkeypatch):
    import experiment_app.loop as loop

    text = adaptive("staircase").text.replace("practice:", "resume: {policy: block}\npractice:", 1)
    file = parse_study("adaptive.yaml", text)
    finished = 0

    def stopping(session, event):
        """Closes the window after the sixth trial, in the middle of the second block of four tracks."""
        nonlocal finished
        before = len(session.emitted)
        session = handle(session, event)
        finished += sum(isinstance(r, TrialRecord) and not r.practice for r in session.emitted[before:])
        return handle(session, Closed(event.time, "window closed")) if finished == 6 else session

    monkeypatch.setattr(loop, "handle", stopping)
    play(opened(tmp_path, study=file))
    monkeypatch.setattr(loop, "handle", handle)
    again = opened(tmp_path, study=file)
    play(again)
    attempts = [(trial["number"], trial["attempt"]) for trial in trials(again.run)]
    assert attempts[:8] == [(1, 1), (2, 1), (3, 1), (4, 1), (5, 1), (6, 1), (5, 2), (6, 2)]
    tracks = begin_tracks(file.study)
    for trial in [trial for trial in trials(again.run) if (trial["number"], trial["attempt"]) not in ((5, 1), (6, 1))]:
        assert trial["factors"]["start"] == tracks[trial["track"]].level
        tracks = after_response(file.study, tracks, trial["track"], {**trial["factors"], **trial["response"]})


def ending(repetitions: int = 30, more: str = "") -> StudyFile:
    """Four tracks that end after four reversals of one up one down, with a break after every sixth trial."""
    text = adaptive("staircase").text.replace("steps: [2, 1]", "steps: [2, 1], down_after: 1, reversals: 4")
    text = text.replace("repetitions: 12", f"repetitions: {repetitions}").replace("every: 24", "every: 6")
    return parse_study("adaptive.yaml", text.replace("practice:", f"{more}practice:", 1))


def fits(file: StudyFile, shown: list[dict]) -> None:
    """Every level follows from the answers before it, in the order of the plan, and every track ends as it should."""
    tracks = begin_tracks(file.study)
    for trial in sorted(shown, key=lambda trial: trial["number"]):
        track = trial["track"]
        assert not tracks[track].ended
        assert trial["factors"]["start"] == tracks[track].level
        tracks = after_response(file.study, tracks, track, {**trial["factors"], **trial["response"]})
        assert trial["track_reversals"] == len(tracks[track].reversals)
        last = "trials" if trial["repetition"] == file.study.repetitions else ""
        assert trial["track_end"] == ("reversals" if tracks[track].ended else last)
    assert sum(track.ended for track in tracks.values()) >= 2
    assert {trial["track"] for trial in shown if trial["track_end"]} == set(tracks)


def test_tracks_end_with_their_reversals_and_the_others_go_on(tmp_path):
    file = ending()
    assert inconsistencies(file.study) == []
    run = opened(tmp_path, study=file)
    play(run)
    shown = trials(run.run)
    fits(file, shown)
    assert len(shown) < 120
    last = {trial["track"]: trial["number"] for trial in shown}
    assert len(set(last.values())) == 4
    assert max(last.values()) == shown[-1]["number"]
    lines = journal_lines(run.run.journal)[0]
    order = [line["kind"] for line in lines if line["kind"] == "trial" or line.get("why") == "set break"]
    assert ("pause", "pause") not in pairwise(order)  # no two breaks without a trial between
    assert order[-1] == "trial"
    assert lines[-2]["reason"] == "finished"


def test_check_says_how_tracks_end_and_how_many_trials_there_can_be():
    said = "\n".join(summary(ending()))
    assert "4 tracks of at most 30 trials = at most 120 trials" in said
    assert "each track ends after 4 reversals" in said
    assert "at most about" in said


def test_tracks_that_run_out_of_trials_end_so(tmp_path):
    file = ending(repetitions=6)
    play(opened(tmp_path, study=file))
    (run,) = participant_runs(tmp_path, file.study.study, "P01")
    ends = {trial["track"]: trial["track_end"] for trial in trials(run)}
    assert set(ends.values()) <= {"trials", "reversals"}
    assert "trials" in ends.values()


@pytest.mark.parametrize("policy", ["trial", "block"])
@pytest.mark.parametrize("places", [(5,), (9, 3), (13, 8, 2), (18, 1, 1)])
def test_tracks_that_end_go_on_after_interruptions_as_if_there_had_been_none(policy, places, tmp_path, monkeypatch):
    import experiment_app.loop as loop

    file = ending(more=f"resume: {{policy: {policy}}}\n")
    for place in places:
        finished = 0

        def stopping(session, event, place=place):
            nonlocal finished
            before = len(session.emitted)
            session = handle(session, event)
            finished += sum(isinstance(r, TrialRecord) and not r.practice for r in session.emitted[before:])
            return handle(session, Closed(event.time, "window closed")) if finished == place else session

        monkeypatch.setattr(loop, "handle", stopping)
        play(opened(tmp_path, study=file))
    monkeypatch.setattr(loop, "handle", handle)
    again = opened(tmp_path, study=file)
    play(again)
    newest = {trial["number"]: trial for trial in trials(again.run)}
    ended, counting = set(), []
    for number in sorted(newest):  # an answer left of a block done again may follow the end of its track
        trial = newest[number]
        if trial["track"] not in ended:
            counting.append(trial)
        if trial["track_end"]:
            ended.add(trial["track"])
    fits(file, counting)


def test_what_counts_as_an_answer_is_what_the_journal_says(tmp_path):
    run = opened(tmp_path, study=adaptive("staircase"))
    play(run)
    line = trials(run.run)[0]
    record = TrialRecord(**{k: v for k, v in line.items() if k not in ("kind", "crc")})
    assert answer_columns(vars(replace(record, response_time=1.0)))["walk_ratio"] == line["response"]["walk_ratio"]
