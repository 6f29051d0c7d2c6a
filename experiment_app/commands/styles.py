"""`gaitlab style ...`: styles of walking: list them, import captured ones. Heavy imports stay inside."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

from cyclopts import App, Parameter

from experiment_app.errors import UsageError
from experiment_app.terminal import out

style_commands = App(name="style", help="Styles of walking: list them, import captured ones.")


@style_commands.command(name="list")
def list_styles() -> int:
    """List all styles with their tempo (times the actor's own step frequency) and where they come from."""
    from stimuli.methods.styles import style_named, style_names

    out.print("name            tempo  provenance")
    for name in style_names():
        style = style_named(name)
        out.print(f"{name:15s} {style.step_frequency:5.2f}  {style.provenance}", markup=False)
    return 0


@style_commands.command(name="import")
def import_style(
    file: Annotated[Path, Parameter(help="A motion file of one straight walk in the style: BVH, C3D, MVNX or glTF.")],
    *,
    name: Annotated[str, Parameter(help="The name that study files use, as lab7_sad.")],
    licence: Annotated[str, Parameter(help="What others may do with the capture, as 'CC BY-NC 4.0'.")],
    source: Annotated[str, Parameter(help="Where it comes from, for pages and journals.")],
    normal: Annotated[Path | None, Parameter(help="The same performer's normal walk, to be taken off.")] = None,
    replace: Annotated[bool, Parameter(negative="", help="Take the place of a style of that name.")] = False,
) -> int:
    """Keep the style of a captured walk, so that any actor can walk in it."""
    from stimuli.importing.styles import captured_style
    from stimuli.methods.errors import MethodError
    from stimuli.methods.styles import store_style
    from stimuli.motion_files.errors import MotionFileError

    try:
        style = captured_style(name, file, normal, licence, source)
        path = store_style(style, replace)
    except (MotionFileError, MethodError) as error:
        raise UsageError(str(error)) from None
    out.print(f"{name} ({style.provenance}) is kept in {path}.", markup=False)
    return 0
