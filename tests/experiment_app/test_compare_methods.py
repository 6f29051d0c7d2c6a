"""`gaitlab compare-methods`: the report, its verdict on the published order, and sentences for bad input."""

import csv
from pathlib import Path

import pytest

from analysis.errors import AnalysisError
from analysis.walk_methods.comparison import (
    Comparison,
    RebuildingError,
    published_order,
    rebuilding_anova,
    write_report,
)
from experiment_app.command import run
from experiment_app.comparing_methods import walks_in
from experiment_app.errors import UsageError

CMU = Path(__file__).parents[2].parent / "shared" / "mocap" / "bvh" / "cmu"


def test_the_report_has_every_method_at_three_speeds_and_pictures(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert run(["compare-methods", "F2", "M1", "M2", "--out", "report"]) == 0
    rows = list(csv.DictReader((tmp_path / "report" / "methods.csv").open()))
    methods = {"captured", "timewarp", "fourier", "pca", "poulaine", "blend"}
    assert {(row["person"], row["method"]) for row in rows} == {(p, m) for p in ("F2", "M1", "M2") for m in methods}
    assert len(rows) == 3 * 3 * 6
    for name in ("points", "rebuilding", "error", "films"):
        assert (tmp_path / "report" / f"{name}.png").stat().st_size > 5000
    text = (tmp_path / "report" / "report.md").read_text()
    assert "reduction factor" in text
    assert "from 0 to 10 km/h" in text
    assert "drawn ones" in text
    assert "published order Hermite, PCHIP, cubic spline" in capsys.readouterr().out


def test_a_comparison_made_again_replaces_its_own_files_and_nobody_elses(tmp_path, capfd):
    comparison = Comparison(methods=(), errors=tuple(errors_of(PUBLISHED)), whose="four people")
    first = {path.name: path.read_bytes() for path in write_report(comparison, tmp_path / "out").paths}
    assert {path.name: path.read_bytes() for path in write_report(comparison, tmp_path / "out").paths} == first
    (tmp_path / "out" / "report.md").write_text("my own words", encoding="utf-8")
    with pytest.raises(AnalysisError, match=r"report\.md was changed since the comparison was made"):
        write_report(comparison, tmp_path / "out")
    (tmp_path / "mine").mkdir()
    (tmp_path / "mine" / "methods.csv").write_text("mine", encoding="utf-8")
    assert run(["compare-methods", "F2", "--out", str(tmp_path / "mine")]) != 0
    assert "methods.csv was not written by gaitlab" in " ".join(capfd.readouterr().err.split())
    assert (tmp_path / "mine" / "methods.csv").read_text(encoding="utf-8") == "mine"


@pytest.mark.skipif(not CMU.is_dir(), reason="the shared captures are not beside the checkout")
def test_captures_named_are_those_the_rebuilding_is_tested_on(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert run(["compare-methods", "F2", "--captures", str(CMU / "cmu_07_01.bvh"), "--out", "report"]) == 0
    assert "three people" in capsys.readouterr().out


def errors_of(values):
    """Three people's RMSE: (points, interpolation) -> m, a little different for everyone."""
    return [
        RebuildingError(f"P{person}", "w", "left", points, way, value * (1 + 0.02 * person) + 1e-4 * ((person * i) % 3))
        for person in range(4)
        for i, ((points, way), value) in enumerate(values.items())
    ]


PUBLISHED = {
    (4, "cubic"): 0.05, (4, "pchip"): 0.03, (4, "hermite"): 0.025,
    (5, "cubic"): 0.04, (5, "pchip"): 0.02, (5, "hermite"): 0.015,
}  # fmt: skip


def test_data_in_the_published_order_agree():
    errors = errors_of(PUBLISHED)
    sentences = published_order(errors, rebuilding_anova(errors))
    assert "DO NOT" not in sentences[0] + sentences[1]


def test_data_in_another_order_are_said_to_disagree():
    turned = {key: 0.06 - value for key, value in PUBLISHED.items()}
    errors = errors_of(turned)
    sentences = published_order(errors, rebuilding_anova(errors))
    assert "DO NOT agree" in sentences[0]
    assert "DO NOT agree" in sentences[1]


def test_two_people_are_too_few():
    with pytest.raises(AnalysisError, match="three people"):
        rebuilding_anova([error for error in errors_of(PUBLISHED) if error.person in ("P0", "P1")])


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        ([], "name at least one actor"),
        (["Nobody"], "no actor"),
        (["F2", "--captures", "nowhere"], "no such folder"),
    ],
)
def test_bad_input_is_a_sentence(tmp_path, monkeypatch, capfd, words, sentence):
    monkeypatch.chdir(tmp_path)
    assert run(["compare-methods", *words]) == 2
    assert sentence in capfd.readouterr().err


def test_of_files_without_a_walk_the_reason_of_the_first_is_told(tmp_path):
    (tmp_path / "a.bvh").write_bytes(b"no motion")
    (tmp_path / "b.c3d").write_bytes(b"nor here")
    alone: list[str] = []
    for place in (tmp_path / "a.bvh", tmp_path):
        with pytest.raises(UsageError):
            walks_in(place, alone)
    of_one, of_both = (note.rpartition("the first: ")[2] for note in alone)
    assert of_both == of_one
