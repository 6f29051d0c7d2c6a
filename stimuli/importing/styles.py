"""A captured style: what a walk does differently from its performer's normal walk, for any actor to walk in."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from stimuli.gait_model import SIGNALS, Step, load_gait_model
from stimuli.importing.errors import ImportingError
from stimuli.importing.walks import CapturedWalk, read_walk
from stimuli.methods.styles import Style
from stimuli.motion_files.reading import read_clip
from stimuli.motion_files.rest_pose import RestPose, rest_pose
from stimuli.skeleton import Floats


def captured_style(name: str, file: Path, normal: Path | None, licence: str, source: str) -> Style:
    """The style of a clip, by the difference of its signals from those of the same performer's normal walk.

    Of each walk the gait model's walk with the same step is taken off first, so that the two may differ in speed.
    Without `normal` the model's average walker stands for it: then the performer's own manner is in the style too, the
    tempo is left alone, and so is the posture of a skeleton whose zero pose does not stand. Raises MotionFileError for
    a clip that makes no walk.
    """
    walk = read_walk(file, _shared_rest(file, normal))
    shift, tempo, late = _residual(walk), 1.0, walk.curves.left_strike - 0.5
    whose = f"captured in {file.name}"
    if normal is not None:
        own = read_walk(normal)
        shift = shift - _residual(own)
        late = walk.curves.left_strike - own.curves.left_strike
        tempo = float(np.sqrt(own.gait.walk_ratio / walk.gait.walk_ratio))  # SF = sqrt(60 v / WR)
        whose += f" against {normal.name}"
    provenance = f"{whose}; licence: {licence}; source: {source}"
    return Style(name, np.ones(len(SIGNALS)), np.nan_to_num(shift), tempo, late, provenance)


def _shared_rest(file: Path, normal: Path | None) -> RestPose | None:
    """The normal walk's mean posture where the clips' zero pose does not stand; else None, each clip's own.

    A clip's own mean posture would take the posture out of the style. Raises ImportingError for two skeletons.
    """
    if normal is None:
        return None
    clip, other = read_clip(file), read_clip(normal)
    rest = rest_pose(other)
    if rest.standing_zero:
        return None
    if clip.joints != other.joints or clip.parents != other.parents:
        raise ImportingError(f"{file} and {normal} are on different skeletons; give a normal walk on the same one")
    return rest


def _residual(walk: CapturedWalk) -> Floats:
    """(2, S, C) signals of both sides less the model's at the same step; nan where the capture holds none."""
    step = Step.of(walk.gait.speed, walk.gait.step_frequency, walk.leg_length)
    return np.asarray(walk.curves.sides - load_gait_model().coefficients(step))
