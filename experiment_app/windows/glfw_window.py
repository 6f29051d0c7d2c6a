"""Opens the GLFW window on the display asked for, with OpenGL 3.3, and says in a sentence why it cannot."""

from __future__ import annotations

import ctypes
import os
import sys
from typing import Any

import glfw

from experiment_app.errors import UsageError


def open_window(title: str, full_screen: bool, display: int, size: tuple[int, int]) -> tuple[Any, Any]:
    """A GLFW window with an OpenGL 3.3 core context, and the monitor it is on (None when GLFW knows of none).

    full_screen, display, size: as of `DesktopWindow`. Raises UsageError.
    """
    problems: list[str] = []
    glfw.set_error_callback(lambda code, text: problems.append(text.decode() if isinstance(text, bytes) else str(text)))
    if not glfw.init():
        raise UsageError(
            "no display was found, so no window can be opened; sit at the computer's own screen, or use "
            "`gaitlab demo` and `gaitlab simulate`, which need none."
        )
    monitors = glfw.get_monitors()
    if monitors and not 1 <= display <= len(monitors):
        glfw.terminate()
        raise UsageError(f"--display {display}: this computer has displays 1 to {len(monitors)}.")
    monitor = monitors[display - 1] if monitors else None
    mode = glfw.get_video_mode(monitor) if monitor else None
    for hint, value in (
        (glfw.CONTEXT_VERSION_MAJOR, 3),
        (glfw.CONTEXT_VERSION_MINOR, 3),
        (glfw.OPENGL_PROFILE, glfw.OPENGL_CORE_PROFILE),
        (glfw.OPENGL_FORWARD_COMPAT, True),
        (glfw.DEPTH_BITS, 0),
        (glfw.SCALE_TO_MONITOR, True),
        (glfw.AUTO_ICONIFY, False),
    ):
        glfw.window_hint(hint, value)
    _let_go_of_egl()
    if full_screen and mode is not None:
        glfw.window_hint(glfw.REFRESH_RATE, mode.refresh_rate)
        handle = glfw.create_window(mode.size.width, mode.size.height, title, monitor, None)
    else:
        handle = glfw.create_window(*size, title, None, None)
        if handle and monitor:
            left, top, width, height = glfw.get_monitor_workarea(monitor)
            wide, high = glfw.get_window_size(handle)  # larger than asked on a display of high density
            glfw.set_window_pos(handle, left + max(width - wide, 0) // 2, top + max(height - high, 0) // 2)
    if not handle:
        reason = problems[-1] if problems else "no reason given"
        glfw.terminate()
        raise UsageError(
            f"no window with OpenGL 3.3 could be opened ({reason}); update the graphics driver, or on Linux "
            "install the system's OpenGL libraries (the README's first command does)."
        )
    return handle, monitor


def _let_go_of_egl() -> None:
    """Makes no off-screen context current on this thread.

    With one, which something drawn off-screen before may have left, the X server refuses the window's own context, and
    Xlib ends the whole program for that.
    """
    if not sys.platform.startswith("linux"):
        return
    try:
        egl = ctypes.CDLL("libEGL.so.1", mode=os.RTLD_NOLOAD | os.RTLD_LAZY)
    except OSError:  # nothing was drawn off-screen: EGL is not loaded
        return
    egl.eglReleaseThread()
