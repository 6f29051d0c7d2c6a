"""The desktop window: GLFW for window and keys, a drawing thread for pixels. Knows no trial and no file.

The main thread does nothing but wait for events, also while a frame is drawn and swapped, so every event is stamped
when it arrives; for keys a better time is taken where the computer has one (`key_times`).
"""

from __future__ import annotations

import sys
import time
from collections.abc import Sequence
from contextlib import ExitStack
from dataclasses import replace
from itertools import pairwise
from typing import Any, Literal

import glfw

from experiment_app.errors import UsageError
from experiment_app.gaze.watching import GazeWatch
from experiment_app.scene import Scene
from experiment_app.walkers import measured_gait
from experiment_app.windows.display_facts import display_facts
from experiment_app.windows.drawing import Drawing, Drawn, Order
from experiment_app.windows.gamepad import Gamepad
from experiment_app.windows.glfw_window import open_window
from experiment_app.windows.key_times import Keyboard, Stamp, open_key_times
from experiment_app.windows.keys import key_name
from experiment_app.windows.pacing import Pacing, measured
from experiment_app.windows.patch import Patch
from experiment_app.windows.waiting import Waiting, WaitingForX, WaitingInGlfw
from experiment_app.windows.window import Flip
from protocols.events import Clicked, Closed, Event, FocusLost, KeyDown, KeyUp, Typed
from protocols.session import Session

PROBED_SWAPS = 20
"""Bare buffer swaps timed at the start to learn whether the driver waits for the display."""

LISTENING = 0.002
"""s after which a wait is looked up from where times are those of arrival: the time since the last look bounds their
error, and a gamepad has no events of its own."""

SWITCH_INTERVAL = 0.0001
"""s after which Python lets the thread that receives events interrupt the one that draws."""

MOUSE_KEYS = {
    glfw.MOUSE_BUTTON_LEFT: "left",
    glfw.MOUSE_BUTTON_RIGHT: "right",
    glfw.MOUSE_BUTTON_MIDDLE: "enter",
}
"""What the mouse's buttons are where there is nothing to click, as in trials whose question keys answer."""

Device = Literal["mouse", "gamepad"]


