"""Every clip of a folder as a captured walk: one closed cycle with its gait, or one sentence why it makes none."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from stimuli.clip import Clip, world_positions
from stimuli.cycle import Cycle, cycle_and_measures, leg_length, seam_gaps
from stimuli.events import GaitError, foot_paths
from stimuli.gait import Gait
from stimuli.gait_measures import GaitMeasures
from stimuli.gait_model import WalkCurves
from stimuli.importing.errors import ImportingError
from stimuli.importing.signals import walk_signals
from stimuli.motion_files.axes import sides_swapped
from stimuli.motion_files.reading import ENDINGS, read_clip
from stimuli.motion_files.rest_pose import RestPose
from stimuli.skeleton import Floats

LONGEST = 120.0
"""s: a longer recording is no walk down a walkway."""

WORTH_PROCESSES = 12
"""Files of markers from which it is worth starting processes: each takes 2 s of loading libraries, a file of markers
0.15 s of fitting. Skeletons are read in 0.05 s."""

SPEEDS = (0.3, 2.6)
"""m/s, from a shuffle to the walk-run transition at its latest (2.1 m/s on average, Hreljac 1995)."""

STRAIGHT = np.radians(15.0)
"""Largest change of heading over the stride that is looped."""

LEG_SHARE = 0.491
"""Thigh and shank over stature (0.245 + 0.246, Winter 2009)."""

LEG_TOLERANCE = 0.14
"""Share by which a leg may differ from LEG_SHARE of the stature: five standard deviations of people's proportions
(sitting height over stature, Pheasant 1996: 0.52 with SD 0.014), and regression joint centres."""

LEG_UNLIKELY = 0.07
"""The same at which it is unlikely: two and a half standard deviations."""

SAME_PERSON = {"markers": 0.05, "skeleton": 0.012}
"""Share by which thigh and shank may differ between clips: one skeleton is exported alike, markers are placed anew."""


@dataclass(frozen=True, eq=False)
class CapturedWalk:
    """One clip's cycle, ready to be arranged.

    curves: signals of the gait model and stance shares of both sides, nan where the capture holds none
    bones:        (4,) m, left thigh and shank, right thigh and shank
    gait:         over all steady strides of the clip, at which the cycle is drawn; loop: of the looped stride alone
    """

    file: str
    format: str
    gait: Gait
    loop: Gait
    measured: GaitMeasures
    curves: WalkCurves
    leg_length: float  # m
    bones: Floats
    names: str  # the table of joint names that fitted, "markers" for a skeleton made from markers
    pose_difference: float  # m, between the joined frames
    seam: float  # m
    seam_velocity: float  # share of the fastest joint's speed
    frames: tuple[int, int]  # the joined frames, from 0
    warnings: tuple[str, ...]

    @property
    def marker_based(self) -> bool:
        """Whether its skeleton was made from markers."""
        return self.names == "markers"


def read_walks(folder: Path, told: Callable[[int, int], None] | None = None, at_once: int = 1) -> list[CapturedWalk]:
    """The captured walk of every motion file in a folder, in order of name.

    told: called with the number of files read so far and of all; at_once: how many are read at the same time, each in a
    process of its own. Raises MotionFileError naming the first file that makes no walk, or two files of two people.
    """
    if not folder.is_dir():
        raise ImportingError(f"{folder} is no folder; give the folder that holds the clips and actor.yaml")
    found = (path for path in folder.iterdir() if path.suffix.lower() in ENDINGS)
    paths = sorted(path for path in found if not path.name.startswith("."))  # macOS leaves ._walk.bvh on sticks
    if not paths:
        raise ImportingError(f"{folder} holds no motion file; they end in {', '.join(ENDINGS)}")
    walks: list[CapturedWalk] = []
    for walk in _read(paths, at_once):
        walks.append(walk)
        if told is not None:
            told(len(walks), len(paths))
    _check_one_person(walks, folder)
    return walks


def _read(paths: list[Path], at_once: int) -> Iterator[CapturedWalk]:
    """The walks in order. Processes are started anew, not forked, so that no thread's lock is copied with them."""
    if at_once < 2 or sum(path.suffix.lower() == ".c3d" for path in paths) < WORTH_PROCESSES:
        yield from map(read_walk, paths)
        return
    import multiprocessing
    import signal
    from concurrent.futures import ProcessPoolExecutor

    context = multiprocessing.get_context("spawn")
    quietly = (signal.SIGINT, signal.SIG_IGN)  # Ctrl+C is for the command, which then ends them
    with ProcessPoolExecutor(at_once, context, initializer=signal.signal, initargs=quietly) as pool:
        yield from pool.map(read_walk, paths)


