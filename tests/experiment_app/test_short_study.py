"""The demo's short versions of the shipped studies."""

from __future__ import annotations

import math
import re

import pytest

from experiment_app.checking.check import checked_study, expected_minutes
from experiment_app.demonstration.demo import film_trial
from experiment_app.demonstration.short_study import short_study
from protocols.orders.design import make_trials
from protocols.study_file import shipped_studies
from tests.protocols.studies import edited


@pytest.mark.parametrize("name", shipped_studies())
def test_every_shipped_study_has_a_short_version_without_mistakes(name, tmp_path):
    short = short_study(name)
    (tmp_path / short.name).write_text(short.text, encoding="utf-8")
    assert checked_study(str(tmp_path / short.name)).study == short.study
    assert len(make_trials(short.study, 1)) == math.prod(map(len, short.study.factors.values())) <= 16


@pytest.mark.parametrize("name", shipped_studies())
def test_what_a_short_study_tells_its_participant_is_true_of_it(name):
    study = short_study(name).study
    (said,) = re.findall(r"takes about (\w+) minutes?", study.pages.consent.text)
    minutes = {"a": 1, "two": 2, "three": 3}[said]
    assert minutes == pytest.approx(expected_minutes(study), abs=0.6)
    told = " ".join(page.text for page in study.pages.in_order)
    assert "they stay on this computer" in told
    for untrue in ("hour", "ten", "twenty", "28", "published", "experimenter"):
        assert not re.search(rf"\b{untrue}\b", told), untrue
    for seconds in re.findall(r"for (\S+) seconds", told):
        assert float(seconds) == study.task.time_limit


@pytest.mark.parametrize("name", shipped_studies())
def test_a_short_study_plans_no_figure_that_so_few_trials_and_levels_cannot_fill(name):
    analysis = short_study(name).study.analysis
    kinds = {figure.kind for part in (analysis, *analysis.also) for figure in part.figures}
    assert kinds
    assert not kinds & {"order", "regression"}


def test_a_short_study_of_which_the_program_assigns_something_is_filmed(tmp_path):
    bodies = "body: {$viewing: {screen: matched, headset: mismatched}}"
    text = edited("walk_ratio_actors", ("body: $character", bodies)).text
    (tmp_path / "s.yaml").write_text(text, encoding="utf-8")
    film_trial(short_study(str(tmp_path / "s.yaml")), tmp_path)
    assert (tmp_path / "trial.webp").stat().st_size
