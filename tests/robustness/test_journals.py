"""Spoiled journals: whoever reads them gets what was recorded, or one sentence; participants' words break nothing."""

from __future__ import annotations

import json
from collections import Counter
from html.parser import HTMLParser
from pathlib import Path
from random import Random

import pytest

from analysis.planned_analysis import analyse
from protocols.record import Answered, decode_line, encode_line
from tests.experiment_app.sessions import opened, play
from tests.journals import resealed, rewrite
from tests.protocols.studies import changed, short
from tests.robustness.judging import journal_verdict
from tests.robustness.mutation import SCALARS, spoiled_bytes


@pytest.fixture(scope="module")
def recorded(tmp_path_factory) -> tuple[Path, bytes]:
    """A finished run's journal and its bytes."""
    run = opened(tmp_path_factory.mktemp("journal"))
    play(run)
    return run.journal.path, run.journal.path.read_bytes()


def data_of(journal: Path) -> Path:
    return journal.parents[4]


@pytest.mark.parametrize("seed", range(4))
def test_spoiled_bytes_of_a_journal_are_read_up_to_the_damage_or_refused(recorded, tmp_path, seed):
    journal, content = recorded
    verdicts: Counter[str] = Counter()
    for number in range(15):
        journal.write_bytes(spoiled_bytes(content, Random(f"{seed}/{number}")))
        verdicts[journal_verdict(data_of(journal), "walk_ratio", "P01", tmp_path / "out")] += 1
    journal.write_bytes(content)
    assert any("refused" in verdict for verdict in verdicts), verdicts


@pytest.mark.parametrize("seed", range(4))
def test_lines_with_right_checksums_and_wrong_contents_are_refused_in_one_sentence(recorded, tmp_path, seed):
    """Nobody but a forger or another version writes those; even then there is no traceback."""
    journal, content = recorded
    lines = content.rstrip(b"\n").split(b"\n")
    rng, verdicts = Random(seed), Counter[str]()
    for _ in range(25):
        place = rng.randrange(len(lines))
        records = [decode_line(line.decode("utf-8")) for line in lines]
        values = records[place]
        member = rng.choice([name for name in values if name not in ("study_text",)])
        if rng.random() < 0.4:
            del values[member]
        else:
            values[member] = rng.choice((*SCALARS, None, [], {}, -1, 1e308, True, {"a": [1]}))
        journal.write_bytes("".join(f"{line}\n" for line in resealed(records)).encode("utf-8", "surrogatepass"))
        verdicts[journal_verdict(data_of(journal), "walk_ratio", "P01", tmp_path / "out")] += 1
    journal.write_bytes(content)
    assert sum(verdicts.values()) == 25


class Tags(HTMLParser):
    """Counts the tags of a page."""

    def __init__(self) -> None:
        super().__init__()
        self.found: Counter[str] = Counter()

    def handle_starttag(self, tag: str, attrs: list) -> None:
        self.found[tag] += 1
        self.found.update(name for name, _ in attrs if name.startswith("on"))


def tags_of(report: Path) -> Counter[str]:
    parser = Tags()
    parser.feed(report.read_text(encoding="utf-8"))
    return parser.found


HARM = '</td></tr></table><script>alert(1)</script><img src=x onerror=alert(2)> " \' & \x00 \u202e =HYPERLINK("x")'


def test_neither_a_participants_words_nor_a_studys_can_break_the_report(tmp_path):
    """The same runs with harmless and with harmful texts give reports with the same tags."""
    found = []
    for name, text in (("mild", "nothing to say"), ("harm", HARM)):
        study = short_with(f"{name} {text}")
        for participant in ("P01", "P02", "P03"):
            run = opened(tmp_path / name, participant, study)
            play(run)
            said = decode_line(encode_line(Answered(1.0, "remarks", text)))
            rewrite(run.journal.path, lambda records, said=said: [*records[:2], said, *records[2:]])
        analyse(tmp_path / name / "walk_ratio", tmp_path / f"report-{name}")
        report = tmp_path / f"report-{name}" / "report.html"
        assert "<script>alert" not in report.read_text(encoding="utf-8")
        found.append(tags_of(report))
    assert found[0] == found[1]
    assert found[1]["script"] == found[0]["script"]
    assert found[1]["onerror"] == 0


def short_with(words: str):
    """The short study whose title and label are given words."""
    from protocols.study_file import parse_study

    text = short().text.replace("title: Which walk looks most natural?", f"title: {json.dumps(words)}", 1)
    return parse_study("s.yaml", text.replace("  label: Walk ratio", f"  label: {json.dumps(words)}", 1))


def test_the_texts_of_the_test_are_in_the_study():
    assert changed(("  label: Walk ratio", "  label: x"))
