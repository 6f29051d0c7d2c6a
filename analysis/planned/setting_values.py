"""The values of a study file's settings in every condition of its design."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from analysis.errors import AnalysisError
from protocols.setting import references, value_of


def values_of(setting: Any, conditions: Sequence[Mapping[str, Any]]) -> list[Any]:
    """The value of a setting in every condition: `$factor`, a table by a factor's levels, or a constant."""
    if setting is None:
        raise AnalysisError("The study file does not say which actor, speed or start value is shown.")
    unknown = [name for name in references(setting) if name not in conditions[0]]
    if unknown:
        raise AnalysisError(f"The study file refers to {f'${unknown[0]}'!r}, which is no factor.")
    try:
        return [value_of(setting, condition) for condition in conditions]
    except KeyError as error:
        raise AnalysisError(f"The study's simulation says nothing about the level {error}.") from None
