"""Mistakes in how walks are seen: views, places and grounds that do not go together in a trial, and the display."""

from __future__ import annotations

from collections.abc import Iterator

from protocols.mistakes.mistake import Mistake, Place
from protocols.mistakes.shown import Shown, shown_trials, value_place
from protocols.setting import CONSTANT, kind_of, references, value_of
from protocols.study import Study
from protocols.viewing import FOLLOWING, PLACED, CameraView, Ground

CAMERA: Place = ("stimulus", "camera")
GROUND: Place = ("stimulus", "ground")
PLACED_VIEWS = " or ".join(PLACED)


def view_mistakes(study: Study) -> Iterator[Mistake]:
    """Every place of the study whose value makes a trial that cannot be seen, once; and a display without a size."""
    found: dict[Place, Mistake] = {}
    for shown, camera, ground in shown_views(study):
        for mistake in _of_a_trial(study, shown, camera, ground):
            found.setdefault(mistake.where, mistake)
    yield from found.values()
    display = study.display
    if display is not None and (display.screen_height is None) == (display.diagonal is None):
        yield Mistake(("display",), "give either screen_height or diagonal, in m")


def shown_views(study: Study) -> Iterator[tuple[Shown, CameraView, Ground]]:
    """Camera and ground of every combination of the factors they depend on, and of the training trials.

    None where a setting has no such value, which has a sentence of its own.
    """
    look = study.stimulus
    settings = [look.ground, *(setting for setting, _, _ in look.camera.settings(CAMERA))]
    for shown in shown_trials(study, {factor for setting in settings for factor in references(setting)}):
        try:
            yield shown, look.camera.resolved(shown.levels), value_of(look.ground, shown.levels)
        except (KeyError, IndexError, TypeError, ValueError):
            continue


def _of_a_trial(study: Study, shown: Shown, camera: CameraView, ground: Ground) -> Iterator[Mistake]:
    given, crowd = study.stimulus.camera, study.stimulus.crowd is not None
    follows, stands = camera.view in FOLLOWING, camera.view in PLACED
    if crowd and follows:
        at = CAMERA if kind_of(given.view) == CONSTANT else value_place(study, shown, given.view, (*CAMERA, "view"))
        message = f"{camera.view} follows one walker; a crowd is seen by {PLACED_VIEWS}"
        yield Mistake(at, message + _when(shown, given.view))
    elif follows and camera.place is not None:
        at = value_place(study, shown, given.place, (*CAMERA, "place"))
        message = f"{camera.view} follows the walker and has no place; {_without(given.view)}, or choose {PLACED_VIEWS}"
        yield Mistake(at, message + _when(shown, given.view, given.place))
    if ground == "treadmill" and (crowd or stands):
        who, way = ("a crowd", "street") if crowd else (camera.view, "open_ground, street or plain")
        message = f"{who} needs a ground that is walked along; choose {way}"
        views = () if crowd else (given.view,)
        at = value_place(study, shown, study.stimulus.ground, GROUND)
        yield Mistake(at, message + _when(shown, study.stimulus.ground, *views))


def _without(view: object) -> str:
    """How to have no place in a trial whose view is this setting."""
    return "make it a table by a factor with null here" if list(references(view)) else "remove it"


def _when(shown: Shown, *settings: object) -> str:
    """In which trials that is, where the settings differ from trial to trial."""
    factors = dict.fromkeys(factor for setting in settings for factor in references(setting))
    levels = ", ".join(f"{factor} {shown.levels[factor]}" for factor in factors if factor in shown.levels)
    return f" (in trials with {levels})" if levels else ""
