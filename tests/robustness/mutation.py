"""Ways to spoil a file: as a tired person would, as a failing disk would, and as somebody who means harm would."""

from __future__ import annotations

import re
from random import Random

SCALARS = (
    "", "null", "~", "yes", "No", "true", "0", "-1", "1e9", "1e400", ".inf", "-.inf", ".nan", "0x10", "0b1", "1_000",
    "12:30:45", "2024-01-01", "1.0.0", "'", '"', "$speed", "$nothing", "$", "[]", "{}", "[[[[[[[[[[",
    "{a: {b: {c: 1}}}",
    "[1, two, 3.0]", "*anchor", "&anchor 1", "&a [*a]", "!!python/object/apply:os.system ['touch owned']",
    "!!binary aGk=", "!!set {a, b}", "!!omap [a: 1]", "!custom x", "<<: {a: 1}", "| \n  text", "> folded", "\t", "é",
    "漢字", "😀", "\u202e", "\ufeff", "\x00", "\x07", "../../etc/passwd", "/etc/passwd", "C:\\boot.ini", "{lower}",
    "{0.__class__}", "%s%s%n",
    "a" * 5000, "9" * 400, "<script>alert(1)</script>", "'; DROP TABLE x; --", "=1+1", "\u0664", "1e-320", "-0.0",
)  # fmt: skip
"""Values to put where a value stands."""


def spoiled_text(text: str, rng: Random) -> str:
    """A study file's text after one to three mutations of its lines, keys, values or characters."""
    for _ in range(rng.choice((1, 1, 1, 2, 3))):
        text = rng.choice((_value, _value, _value, _key, _lines, _lines, _indent, _characters))(text, rng)
    return text


def spoiled_bytes(content: bytes, rng: Random) -> bytes:
    """Any file's bytes after one to three mutations: flipped bits, holes, repeats, other bytes, a lost end."""
    raw = bytearray(content)
    for _ in range(rng.choice((1, 1, 2, 3))):
        at = rng.randrange(len(raw) + 1) if raw else 0
        span = min(rng.choice((1, 2, 4, 16, 200)), len(raw) - at)
        what = rng.randrange(6)
        if what == 0 and at < len(raw):
            raw[at] ^= 1 << rng.randrange(8)
        elif what == 1:
            del raw[at : at + span]
        elif what == 2:
            raw[at:at] = raw[at : at + span]
        elif what == 3:
            raw[at : at + span] = rng.randbytes(span)
        elif what == 4:
            raw[at : at + span] = rng.choice((b"\xff", b"\x00", b"\x7f", b"9", b"-", b"nan ")) * span
        else:
            del raw[at:]
    return bytes(raw)


def _value(text: str, rng: Random) -> str:
    found = list(re.finditer(r"(?<=[:,\[\-]) *([^\s:,\[\]{}#][^\n,\]}#]*)", text))
    if not found:
        return text
    place = rng.choice(found)
    return f"{text[: place.start()]} {rng.choice(SCALARS)}{text[place.end() :]}"


def _key(text: str, rng: Random) -> str:
    found = list(re.finditer(r"\b(\w+):", text))
    if not found:
        return text
    place, other = rng.choice(found), rng.choice(found)
    new = rng.choice(
        (other[1], place[1][:-1], place[1] + "s", place[1].upper(), "?", "- ", "__class__", rng.choice(SCALARS))
    )
    return text[: place.start()] + new + text[place.end() - 1 :]


def _lines(text: str, rng: Random) -> str:
    lines = text.split("\n")
    at, span = rng.randrange(len(lines)), rng.choice((1, 1, 2, 8))
    part = lines[at : at + span]
    what = rng.randrange(4)
    if what == 0:
        del lines[at : at + span]
    elif what == 1:
        lines[at:at] = part
    elif what == 2:
        del lines[at : at + span]
        to = rng.randrange(len(lines) + 1)
        lines[to:to] = part
    else:
        lines[at:] = []
    return "\n".join(lines)


def _indent(text: str, rng: Random) -> str:
    lines = text.split("\n")
    at = rng.randrange(len(lines))
    lines[at] = rng.choice((" ", "  ", "\t", "      ")) + lines[at] if rng.random() < 0.5 else lines[at].lstrip()
    return "\n".join(lines)


def _characters(text: str, rng: Random) -> str:
    if not text:
        return text
    at = rng.randrange(len(text))
    new = rng.choice(
        ("", chr(rng.randrange(32, 127)), rng.choice(SCALARS), text[at] * 3, "\n", ": ", "#", "'", '"', "[", "}")
    )
    return text[:at] + new + text[at + 1 :]
