"""What can be wrong with a folder of captures, as one sentence with the way out."""

from __future__ import annotations

from stimuli.motion_files.errors import MotionFileError


class ImportingError(MotionFileError):
    """A folder of captures makes no actor; the message names the file, the reason and the way out."""
