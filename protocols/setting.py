"""A setting of the stimulus or the task: a constant, `$factor`, or a table of values by the levels of a factor.

speed: 1.1
speed: $speed
speed: {$actor: {F1: 1.24, M1: {$pace: {slow: 0.89, fast: 1.31}}}}
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterator, Mapping
from typing import Annotated, Any, TypeVar

from pydantic import BeforeValidator, Discriminator, Field, Tag, TypeAdapter, ValidationError

from protocols.mistakes.mistake import Mistake, Place, no_such
from protocols.mistakes.wrong_types import wrong_type
from protocols.parts import Level, Number, Part, Reference, Speed, StepFrequency, Text

FACTOR, TABLE, CONSTANT = "$factor", "$table", "$constant"


def kind_of(value: Any) -> str:
    """Which of the three forms of a setting a value has."""
    if isinstance(value, Mapping):
        return TABLE
    return FACTOR if isinstance(value, str) and value.startswith("$") else CONSTANT


def _one_factor(table: Any) -> Any:
    """Refuses what is no table, also further inside, where pydantic does not look."""
    factor, values = next(iter(table.items())) if len(table) == 1 else ("", {})
    if not isinstance(factor, str) or not factor.startswith("$") or not isinstance(values, Mapping) or not values:
        raise ValueError("a table names one factor and its levels, as {$speed: {0.8: ..., 1.2: ...}}")
    for value in values.values():
        if isinstance(value, Mapping):
            _one_factor(value)
    return table


Table = Annotated[dict[str, dict[Level, Any]], BeforeValidator(_one_factor)]
T = TypeVar("T")
SettingOf = Annotated[
    Annotated[Reference, Tag(FACTOR)] | Annotated[Table, Tag(TABLE)] | Annotated[T, Tag(CONSTANT)],
    Discriminator(kind_of),
]
"""A setting whose values are of type T: one of them, `$factor`, or a table."""

NameSetting = SettingOf[Text]
SpeedSetting = SettingOf[Speed]
Probability = Annotated[float, Field(strict=True, ge=0.0, le=1.0)]
Seconds = Annotated[float, Field(strict=True, gt=0.0, le=600.0)]
NumberSetting = SettingOf[Number]
ProbabilitySetting = SettingOf[Probability]
SecondsSetting = SettingOf[Seconds]
StepFrequencySetting = SettingOf[StepFrequency]


def value_of(setting: Any, levels: Mapping[str, Level]) -> Any:
    """A setting's value in a trial with these levels; raises KeyError where a table has none for a level."""
    kind = kind_of(setting)
    if kind == FACTOR:
        return levels[setting[1:]]
    if kind == CONSTANT:
        return setting
    ((factor, values),) = setting.items()
    return value_of(values[levels[factor[1:]]], levels)


def lacking(setting: Any, levels: Mapping[str, Level]) -> Iterator[tuple[str, Level, tuple[Level, ...]]]:
    """The factor and its level for which a table has no value in a trial with these levels, and those it has one for.

    Nothing where the setting has a value, or the trial no level of the factor.
    """
    if kind_of(setting) != TABLE:
        return
    ((factor, values),) = setting.items()
    level = levels.get(factor[1:])
    if level is not None and level not in values:
        yield factor[1:], level, tuple(values)
    elif level is not None:
        yield from lacking(values[level], levels)


def references(setting: Any) -> Iterator[str]:
    """Names of the factors a setting depends on, each as often as it is named."""
    kind = kind_of(setting)
    if kind == FACTOR:
        yield setting[1:]
    elif kind == TABLE:
        ((factor, values),) = setting.items()
        yield factor[1:]
        for value in values.values():
            yield from references(value)


def leaves(setting: Any, place: Place, factors: Mapping[str, list[Level]]) -> Iterator[tuple[Any, Place]]:
    """Every value a setting can have in the design, and its place in the file; factors that do not exist have none."""
    kind = kind_of(setting)
    if kind == CONSTANT:
        yield setting, place
    elif kind == FACTOR:
        for i, level in enumerate(factors.get(setting[1:], [])):
            yield level, ("factors", setting[1:], i)
    else:
        ((factor, values),) = setting.items()
        for level, value in values.items():
            yield from leaves(value, (*place, factor, level), factors)


LIMITS = {"ge": "at least", "gt": "more than", "le": "at most", "lt": "less than"}
"""Limits of numbers, as pydantic calls them, in words."""

Given = tuple[Any, Place, Any]
"""A setting, its place, and the type of its values."""


def setting_mistakes(given: Given, factors: Mapping[str, list[Level]]) -> Iterator[Mistake]:
    """Factors that do not exist, levels without a value, and values that do not fit what the setting takes."""
    setting, place, kind = given
    if kind_of(setting) == FACTOR and setting[1:] not in factors:
        yield Mistake(place, no_such(setting, [f"${f}" for f in factors], "factor"))
    elif kind_of(setting) == FACTOR:
        for i, level in enumerate(factors[setting[1:]]):
            yield from unfit(level, kind, ("factors", setting[1:], i), place)
    elif kind_of(setting) == TABLE:
        ((factor, values),) = setting.items()
        if factor[1:] not in factors:
            yield Mistake((*place, factor), no_such(factor, [f"${f}" for f in factors], "factor"), on_key=True)
            return
        missing = [str(level) for level in factors[factor[1:]] if level not in values]
        if missing:
            yield Mistake((*place, factor), f"a value for {', '.join(missing)} is missing", on_key=True)
        for level, value in values.items():
            if kind_of(value) == CONSTANT:
                yield from unfit(value, kind, (*place, factor, level), place)
            else:
                yield from setting_mistakes((value, (*place, factor, level), kind), factors)


def unfit(value: Any, kind: Any, where: Place, place: Place) -> Iterator[Mistake]:
    """The mistake of a value that the setting at `place` cannot take, if it is one."""
    try:
        TypeAdapter(kind).validate_python(value)
    except ValidationError as error:
        found = error.errors(include_url=False)[0]
        name = ".".join(str(part) for part in place)
        if found["type"] in ("float_type", "int_type"):
            quoted = "; take the quotes away" if "take the quotes" in wrong_type(found["type"], value) else ""
            yield Mistake(where, f"{value!r} is not a number, and {name} takes it from here{quoted}")
        elif found["type"] == "greater_than" and found["ctx"]["gt"] == 0.0:
            yield Mistake(where, f"{value} must be more than 0")
        elif set(found.get("ctx", {})) & LIMITS.keys():
            limits = " and ".join(f"{LIMITS[end]} {limit:g}" for end, limit in found["ctx"].items() if end in LIMITS)
            yield Mistake(where, f"{value} is out of range; for {name} it must be {limits}")
        elif found["type"] == "literal_error":
            yield Mistake(where, f"{value} is not allowed for {name}; allowed: {found['ctx']['expected']}")
        else:
            why = wrong_type(found["type"], value) or f"{value!r}: {found['msg'][0].lower() + found['msg'][1:]}"
            yield Mistake(where, f"{why}, for {name}")


class SettingsPart(Part, ABC):
    """A part some of whose values are settings; `takes()` says which, and the type of their values."""

    @classmethod
    @abstractmethod
    def takes(cls) -> dict[str, Any]:
        """Field to the type of its values, for every field that is a setting."""

    def settings(self, place: Place) -> Iterator[Given]:
        """Every setting that is given, also in parts of this part, with its place under `place`."""
        for name, kind in self.takes().items():
            value = getattr(self, name)
            if value is not None:
                yield value, (*place, name), kind
        for name, value in self:
            if isinstance(value, SettingsPart):
                yield from value.settings((*place, name))
