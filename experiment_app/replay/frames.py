"""A recorded trial to the scenes its participant saw, one per logged frame, each with the check that it is the same."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

from experiment_app.replay.recorded import RecordedTrial
from experiment_app.scene import Scene
from experiment_app.staging import stage
from experiment_app.walkers import drawn_walkers, pose_checksum
from protocols.plan import Plan, TrialStep
from protocols.session import advance, begin, handle


@dataclass(frozen=True)
class ReplayedFrame:
    """One frame made again.

    flip: s on the run's clock, when it was seen; recorded: checksum of the poses drawn then.
    """

    flip: float
    scene: Scene
    recorded: str

    @property
    def same(self) -> bool:
        """True when the walkers of the scene stand exactly as they were drawn."""
        return pose_checksum(drawn_walkers(self.scene)) == self.recorded


def replayed_frames(plan: Plan, trial: RecordedTrial) -> Iterator[ReplayedFrame]:
    """Every frame of a trial, as the recorded keys and display times make it; plan: of the run that recorded it.

    The same functions that ran the session run again: events up to a frame, then a preview for when it was to be seen.
    """
    session = begin(replace(plan, steps=(_step(plan, trial),)))
    waiting = list(trial.events)
    log = trial.frames
    for number, (flip, predicted, pose) in enumerate(zip(log["flips"], log["predicted"], log["poses"], strict=True)):
        while waiting and waiting[0][0] <= number:
            session = handle(session, waiting.pop(0)[1])
        yield ReplayedFrame(flip, stage(advance(session, predicted)), pose)


def _step(plan: Plan, trial: RecordedTrial) -> TrialStep:
    """The step of the plan with the levels that were recorded, which an adaptive order chooses during the run."""
    begun = trial.begun
    number, practice = begun["number"], begun["practice"]
    for step in plan.steps:
        if isinstance(step, TrialStep) and (step.trial.number, step.trial.practice) == (number, practice):
            return replace(step, trial=replace(step.trial, levels=begun["factors"], track=0), attempt=begun["attempt"])
    raise LookupError(f"the plan has no {trial.name}")  # the plan follows from the journal's own header
