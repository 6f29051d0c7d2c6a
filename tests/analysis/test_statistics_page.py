"""docs/statistics.md is true: its commands run, its Python works, its plan is accepted, its numbers are today's."""

from __future__ import annotations

import re
import shlex
import subprocess
import sys
from pathlib import Path

import pytest

from analysis.check_reference import worst_differences
from experiment_app.command import run
from protocols.mistakes.consistency import inconsistencies
from protocols.study_file import parse_study
from tests.analysis.recorded import study_text, write_study
from tests.analysis.reference import path

PAGE = (Path(__file__).parents[2] / "docs" / "statistics.md").read_text(encoding="utf-8")


def blocks(language: str) -> list[str]:
    return re.findall(rf"```{language}\n(.*?)```", PAGE, re.S)


def test_every_gaitlab_command_and_the_python_run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    write_study(tmp_path / "data" / "walk_ratio", 6)  # in place of the slower `gaitlab simulate`, tested elsewhere
    lines = [line for block in blocks("sh") for line in block.splitlines()]
    commands = [shlex.split(line) for line in lines if line.startswith("gaitlab ")]
    assert [words[1] for words in commands] == ["simulate", "analyse", "power", "power", "power", "power"]
    for words in commands:
        if words[1] != "simulate":
            assert run(words[1:]) == 0, words
    assert (tmp_path / "report" / "report.html").exists()
    (python,) = blocks("python")
    code = (
        f"import sys; sys.path.insert(0, {str(Path(__file__).parents[2])!r})\n{python}\nprint(len(table), len(pairs))"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.split() == ["15", "6"]


def test_the_plan_on_the_page_is_accepted() -> None:
    plan, choices = blocks("yaml")
    head, _, rest = study_text().partition("\nanalysis:")
    text = f"{head}\n{plan}\n{rest[rest.index('# Simulated observers') :]}"
    assert inconsistencies(parse_study("page.yaml", text).study) == []
    choosing = Path(__file__).with_name("choosing.yaml").read_text(encoding="utf-8")
    head, rest = choosing[: choosing.index("analysis:")], choosing[choosing.index("simulation:") :]
    assert inconsistencies(parse_study("page.yaml", f"{head}{choices}{rest}").study) == []


def test_no_difference_from_r_is_larger_than_the_page_says() -> None:
    folder = path("15_power.json").parent
    if not all((folder / name).is_file() for name in ("02_mixed_2x2_2x2.csv", "18_higgins1990_table5.csv")):
        pytest.skip("not all reference files are here")
    found = worst_differences(folder)
    print(found.to_string())
    rows = re.findall(r"^\| ([^|]+?) \| (\d+) \| (\S+) (relative|absolute) \|$", PAGE, re.M)
    page = {what: (int(values), float(worst)) for what, values, worst, _ in rows}
    assert set(page) == set(found["what"])
    for row in found.itertuples():
        assert row.values == page[row.what][0], row.what
        # the last digits of rounding differ between machines
        assert row.worst <= max(10 * page[row.what][1], 1e-11), row.what


def test_statsmodels_mixed_model_and_pingouins_bayes_factor_agree_with_ours() -> None:
    import warnings

    import numpy as np
    import pingouin
    from statsmodels.regression.mixed_linear_model import MixedLM

    from analysis import mixed_model
    from analysis.statistics.bayes_factor import jzs
    from tests.analysis.reference import expected, table

    for t, n in ((0.4, 12), (2.3, 22), (8.44, 22)):
        assert jzs(t, n - 1, n) == pytest.approx(float(pingouin.bayesfactor_ttest(t, n, r=2**0.5 / 2)), rel=1e-8)
    design = expected("16_crossed_lmm")["design"]
    data = table("16_crossed_lmm", design)
    ours = mixed_model(data, "ratio", "id", "actor", "speed")
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        theirs = MixedLM.from_formula(
            "ratio ~ C(speed, Sum)", data, groups=np.ones(len(data)), vc_formula={"id": "0+C(id)", "a": "0+C(actor)"}
        ).fit(reml=True)
    rows = ours[ours["part"] == "coefficient"]
    assert rows["estimate"].to_numpy() == pytest.approx(theirs.fe_params.to_numpy(), rel=1e-4)
    assert -2 * theirs.llf == pytest.approx(ours.attrs["reml"], abs=1e-4)
