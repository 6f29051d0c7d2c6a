"""What a computer says of its display and desktop: size, scale, reported refresh, session, compositor."""

from __future__ import annotations

import os
from typing import Any

import glfw

from experiment_app.windows.xlib import xlib

PLATFORMS = {
    glfw.PLATFORM_X11: "X11",
    glfw.PLATFORM_WAYLAND: "Wayland",
    glfw.PLATFORM_WIN32: "Windows",
    glfw.PLATFORM_COCOA: "macOS",
}


def display_facts(handle: Any, monitor: Any) -> dict[str, Any]:
    """For the journal: monitor (name, mm, scale), reported refresh (Hz, 0 if unknown), platform, compositor.

    handle: GLFW's window; monitor: its monitor, None where GLFW knows of none.
    """
    platform = PLATFORMS.get(glfw.get_platform(), "unknown")
    mode = glfw.get_video_mode(monitor) if monitor else None
    across, down = glfw.get_monitor_physical_size(monitor) if monitor else (0, 0)
    name = glfw.get_monitor_name(monitor) if monitor else ""
    return {
        "platform": platform,
        "compositor": compositor(platform),
        "full_screen": bool(glfw.get_window_monitor(handle)),
        "monitor": name.decode() if isinstance(name, bytes) else str(name or ""),
        "monitors": len(glfw.get_monitors()),
        "screen_pixels": [mode.size.width, mode.size.height] if mode else [],
        "screen_mm": [across, down],
        "screen_scale": float(glfw.get_monitor_content_scale(monitor)[0]) if monitor else 1.0,
        "reported_refresh_hz": mode.refresh_rate if mode else 0,
    }


def compositor(platform: str) -> str:
    """Who may hold a frame back before it reaches the screen: a name, "none", or "unknown"."""
    if platform == "Wayland":
        return os.environ.get("XDG_CURRENT_DESKTOP") or "Wayland"
    if platform == "X11":
        return _on_x()
    return {"Windows": "Desktop Window Manager", "macOS": "Quartz"}.get(platform, "unknown")


def _on_x() -> str:
    """The owner of the selection that a compositing manager must take (EWMH, _NET_WM_CM_S0)."""
    display = glfw.get_x11_display()
    owner = xlib().XGetSelectionOwner(display, xlib().XInternAtom(display, b"_NET_WM_CM_S0", 0))
    if not owner:
        return "none"
    return os.environ.get("XDG_CURRENT_DESKTOP") or f"window {owner:#x}"
