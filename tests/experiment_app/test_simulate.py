"""Simulated observers go through the same trials, loop and journal, and their preferences come back out."""

from __future__ import annotations

from collections import Counter
from statistics import mean

import pytest

from experiment_app.errors import UsageError
from experiment_app.run_folder import journal_lines
from experiment_app.simulated.observer import draw_observer
from experiment_app.simulated.simulate import simulate
from protocols.study_file import parse_study, read_study
from tests.experiment_app.sessions import opened, play
from tests.protocols.studies import changed, shipped_text, short, study


def responses(run, **levels):
    return [
        line["response"]["walk_ratio"]
        for line in journal_lines(run.journal)[0]
        if line["kind"] == "trial" and not line["practice"] and levels.items() <= line["factors"].items()
    ]


def test_the_same_seed_gives_the_same_journal_apart_from_the_start_time(tmp_path, monkeypatch):
    """Checksums go on from line to line, so they follow from the start too: at one second every byte is the same."""
    journals = []
    for folder, second in (("a", 1), ("b", 1), ("c", 2)):
        monkeypatch.setattr("experiment_app.opening._utc_now", lambda second=second: f"2026-11-24T12:00:0{second}Z")
        (run,) = simulate(short(), 1, tmp_path / folder, seed=5)
        journals.append(run.journal)
    first, again, later = journals
    assert first.read_bytes() == again.read_bytes()
    assert first.read_bytes() != later.read_bytes()
    checks = {"started": None, "after": None, "crc": None}
    content = [[{**line, **checks} for line in journal_lines(journal)[0]] for journal in (first, later)]
    assert len(content[0]) > 10
    assert content[0] == content[1]


def test_observers_without_noise_answer_their_own_preference_to_half_a_percent(tmp_path):
    text = shipped_text()
    for sd in ("0.00065", "0.00062", "0.00051", "0.00058"):
        text = text.replace(f"sd: {sd}", "sd: 0.0")
    file = parse_study("s.yaml", text.replace("trial_noise: 0.0004", "trial_noise: 0.0"))
    (run,) = simulate(file, 1, tmp_path)
    # release slips by 15 ms at 10 steps/min per s: 0.15 steps/min of 100, so 0.3 % of a walk ratio
    assert mean(responses(run, actor="F1")) == pytest.approx(0.00573, rel=0.005)
    assert mean(responses(run, actor="M1")) == pytest.approx(0.00658, rel=0.005)


def test_participants_fill_the_between_factor_in_turn(tmp_path):
    answers = [
        next(line["value"] for line in journal_lines(run.journal)[0] if line.get("question") == "sex")
        for run in simulate(short(), 4, tmp_path)
    ]
    assert answers == ["female", "male", "female", "male"]


def test_simulating_again_leaves_finished_participants_as_they_are(tmp_path):
    first = [run.journal.read_bytes() for run in simulate(short(), 2, tmp_path)]
    second = [run.journal.read_bytes() for run in simulate(short(), 3, tmp_path)]
    assert second[:2] == first


def test_another_study_file_or_seed_is_refused_rather_than_mixed_in(tmp_path):
    list(simulate(short(), 1, tmp_path, seed=1))
    with pytest.raises(UsageError, match="simulated with another seed"):
        list(simulate(short(), 1, tmp_path, seed=2))
    other = parse_study("s.yaml", short().text + "\n# edited\n")
    with pytest.raises(UsageError, match="simulated with another version of the study file"):
        list(simulate(other, 1, tmp_path, seed=1))


def test_simulated_participants_are_not_mixed_with_real_ones(tmp_path, monkeypatch):
    import experiment_app.opening as opening

    real = opening.open_new
    run = real(short(), "P01", tmp_path, display={}, simulated=False)
    play(run)
    with pytest.raises(UsageError, match="holds real participants"):
        list(simulate(short(), 1, tmp_path))


def test_without_a_simulation_section_the_observers_are_the_published_ones():
    text = shipped_text()
    bare = parse_study("s.yaml", text[: text.index("# Simulated observers")]).study
    # Niay (2022), table 3.4: the published means and standard deviations, as the shipped study spells them out
    assert bare.simulation.preferred_walk_ratio == study().simulation.preferred_walk_ratio
    assert bare.simulation.preferred_walk_ratio["M1"].mean == 0.00658
    assert draw_observer(bare, 1, 7) == draw_observer(study(), 1, 7)


def test_anchoring_pulls_the_answer_towards_the_start(tmp_path):
    text = changed(("trial_noise: 0.0004", "anchoring: 0.4\n  trial_noise: 0.0"))
    (run,) = simulate(parse_study("s.yaml", text), 1, tmp_path)
    assert mean(responses(run, start=80)) > mean(responses(run, start=120)) * 1.1


def test_22_participants_of_96_trials_record_2112_trials(tmp_path):
    runs = list(simulate(read_study("walk_ratio"), 22, tmp_path))
    assert sum(len(responses(run)) for run in runs) == 2112


def test_the_plan_and_its_order_depend_on_participant_and_seed_only(tmp_path):
    a, b = opened(tmp_path / "a"), opened(tmp_path / "b")
    assert a.plan == b.plan
    a.journal.close()
    b.journal.close()


def test_simulated_participants_fill_every_combination_of_groups_equally() -> None:
    """Two factors of two groups: 8 participants are two in each of the four combinations."""
    text = changed(
        ("    sex: [female, male]  ", "    sex: [female, male]\n    vision: ['yes', 'no']"),
    )
    study = parse_study("s.yaml", text).study
    answers = [draw_observer(study, number, seed=3).answers for number in range(1, 9)]
    assert Counter((a["sex"], a["vision"]) for a in answers) == dict.fromkeys(
        (("female", "yes"), ("male", "yes"), ("female", "no"), ("male", "no")), 2
    )
