"""The thread that draws: it owns the OpenGL context, so that the main thread is free to receive events meanwhile."""

from __future__ import annotations

import ctypes
import threading
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from queue import SimpleQueue
from typing import Any

import glfw
import moderngl

from experiment_app.render.drawn import Drawn as Posed
from experiment_app.render.part_map import PartMap
from experiment_app.render.renderer import Renderer
from experiment_app.scene import Scene
from experiment_app.walkers import drawn_walkers, pose_checksum
from experiment_app.windows.driver_memory import keep_freed_memory
from experiment_app.windows.patch import Patch
from experiment_app.windows.window import Flip

PART_MAP_SCALE = 4
"""Pixels of the picture per pixel of the body-part map: a quarter of a degree at most, below an eye tracker's error."""


@dataclass(frozen=True)
class Order:
    """A frame to draw.

    size, pixel_ratio: of the framebuffer, pixels. swap_at: s on `time.perf_counter`, not before which to swap;
    None leaves it to the driver. patch: a square for a photodiode, or None. parts: also draw the body-part map.
    """

    scene: Scene
    size: tuple[int, int]
    pixel_ratio: float
    swap_at: float | None = None
    patch: Patch | None = None
    parts: bool = False


@dataclass(frozen=True)
class Drawn:
    """A frame that was seen: its flip (time on `time.perf_counter`), and s from the order until it could be swapped.

    parts: the body-part map of the frame before, whose bytes have come meanwhile; None when none was drawn.
    """

    flip: Flip
    cost: float
    parts: PartMap | None = None


class Drawing:
    """The drawing thread of a GLFW window. Raises what starting OpenGL raises.

    finished: called from the thread when a frame has been seen.
    """

    def __init__(
        self, handle: Any, size: tuple[int, int], pixel_ratio: float, samples: int, finished: Callable[[], None]
    ) -> None:
        self._handle = handle
        self._finished = finished
        self._orders: SimpleQueue[Callable[[], object] | None] = SimpleQueue()
        self._results: SimpleQueue[object] = SimpleQueue()
        self._thread = threading.Thread(target=self._work, name="drawing", daemon=True)
        self._thread.start()
        try:
            self._call(lambda: self._start(size, pixel_ratio, samples))
        except BaseException:  # Ctrl-C too: the context must not be in use when the window goes
            self._orders.put(None)
            self._thread.join()
            raise

    def begin(self, order: Order) -> None:
        """Begins a frame; `seen` tells when it is there."""
        self._orders.put(lambda: self._draw(order))

    def seen(self) -> Drawn | None:
        """The frame begun last once it has been seen, else None; raises what drawing it raised."""
        if self._results.empty():
            return None
        drawn = self._taken()
        assert isinstance(drawn, Drawn)
        return drawn

    def bare_swaps(self, count: int) -> list[float]:
        """Times (s) of `count` buffer swaps with nothing drawn."""
        times: list[float] = []

        def swap() -> None:
            for _ in range(count):
                self.context.screen.clear(0.0, 0.0, 0.0)
                glfw.swap_buffers(self._handle)
                self._finish()
                times.append(time.perf_counter())

        self._call(swap)
        return times

    def prepare(self, orders: Sequence[Order]) -> None:
        """Draws frames that nobody sees."""

        def draw() -> None:
            for order in orders:
                self._paint(order)
            self._finish()

        self._call(draw)

    def close(self) -> None:
        """Frees the GPU's memory and ends the thread."""
        self._call(self._stop)
        self._orders.put(None)
        self._thread.join()

    # Inside; everything below runs on the drawing thread, unless it says otherwise

    def _call(self, work: Callable[[], None]) -> None:
        """Runs work on the drawing thread and waits for it (called from the main thread)."""
        self._orders.put(work)
        self._taken()

    def _taken(self) -> object:
        result = self._results.get()
        if isinstance(result, Exception):
            raise result
        return result

    def _work(self) -> None:
        while (work := self._orders.get()) is not None:
            try:
                self._results.put(work())
            except Exception as error:  # the main thread raises it
                self._results.put(error)
            self._finished()

    def _start(self, size: tuple[int, int], pixel_ratio: float, samples: int) -> None:
        glfw.make_context_current(self._handle)
        glfw.swap_interval(1)
        self.context = moderngl.create_context(require=330)
        keep_freed_memory(self.context)
        self.info = dict(self.context.info)
        # through ctypes, because moderngl's own finish would keep Python's lock and so delay the stamps of keys
        self._finish = ctypes.cast(glfw.get_proc_address("glFinish"), ctypes.CFUNCTYPE(None))
        self.renderer = Renderer(self.context, size, pixel_ratio, samples)

    def _stop(self) -> None:
        self.renderer.release()
        glfw.make_context_current(None)  # type: ignore[arg-type]

    def _paint(self, order: Order) -> tuple[Posed, ...]:
        """Draws a frame into the back buffer; returns its walkers."""
        walkers = drawn_walkers(order.scene)
        if min(order.size) > 0:
            self.renderer.resize(order.size, order.pixel_ratio)
            self.renderer.draw(order.scene, walkers, self.context.screen)
            if order.patch is not None:
                order.patch.draw(self.context.screen, order.size, order.scene)
        return walkers

    def _draw(self, order: Order) -> Drawn:
        begun, cpu = time.perf_counter(), time.thread_time()
        walkers = self._paint(order)
        cpu_ms = 1e3 * (time.thread_time() - cpu)
        if order.swap_at is not None:
            self._finish()
        ready = time.perf_counter()
        if order.swap_at is not None and ready < order.swap_at:
            time.sleep(order.swap_at - ready)
        glfw.swap_buffers(self._handle)
        self._finish()
        flip = Flip(time.perf_counter(), cpu_ms, pose_checksum(walkers))
        parts = None
        if order.parts and walkers and min(order.size) > PART_MAP_SCALE:  # after the flip, which it cannot hold up
            parts = self.renderer.draw_parts(1, PART_MAP_SCALE)
        return Drawn(flip, ready - begun, parts)
