"""Whatever is done to a study file, it is accepted or refused with file, line and column, and does nothing else."""

from __future__ import annotations

import os
from collections import Counter

import pytest

from experiment_app.command import run
from protocols.study_file import StudyFileError, parse_study, read_study
from tests.protocols.studies import changed, short
from tests.robustness.judging import spoiled_studies


def test_spoiled_study_files_are_accepted_or_refused_with_their_place(tmp_path):
    """`python -m tests.benchmarks.mutants 10000` does as many as one likes."""
    verdicts = Counter(verdict for _, _, verdict in spoiled_studies(short().text, tmp_path, 120))
    assert set(verdicts) == {"accepted", "refused"}
    assert verdicts["refused"] > verdicts["accepted"] > 5, "the mutations are too mild, or too wild, to test anything"


@pytest.mark.slow
def test_a_thousand_more(tmp_path):
    assert sum(1 for _ in spoiled_studies(short().text, tmp_path, 1000, seed=1)) == 1000


@pytest.mark.parametrize(
    "tag",
    ["!!python/object/apply:os.system ['touch owned']", "!!python/name:os.system", "!!python/object/new:os.system [x]"],
)
def test_a_study_file_cannot_run_code(tmp_path, monkeypatch, tag, capfd):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "s.yaml").write_text(changed(("title: Which walk looks most natural?", f"title: {tag}")), "utf-8")
    assert run(["check", "s.yaml"]) == 2
    assert "s.yaml:7:8: title" in capfd.readouterr().err
    assert os.listdir(tmp_path) == ["s.yaml"]


@pytest.mark.parametrize("where", ["../../../etc/passwd", "/etc/passwd", "~/.ssh/id_rsa", "..", "C:\\boot.ini"])
@pytest.mark.parametrize(
    ("key", "line"),
    [("actor: $actor", "  actor: {}"), ("ground: open_ground", "  body: {}\n  ground: open_ground")],
    ids=["actor", "body"],
)
def test_a_study_file_cannot_read_outside_its_folder(tmp_path, where, key, line):
    """Names of actors and bodies are looked up among those that exist, never opened as paths."""
    from experiment_app.checking.check import checked_study

    text = changed((f"  {key}", line.format(f'"{where}"'.replace("\\", "\\\\"))))
    (tmp_path / "s.yaml").write_text(text, encoding="utf-8")
    with pytest.raises(StudyFileError, match=r"there is no (actor|body) "):
        checked_study(str(tmp_path / "s.yaml"))


@pytest.mark.parametrize("name", ["../elsewhere", "/tmp/x", "a/b", "..", "", "con\\x", "x\n"])
def test_the_name_of_a_study_cannot_lead_out_of_the_data_folder(name):
    import json

    with pytest.raises(StudyFileError, match="study"):
        parse_study("s.yaml", changed(("study: walk_ratio", f"study: {json.dumps(name)}")))


def laughs(levels: int) -> str:
    """The "billion laughs": each line means ten of the line before."""
    lines = ["a0: &a0 [ha, ha, ha, ha, ha, ha, ha, ha, ha, ha]"]
    lines += [f"a{i}: &a{i} [{', '.join([f'*a{i - 1}'] * 10)}]" for i in range(1, levels)]
    return "\n".join(lines) + "\n"


@pytest.mark.parametrize("text", [laughs(9), "a: &a [*a]\n", "a: &a {b: *a}\n", "[" * 1200, "{a: " * 1200])
def test_files_that_mean_more_than_they_hold_are_refused_at_once(text):
    with pytest.raises(StudyFileError, match=r"^s.yaml:\d+:\d+: "):
        parse_study("s.yaml", text)


def test_aliases_of_a_sensible_size_are_welcome():
    text = read_study("walk_ratio").text
    text = text.replace("  - {actor: T1, speed: 1.0, start: 120}", "  - &first {actor: T1, speed: 1.0, start: 120}")
    text = text.replace("  - {actor: T2, speed: 1.0, start: 80}", "  - *first")
    assert len(parse_study("s.yaml", text).study.practice) == 2


def test_a_mapping_as_a_key_is_refused_with_a_sentence():
    with pytest.raises(StudyFileError, match=r"^s.yaml:\d+:\d+: not valid YAML"):
        parse_study("s.yaml", "{a: 1}: {b: 2}\n? {c: 3}\n: 4\n? {c: {d: 5}}\n: 6\n")
