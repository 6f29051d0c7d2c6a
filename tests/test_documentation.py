"""The documentation is true: commands in the README run, the YAML in the pages is valid, links lead somewhere."""

from __future__ import annotations

import ast
import pkgutil
import re
import shlex
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

from experiment_app.command import run

ROOT = Path(__file__).parents[1]
PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md")), ROOT / "CHANGELOG.md"]


def blocks(path: Path, language: str) -> list[str]:
    return re.findall(rf"```{language}\n(.*?)```", path.read_text(encoding="utf-8"), re.S)


@pytest.mark.slow
def test_the_readmes_path_from_copying_a_study_to_its_report_works(tmp_path, monkeypatch, capfd):
    """Every gaitlab line of the README in order, but for the demo (tested below) and the window."""
    monkeypatch.chdir(tmp_path)
    lines = [line for block in blocks(ROOT / "README.md", "sh") for line in block.splitlines()]
    commands = [line.split("#")[0].strip() for line in lines if line.startswith("gaitlab ")]
    (change,) = blocks(ROOT / "README.md", "yaml")
    assert [c.split()[1] for c in commands] == [
        "demo", "copy", "check", "simulate", "analyse", "run", "analyse",
    ]  # fmt: skip
    for command in commands:
        words = shlex.split(command)[1:]
        if words[0] == "run" or words[0] == "demo" or words[1].startswith("data/"):
            continue
        assert run(words) == 0, (command, capfd.readouterr())
        assert "cannot be run" not in capfd.readouterr().out, command  # every planned test runs
        if words[0] == "copy":
            _apply(tmp_path / "my_study.yaml", change)
    assert (tmp_path / "report_simulated" / "report.html").exists()
    assert (tmp_path / "balance.png").exists()


def _apply(path: Path, change: str) -> None:
    """Makes the README's change to a study file as a person would: replaces the lines with the same keys."""
    text = path.read_text(encoding="utf-8")
    for line in change.splitlines():
        if not line.startswith("factors"):
            key = line.split(":")[0]
            text = re.sub(rf"^{key}:.*$", line, text, count=1, flags=re.M)
    path.write_text(text, encoding="utf-8")


ROOMS = ("protocols", "stimuli", "experiment_app", "analysis", "tests")


def _docstrings(path: Path) -> str:
    named = (ast.Module, ast.ClassDef, ast.FunctionDef)
    nodes = [node for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))) if isinstance(node, named)]
    return "\n".join(ast.get_docstring(node) or "" for node in nodes)


def test_modules_named_in_the_pages_and_in_docstrings_exist():
    texts = {path: path.read_text(encoding="utf-8") for path in PAGES}
    texts |= {path: _docstrings(path) for folder in ROOMS for path in (ROOT / folder).rglob("*.py")}
    for path, text in texts.items():
        for name in re.findall(rf"(?<![\w./])(?:{'|'.join(ROOMS)})(?:\.[a-zA-Z_]\w*)+", text):
            assert _exists(name), f"{path.relative_to(ROOT)} names {name}"


@pytest.mark.parametrize(
    ("command", "says"),
    [
        ("analysis.check_reference nowhere", "nowhere holds no results of R; name the folder"),
        ("stimuli.fitting.gait_model --mocap nowhere", "nowhere has no mocap/REFERENCE_C3D_EVENTS.csv"),
        ("stimuli.fitting.validation --mocap nowhere", "nowhere has no mocap/REFERENCE_C3D_EVENTS.csv"),
        ("stimuli.poulaine.fitting nowhere", "is missing; give the folder of the gait tables"),
        ("tests.benchmarks cups", "there is no benchmark cups; there are: help_text, poses"),
    ],
)
def test_programs_of_the_pages_say_what_is_missing(command, says):
    ran = subprocess.run([sys.executable, "-m", *command.split()], cwd=ROOT, capture_output=True, text=True)
    assert ran.returncode != 0
    assert says in " ".join(ran.stderr.split())
    assert "Traceback" not in ran.stderr


