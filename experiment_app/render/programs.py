"""Shader programs from the .glsl files beside this module, with #include lines resolved. Knows no scene."""

from __future__ import annotations

import re
from collections.abc import Mapping
from functools import cache
from importlib.resources import files

import moderngl

INCLUDE = re.compile(r'^#include "([a-z_]+\.glsl)"$', re.MULTILINE)


@cache
def shader_text(name: str) -> str:
    """The text of a shader file, with the text of every file it includes in the place of the #include line."""
    text = files("experiment_app.render").joinpath("shaders", name).read_text(encoding="utf-8")
    return INCLUDE.sub(lambda found: shader_text(found.group(1)), text)


def compose(name: str, constants: Mapping[str, str] | None = None) -> str:
    """A whole shader: #version first, then the constants as #define lines, then the rest of the file."""
    version, rest = shader_text(name).split("\n", 1)
    lines = [version, *(f"#define {key} {value}" for key, value in (constants or {}).items())]
    return "\n".join(lines) + "\n" + rest


def build(
    context: moderngl.Context, vertex: str, fragment: str, constants: Mapping[str, str] | None = None
) -> moderngl.Program:
    """The program of two shader files (names without .glsl) under the same constants."""
    return context.program(
        vertex_shader=compose(f"{vertex}.glsl", constants),
        fragment_shader=compose(f"{fragment}.glsl", constants),
    )


def set_if_used(program: moderngl.Program, name: str, value: object) -> None:
    """Sets a uniform; a driver may have removed one that does not change the result. A value it has is not sent again.

    What was sent is kept on the program (its `extra`), so a uniform set here must not be set otherwise too.
    """
    sent = program.extra
    if sent is None:
        sent = program.extra = {}
    if sent.get(name) == value:
        return
    uniform = program.get(name, None)
    if uniform is not None:
        if isinstance(value, bytes):
            uniform.write(value)
        else:
            uniform.value = value
    sent[name] = value
