"""Whether there is a screen to open a window on."""

from __future__ import annotations

import warnings


def has_screen() -> bool:
    """True where a window can be opened: GLFW starts and finds a monitor."""
    import glfw

    with warnings.catch_warnings():  # no screen is an answer here, and no mistake
        warnings.simplefilter("ignore", glfw.GLFWError)
        return bool(glfw.init()) and bool(glfw.get_monitors())