class DesktopWindow:
    """A window on a display. Use as a context manager.

    full_screen: cover display number `display` (from 1); otherwise a window of `size` (width, height).
    refresh:  Hz, overrides what the display reports. keyboard: where the times of keys come from.
    devices:  what else gives keys. patch: a square for a photodiode, or None.
    origin:   the zero of the run's clock on `time.perf_counter`.
    Raises UsageError when there is no display, no such display, or no OpenGL 3.3.
    """

    def __init__(
        self,
        *,
        title: str = "gaitlab",
        full_screen: bool = True,
        display: int = 1,
        size: tuple[int, int] = (1280, 720),
        refresh: float = 0.0,
        samples: int = 4,
        keyboard: Keyboard = "auto",
        devices: Sequence[Device] = (),
        patch: Patch | None = None,
    ) -> None:
        self.origin = time.perf_counter()
        self._events: list[Event] = []
        self._clicks: list[tuple[float, float, float]] = []
        self._scene = Scene()
        self._requested = ""
        self._patch = patch
        self._mouse = "mouse" in devices
        self._pad = Gamepad() if "gamepad" in devices else None
        self._watch: GazeWatch | None = None
        self._unlooked: float | None = None
        with ExitStack() as opened:  # what was opened is closed again, latest first, if the rest fails
            self._handle, self._monitor = open_window(title, full_screen, display, size)
            opened.callback(glfw.terminate)
            try:
                self._start(opened, keyboard, samples)
            except UsageError:
                raise
            except Exception as error:
                raise UsageError(f"OpenGL 3.3 is needed and could not be started ({error}).") from None
            by_arrival = self._mouse or self._pad is not None or self._times.name == "arrival"
            self._patience = LISTENING if by_arrival else float("inf")
            opened.callback(sys.setswitchinterval, sys.getswitchinterval())
            sys.setswitchinterval(SWITCH_INTERVAL)
            self._heard = self.now()
            self._connect()
            self._intervals, self._pacing = self._probe(refresh)
            self._opened = opened.pop_all()

    def __enter__(self) -> DesktopWindow:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """Closes the window and gives the display back."""
        self._opened.close()

    @property
    def period(self) -> float:
        """The refresh period, s."""
        return self._pacing.period

    def now(self) -> float:
        """s on the run's clock."""
        return time.perf_counter() - self.origin

    def description(self) -> dict[str, Any]:
        """What a journal says about this display, its driver and its inputs."""
        info = self._drawing.info
        return {
            "window": "desktop",
            "pixels": list(self._pixels),
            "pixel_ratio": self._pixel_ratio(),
            **display_facts(self._handle, self._monitor),
            "period_s": round(self._pacing.period, 6),
            "swap_waits_for_display": self._pacing.throttled,
            "bare_swaps_ms": [round(1e3 * interval, 3) for interval in self._intervals],
            "gl_renderer": info["GL_RENDERER"],
            "gl_vendor": info["GL_VENDOR"],
            "gl_version": info["GL_VERSION"],
            "samples": self._drawing.renderer.samples,
            "keyboard": self._times.description(),
            "devices": ["keyboard", *(["mouse"] * self._mouse), *(["gamepad"] * (self._pad is not None))],
            "photodiode": self._patch.corner if self._patch else "",
            "clock_resolution_ns": round(1e9 * time.get_clock_info("perf_counter").resolution, 3),
        }

    def prepare(self, scenes: Sequence[Scene]) -> None:
        """Draws scenes unseen, so that what they need is on the GPU before it is their turn."""
        self._drawing.prepare([Order(scene, self._pixels, self._pixel_ratio()) for scene in scenes])

    def request_end(self, reason: str) -> None:
        """Asks the session to end, as a signal handler does; safe to call at any time."""
        self._requested = reason
        self._waiting.wake()

    # The three verbs

    def poll(self, session: Session) -> tuple[float, Sequence[Event]]:
        """Waits, receiving events as they come, until it is time to draw; then the time and the events since."""
        draw_at = self._pacing.draw_time()
        self._receive(0.0)
        while (left := draw_at - self.now()) > 0.0 and not self._requested:
            self._receive(left)
        if self._requested:
            self._events.append(Closed(self.now(), self._requested))
            self._requested = ""
        self._events += [Clicked(at, target) for at, target in self._targets()]
        events, self._events = sorted(self._events, key=lambda event: event.time), []
        return self.now(), events

    def next_display_time(self) -> float:
        """The next refresh for which a frame drawn now can be ready (s)."""
        return self._pacing.display_time(self.now())

    def show(self, scene: Scene) -> Flip:
        """Draws the scene and swaps on the drawing thread, receiving events until it has been seen."""
        self._scene = scene
        self._set_cursor(scene)
        predicted = self._pacing.display_time(self.now())
        swap_at = None if self._pacing.throttled else predicted + self.origin
        watched = self._watch is not None and scene.visible
        self._drawing.begin(Order(scene, self._pixels, self._pixel_ratio(), swap_at, self._patch, watched))
        while (drawn := self._drawing.seen()) is None:
            self._receive(0.1)
        flip = self._flipped(drawn, predicted)
        if self._watch is not None:
            if self._unlooked is not None and watched:
                self._watch.shown(self._unlooked, drawn.parts)
            self._unlooked = flip.time if watched else None
        return flip

    def measure(self, scene: Scene) -> dict[str, float]:
        """The scene's walker measured as it is drawn."""
        return measured_gait(scene)

    def watch(self, gaze: GazeWatch) -> None:
        """From now on the body-part map of every frame with walkers goes to `gaze`, a frame later."""
        self._watch = gaze

    def pointer(self) -> tuple[float, float]:
        """Where the mouse pointer is on the picture, from (0, 0) at its top left to (1, 1)."""
        x, y = glfw.get_cursor_pos(self._handle)
        width, height = glfw.get_window_size(self._handle)
        return x / max(width, 1), y / max(height, 1)

    @property
    def display_size(self) -> tuple[int, int]:
        """(width, height) of the display the window is on, in its own pixels; of the window where that is not known."""
        mode = glfw.get_video_mode(self._monitor) if self._monitor else None
        return (mode.size.width, mode.size.height) if mode else glfw.get_window_size(self._handle)

    def on_picture(self, x: float, y: float) -> tuple[float, float]:
        """A place on the display, from (0, 0) at its top left to (1, 1), as the same place on the picture."""
        left, top = glfw.get_monitor_pos(self._monitor) if self._monitor else glfw.get_window_pos(self._handle)
        across, down = self.display_size
        own_left, own_top = glfw.get_window_pos(self._handle)
        width, height = glfw.get_window_size(self._handle)
        return (left + x * across - own_left) / max(width, 1), (top + y * down - own_top) / max(height, 1)

    # Inside

    def _start(self, opened: ExitStack, keyboard: Keyboard, samples: int) -> None:
        """Starts what receives keys and what draws; `opened` closes each."""
        x_display = glfw.get_x11_display() if glfw.get_platform() == glfw.PLATFORM_X11 else None
        self._times = open_key_times(keyboard, x_display)
        opened.callback(self._times.close)
        self._waiting: Waiting = WaitingForX(x_display) if x_display else WaitingInGlfw()
        opened.callback(self._waiting.close)
        glfw.set_framebuffer_size_callback(self._handle, self._on_size)
        self._pixels = glfw.get_framebuffer_size(self._handle)
        self._drawing = Drawing(self._handle, self._pixels, self._pixel_ratio(), samples, self._waiting.wake)
        opened.callback(self._drawing.close)

    def _on_size(self, _handle: Any, width: int, height: int) -> None:
        """The picture's size in pixels as it was last reported: asked of a window that is gone, it would be rubbish."""
        self._pixels = (width, height)

    def _pixel_ratio(self) -> float:
        return float(glfw.get_window_content_scale(self._handle)[0])

    def _flipped(self, drawn: Drawn, predicted: float) -> Flip:
        flip = replace(drawn.flip, time=drawn.flip.time - self.origin)
        self._pacing = self._pacing.after(flip.time, drawn.cost, predicted)
        return flip

    def _probe(self, refresh: float) -> tuple[list[float], Pacing]:
        """Times bare swaps, because a display's reported rate and a driver's setting are not to be believed."""
        times = self._drawing.bare_swaps(PROBED_SWAPS)
        intervals = [later - earlier for earlier, later in pairwise(times[2:])]
        mode = glfw.get_video_mode(self._monitor) if self._monitor else None
        reported = refresh or float(mode.refresh_rate if mode else 0)
        return intervals, replace(measured(reported, intervals), refresh=times[-1] - self.origin)

    def _set_cursor(self, scene: Scene) -> None:
        mode = glfw.CURSOR_NORMAL if scene.clickable else glfw.CURSOR_HIDDEN
        if glfw.get_input_mode(self._handle, glfw.CURSOR) != mode:
            glfw.set_input_mode(self._handle, glfw.CURSOR, mode)

    # Events

    def _receive(self, timeout: float) -> None:
        """Waits up to `timeout` (s) for events, notes their times, then lets GLFW report them."""
        if timeout > 0.0:
            self._waiting.wait(min(timeout, self._patience))
        self._times.collect()
        glfw.poll_events()
        self._times.forget()
        self._heard = self.now()
        if self._pad is not None:
            self._events += self._pad.look(self._heard)

    def _stamp(self, keycode: int, down: bool) -> Stamp:
        """The event's time on the run's clock: the source's where it has one, else now.

        An event that arrives has come after the last time all events were received, which bounds its error.
        """
        now = self.now()
        stamp = self._times.take(keycode, down)
        if stamp is None:
            return Stamp(now, "arrival", round(1e3 * (now - self._heard), 3))
        return replace(stamp, time=min(stamp.time - self.origin, now))

    def _connect(self) -> None:
        """Every callback stamps the time before anything else."""

        def on_key(_: Any, key: int, scancode: int, action: int, modifiers: int) -> None:
            if action == glfw.REPEAT and not self._times.notes_repeats:
                stamp = Stamp(self.now(), "arrival", 0.0)
            else:
                stamp = self._stamp(scancode, action != glfw.RELEASE)
            shifted = key == glfw.KEY_TAB and modifiers & glfw.MOD_SHIFT
            name = "backtab" if shifted else key_name(key, scancode)
            if action == glfw.RELEASE:
                self._events.append(KeyUp(stamp.time, name, stamp.source, stamp.uncertainty_ms))
            elif action == glfw.PRESS or key == glfw.KEY_BACKSPACE:  # repeats are no events, but may empty a field
                self._events.append(KeyDown(stamp.time, name, stamp.source, stamp.uncertainty_ms))

        def on_text(_: Any, code: int) -> None:
            self._events.append(Typed(self.now(), chr(code)))

        def on_button(_: Any, button: int, action: int, __: int) -> None:
            now = self.now()
            if self._scene.clickable:
                if button == glfw.MOUSE_BUTTON_LEFT and action == glfw.PRESS:
                    self._clicks.append((now, *glfw.get_cursor_pos(self._handle)))
            elif self._mouse and button in MOUSE_KEYS:
                kind = KeyDown if action == glfw.PRESS else KeyUp
                late = round(1e3 * (now - self._heard), 3)
                self._events.append(kind(now, MOUSE_KEYS[button], "mouse", late))

        def on_focus(_: Any, focused: int) -> None:
            if not focused:
                self._events.append(FocusLost(self.now()))

        def on_close(_: Any) -> None:
            self._events.append(Closed(self.now()))

        self._callbacks = (on_key, on_text, on_button, on_focus, on_close)
        glfw.set_key_callback(self._handle, on_key)
        glfw.set_char_callback(self._handle, on_text)
        glfw.set_mouse_button_callback(self._handle, on_button)
        glfw.set_window_focus_callback(self._handle, on_focus)
        glfw.set_window_close_callback(self._handle, on_close)

    def _targets(self) -> list[tuple[float, str]]:
        """What the clicks since the last poll hit; looked up now, when nothing is being drawn."""
        clicks, self._clicks = self._clicks, []
        found = [(at, self._hit(x, y)) for at, x, y in clicks]
        return [(at, target) for at, target in found if target is not None]

    def _hit(self, x: float, y: float) -> str | None:
        if self._scene.page is None:
            return None
        width, height = glfw.get_window_size(self._handle)
        across, down = self._pixels
        return self._drawing.renderer.hit(self._scene.page, x * across / width, y * down / height)