def read_walk(path: Path, rest: RestPose | None = None) -> CapturedWalk:
    """The captured walk of one motion file, counted from a rest pose or its own. Raises MotionFileError."""
    clip = read_clip(path)
    _check_clip(clip, path)
    try:
        cycle, measured = cycle_and_measures(clip, rest=rest)
    except GaitError as error:
        raise ImportingError(f"{path}: {str(error).removeprefix(clip.name + ': ')}") from error
    _check_walk(clip, cycle, path)
    seam, seam_velocity = seam_gaps(cycle)
    parts = ("leftLowerLeg", "leftFoot", "rightLowerLeg", "rightFoot")
    return CapturedWalk(
        file=path.name,
        format=clip.source.format,
        gait=measured.gait,
        loop=cycle.gait,
        measured=measured,
        curves=WalkCurves(walk_signals(cycle), np.array(cycle.stance_share), cycle.left_strike),
        leg_length=leg_length(cycle),
        bones=np.array([float(np.linalg.norm(cycle.offsets[cycle.joints.index(part)])) for part in parts]),
        names=clip.source.names,
        pose_difference=cycle.provenance.pose_difference,
        seam=seam,
        seam_velocity=seam_velocity,
        frames=(cycle.provenance.first_frame, cycle.provenance.last_frame),
        warnings=clip.warnings,
    )


def check_height(walks: list[CapturedWalk], height: float, folder: Path) -> None:
    """Raises ImportingError if the captured legs do not belong to a person of this height (m)."""
    leg = float(np.median([walk.leg_length for walk in walks]))
    if abs(leg / (LEG_SHARE * height) - 1.0) > LEG_TOLERANCE:
        raise ImportingError(
            f"{folder}: thigh and shank are {leg:.2f} m long, which is no leg of somebody {height:g} m tall "
            f"(about {LEG_SHARE * height:.2f} m); check height in actor.yaml and the unit of {walks[0].file}"
        )


def height_note(walks: list[CapturedWalk], height: float) -> tuple[str, ...]:
    """A sentence if the captured legs are unlikely for a person of this height (m), or none."""
    leg = float(np.median([walk.leg_length for walk in walks]))
    likely = leg / LEG_SHARE
    if abs(likely / height - 1.0) <= LEG_UNLIKELY:
        return ()
    return (
        f"thigh and shank of {leg:.2f} m are rather those of somebody {likely:.2f} m tall than {height:g} m; if height "
        "in actor.yaml is wrong, steps are drawn too long or too short for the legs",
    )


def _check_clip(clip: Clip, path: Path) -> None:
    if clip.frame_count < 2:
        raise ImportingError(f"{path}: holds one frame and so no walk; take it out of the folder")
    if clip.duration > LONGEST:
        raise ImportingError(
            f"{path}: lasts {clip.duration:.0f} s; cut it to one straight walk of at most {LONGEST:.0f} s"
        )
    missing = [role for side in ("left", "right") for role in (f"{side}LowerLeg",) if role not in clip.roles]
    if missing:
        raise ImportingError(f"{path}: no joint plays {', '.join(missing)}; name it in a YAML file beside the motion")


def _check_walk(clip: Clip, cycle: Cycle, path: Path) -> None:
    speed = cycle.gait.speed
    if not SPEEDS[0] <= speed <= SPEEDS[1]:
        raise ImportingError(
            f"{path}: goes at {speed:.2f} m/s, which is no walk ({SPEEDS[0]:g} to {SPEEDS[1]:g} m/s); check unit_to_m "
            f"({clip.source.unit_to_m:g}) and up ({clip.source.up})"
        )
    positions = world_positions(clip)
    turn = _turn(clip, positions, cycle.provenance.first_frame, cycle.provenance.last_frame)
    if turn > STRAIGHT:
        raise ImportingError(
            f"{path}: turns by {np.degrees(turn):.0f} degrees within a stride; cut it to a straight walk"
        )
    if sides_swapped(positions, clip.roles):
        raise ImportingError(f"{path}: left and right are swapped or the file is mirrored; export it anew")


def _turn(clip: Clip, positions: Floats, first: int, last: int) -> float:
    """rad by which both the pelvis' facing and the way turn between two frames; the smaller, as each alone misleads.

    In a clip of little more than a stride the facing still holds the pelvis' own rotation, and the way the sway.
    """
    heading = foot_paths(clip, positions).heading
    way = positions[:, clip.roles["hips"]][:, [0, 2]]
    middle = (first + last) // 2
    halves = way[middle] - way[first], way[last] - way[middle]
    return min(_angle(heading[first], heading[last]), 2.0 * _angle(*halves))


def _angle(first: Floats, second: Floats) -> float:
    """rad between two directions (2,) on the ground."""
    return float(abs(np.arctan2(first[0] * second[1] - first[1] * second[0], first @ second)))


def _check_one_person(walks: list[CapturedWalk], folder: Path) -> None:
    """Raises ImportingError naming two clips whose legs are not of one person."""
    for walk in walks[1:]:
        kind = "markers" if walk.marker_based or walks[0].marker_based else "skeleton"
        ratios = walk.bones / walks[0].bones
        if float(np.max(np.abs(ratios - 1.0))) > SAME_PERSON[kind]:
            raise ImportingError(
                f"{folder}: {walks[0].file} and {walk.file} are of two people: thigh and shank measure "
                f"{walks[0].leg_length:.3f} m and {walk.leg_length:.3f} m; keep one person's clips in a folder"
            )
