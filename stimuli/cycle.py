"""One stride out of a clip, made to loop: the captured cycle that blend trees are built of.

The loop joins the two most alike frames one cycle apart (Kovar, Gleicher & Pighin 2002), spreads their difference
linearly over the cycle, and bends the first and last tenth so that velocities meet as well. Travel is separated from
posture: what remains walks on the spot. Foot sliding is not treated here. Knows clips, no character.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from stimuli.clip import Clip, FootEvent, world_pose
from stimuli.events import GaitError, foot_paths, told_or_found
from stimuli.gait import Gait
from stimuli.gait_measures import GaitMeasures, measure_paths
from stimuli.motion_files.rest_pose import RestPose, rest_pose
from stimuli.rotations import (
    about_axis,
    continuous,
    from_exponential,
    inverse,
    multiply,
    normalise,
    rotate,
    to_exponential,
    yaw,
)
from stimuli.skeleton import JOINTS, role_parents

Floats = NDArray[np.floating]

PHASES = 128
"""Samples per cycle."""

UP = np.array([0.0, 1.0, 0.0])
STRETCH = 0.08  # of the stride time: how much shorter or longer than the mean stride a loop may be
WINDOW = 0.04  # s on each side of a frame that is compared with it, so that velocities count
UNLIKE = 0.10  # share by which a loop's travel may differ from the walk's before it counts against it
MEETING = 0.12  # of the cycle at each end over which the difference of velocities is bent away
SMOOTH = 10.0  # Hz, low-pass of the closed cycle; walking has 99.7 % of its power below 6 Hz (Winter 2009)
LEAST_STEP = 0.3  # of the stride time; a shorter step than that is a strike missed, not a limp
TRAVEL_WEIGHT = 0.05  # s, by which a difference of hips velocity counts like one of joint places


@dataclass(frozen=True)
class Provenance:
    """Where a cycle comes from and how well it closed."""

    clip: str
    format: str
    first_frame: int  # the joined frames, counted from 0
    last_frame: int
    frame_rate: float  # Hz
    pose_difference: float  # m, root mean square over joints between the joined frames
    seam_phase: float  # phase at which they were joined
    rest: str  # "zero pose" or "mean posture"


@dataclass(frozen=True, eq=False)
class Cycle:
    """One stride of one person, without travel; phase 0 is the right heel strike.

    joints:       R names of JOINTS found in the clip, parents before children; the first is the hips
    parents:      R indices into joints, -1 for the hips
    offsets:      (R, 3) m from parent to joint in the clip's rest pose, facing +Z; the hips' is their rest height
                  above the ankles
    rotations:    (N, R, 4) local rotations relative to that rest pose (world deltas, parent's taken off), x y z w
    hips:         (N, 3) m: left, above the clip's ground, ahead of a point that moves evenly at the walker's speed
    stride_length m; stride_time s
    stance_share: of the cycle, left and right foot; nan where no toe-off was found
    left_strike: phase of the left heel strike; 0.5 where none was found
    """

    joints: tuple[str, ...]
    parents: tuple[int, ...]
    offsets: Floats
    rotations: Floats
    hips: Floats
    stride_length: float
    stride_time: float
    stance_share: tuple[float, float]
    provenance: Provenance
    left_strike: float = 0.5

    @property
    def gait(self) -> Gait:
        """The gait this loop walks at when played at its own speed."""
        return Gait(0.5 * self.stride_length, 120.0 / self.stride_time)

    @property
    def phases(self) -> Floats:
        """(N,) in [0, 1)."""
        return np.arange(len(self.hips)) / len(self.hips)


def extract_cycle(clip: Clip, phases: int = PHASES) -> Cycle:
    """The best one-stride loop of a walk. Raises GaitError if it has no whole stride."""
    return cycle_and_measures(clip, phases)[0]


def cycle_and_measures(clip: Clip, phases: int = PHASES, rest: RestPose | None = None) -> tuple[Cycle, GaitMeasures]:
    """The best one-stride loop, and the gait of the whole walk it was chosen from. Raises GaitError.

    rest: the standing pose that rotations are counted from; by default the clip's own (rest_pose.py).
    """
    world, positions = world_pose(clip)
    paths = foot_paths(clip, positions)
    events = told_or_found(clip.events, paths)
    measures = measure_paths(paths, events, clip.name)
    first, last, difference = _most_alike(clip, positions, measures)
    rest = rest or rest_pose(clip)
    joints = tuple(joint for joint in JOINTS if joint in clip.roles)
    margin = min(first, clip.frame_count - 1 - last, 2)
    frames = slice(first - margin, last + margin + 1)
    share = np.arange(-margin, last - first + margin + 1) / (last - first)
    rotations = _deltas(clip, world[frames], rest, joints)
    path = positions[frames, clip.roles["hips"]]
    hips, length = _without_travel(path, rotations[:, 0], share)
    seam, left_strike = _strikes(clip, events, first, last)
    sample = (np.arange(phases) / phases + seam) % 1.0
    time = (last - first) / clip.rate
    cycle = Cycle(
        joints=joints,
        parents=role_parents(joints),
        offsets=_offsets(clip, rest, joints),
        rotations=normalise(_sampled(close_rotations(continuous(rotations), share), sample, time)),
        hips=_sampled(close_curve(hips, share), sample, time) - [0.0, _ground(clip, positions[frames]), 0.0],
        stride_length=measures.speed * time if measures.on_the_spot else length,
        stride_time=time,
        stance_share=(measures.stance_share_left, measures.stance_share_right),
        provenance=Provenance(
            clip=clip.name,
            format=clip.source.format,
            first_frame=first,
            last_frame=last,
            frame_rate=clip.rate,
            pose_difference=difference,
            seam_phase=float(-seam % 1.0),
            rest="zero pose" if rest.standing_zero else "mean posture",
        ),
        left_strike=left_strike,
    )
    return cycle, measures


def close_curve(values: Floats, share: Floats) -> Floats:
    """A curve made periodic: its difference spread evenly, its velocities met near the ends.

    values:  (T, ...) at share, which runs from 0 or a little before to 1 or a little after
    returns: (K, ...) at the K shares from 0 to 1, the last equal to the first
    """
    inside = (share > -1e-9) & (share < 1 + 1e-9)
    velocity = np.gradient(values, share, axis=0)[inside]
    values, share = values[inside], share[inside].reshape(-1, *[1] * (values.ndim - 1))
    closed = values - (share - 0.5) * (values[-1] - values[0])
    closed = closed + _meeting(share) * (velocity[-1] - velocity[0])
    closed[-1] = closed[0]
    return closed


def close_rotations(rotations: Floats, share: Floats) -> Floats:
    """Rotations (T, ..., 4) made periodic as `close_curve` does it, joint by joint in the exponential map."""
    inside = (share > -1e-9) & (share < 1 + 1e-9)
    places = np.flatnonzero(inside)
    spin = [_spin(rotations, share, frame) for frame in (places[0], places[-1])]
    rotations, share = rotations[inside], share[inside].reshape(-1, *[1] * (rotations.ndim - 1))
    difference = to_exponential(multiply(inverse(rotations[0]), rotations[-1]))
    closed = multiply(rotations, from_exponential(-(share - 0.5) * difference))
    start = rotate(from_exponential(-0.5 * difference), spin[0])
    end = rotate(from_exponential(0.5 * difference), spin[1])
    closed = continuous(multiply(closed, from_exponential(_meeting(share) * (end - start))))
    closed[-1] = closed[0]
    return closed


def _spin(rotations: Floats, share: Floats, frame: int) -> Floats:
    """(..., 3) angular velocity in the joint's own axes, rad per cycle, from the neighbouring frames."""
    before, after = max(frame - 1, 0), min(frame + 1, len(rotations) - 1)
    here = rotations[frame]
    turned = to_exponential(multiply(inverse(here), rotations[after])) - to_exponential(
        multiply(inverse(here), rotations[before])
    )
    return turned / (share[after] - share[before])


def _meeting(share: Floats) -> Floats:
    """A curve that is 0 at both ends, with slope 1/2 at the start and -1/2 at the end, and 0 away from them."""
    near = np.minimum(share, 1 - share)
    return np.where(near < MEETING, 0.5 * near * (1 - near / MEETING) ** 2, 0.0)


def _sampled(closed: Floats, sample: Floats, time: float) -> Floats:
    """(N, ...) of a periodic curve (K, ...) at shares `sample`, smoothed at SMOOTH Hz; time: s per cycle.

    Frame-to-frame marker noise would make every sample a seam of some millimetres; the zero-lag low-pass acts on
    the closed cycle, so it knows no ends. For unit quaternions, normalised afterwards, the cubic through the frames
    is slerp without its kinks, at which joint speeds would jump at every frame of a 30 Hz capture.
    """
    frames = closed[:-1]
    harmonics = np.fft.rfftfreq(len(frames), 1.0 / len(frames))
    gain = 1.0 / (1.0 + (harmonics / (SMOOTH * time)) ** 4)  # 2nd-order Butterworth, there and back
    spectrum = np.fft.rfft(frames, axis=0) * gain.reshape(-1, *[1] * (closed.ndim - 1))
    smooth = np.fft.irfft(spectrum, n=len(frames), axis=0)
    looped = np.concatenate([smooth, smooth[:1]])
    from scipy.interpolate import CubicSpline  # here, because showing made cycles needs none of it

    return np.asarray(CubicSpline(np.linspace(0.0, 1.0, len(looped)), looped, bc_type="periodic")(sample))


def _strikes(clip: Clip, events: Sequence[FootEvent], first: int, last: int) -> tuple[float, float]:
    """Share of the loop at which the right heel strikes, and the phase from there at which the left one does.

    A foot without a strike, or one that would strike out of turn, is taken to strike half a cycle after the other.
    """
    right, left = (_strike_share(clip, events, side, first, last) for side in ("right", "left"))
    if right is None and left is None:
        raise GaitError(f"{clip.name}: no heel strike was found")
    if right is None or left is None:
        return ((left or 0.0) + 0.5) % 1.0 if right is None else right, 0.5
    between = (left - right) % 1.0
    return right, between if LEAST_STEP <= between <= 1.0 - LEAST_STEP else 0.5


def _strike_share(clip: Clip, events: Sequence[FootEvent], side: str, first: int, last: int) -> float | None:
    """Share of the loop at which a heel strikes; of several the strike nearest to the loop's middle."""
    strikes = [e.time * clip.rate for e in events if e.side == side and e.kind == "strike"]
    if not strikes:
        return None
    nearest = min(strikes, key=lambda frame: abs(frame - 0.5 * (first + last)))
    return float(((nearest - first) / (last - first)) % 1.0)


def _ground(clip: Clip, positions: Floats) -> float:
    """m: height of the lowest foot joint or end over the loop, taken for the ground; soles lie a little lower."""
    feet = {
        clip.roles[side + part] for side in ("left", "right") for part in ("Foot", "Toes") if side + part in clip.roles
    }
    below = {joint for joint, parent in enumerate(clip.parents) if parent in feet}
    return float(positions[:, sorted(feet | below), 1].min())


def cycle_pose(cycle: Cycle) -> tuple[Floats, Floats]:
    """World rotations (N, R, 4) and positions (N, R, 3) m of the walker on the spot, on the cycle's own offsets."""
    world = np.empty_like(cycle.rotations)
    positions = np.empty((*cycle.rotations.shape[:2], 3))
    for joint, parent in enumerate(cycle.parents):
        if parent < 0:
            world[:, joint], positions[:, joint] = cycle.rotations[:, joint], cycle.hips
        else:
            world[:, joint] = multiply(world[:, parent], cycle.rotations[:, joint])
            positions[:, joint] = positions[:, parent] + rotate(world[:, parent], cycle.offsets[joint])
    return world, positions


def cycle_positions(cycle: Cycle) -> Floats:
    """(N, R, 3) m: joints of the walker on the spot."""
    return cycle_pose(cycle)[1]


def leg_length(cycle: Cycle) -> float:
    """m, thigh and shank, mean of both legs; the cycle has both."""
    bones = [
        cycle.offsets[cycle.joints.index(f"{side}{end}")] for side in ("left", "right") for end in ("LowerLeg", "Foot")
    ]
    return 0.5 * sum(float(np.linalg.norm(bone)) for bone in bones)


def seam_gaps(cycle: Cycle) -> tuple[float, float]:
    """How far the loop is from meeting itself: position (m), and velocity as a share of the fastest joint speed.

    Both are the largest over joints of what the samples before the seam foretell against those after it.
    """
    positions = np.roll(cycle_positions(cycle), -int(np.ceil(cycle.provenance.seam_phase * len(cycle.hips))), axis=0)
    step = cycle.stride_time / len(cycle.hips)
    foretold = 3 * positions[-1] - 3 * positions[-2] + positions[-3]
    before = (3 * positions[-1] - 4 * positions[-2] + positions[-3]) / (2 * step)
    before = before + (positions[-1] - 2 * positions[-2] + positions[-3]) / step  # carried on to the seam
    after = (-3 * positions[0] + 4 * positions[1] - positions[2]) / (2 * step)
    speeds = np.linalg.norm(np.roll(positions, -1, axis=0) - positions, axis=2) / step
    gap = np.linalg.norm(foretold - positions[0], axis=1)
    return float(gap.max()), float(np.linalg.norm(after - before, axis=1).max() / speeds.max())


def _most_alike(clip: Clip, positions: Floats, measures: GaitMeasures) -> tuple[int, int, float]:
    """First and last frame of the loop, and their difference (m, root mean square over joints).

    Poses are compared as points about the hips, each turned to its own heading, over a short window. Only loops
    that travel like the measured walk count, so that standing, starting and stopping are not taken for it.
    """
    stride_frames = measures.gait.stride_time * clip.rate
    pace = 0.0 if measures.on_the_spot else measures.speed / clip.rate
    chosen = [clip.roles[joint] for joint in JOINTS if joint in clip.roles]
    hips = positions[:, clip.roles["hips"]]
    left = positions[:, clip.roles["leftUpperLeg"]] - positions[:, clip.roles["rightUpperLeg"]]
    heading = about_axis(UP, np.arctan2(left[:, 2], left[:, 0]))
    points = rotate(heading[:, None], positions[:, chosen] - hips[:, None] * [1.0, 0.0, 1.0])
    velocity = rotate(heading, np.gradient(hips, axis=0) * clip.rate) * TRAVEL_WEIGHT
    features = np.concatenate([points.reshape(len(points), -1), velocity], axis=1)
    half = max(round(WINDOW * clip.rate), 1)
    shortest, longest = int(np.floor((1 - STRETCH) * stride_frames)), int(np.ceil((1 + STRETCH) * stride_frames))
    best = (np.inf, 0, 0)
    for lag in range(max(shortest, 2), min(longest, len(points) - 2 * half - 1) + 1):
        squares = np.sum((features[lag:] - features[:-lag]) ** 2, axis=1)
        windowed = np.convolve(squares, np.ones(2 * half + 1), mode="valid") / (2 * half + 1)
        travel = np.linalg.norm((hips[lag:] - hips[:-lag])[half : len(hips) - lag - half][:, [0, 2]], axis=1)
        windowed = windowed + np.maximum(np.abs(travel - pace * lag) - UNLIKE * pace * lag, 0.0) ** 2 * 1e3
        first = int(np.argmin(windowed))
        best = min(best, (float(windowed[first]), first + half, first + half + lag))
    if not np.isfinite(best[0]):
        raise GaitError(f"{clip.name}: too short for a loop of one stride of {stride_frames / clip.rate:.2f} s")
    return best[1], best[2], float(np.sqrt(best[0] / len(chosen)))


def _deltas(clip: Clip, world: Floats, rest: RestPose, joints: tuple[str, ...]) -> Floats:
    """(T, R, 4): each joint's world rotation since the rest pose, seen from its parent's."""
    since = [multiply(world[:, clip.roles[joint]], inverse(rest.rotations[clip.roles[joint]])) for joint in joints]
    parents = role_parents(joints)
    local = [since[0]] + [multiply(inverse(since[p]), since[j]) for j, p in enumerate(parents) if p >= 0]
    return continuous(np.stack(local, axis=1))


def _offsets(clip: Clip, rest: RestPose, joints: tuple[str, ...]) -> Floats:
    """(R, 3) m; between joints with others in between, their distance in the rest pose."""
    places = rest.positions[[clip.roles[joint] for joint in joints]]
    offsets = np.array([places[j] - places[p] if p >= 0 else places[j] for j, p in enumerate(role_parents(joints))])
    ankles = np.mean([rest.positions[clip.roles[side + "Foot"], 1] for side in ("left", "right")])
    offsets[0] = [0.0, places[0, 1] - ankles, 0.0]
    return offsets


def _without_travel(path: Floats, hips: Floats, share: Floats) -> tuple[Floats, float]:
    """Hips about a point moving evenly along +Z (T, 3), and the stride length (m); turns `hips` (T, 4) in place.

    share runs from 0 to 1 over the stride, a little beyond at both ends. A walk that turns is unrolled: the change
    of heading over the stride is taken off evenly, from the way as well.
    """
    start, end = int(np.argmin(np.abs(share))), int(np.argmin(np.abs(share - 1.0)))
    turn = float(yaw(multiply(hips[end], inverse(hips[start]))))
    unroll = about_axis(UP, -turn * (share - 0.5))
    middle = about_axis(UP, -turn * (0.5 * (share[1:] + share[:-1]) - 0.5))
    straight = np.concatenate([path[:1], path[:1] + np.cumsum(rotate(middle, np.diff(path, axis=0)), axis=0)])
    travel = straight[end] - straight[start]
    length = float(np.hypot(travel[0], travel[2]))
    unrolled = multiply(unroll, hips)
    facing = np.mean(rotate(unrolled, np.array([0.0, 0.0, 1.0])), axis=0)
    forward = np.arctan2(travel[0], travel[2]) if length > 0.1 else np.arctan2(facing[0], facing[2])
    to_forward = about_axis(UP, -forward)
    hips[:] = multiply(to_forward, unrolled)
    local = rotate(to_forward, straight - straight[start]) - share[:, None] * [0.0, 0.0, length]
    local = local - local[start : end + 1].mean(axis=0)
    local[:, 1] += path[start : end + 1, 1].mean()
    return local, length
