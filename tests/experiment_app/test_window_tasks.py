"""A choice and a rating in the real window under a virtual display, by injected keys and clicks."""

from __future__ import annotations

import subprocess
import time
from collections.abc import Callable, Iterator
from io import StringIO
from pathlib import Path

import pytest

from experiment_app.render.layout import layout_page
from experiment_app.staging import view_scene
from protocols.plan import TrialStep, make_plan
from protocols.study_file import StudyFile
from tests.experiment_app.test_window import Sitting, number_of, pytestmark  # noqa: F401 - the marks are for this file too
from tests.protocols.studies import edited, few_choices

SIZE = (640, 360)


def without_questions(file: StudyFile) -> str:
    """The study without questions, training and between factors: consent, instructions, trials."""
    from ruamel.yaml import YAML

    yaml, text = YAML(typ="rt"), StringIO()
    document = yaml.load(file.text)
    document["practice"] = []
    document["participants"]["questions"] = []
    document["participants"].pop("between", None)
    for page in ("before_practice", "before_trials"):
        del document["pages"][page]
    document["analysis"] = {"measure": "response_time", "anova": {"within": []}}
    yaml.dump(document, text)
    return text.getvalue()


class Comparing(Sitting):
    """A participant at one of the studies that compare walks."""

    def __init__(self, folder: Path, file: StudyFile) -> None:
        (folder / "short.yaml").write_text(without_questions(file), encoding="utf-8")
        super().__init__(folder)
        self.journal = Path(str(self.journal).replace("walk_ratio", file.study.study))

    def to_the_first_trial(self) -> None:
        self.wait(lambda lines: lines[0]["kind"] == "header")
        time.sleep(1.0)
        self.key("Right", "Return")
        self.wait(lambda lines: number_of(lines, "consent") == 1)
        while self.count("begin") == 0:
            self.key("Return")
            time.sleep(0.6)

    def answers(self) -> list[dict]:
        return [line for line in self.lines() if line["kind"] == "trial"]

    def click(self, title: str, x: int, y: int) -> None:
        place = ["mousemove", "--window", "%1", str(x), str(y), "click", "1"]
        subprocess.run(["xdotool", "search", "--onlyvisible", "--name", title, *place], check=True)


@pytest.fixture
def comparing(tmp_path) -> Iterator[Callable[[StudyFile], Comparing]]:
    people: list[Comparing] = []

    def begin(file: StudyFile) -> Comparing:
        people.append(Comparing(tmp_path, file))
        return people[-1]

    yield begin
    for person in people:
        if person.process.poll() is None:
            person.process.kill()
            person.process.communicate()


def test_a_choice_by_key_and_one_that_is_forced_after_the_limit(comparing):
    person = comparing(
        few_choices(
            ("method: [poulaine, blend, timewarp]", "method: [timewarp]"),
            ("repetitions: 2 ", "repetitions: 1 "),
            ("time_limit: 10 ", "time_limit: 1 "),
            ("interval: 0.7", "interval: 0.1"),
        )
    )
    person.to_the_first_trial()
    person.until_key("Left", "trial")
    person.wait(lambda lines: number_of(lines, "begin") == 2)
    time.sleep(2.5)  # the walks have vanished
    person.until_key("Right", "trial")
    first, second = person.answers()
    assert (first["response"]["side"], second["response"]["side"]) == ("left", "right")
    assert second["response_time"] > 2.0
    assert second["measured"]["beside_speed"] == pytest.approx(1.06, abs=0.05)


def test_a_rating_by_digit_and_enter_and_one_by_pointer_alone(comparing):
    file = edited("fourier_naturalness", ("interval: 0.5", "interval: 0.1"))
    person = comparing(file)
    person.to_the_first_trial()
    time.sleep(1.5)
    person.key("3")
    person.until_key("Return", "trial")
    person.wait(lambda lines: number_of(lines, "begin") == 2)
    time.sleep(1.5)
    plan = make_plan(file.study, 1, 1)
    trial = plan.begin(next(step for step in plan.steps if isinstance(step, TrialStep)))
    page = view_scene(file.study, trial.view, {}).page
    assert page is not None
    layout = layout_page(page, *SIZE, 1.0)
    point, button = layout.sliders[0].points[1], layout.boxes[0].rectangle
    for at in (point, button):
        person.click(file.study.title, at.x + at.width // 2, at.y + at.height // 2)
        time.sleep(0.8)
    person.wait(lambda lines: number_of(lines, "trial") == 2)
    assert [line["response"]["rating"] for line in person.answers()] == [3.0, 1.0]
    assert [line["target"] for line in person.lines() if line["kind"] == "click"] == ["scale:1", "confirm"]
