"""What a person can put right, as one sentence with the way out; the command prints it and exits."""

from __future__ import annotations


class UsageError(Exception):
    """Wrong usage, study file or environment; found before the participant sits down. Exit status 2."""


class RunError(Exception):
    """Something failed while a run was going on; what was recorded is safe. Exit status 1.

    reason: what the operating system said, where it said something.
    """

    def __init__(self, message: str, reason: str = "") -> None:
        super().__init__(message)
        self.reason = reason
