"""The text of a journal: whatever is done to it is seen, but for whole lines cut off its end."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from protocols.journal_text import DamagedJournalError, JournalText, read_text
from protocols.record import Answered, Consented, Ended, PageShown, checksum_of, decode_line, encode_line, sealed
from tests.analysis.recorded import journal_lines
from tests.journals import rechained

HEADER = decode_line(journal_lines("P01", 1, "study: s", trials=0)[0])

TIMES = st.floats(0, 1e4)
WORDS = st.text(st.characters(exclude_categories=["Cs"]), max_size=12)
RECORDS = st.one_of(
    st.builds(Answered, TIMES, WORDS, st.one_of(WORDS, st.integers())),
    st.builds(PageShown, TIMES, WORDS, TIMES),
    st.builds(Consented, TIMES, st.booleans()),
)


@st.composite
def journals(draw: st.DrawFn) -> list[str]:
    """The lines of a finished run; some of its records are the same as others."""
    records = draw(st.lists(RECORDS, min_size=2, max_size=8))
    return rechained([sealed(HEADER), *map(encode_line, [*records, records[0], Ended(9.0, "finished")])])


def written(lines: list[str]) -> bytes:
    return "".join(f"{line}\n" for line in lines).encode("utf-8")


def seen(content: bytes, original: list[str]) -> bool:
    """Whether a reader learns that a journal is not what was written."""
    try:
        text = read_text(content)
    except DamagedJournalError as error:
        return 1 <= error.line <= error.lines
    headed = bool(text.records) and text.records[0]["kind"] == "header"
    return bool(text.torn) or not headed or len(text.records) < len(original)  # its readers look for header and end


@given(journals())
def test_what_was_written_is_read(lines):
    text = read_text(written(lines))
    assert text == JournalText(tuple(map(decode_line, lines)), checksum_of(lines[-1]), 0, True)


@given(journals(), st.data())
def test_any_line_left_out_doubled_or_moved_is_seen(lines, data):
    place = data.draw(st.integers(0, len(lines) - 2))
    other = data.draw(st.integers(0, len(lines)))
    assert seen(written(lines[:place] + lines[place + 1 :]), lines)
    assert seen(written([*lines[:other], lines[place], *lines[other:]]), lines)
    moved = lines[:place] + lines[place + 1 :]
    moved.insert(other, lines[place])
    assert moved == lines or seen(written(moved), lines)


@given(journals(), st.data())
def test_any_two_lines_exchanged_are_seen(lines, data):
    one, two = data.draw(st.lists(st.integers(0, len(lines) - 1), min_size=2, max_size=2, unique=True))
    lines[one], lines[two] = lines[two], lines[one]
    with pytest.raises(DamagedJournalError, match=r"removed|moved|doubled|put in"):
        read_text(written(lines))


@given(journals(), st.data())
def test_a_line_replaced_by_another_with_a_right_checksum_of_its_own_is_seen(lines, data):
    """As by a program that knows how a line ends, but not the one before it; in the last line it cannot be seen."""
    place = data.draw(st.integers(1, len(lines) - 2))
    after = data.draw(st.sampled_from(["", checksum_of(lines[place - 1])]))
    new = encode_line(Answered(0.0, "age", 1000), after)
    with pytest.raises(DamagedJournalError):
        read_text(written([*lines[:place], new, *lines[place + 1 :]]))


@given(journals(), st.data())
def test_any_byte_altered_left_out_or_put_in_is_seen(lines, data):
    content = written(lines)
    place = data.draw(st.integers(0, len(content) - 1))
    byte = data.draw(
        st.binary(min_size=1, max_size=1).filter(lambda new: new not in (content[place : place + 1], b"\r"))
    )
    assert seen(content[:place] + byte + content[place + 1 :], lines)
    assert seen(content[:place] + content[place + 1 :], lines)
    assert seen(content[:place] + byte + content[place:], lines)


@given(journals(), st.data())
def test_a_journal_cut_anywhere_is_read_up_to_there_and_is_no_longer_finished(lines, data):
    """No line follows those cut off, so nothing but the missing end can tell."""
    content = written(lines)
    text = read_text(content[: data.draw(st.integers(0, len(content) - 1))])
    assert text.records == tuple(map(decode_line, lines))[: len(text.records)]
    assert not text.records or text.records[-1]["kind"] != "end"


def test_line_ends_of_windows_which_a_program_for_versions_may_put_in_change_nothing():
    content = written(journal_lines("P01", 1, trials=4))
    assert read_text(content.replace(b"\n", b"\r\n")).records == read_text(content).records


def test_lines_of_the_earlier_form_name_no_line_before_and_are_read():
    lines = [sealed({**HEADER, "format": 1}), encode_line(Consented(1.0, True)), encode_line(Ended(2.0, "finished"))]
    text = read_text(written(lines))
    assert (len(text.records), text.chained) == (3, False)


def test_the_lines_of_another_run_are_no_part_of_this_one():
    mine, others = journal_lines("P01", 1, trials=4), journal_lines("P02", 2, trials=4)
    with pytest.raises(DamagedJournalError, match="line before it is missing") as caught:
        read_text(written([*mine[:6], *others[6:]]))
    assert (caught.value.line, caught.value.lines) == (7, 10)
