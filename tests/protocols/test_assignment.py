"""Places and groups: who gets what when people arrive, drop out and come back; counted by hand."""

from __future__ import annotations

from collections import Counter

import pytest
from hypothesis import given
from hypothesis import strategies as st

from protocols.mistakes.consistency import inconsistencies
from protocols.mistakes.order_mistakes import order_mistakes
from protocols.orders.assignment import Arrival, counts, group_of, place_in_group, place_of
from protocols.plan import make_plan
from protocols.setting import value_of
from protocols.study import Participants
from protocols.study_file import parse_study
from tests.protocols.studies import changed, study


def assigned(**between):
    """The walk ratio study with factors that the program assigns."""
    people = study().participants
    factors = {**people.between, **between}
    return study().model_copy(
        update={"participants": people.model_copy(update={"between": factors, "assigned": list(between)})}
    )


TWO = assigned(viewing=["screen", "headset"])
SIX = assigned(viewing=["screen", "headset"], body_shown=["woman", "man", "stick_figure"])


def test_the_first_to_arrive_get_places_one_two_three():
    arrivals = []
    for number, who in enumerate(("P01", "P02", "P03"), start=1):
        assert place_of(who, arrivals) == number
        arrivals.append(Arrival(who, number, "finished"))
    assert place_of("P02", arrivals) == 2


@pytest.mark.parametrize("ended", ["declined", "withdrawn", "dropped out"])
def test_a_place_given_back_is_taken_by_the_next_to_arrive(ended):
    arrivals = [Arrival("P01", 1, "finished"), Arrival("P02", 2, ended), Arrival("P03", 3, "finished")]
    assert place_of("P04", arrivals) == 2
    assert place_of("P05", [*arrivals, Arrival("P04", 2)]) == 4


@pytest.mark.parametrize("ended", ["", "stopped", "window closed", "SIGTERM"])
def test_who_may_still_go_on_keeps_the_place(ended):
    assert place_of("P03", [Arrival("P01", 1, "finished"), Arrival("P02", 2, ended)]) == 3


def test_who_comes_back_after_dropping_out_keeps_the_place_unless_it_is_taken():
    gone = [Arrival("P01", 1, "dropped out"), Arrival("P02", 2)]
    assert place_of("P01", gone) == 1
    assert place_of("P01", [*gone, Arrival("P03", 1)]) == 3


def test_places_of_those_who_are_no_longer_in_the_folder_are_filled_lowest_first():
    assert place_of("P09", [Arrival("P01", 1), Arrival("P04", 4)], given_back=[3, 2]) == 2
    assert place_of("P09", [], given_back=[3]) == 3
    assert place_of("P09", [Arrival("P03", 3)], given_back=[3]) == 4


@given(st.lists(st.sampled_from(["arrive", "drop out"]), max_size=60), st.randoms())
def test_no_two_people_who_stay_ever_have_the_same_place_and_no_gap_stays(steps, rng):
    arrivals: list[Arrival] = []
    for number, step in enumerate(steps):
        staying = [a for a in arrivals if a.ended != "dropped out"]
        if step == "arrive":
            who = f"P{number}"
            arrivals.append(Arrival(who, place_of(who, arrivals)))
        elif staying:
            leaving = rng.choice(staying)
            arrivals[arrivals.index(leaving)] = Arrival(leaving.participant, leaving.place, "dropped out")
    places = [a.place for a in arrivals if a.ended != "dropped out"]
    assert len(set(places)) == len(places)
    # the next ones fill every gap below the highest place before a new one is begun
    highest = max((a.place for a in arrivals), default=0)
    for extra in range(highest - len(places)):
        place = place_of(f"N{extra}", arrivals)
        assert place <= highest
        arrivals.append(Arrival(f"N{extra}", place))
    assert place_of("last", arrivals) == highest + 1


def test_28_participants_are_14_per_viewing_condition():
    assert [number for _, number in counts(TWO, range(1, 29))] == [14, 14]
    assert sorted(number for _, number in counts(SIX, range(1, 29))) == [4, 4, 5, 5, 5, 5]


@given(st.integers(1, 200))
def test_groups_never_differ_by_more_than_one(people):
    for some in (TWO, SIX):
        numbers = [number for _, number in counts(some, range(1, people + 1))]
        assert max(numbers) - min(numbers) <= 1


def test_which_group_comes_first_in_a_pair_is_a_matter_of_chance_and_always_the_same():
    first = Counter(group_of(TWO, place)["viewing"] for place in range(1, 401, 2))
    assert first == Counter(group_of(TWO, place)["viewing"] for place in range(1, 401, 2))
    assert abs(first["screen"] - 100) < 36  # 200 coin tosses, s.d. 7.1: within five of them


def test_places_in_a_group_count_up():
    seen: Counter[str] = Counter()
    for place in range(1, 20):
        viewing = group_of(TWO, place)["viewing"]
        assert place_in_group(TWO, place) == seen[viewing]
        seen[viewing] += 1


def test_what_is_shown_can_depend_on_the_assigned_group():
    text = changed(
        ("    sex: [female, male]  ", "    sex: [female, male]\n    shown: [woman, man]"),
        ("  planned: 22", "  planned: 22\n  assigned: [shown]"),
        ("  speed: $speed", "  speed: $speed\n  body: $shown"),
    )
    file = parse_study("assigned.yaml", text)
    assert inconsistencies(file.study) == []
    trial = make_plan(file.study, 1, 2, {"shown": "man"}).steps[-2].trial  # type: ignore[union-attr]
    assert value_of("$shown", trial.values) == "man"
    assert "shown" not in trial.levels


@pytest.mark.parametrize(
    ("changes", "says"),
    [
        ({"assigned": ["vewing"]}, "did you mean viewing?"),
        ({"assigned": ["sex"]}, "assign it or ask it, not both"),
        ({"assigned": ["viewing", "viewing"]}, "stands twice"),
    ],
)
def test_assigning_in_vain_is_a_sentence(changes, says):
    people = Participants.model_validate({**TWO.participants.model_dump(), **changes})
    (mistake,) = order_mistakes(TWO.model_copy(update={"participants": people}))
    assert mistake.where[:2] == ("participants", "assigned")
    assert says in mistake.message


def test_a_between_factor_without_question_says_that_it_can_be_assigned():
    text = changed(("    sex: [female, male]  ", "    viewing: [screen, headset]"),
                   ("between: [sex]", "between: [viewing]"),
                   ("x: actor, lines: sex}", "x: actor, lines: viewing}"))  # fmt: skip
    messages = [mistake.message for mistake in inconsistencies(parse_study("s.yaml", text).study)]
    assert any("participants.assigned" in message for message in messages)
