"""What check says about balance and about one participant, and that it is what a run then shows; dropping out."""

from __future__ import annotations

import pytest

from experiment_app.checking.balance import balance, order_in_words, what_participant_sees
from experiment_app.command import run
from experiment_app.errors import UsageError
from experiment_app.participants.arrivals import participant_number
from experiment_app.participants.dropping_out import drop_out
from experiment_app.run_folder import journal_lines
from experiment_app.simulated.simulate import simulate
from protocols.study_file import StudyFile, parse_study
from tests.experiment_app.sessions import opened, play
from tests.protocols.studies import changed, ordered, short, study


def between() -> StudyFile:
    """The short study with a viewing condition that the program assigns, and speeds in a square."""
    return parse_study(
        "between.yaml",
        short()
        .text.replace("    sex: [female, male]  ", "    sex: [female, male]\n    viewing: [screen, headset]")
        .replace("planned: 22", "planned: 8\n  assigned: [viewing]")
        .replace("order: random", "order: {kind: balanced_latin_square, of: actor}"),
    )


def line(run, kind):
    return next(entry for entry in journal_lines(run.journal)[0] if entry["kind"] == kind)


def test_what_check_says_participant_7_will_see_is_what_a_run_shows(tmp_path):
    for number in range(1, 8):
        run = opened(tmp_path, f"P{number:02d}")
        play(run)
    shown = [
        ", ".join(f"{name} {level}" for name, level in entry["factors"].items())
        for entry in journal_lines(run.run.journal)[0]
        if entry["kind"] == "trial" and not entry["practice"]
    ]
    said = [text.split(": ")[1] for text in what_participant_sees(short().study, 7) if text.startswith("    trial")]
    assert said == shown


def test_the_session_of_a_participant_is_told_step_by_step():
    lines = what_participant_sees(between().study, 3)
    assert lines[0] == "What participant 3 will see (P03, first run)"
    assert lines[1] in ("  group: viewing screen", "  group: viewing headset")
    assert lines[2] == "  row 1 of the square: actor F1 - actor M1"
    assert "  questions: age, sex, vision" in lines
    assert lines.index("  block 1") < lines.index("  block 2")
    assert lines[-1] == "  debrief: Thank you!"


def test_another_seed_is_another_order_of_the_same_participant():
    assert what_participant_sees(study(), 7, seed=1) != what_participant_sees(study(), 7)
    assert what_participant_sees(study(), 7, seed=1) == what_participant_sees(study(), 7, seed=1)


def test_the_balance_of_groups_rows_and_halves_is_counted():
    lines = balance(between().study)
    assert lines[0] == "Balance over the 8 planned participants"
    assert lines[1:3] == ["  assigned viewing screen: 4 participants", "  assigned viewing headset: 4 participants"]
    assert "  row 1 (4 participants): actor F1 - actor M1" in lines
    # 8 people, 2 trials of each actor: half of the people see F1 first, so 8 trials in either half
    assert any("F1 8 | 8" in text for text in lines)


def test_a_number_of_participants_that_does_not_fill_the_square_says_which_would():
    lines = balance(ordered(study(), kind="balanced_latin_square", of="speed"))
    assert any("22 is no multiple of the 6 rows: places are balanced with 18 or 24 participants" in x for x in lines)
    assert sum(int(x.split("(")[1].split()[0]) for x in lines if x.startswith("  row")) == 22


def test_the_order_is_said_in_words():
    limited = ordered(study(), kind="random", at_most_in_a_row={"actor": 2}, repeats_at_least_apart=6)
    assert order_in_words(limited) == (
        "random order, at most 2 in a row with the same actor, repeats at least 6 trials apart"
    )


def test_check_prints_it_for_a_study_file(tmp_path, capfd):
    path = tmp_path / "mine.yaml"
    path.write_text(changed(("order: random", "order: {kind: random, at_most_in_a_row: {actor: 2}}")), encoding="utf-8")
    assert run(["check", str(path), "--participant-number", "7"]) == 0
    said = capfd.readouterr().out
    assert "What participant 7 will see" in said
    assert "trial  96:" in said
    assert run(["check", str(path), "--participant-number", "0"]) == 2


def test_check_refuses_limits_that_cannot_be_kept_with_line_and_way_out(tmp_path, capfd):
    path = tmp_path / "mine.yaml"
    path.write_text(changed(("order: random", "order: {kind: random, at_least_apart: {speed: 4}}")), encoding="utf-8")
    assert run(["check", str(path)]) == 2
    said = capfd.readouterr().err
    assert "mine.yaml:" in said
    assert "order.at_least_apart.speed: a level returns after at most 3 trials" in said


def test_who_drops_out_gives_group_and_row_back_to_the_next(tmp_path):
    file = between()
    runs = [opened(tmp_path, f"P{number:02d}", file) for number in (1, 2, 3)]
    groups = [line(run.run, "header")["group"] for run in runs]
    assert sorted(group["viewing"] for group in groups[:2]) == ["headset", "screen"]
    for run_ in runs:
        run_.journal.close()
    drop_out(tmp_path / "walk_ratio", "P02")
    again = opened(tmp_path, "P04", file)
    assert again.participant_number == 2
    assert line(again.run, "header")["group"] == groups[1]
    again.journal.close()
    assert participant_number(tmp_path, "walk_ratio", "P05") == 4
    assert line(runs[1].run, "end")["reason"] == "dropped out"


def test_a_finished_participant_cannot_drop_out_and_nobody_twice(tmp_path):
    play(opened(tmp_path, "P01"))
    with pytest.raises(UsageError, match="has finished"):
        drop_out(tmp_path / "walk_ratio", "P01")
    opened(tmp_path, "P02").journal.close()
    drop_out(tmp_path / "walk_ratio", "P02")
    with pytest.raises(UsageError, match="given the place back already"):
        drop_out(tmp_path / "walk_ratio", "P02")
    with pytest.raises(UsageError, match="there are: P01, P02"):
        drop_out(tmp_path / "walk_ratio", "P03")
    with pytest.raises(UsageError, match="is no study's folder"):
        drop_out(tmp_path / "other", "P01")


def test_simulated_groups_are_equal_and_cross_the_question_and_the_analysis_sees_them(tmp_path):
    from analysis import analyse

    runs = list(simulate(between(), 8, tmp_path))
    cells = [
        (line(run, "header")["group"]["viewing"],
         next(e["value"] for e in journal_lines(run.journal)[0] if e.get("question") == "sex"))
        for run in runs
    ]  # fmt: skip
    assert {cell: cells.count(cell) for cell in set(cells)} == {
        ("screen", "female"): 2, ("screen", "male"): 2, ("headset", "female"): 2, ("headset", "male"): 2,
    }  # fmt: skip
    analyse(tmp_path / "walk_ratio", tmp_path / "report")
    header, first, *_ = (tmp_path / "report" / "trials.csv").read_text(encoding="utf-8").splitlines()
    assert dict(zip(header.split(","), first.split(","), strict=True))["viewing"] == cells[0][0]