def test_extras_that_are_to_be_installed_exist_and_are_quoted_for_every_shell():
    extras = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]["optional-dependencies"]
    for path in [*PAGES, *(p for room in ROOMS[:-1] for p in (ROOT / room).rglob("*.py"))]:
        for quote, extra in re.findall(r"pip install (['\"]?)gaitlab\[(\w+)\]", path.read_text(encoding="utf-8")):
            assert quote, f"{path.relative_to(ROOT)}: zsh wants quotes around gaitlab[{extra}]"
            assert extra in extras, path.relative_to(ROOT)


def _exists(name: str) -> bool:
    try:
        pkgutil.resolve_name(name)
    except (ImportError, AttributeError):
        return False
    return True


@pytest.mark.parametrize("path", PAGES, ids=lambda p: p.name)
def test_links_and_pictures_lead_somewhere(path):
    for target in re.findall(r"\]\(([^)#]+)\)", path.read_text(encoding="utf-8")):
        if "://" not in target:
            assert (path.parent / target).exists(), target


def test_the_page_about_the_code_says_of_every_folder_what_the_folder_says_of_itself():
    page = (ROOT / "docs" / "code.md").read_text(encoding="utf-8")
    rooms = [ROOT / room for room in ("protocols", "stimuli", "experiment_app", "analysis")]
    for path in (path for room in rooms for path in room.rglob("__init__.py")):
        said = ast.get_docstring(ast.parse(path.read_text(encoding="utf-8")))
        assert said, path
        assert said.splitlines()[0] in page, path


def test_the_page_of_studies_names_all_with_their_participants_and_trials():
    from protocols.orders.design import conditions
    from protocols.study_file import read_study, shipped_studies

    rows = re.findall(
        r"^\| `(\w+)` \|[^|]*\| (\d+) × (\d+) trials",
        (ROOT / "docs" / "studies.md").read_text(encoding="utf-8"),
        re.M,
    )
    studies = {name: read_study(name).study for name in shipped_studies()}
    assert [(name, int(people), int(trials)) for name, people, trials in rows] == [
        (name, study.participants.planned, len(conditions(study)) * study.repetitions)
        for name, study in studies.items()
    ]


def test_the_readme_names_all_studies_with_their_participants_trials_and_minutes(capsys):
    from protocols.study_file import shipped_studies

    rows = re.findall(r"^\| `(\w+)` \| (\d+) × (\d+) trials \| (\d+) \|", (ROOT / "README.md").read_text("utf-8"), re.M)
    assert sorted(row[0] for row in rows) == sorted(shipped_studies())
    for name, people, trials, minutes in rows:
        assert run(["check", name]) == 0
        said = capsys.readouterr().out
        assert f"= {trials} trials" in said
        assert f"{people} participants planned" in said
        (checked,) = re.findall(r"about (\d+) minutes", said)
        assert abs(int(minutes) - int(checked)) <= 2, name


def test_the_yaml_of_the_study_file_page_is_accepted_in_a_study():
    from protocols.mistakes.consistency import inconsistencies
    from protocols.study_file import parse_study
    from tests.protocols.studies import shipped_text

    page = {block.split(":")[0]: block for block in blocks(ROOT / "docs" / "study-file.md", "yaml")}
    questions, keys, words, analysis = page["questions"], page["keys"], page["language"], page["analysis"]
    text = shipped_text()
    start, end = text.index("analysis:\n"), text.index("# Simulated observers")
    text = text[:start] + analysis + "\n" + text[end:]
    start, end = text.index("  questions:"), text.index("# Design")
    text = text[:start] + "".join(f"  {line}\n" for line in questions.splitlines()) + "\n" + text[end:]
    text = re.sub(r"  keys: .*", f"  {keys.strip()}", text)
    text = text.replace("language: en\n", words).replace("stimulus:\n", f"{page['display']}stimulus:\n")
    text = text.replace("  ground: open_ground", f"  ground: street\n  {page['marks'].strip()}")
    for camera in page["camera"].splitlines():
        file = parse_study("page.yaml", re.sub(r"  camera: .*", f"  {camera}", text))
        assert inconsistencies(file.study) == []
    texts = {name for name, field in type(file.study.words).model_fields.items() if field.default}
    assert texts <= file.study.words.model_fields_set, "the French example names every word"


