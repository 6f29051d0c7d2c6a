"""Why a small YAML file (actor.yaml, a clip's overrides) cannot be read, in words that need no knowledge of YAML."""

from __future__ import annotations

from ruamel.yaml.error import MarkedYAMLError


def yaml_reason(error: Exception) -> str:
    """What to put after the file's name: ", line 3: duplicate key "age"; keep one of the two", say."""
    if not isinstance(error, MarkedYAMLError) or not error.problem:
        why = " ".join(str(error).split())[:160]
        return f": cannot be read ({why}); save it as UTF-8 text with one `key: value` a line"
    line = f", line {error.problem_mark.line + 1}" if error.problem_mark is not None else ""
    if "duplicate key" in error.problem:
        key = error.problem.split('"')[1]
        return f"{line}: {key} is there twice; keep one of the two"
    if "\\t" in error.problem:
        return f"{line}: a tab cannot indent or begin a value in YAML; use spaces"
    return f"{line}: not valid YAML ({' '.join(error.problem.split())}); write one `key: value` a line"
