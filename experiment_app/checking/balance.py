"""What a study will be for whom: the balance over the planned participants, and the whole session of one of them."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator

from protocols.orders.adaptive import begin_tracks
from protocols.orders.assignment import counts, group_of
from protocols.orders.design import default_seed, make_trials, square_parts, square_row, square_rows
from protocols.orders.order import AdaptiveOrder
from protocols.orders.staircase import Staircase
from protocols.plan import QuestionsStep, TrialStep, make_plan
from protocols.study import Level, Study

FEW = 12
"""Rows of a square or levels of a factor up to which a table of them is printed."""

COUNTED = 200
"""Participants whose orders are made to count the balance; a larger study is counted over the first of them."""


def order_in_words(study: Study) -> str:
    """The order of the trials as a phrase, as "random order, never more than 2 in a row with the same actor"."""
    order = study.order
    if isinstance(order, AdaptiveOrder):
        rule = order.rule.kind.replace("quest_plus", "QUEST+").replace("_", " ")
        return f"adaptive order: {order.of} placed by {rule}, yes where {order.yes}{_settling(study)}{_ending(order)}"
    words = [f"{order.kind.replace('_', ' ')}{' of ' + ' x '.join(order.of) if order.of else ''} order"]
    words += [f"at most {n} in a row with the same {factor}" for factor, n in order.at_most_in_a_row.items()]
    words += [f"the same {factor} at least {n} trials apart" for factor, n in order.at_least_apart.items()]
    if order.repeats_at_least_apart:
        words.append(f"repeats at least {order.repeats_at_least_apart} trials apart")
    return ", ".join(words)


def _settling(study: Study) -> str:
    """Where the study's staircases settle, as half a sentence; "" where that is not known, as of QUEST+."""
    track = begin_tracks(study)[1]
    share = track.settles_at if isinstance(track, Staircase) else None
    return "" if share is None else f", settling at {100.0 * share:.0f} % yes"


def _ending(order: AdaptiveOrder) -> str:
    return "" if order.stops_after is None else f"; each track ends after {order.stops_after} reversals"


def balance(study: Study) -> list[str]:
    """Lines about the planned participants: groups, rows of the square, counterbalanced keys, early and late trials."""
    planned = study.participants.planned
    lines = [f"Balance over the {planned} planned participants"]
    if study.participants.assigned:
        lines += [
            f"  assigned {_named(group)}: {number} participants"
            for group, number in counts(study, range(1, planned + 1))
        ]
    lines += _square_lines(study, planned)
    if study.task.kind == "adjustment" and study.task.keys.counterbalanced:
        lines.append(f"  keys as in the file: {(planned + 1) // 2} participants; swapped: {planned // 2}")
    people = min(planned, COUNTED)
    if not study.order.placed_factor:
        lines += _halves(study, people)
    return lines


def _named(levels: dict[str, Level] | dict[str, str]) -> str:
    return ", ".join(f"{name} {level}" for name, level in levels.items())


def _square_lines(study: Study, planned: int) -> list[str]:
    if not study.order.is_square:
        return []
    rows, parts = square_rows(study), square_parts(study)
    each, more = divmod(planned, len(rows))
    lines = []
    for number, row in enumerate(rows[:FEW], start=1):
        shown = " - ".join(_named(parts[part]) if len(parts) <= FEW else str(part + 1) for part in row)
        lines.append(f"  row {number} ({each + (number <= more)} participants): {shown}")
    if len(rows) > FEW:
        lines.append(f"  ... and {len(rows) - FEW} more rows")
    if more:
        below, above = planned - more, planned - more + len(rows)
        way = f"{below} or {above}" if below else str(above)
        lines.append(f"  {planned} is no multiple of the {len(rows)} rows: places are balanced with {way} participants")
    return lines


def _halves(study: Study, people: int) -> Iterator[str]:
    """How often every level stands in the first and in the second half of the session, over participants."""
    first: Counter[tuple[str, str]] = Counter()
    second: Counter[tuple[str, str]] = Counter()
    for number in range(1, people + 1):
        trials = make_trials(study, likely_seed(study, number), number, group_of(study, number))
        for trial in trials:
            half = first if 2 * trial.number <= len(trials) else second
            half.update((factor, str(level)) for factor, level in trial.levels.items())
    yield "  trials in the first | second half of the session:"
    for factor, levels in study.factors.items():
        shown = [f"{level} {first[factor, str(level)]} | {second[factor, str(level)]}" for level in levels[:FEW]]
        more = f", ... {len(levels) - FEW} more" if len(levels) > FEW else ""
        yield f"  {factor:>10}  {', '.join(shown)}{more}"


def likely_seed(study: Study, number: int) -> int:
    """The seed of a participant whose ID is P and the number of arrival, as P07, in the first run."""
    return default_seed(study.study, f"P{number:02d}", 1)


def what_participant_sees(study: Study, number: int, seed: int | None = None) -> list[str]:
    """The whole session of the participant with this number of arrival, step by step.

    The order inside shuffled parts follows from the seed, which the ID decides: P07 for number 7.
    """
    own_seed = likely_seed(study, number) if seed is None else seed
    group = group_of(study, number)
    plan = make_plan(study, own_seed, number, group)
    whose = f"P{number:02d}, first run" if seed is None else f"seed {seed}"
    lines = [f"What participant {number} will see ({whose})"]
    if group:
        lines.append(f"  group: {_named(group)}")
    if study.order.is_square:
        parts = square_parts(study)
        shown = " - ".join(_named(parts[part]) for part in square_row(study, number))
        lines.append(f"  row {(number - 1) % len(square_rows(study)) + 1} of the square: {shown}")
    lines.append(f"  keys: {', '.join(f'{name} {key}' for name, key in study.task.keys_for(number).items())}")
    placed = study.order.placed_factor
    if placed:
        stops = study.order.stops_after if isinstance(study.order, AdaptiveOrder) else None
        over = f"; a track's trials after its {stops} reversals are passed over" if stops is not None else ""
        lines.append(f"  {placed} is placed by the answers, so only the rest is known beforehand{over}")
    blocks = {step.trial.block for step in plan.steps if isinstance(step, TrialStep) and not step.trial.practice}
    block = 0
    for step in plan.steps:
        if isinstance(step, TrialStep):
            if step.trial.block != block and not step.trial.practice and len(blocks) > 1 and not placed:
                block = step.trial.block
                lines.append(f"  block {block}")
            lines.append(f"    {_trial(step, placed)}")
        elif isinstance(step, QuestionsStep):
            lines.append(f"  questions: {', '.join(question.id for question in step.questions)}")
        else:
            lines.append(f"  {step.kind if step.kind != 'text' else 'page'}: {step.page.title}")
    return lines


def _trial(step: TrialStep, placed: str) -> str:
    """One trial in words; placed: the factor whose level only the answers will decide."""
    trial = step.trial
    what = "training" if trial.practice else f"trial {trial.number:>3}"
    track = f"  (track {trial.track})" if trial.track else ""
    order = f"  ({' | '.join(step.order)})" if len(step.order) > 1 else ""
    levels = {factor: level for factor, level in trial.levels.items() if trial.practice or factor != placed}
    return f"{what}: {_named(levels)}{order}{track}"
