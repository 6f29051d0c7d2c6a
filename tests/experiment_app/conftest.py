"""What tests of drawing share: an off-screen OpenGL context and a renderer, one of each for a file of tests."""

from __future__ import annotations

from collections.abc import Iterator

import moderngl
import pytest

from experiment_app.render.renderer import Renderer


@pytest.fixture(scope="module")
def context() -> Iterator[moderngl.Context]:
    """OpenGL 3.3 without a window; tests that need it are skipped where there is none."""
    try:
        made = moderngl.create_context(standalone=True, backend="egl", require=330)
    except Exception as error:  # glcontext raises bare Exceptions
        pytest.skip(f"no OpenGL 3.3 through EGL on this machine: {error}")
    yield made
    made.release()


@pytest.fixture(scope="module")
def renderer(context: moderngl.Context, request: pytest.FixtureRequest) -> Iterator[Renderer]:
    """A renderer for pictures of the file's SIZE (width, height) with four samples per pixel."""
    made = Renderer(context, request.module.SIZE, 1.0, 4)
    yield made
    made.release()
