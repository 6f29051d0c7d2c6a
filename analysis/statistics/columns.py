"""Columns of a tidy table, read strictly: numbers are numbers, labels are trimmed text.

Knows nothing of designs. Every complaint names the column and what was found in it.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import pandas as pd

from analysis.errors import AnalysisError, listed


@dataclass(frozen=True)
class Labels:
    """A column of labels as codes into its levels; -1 where the row has no label."""

    codes: np.ndarray  # (rows,) int
    levels: tuple[str, ...]
    notes: tuple[str, ...] = ()


def label(value: Any) -> str:
    """The text of a level: trimmed, and 80.0 written as 80; whole numbers keep all their digits."""
    if isinstance(value, (float, np.floating)):
        number = float(value)
        return f"{number:.0f}" if abs(number) < 2**53 and number.is_integer() else f"{number:.12g}"
    return str(value).strip()


def same_decimals(levels: Sequence[str]) -> tuple[str, ...]:
    """Numbers with as many decimals as the longest of them: 0.8, 1, 1.2 becomes 0.8, 1.0, 1.2."""
    tails = [level.partition(".")[2] for level in levels]
    if not any(tails) or not all(_is_number(level) and "e" not in level for level in levels):
        return tuple(levels)
    longest = max(map(len, tails))
    return tuple(f"{float(level):.{longest}f}" for level in levels)


def level_names(values: Iterable[Any]) -> tuple[str, ...]:
    """Levels as written in a study file, as `labels` will name them."""
    listed_values = list(values)
    names = [label(value) for value in listed_values]
    return same_decimals(names) if any(isinstance(v, float) for v in listed_values) else tuple(names)


def numeric_label(value: Any) -> str:
    """`label`, with text that is a number written as the number is: '1.0' as 1."""
    text = label(value)
    return label(float(text)) if _is_number(text) else text


def _is_number(text: str) -> bool:
    try:
        return math.isfinite(float(text))
    except ValueError:
        return False


def require(data: pd.DataFrame, names: Sequence[str]) -> None:
    """Every name is one column of `data`, or a sentence that says which are not."""
    if not all(isinstance(name, str) for name in names):
        raise AnalysisError(
            "Columns are named by text, not by number or position; "
            "give them names first, as data.columns = data.columns.map(str)."
        )
    missing = [name for name in names if name not in data.columns]
    if missing:
        known = listed([repr(str(c)) for c in data.columns], 20)
        raise AnalysisError(f"There is no column {listed(map(repr, missing))}; the columns are {known}.")
    twice = [name for name in dict.fromkeys(names) if list(data.columns).count(name) > 1]
    if twice:
        raise AnalysisError(f"There are several columns called {listed(map(repr, twice))}; keep or rename all but one.")
    if len(data) == 0:
        raise AnalysisError("The table has no rows.")


def require_different(**named: str | None) -> None:
    """The columns play different parts: none is named twice. Raises AnalysisError."""
    given = [name for name in named.values() if name is not None]
    twice = [name for name in dict.fromkeys(given) if given.count(name) > 1]
    if twice:
        raise AnalysisError(
            f"{listed(map(repr, twice))} is named twice, among {listed(named)}; they are different columns."
        )


def require_filled(data: pd.DataFrame, names: Iterable[str]) -> None:
    """Every row has a label in each of these columns, or a sentence that says which has none."""
    for name in names:
        gaps = np.flatnonzero(data[name].isna().to_numpy())
        if gaps.size:
            raise AnalysisError(f"Column {name!r} is empty in row {gaps[0] + 1} ({gaps.size} such row(s)); fill it in.")


def require_other_names(factors: Iterable[str], taken: Iterable[str]) -> None:
    """No factor is called as a column of the result, which would overwrite its levels. Raises AnalysisError."""
    columns = set(taken)
    clashing = [name for name in factors if name in columns]
    if clashing:
        raise AnalysisError(
            f"The result has a column {listed(map(repr, clashing))} of its own; rename the factor, "
            f"as data.rename(columns={{{clashing[0]!r}: {clashing[0] + '_factor'!r}}})."
        )


def require_no_colon(factors: Iterable[str]) -> None:
    """A colon joins the factors of an interaction, so none has it in its name. Raises AnalysisError."""
    odd = [name for name in factors if ":" in name]
    if odd:
        raise AnalysisError(
            f"{listed(map(repr, odd))}: a colon joins the factors of an interaction (as 'a:b'); rename the column."
        )


def numbers(data: pd.DataFrame, name: str) -> np.ndarray:
    """Column `name` as (rows,) float64; missing values are nan.

    Raises AnalysisError naming the first row that holds text, a decimal comma or an infinite value
    (rows are counted from 1, without the heading).
    """
    column = data[name]
    if pd.api.types.is_datetime64_any_dtype(column) or pd.api.types.is_timedelta64_dtype(column):
        raise AnalysisError(
            f"Column {name!r} must hold numbers, but it holds times; write durations in seconds, "
            f"as data[{name!r}].dt.total_seconds()."
        )
    if pd.api.types.is_bool_dtype(column) or pd.api.types.is_numeric_dtype(column):
        values = column.to_numpy(dtype=np.float64, na_value=np.nan)
    else:
        values = np.asarray(pd.to_numeric(column, errors="coerce"), dtype=np.float64)
        wrong = np.flatnonzero(np.isnan(values) & ~column.isna().to_numpy())
        if wrong.size:
            found = str(column.iloc[wrong[0]])
            hint = " Write decimals with a point, not a comma." if "," in found else ""
            raise AnalysisError(
                f"Column {name!r} must hold numbers, but row {wrong[0] + 1} holds {found!r} "
                f"({wrong.size} such row(s)).{hint}"
            )
    infinite = np.flatnonzero(np.isinf(values))
    if infinite.size:
        raise AnalysisError(
            f"Column {name!r} holds an infinite value in row {infinite[0] + 1} "
            f"({infinite.size} such row(s)); correct it or leave it empty."
        )
    return values


def labels(data: pd.DataFrame, name: str, order: Sequence[Any] | None = None) -> Labels:
    """Column `name` as levels in order: `order` if given, else the order of a categorical column,
    else numbers by size and words by alphabet.

    Blanks around a label are removed (and noted); a row with nothing but blanks has no label. Labels
    that differ in capitals only, or that are not in `order`, are an AnalysisError naming the odd level
    and its number of rows; so is a level of `order` that no row has.
    """
    column = data[name]
    categorical = isinstance(column.dtype, pd.CategoricalDtype)
    raw_codes, raw_levels = pd.factorize(column, use_na_sentinel=True)
    numeric = pd.api.types.is_float_dtype(raw_levels)
    key = numeric_label if numeric else label
    texts = [key(value) for value in raw_levels]
    known = dict.fromkeys(text for text in texts if text)
    notes = []
    if categorical and order is None:
        wanted = [key(value) for value in column.cat.categories]
        unused = [text for text in wanted if text and text not in known]
        if unused:
            notes.append(f"No row has the level {listed(map(repr, unused))} of {name!r}; it was left out.")
        ordered = [text for text in dict.fromkeys(wanted) if text in known]
    elif order is not None:
        ordered = list(dict.fromkeys(key(value) for value in order))
        _check_levels(name, ordered, texts, raw_codes)
    else:
        ordered = _natural_order(known)
    _check_capitals(name, ordered, texts, raw_codes)
    for value, text in zip(raw_levels, texts, strict=True):
        if isinstance(value, str) and value != text and text in {label(v) for v in raw_levels if v != value}:
            rows = int(np.sum(raw_codes == texts.index(text)))
            notes.append(f"{name!r}: {value!r} was read as {text!r} (blanks removed; {rows} rows in all).")
    place = {text: position for position, text in enumerate(ordered)} | {"": -1}
    lookup = np.array([*(place[text] for text in texts), -1], dtype=np.intp)
    return Labels(lookup[raw_codes], same_decimals(ordered) if numeric else tuple(ordered), tuple(notes))


def _natural_order(texts: Iterable[str]) -> list[str]:
    try:
        return sorted(texts, key=lambda text: (float(text), text))
    except ValueError:
        return sorted(texts)


def _rows_of(text: str, texts: list[str], codes: np.ndarray) -> int:
    return int(np.isin(codes, [i for i, other in enumerate(texts) if other == text]).sum())


def _check_levels(name: str, ordered: list[str], texts: list[str], codes: np.ndarray) -> None:
    for text in texts:
        if text and text not in ordered:
            rows = _rows_of(text, texts, codes)
            raise AnalysisError(
                f"{name!r} has the level {text!r} in {rows} row(s), which is not one of "
                f"{listed(map(repr, ordered), 20)}; correct the spelling or name it among the levels."
            )
    absent = [text for text in ordered if text not in texts]
    if absent:
        raise AnalysisError(
            f"No row has the level {listed(map(repr, absent))} of {name!r}; "
            f"leave it out of the levels, or add the data."
        )


def _check_capitals(name: str, ordered: list[str], texts: list[str], codes: np.ndarray) -> None:
    seen: dict[str, str] = {}
    for text in ordered:
        twin = seen.setdefault(text.casefold(), text)
        if twin != text:
            few, many = sorted((text, twin), key=lambda t: _rows_of(t, texts, codes))
            raise AnalysisError(
                f"{name!r} has the odd level {few!r} ({_rows_of(few, texts, codes)} row(s)) beside {many!r} "
                f"({_rows_of(many, texts, codes)} rows); if they are the same, spell them alike."
            )
