"""In what two versions of a study file differ, in words."""

from __future__ import annotations

import pytest

from protocols.versions import differences, what_differs
from tests.protocols.studies import changed


@pytest.mark.parametrize(
    ("replacements", "said"),
    [
        ((), "comments only"),
        ((("# m/s", "# metres per second"),), "comments only"),
        ((("about half", "roughly half"),), "pages.consent"),
        ((("[0.8, 1.0, 1.2]", "[0.8, 1.0]"), ("about half", "half")), "factors.speed and pages.consent"),
        ((("  normality: shapiro_wilk\n", ""),), "analysis.normality"),
    ],
)
def test_the_places_that_differ_are_named(replacements, said):
    assert what_differs(changed(), changed(*replacements)) == said
    assert what_differs(changed(*replacements), changed()) == said


def test_many_places_are_counted():
    assert (
        what_differs("{a: 1, b: 1, c: 1, d: 1, e: 1}", "{a: 2, b: 2, c: 2, d: 2, e: 2}") == "a, b, c and 2 more places"
    )
    assert differences("{a: {b: {c: 1}}}", "{a: {b: {c: 2}, x: 1}}") == ("a.b", "a.x")
