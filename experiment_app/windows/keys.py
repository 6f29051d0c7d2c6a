"""Names of keys: what study files call left, enter, a, 1, from what GLFW reports."""

from __future__ import annotations

import glfw

NAMED = {
    glfw.KEY_LEFT: "left",
    glfw.KEY_RIGHT: "right",
    glfw.KEY_UP: "up",
    glfw.KEY_DOWN: "down",
    glfw.KEY_ENTER: "enter",
    glfw.KEY_KP_ENTER: "enter",
    glfw.KEY_SPACE: "space",
    glfw.KEY_ESCAPE: "escape",
    glfw.KEY_TAB: "tab",
    glfw.KEY_BACKSPACE: "backspace",
}


def key_name(key: int, scancode: int) -> str:
    """The key's name; letters are those printed on this keyboard layout, else "key-<code>"."""
    if key in NAMED:
        return NAMED[key]
    printed = glfw.get_key_name(key, scancode) if key != glfw.KEY_UNKNOWN else None
    if printed and printed.isascii() and printed.isalnum():
        return str(printed).lower()
    if glfw.KEY_A <= key <= glfw.KEY_Z or glfw.KEY_0 <= key <= glfw.KEY_9:
        return chr(key).lower()
    return f"key-{key}"
