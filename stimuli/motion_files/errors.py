"""The one error a motion file may end in."""

from __future__ import annotations


class MotionFileError(ValueError):
    """A motion file cannot be used; the message is one sentence naming file, place, value and the way out."""
