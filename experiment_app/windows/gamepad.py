"""A gamepad as keys: GLFW's mapping of buttons and the left stick to the arrow keys, Enter, B and Escape."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Protocol

import glfw

from protocols.events import KeyDown, KeyUp

PUSHED, CENTRED = 0.5, 0.35
"""How far the stick must go to count as held, and come back to count as let go (of 1)."""

BUTTONS = {
    glfw.GAMEPAD_BUTTON_DPAD_LEFT: "left",
    glfw.GAMEPAD_BUTTON_DPAD_RIGHT: "right",
    glfw.GAMEPAD_BUTTON_DPAD_UP: "up",
    glfw.GAMEPAD_BUTTON_DPAD_DOWN: "down",
    glfw.GAMEPAD_BUTTON_A: "enter",
    glfw.GAMEPAD_BUTTON_B: "b",
    glfw.GAMEPAD_BUTTON_START: "escape",
}
STICKS = (
    (glfw.GAMEPAD_AXIS_LEFT_X, -1, "left"),
    (glfw.GAMEPAD_AXIS_LEFT_X, 1, "right"),
    (glfw.GAMEPAD_AXIS_LEFT_Y, -1, "up"),
    (glfw.GAMEPAD_AXIS_LEFT_Y, 1, "down"),
)


class State(Protocol):
    """A gamepad's state as GLFW gives it: `buttons` by number, 1 while down; `axes` by number, -1 to 1."""

    @property
    def buttons(self) -> Any: ...
    @property
    def axes(self) -> Any: ...


def glfw_gamepad() -> State | None:
    """The state of the first gamepad that has a mapping, None when there is none."""
    for number in range(glfw.JOYSTICK_1, glfw.JOYSTICK_LAST + 1):
        if glfw.joystick_is_gamepad(number):
            state: State = glfw.get_gamepad_state(number)
            return state
    return None


class Gamepad:
    """Turns what is down now into key events; GLFW tells no times, so the time between two looks is the uncertainty."""

    def __init__(self, read: Callable[[], State | None] = glfw_gamepad) -> None:
        self._read = read
        self._down: frozenset[str] = frozenset()
        self._looked: float | None = None

    def look(self, now: float) -> list[KeyDown | KeyUp]:
        """The events since the last look, at `now` (s); unplugging it lets everything go."""
        state = self._read()
        down = frozenset() if state is None else self._held(state)
        uncertainty = round(1e3 * (now - self._looked), 3) if self._looked is not None else 0.0
        self._looked = now
        events: list[KeyDown | KeyUp] = [KeyUp(now, key, "gamepad", uncertainty) for key in sorted(self._down - down)]
        events += [KeyDown(now, key, "gamepad", uncertainty) for key in sorted(down - self._down)]
        self._down = down
        return events

    def _held(self, state: State) -> frozenset[str]:
        keys = {key for button, key in BUTTONS.items() if state.buttons[button]}
        for axis, sign, key in STICKS:
            limit = CENTRED if key in self._down else PUSHED
            if sign * state.axes[axis] > limit:
                keys.add(key)
        return frozenset(keys)
