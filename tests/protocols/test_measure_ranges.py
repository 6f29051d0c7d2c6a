"""Reference values and bounds of a planned analysis that its measure can never reach are refused; others are not."""

from __future__ import annotations

import pytest

from protocols.mistakes.consistency import inconsistencies
from tests.protocols.studies import edited

T_TESTS = "  normality: shapiro_wilk"


def said(study: str, *replacements: tuple[str, str]) -> str:
    mistakes = inconsistencies(edited(study, *replacements).study)
    return "\n".join(f"{'.'.join(map(str, m.where))}: {m.message}" for m in mistakes)


@pytest.mark.parametrize(
    ("study", "old", "new", "sentence"),
    [
        ("crowd_variety", '"1:5": 0.5', '"1:5": 50', "analysis.t_tests.0.against.1:5: correct can be 0 to 1, so its "
         "mean is never 50; 50 % is 0.5"),
        ("crowd_variety", T_TESTS, "    - {against: 2, label: two}\n" + T_TESTS,
         "analysis.t_tests.1.against: correct can be 0 to 1, so its mean is never 2; 2 % is 0.02"),
        ("speed_editing", "blend: 50", "blend: 150", "confusion_rate can be 0 to 100, so its mean is never 150"),
        ("fourier_naturalness", T_TESTS, "  t_tests:\n    - {against: 50}\n" + T_TESTS,
         "analysis.t_tests.0.against: rating can be 0 to 4, so its mean is never 50"),
        ("walk_ratio", "F1: 0.00690", "F1: -0.00690", "walk_ratio can be 0 or more, so its mean is never -0.0069"),
        ("crowd_variety", T_TESTS, "  equivalence:\n    - {factor: size, bound: 5}\n" + T_TESTS,
         "analysis.equivalence.0.bound: correct can be 0 to 1, so differences are never more than 5; 5 % is 0.05"),
        ("fourier_naturalness", T_TESTS, "  equivalence:\n    - {factor: style, bound: 4}\n" + T_TESTS,
         "analysis.equivalence.0.bound: rating can be 0 to 4, so differences are never more than 4"),
    ],
)  # fmt: skip
def test_a_value_that_the_measure_never_has_is_refused_with_its_range(study, old, new, sentence):
    found = said(study, (old, new))
    assert "\n" not in found
    assert found.endswith(sentence)


@pytest.mark.parametrize(
    ("study", "old", "new"),
    [
        ("crowd_variety", '"1:5": 0.5', '"1:5": 1'),  # all correct: at the very end, but possible
        ("speed_editing", "blend: 50", "blend: 0.5"),  # half a percent
        ("fourier_naturalness", T_TESTS, "  t_tests:\n    - {against: 2.3}\n" + T_TESTS),  # between two points
        ("walk_ratio", "M2: 0.00700}", "M2: 0.00700, gone: -1}"),  # of an actor no longer shown
    ],
)
def test_a_value_that_a_mean_can_have_is_left_alone(study, old, new):
    assert said(study, (old, new)) == ""


def test_shares_of_gaze_are_percentages_whatever_the_task():
    gaze = "  also:\n    - measure: gaze_share\n      label: Gaze\n      unit: '%'\n      anova: {within: [region]}\n"
    tests = "      t_tests: [{against: 120}]\n"
    text = "  exclusions: []"
    assert "gaze_share can be 0 to 100, so its mean is never 120" in said("walk_ratio", (text, gaze + tests + text))


def test_a_scale_upside_down_is_told_once():
    upside_down = ("minimum: 0, maximum: 4", "minimum: 4, maximum: 0")
    tests = (T_TESTS, "  t_tests:\n    - {against: 2}\n" + T_TESTS)
    assert said("fourier_naturalness", upside_down, tests) == "task.scale: minimum 4 is not below maximum 0"
