"""A value of the wrong type, as somebody who types YAML would put it: what it must be, and what to change."""

from __future__ import annotations

import math
from typing import Any

WANTED = {
    "int_type": "a whole number, as 4", "int_from_float": "a whole number, as 4", "int_parsing": "a whole number, as 4",
    "float_type": "a number, as 1.2", "float_parsing": "a number, as 1.2", "finite_number": "a number, as 1.2",
    "string_type": "text", "bool_type": "true or false", "bool_parsing": "true or false",
    "list_type": "a list, as [a, b]", "dict_type": "keys with values, as {key: value}",
    "model_type": "keys with values, as {key: value}", "model_attributes_type": "keys with values, as {key: value}",
}  # fmt: skip
"""Pydantic's name of an error of type -> what a value must be."""


def wrong_type(kind: str, value: Any) -> str:
    """Half a sentence on a value of the wrong type; "" for an error of another kind."""
    wanted = WANTED.get(kind)
    if wanted is None:
        return ""
    if value is None:
        return f"nothing stands here; it must be {wanted} (what follows # is a comment)"
    return f"{shortened(value)} must be {wanted}{_way_out(wanted, value)}"


def shortened(value: Any) -> str:
    """A value as it is shown in a sentence, 60 characters at most."""
    shown = repr(value) if isinstance(value, (str, list, dict, bool, int, float, type(None))) else str(value)
    return shown if len(shown) <= 60 else shown[:57] + "..."


def _way_out(wanted: str, value: Any) -> str:
    if wanted == "text" and isinstance(value, (int, float)):
        return f'; put it into quotes, as "{"yes" if value is True else "no" if value is False else value}"'
    if "number" in wanted and isinstance(value, str) and _is_number(value.replace(",", ".")):
        return "; write it with a point" if "," in value else "; take the quotes away"
    if wanted.startswith("a list") and isinstance(value, str):
        dashes = value.startswith("-") or " " in value.replace(", ", "")
        return "; - and a space begin each line of one" if dashes else f"; put it into brackets, as [{value}]"
    return ""


def _is_number(text: str) -> bool:
    try:
        return math.isfinite(float(text))
    except ValueError:
        return False
