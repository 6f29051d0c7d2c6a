"""What was looked at, frame by frame, from samples and body-part maps made by hand."""

import numpy as np
import pytest

from experiment_app.gaze.samples import GazeSample, GazeTrack, LookedAt, Looking
from experiment_app.gaze.watching import GazeWatch
from experiment_app.render.part_map import PartMap
from stimuli.skeleton import JOINTS


def halves(upper: str, lower: str) -> PartMap:
    """A map of 100 x 100 pixels whose upper half is one joint's and whose lower half is another's."""
    codes = np.zeros((100, 100, 4), np.uint8)
    codes[:50, :, 0] = JOINTS.index(upper) + 1
    codes[50:, :, 0] = JOINTS.index(lower) + 1
    codes[:, :, 1] = 1
    return PartMap(codes)


class Tracker:
    """An eye tracker whose samples come `delay` s after they were taken."""

    def __init__(self, samples: list[GazeSample], delay: float = 0.0) -> None:
        self._samples, self._delay, self.now = samples, delay, 0.0

    def poll(self) -> list[GazeSample]:
        come = [s for s in self._samples if s.time + self._delay <= self.now]
        self._samples = [s for s in self._samples if s.time + self._delay > self.now]
        return come


def watch(tracker: Tracker, flips: list[float], parts: PartMap) -> Looking:
    watching = GazeWatch(tracker)
    watching.begin()
    for flip in flips:
        tracker.now = flip
        watching.shown(flip, parts)
    tracker.now += 1.0
    return watching.taken()


def test_a_frame_takes_the_sample_nearest_to_its_flip():
    track = GazeTrack().after([GazeSample(1.0, 0.1, 0.1), GazeSample(1.010, 0.2, 0.2)])
    assert track.at(1.004) == GazeSample(1.0, 0.1, 0.1)
    assert track.at(1.006) == GazeSample(1.010, 0.2, 0.2)


def test_no_sample_within_reach_is_no_gaze():
    track = GazeTrack().after([GazeSample(1.0, 0.1, 0.1)])
    assert track.at(1.051) is None
    assert GazeTrack().at(1.0) is None


def test_shares_are_counted_over_frames_with_a_gaze_and_sum_to_100():
    looking = Looking()
    for region in ("legs", "legs", "head", "elsewhere", "unknown"):
        looking = looking.after(LookedAt(0.0, 0.5, 0.5, region))
    assert looking.shares() == {
        "gaze_legs": 50.0, "gaze_arms": 0.0, "gaze_torso": 0.0, "gaze_head": 25.0, "gaze_elsewhere": 25.0,
        "gaze_frames": 4.0,
    }  # fmt: skip


def test_a_trial_without_any_gaze_has_no_shares():
    assert Looking((LookedAt(0.0, None, None, "unknown"),)).shares() == {"gaze_frames": 0.0}


@pytest.mark.parametrize("delay", [0.0, 0.02, 0.08])
def test_samples_that_come_late_give_the_same_regions(delay):
    flips = [i / 60 for i in range(60)]
    samples = [GazeSample(i / 250, 0.5, 0.25 if i < 125 else 0.75) for i in range(250)]
    looking = watch(Tracker(samples, delay), flips, halves("head", "leftLowerLeg"))
    regions = [frame.region for frame in looking.frames]
    assert regions == ["head"] * 30 + ["legs"] * 30
    assert {frame.joint for frame in looking.frames} == {"head", "leftLowerLeg"}


def test_a_blink_is_a_gap_and_not_a_look_elsewhere():
    flips = [i / 60 for i in range(60)]
    samples = [GazeSample(i / 250, 0.5, 0.25) for i in range(250) if not 100 <= i < 150]
    looking = watch(Tracker(samples), flips, halves("head", "leftFoot"))
    regions = [frame.region for frame in looking.frames]
    assert regions.count("elsewhere") == 0
    assert 4 <= regions.count("unknown") <= 8  # 200 ms of blink less 50 ms of reach on both sides: 6 frames
    assert looking.shares()["gaze_head"] == 100.0


def test_a_gaze_beside_the_picture_is_elsewhere():
    looking = watch(Tracker([GazeSample(0.0, 1.4, 0.5)]), [0.0], halves("head", "leftFoot"))
    assert looking.frames[0].region == "elsewhere"


def test_a_new_trial_begins_with_nothing_looked_at():
    watching = GazeWatch(Tracker([GazeSample(0.0, 0.5, 0.5)]))
    watching.shown(0.0, halves("head", "head"))
    watching.begin()
    assert watching.taken() == Looking()
