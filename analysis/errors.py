"""What goes wrong in an analysis, said in sentences a person can act on."""

from __future__ import annotations


class AnalysisError(ValueError):
    """Something a person can put right: a wrong file, column, level or design.

    Its text is one or more complete sentences that name the participants, cells or
    levels concerned and say what to do.
    """


class AnalysisWarning(UserWarning):
    """A result was computed, but on something other than what was handed in."""


def check_share(name: str, value: float, usual: float) -> None:
    """Raises AnalysisError unless `value` lies between 0 and 1, both excluded; `usual` is shown as an example."""
    if not 0 < value < 1:
        raise AnalysisError(f"{name} is a share between 0 and 1, as {usual:g}, not {value!r}.")


def listed(names: object, most: int = 8) -> str:
    """'P01, P02 and P03': at most `most` names, then how many more there are."""
    words = [str(name) for name in names]  # type: ignore[attr-defined]
    if len(words) > most:
        return ", ".join(words[:most]) + f" and {len(words) - most} more"
    if len(words) < 2:
        return "".join(words)
    return ", ".join(words[:-1]) + " and " + words[-1]
