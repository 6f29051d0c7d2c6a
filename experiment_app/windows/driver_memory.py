"""Memory of software drivers: large blocks that they free are kept for the next frame (glibc only)."""

from __future__ import annotations

import ctypes
import sys

import moderngl

from experiment_app.timing.facts import is_software

M_TRIM_THRESHOLD, M_MMAP_THRESHOLD = -1, -3  # of mallopt(3)
KEPT = 1 << 28  # bytes at the heap's top that are not handed back
FROM_HEAP = 1 << 25  # bytes of a block below which it comes from the heap; the most that glibc allows


def keep_freed_memory(context: moderngl.Context) -> None:
    """Spares a frame thousands of page faults where the driver draws on the CPU.

    Such a driver takes megabytes for the vertices of each draw call and frees them after it. By default glibc may hand
    them back to the system every time, and a crowd of 1000 then pays some 30 ms per frame to get them again.
    """
    if not sys.platform.startswith("linux") or not is_software(context.info["GL_RENDERER"]):
        return
    mallopt = getattr(ctypes.CDLL(None), "mallopt", None)
    if mallopt is not None:
        mallopt(M_TRIM_THRESHOLD, KEPT)
        mallopt(M_MMAP_THRESHOLD, FROM_HEAP)
