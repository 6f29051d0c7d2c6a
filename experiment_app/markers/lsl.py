"""Lab Streaming Layer: the optional library, its clock, and what to do when either is missing."""

from __future__ import annotations

from typing import Any

from experiment_app.errors import UsageError


def import_pylsl() -> Any:
    """The pylsl module; raises UsageError with the way out when it, or the library inside it, is missing."""
    try:
        import pylsl
    except ImportError:
        raise UsageError(
            "Lab Streaming Layer needs the package pylsl; install it with: pip install 'gaitlab[lsl]'."
        ) from None
    except RuntimeError as error:  # the wheel for older systems comes without liblsl
        first = str(error).splitlines()[0]
        raise UsageError(
            f"pylsl is installed but its library liblsl is not ({first}); install liblsl, then set PYLSL_LIB to it."
        ) from None
    return pylsl


def clock_offset(run_clock_now: float) -> float:
    """s to add to a time on the run's clock to get Lab Streaming Layer's time, given the run's clock just now.

    Both advance alike (on Linux both are the monotonic clock), so one reading is enough.
    """
    return float(import_pylsl().local_clock()) - run_clock_now
