"""The `gaitlab` command: its subcommands, and the exit status and sentence for what goes wrong in them.

Exit status: 0 fine, 1 something failed, 2 wrong usage or study file.
"""

from __future__ import annotations

import logging
import sys
from io import TextIOWrapper

from cyclopts import App

from experiment_app.commands.bodies import body_commands
from experiment_app.commands.data import console, drop_out, export, withdraw
from experiment_app.commands.films import film, gallery
from experiment_app.commands.motion import actor_commands, clip
from experiment_app.commands.results import analyse, compare_methods, power
from experiment_app.commands.sessions import certificate, doctor, replay, run_study
from experiment_app.commands.studies import check, copy, demo, schema, simulate
from experiment_app.commands.styles import style_commands
from experiment_app.errors import RunError, UsageError
from experiment_app.terminal import problems

app = App(
    name="gaitlab",
    help="Perceptual experiments on walking virtual humans: from a study file to a report.",
    version=lambda: _version(),
    version_flags=["--version"],
    help_format="plaintext",  # markdown would cost a fifth of a second at every --help
)
app.command(run_study, name="run")
app.command(compare_methods, name="compare-methods")
for command in (
    copy, schema, check, simulate, demo, doctor, certificate, replay, console, drop_out, withdraw, export, analyse,
    power, clip, actor_commands, body_commands, style_commands, film, gallery,
):  # fmt: skip
    app.command(command)


def main() -> None:
    """Runs the command of sys.argv and exits.

    A sign that the terminal or the file cannot hold, as a histogram's bar in Windows' cp1252, becomes a question mark.
    """
    if isinstance(sys.stdout, TextIOWrapper):
        sys.stdout.reconfigure(errors="replace")
    sys.exit(run(sys.argv[1:]))


def run(arguments: list[str]) -> int:
    """Runs one command and returns its exit status; every foreseeable problem is one sentence, never a traceback."""
    logging.getLogger("matplotlib").setLevel(logging.ERROR)  # where nothing can be cached it makes a speech, and draws
    try:
        result = app(arguments, exit_on_error=False, print_error=True, result_action="return_value")
        return result if isinstance(result, int) else 0
    except UsageError as error:
        problems.print(f"gaitlab: {error}", style="red", markup=False)
        return 2
    except KeyboardInterrupt:
        problems.print("gaitlab: interrupted; everything recorded so far is kept.", markup=False)
        return 1
    except RunError as error:
        problems.print(f"gaitlab: {error}", style="red", markup=False)
        return 1
    except OSError as error:
        problems.print(f"gaitlab: {_of_the_system(error)}", style="red", markup=False)
        return 2 if isinstance(error, FileNotFoundError) else 1
    except Exception as error:
        status = _status_of_named_error(error)
        if status is None:
            raise
        return status


def _of_the_system(error: OSError) -> str:
    """What the operating system refused, as "file: reason." without its number; our own sentences stay as they are."""
    if error.filename is None or not error.strerror:
        return str(error)
    files = [str(name) for name in (error.filename, error.filename2) if name is not None]
    return f"{' to '.join(files)}: {error.strerror[0].lower()}{error.strerror[1:]}."


def _status_of_named_error(error: Exception) -> int | None:
    """The exit status for an error of another room that is a sentence already; None for one that is a bug."""
    kinds = {base.__name__ for base in type(error).__mro__}
    if "CycloptsError" in kinds:
        return 2
    if "StudyFileError" in kinds:
        problems.print(str(error), style="red", markup=False)
        return 2
    if kinds & {"ActorError", "BodyError", "CoverageError", "AnalysisError", "MotionFileError"}:
        problems.print(f"gaitlab: {error}", style="red", markup=False)
        return 1 if "AnalysisError" in kinds else 2
    return None


def _version() -> str:
    from importlib.metadata import version

    return version("gaitlab")