def test_the_views_by_factors_of_the_study_file_page_go_together():
    from protocols.mistakes.consistency import inconsistencies
    from protocols.study_file import parse_study
    from tests.protocols.studies import shipped_text

    (block,) = (b for b in blocks(ROOT / "docs" / "study-file.md", "yaml") if b.startswith("factors:"))
    factors, _, look = block.partition("stimulus:\n")
    levels = "".join(f"  {level}\n" for level in re.findall(r"\w+: \[[^]]*\]", factors))
    text = shipped_text().replace("factors:\n", f"factors:\n{levels}")
    text = re.sub(r"  ground: .*\n  camera: .*\n", look + "\n", text)
    text = re.sub(r"(  - \{actor: T\d[^}]*)\}", r"\1, stands: beside, nearness: near}", text)
    study = parse_study("page.yaml", text).study
    assert inconsistencies(study) == []
    assert study.stimulus.camera.resolved({"stands": "before", "nearness": "far"}).place == (0.0, 8.0)


def test_the_orders_of_the_study_file_page_are_orders():
    from pydantic import TypeAdapter
    from ruamel.yaml import YAML

    from protocols.orders.order import Order

    orders = [block for block in blocks(ROOT / "docs" / "study-file.md", "yaml") if block.startswith("order:")]
    kinds = [TypeAdapter(Order).validate_python(YAML(typ="safe").load(block)["order"]).kind for block in orders]
    assert kinds == ["balanced_latin_square", "random", "adaptive"]


def test_the_tasks_makings_and_tables_of_the_study_file_page_are_accepted():
    from pydantic import TypeAdapter
    from ruamel.yaml import YAML

    from protocols.stimulus import MakingPart, Stimulus
    from protocols.study import Simulation, Task

    page = blocks(ROOT / "docs" / "study-file.md", "yaml")
    begun = ("task:", "making:", "speed:", "simulation:")
    written = [YAML(typ="safe").load(block) for block in page if block.startswith(begun)]
    tasks = [TypeAdapter(Task).validate_python(part["task"]) for part in written if "task" in part]
    assert [task.kind for task in tasks] == ["choice", "rating"]
    (making,) = (MakingPart.model_validate(part["making"]) for part in written if "making" in part)
    assert making.points == 5
    (speed,) = (part["speed"] for part in written if "speed" in part)
    assert Stimulus(actor="$actor", speed=speed).walk({"actor": "F2", "pace": "slow"}).speed == 0.88
    (simulation,) = (Simulation.model_validate(part["simulation"]) for part in written if "simulation" in part)
    assert simulation.choice.spread == 0.4


def test_every_command_of_the_data_page_runs_in_order(tmp_path, monkeypatch, capfd):
    monkeypatch.chdir(tmp_path)
    commands = [line for block in blocks(ROOT / "docs" / "data.md", "sh") for line in block.splitlines()]
    assert len(commands) == 7
    for command in commands:
        assert run(shlex.split(command)[1:]) == 0, (command, capfd.readouterr())
    assert (tmp_path / "tables" / "trace.csv").stat().st_size > 10_000
    assert (tmp_path / "bids" / "sub-S001").exists()
    assert not (tmp_path / "bids" / "sub-S002").exists()


@pytest.mark.slow
def test_the_demo_without_a_screen_ends_with_a_report_tables_a_picture_and_a_film(tmp_path, capfd):
    assert run(["demo", "--off-screen", "--folder", str(tmp_path / "demo")]) == 0
    said = capfd.readouterr().out
    for name in ("report.html", "anova.csv", "trial.webp"):
        (path,) = (tmp_path / "demo").rglob(name)
        assert name in said
        assert path.stat().st_size > 500
    assert (tmp_path / "demo" / "pictures" / "trial.png").exists()
    assert len(list((tmp_path / "demo" / "data").rglob("journal.jsonl"))) == 22
