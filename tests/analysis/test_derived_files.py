"""A report replaces what an earlier one of the same data wrote, and never anything else."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from analysis import AnalysisError
from analysis.planned_analysis import analyse
from tests.analysis.recorded import study_text, write_study


@pytest.fixture(scope="module")
def data(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write_study(tmp_path_factory.mktemp("data") / "walk_ratio", 4)


def test_what_an_earlier_plan_drew_is_gone_from_the_next_report(data: Path, tmp_path: Path) -> None:
    """Else a figure of yesterday's plan would lie beside today's tables as if it belonged to them."""
    analyse(data, tmp_path / "out")
    assert (tmp_path / "out" / "means_actor.png").exists()
    plain = re.sub(r"(?ms)^  figures:.*?(?=^  \S|\Z)", "", study_text())
    assert "figures" not in plain
    written = analyse(write_study(tmp_path / "walk_ratio", 4, plain), tmp_path / "out").paths
    left = {path for path in (tmp_path / "out").rglob("*") if path.is_file() and path.name[0] != "."}
    assert left == set(written)


def test_a_report_of_other_data_is_not_replaced(data: Path, tmp_path: Path) -> None:
    analyse(data, tmp_path / "out")
    before = (tmp_path / "out" / "report.html").read_bytes()
    other = write_study(tmp_path / "other_study", 4, study="other_study")
    with pytest.raises(AnalysisError, match="holds the report of simulated participants of walk_ratio, this one is of"):
        analyse(other, tmp_path / "out")
    real = write_study(tmp_path / "walk_ratio", 4, simulated=False)
    with pytest.raises(AnalysisError, match=r"this one is of walk_ratio; name another folder with --out\.$"):
        analyse(real, tmp_path / "out")
    assert (tmp_path / "out" / "report.html").read_bytes() == before


def test_a_table_somebody_changed_and_a_file_of_theirs_are_not_replaced(data: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"
    out.mkdir()
    (out / "trials.csv").write_text("collected by hand")
    with pytest.raises(AnalysisError, match=r"trials\.csv was not written by gaitlab and is in the way of the report"):
        analyse(data, out)
    assert (out / "trials.csv").read_text() == "collected by hand"
    (out / "trials.csv").rename(out / "mine.csv")
    analyse(data, out)
    (out / "anova.csv").write_text("with a column of mine")
    with pytest.raises(AnalysisError, match=r"anova\.csv was changed since the report was made; move it away"):
        analyse(data, out)
    analyse(data, out, over_edits=True)
    assert (out / "anova.csv").read_text().startswith("effect,")
    assert (out / "mine.csv").read_text() == "collected by hand"
