"""Which inputs a crew can be asked to repeat."""

from types import SimpleNamespace

import pytest

from advisor.decision.history import CandidateManeuver, is_named, nothing_tested
from advisor.decision.verdict import Reason
from advisor.oem.estimate import NoEstimate
from tests.decision.campaigns import estimate


@pytest.mark.parametrize(("kind", "named"), [("3-2-1-1", True), ("other", False)])
def test_a_crew_can_repeat_an_input_whose_shape_has_a_name(kind, named):
    maneuver = SimpleNamespace(span=SimpleNamespace(kind=kind))
    assert is_named(CandidateManeuver(estimate(), maneuver=maneuver)) == named


def test_an_input_of_which_nothing_is_kept_counts_as_named():
    assert is_named(CandidateManeuver(estimate()))


BAD = Reason("bank", "banked", 60.0, 30.0)
FLOWN = CandidateManeuver(estimate())
REFUSED = CandidateManeuver(estimate(), reasons=(BAD,))


@pytest.mark.parametrize(
    ("manoeuvre", "counts"),
    [
        (FLOWN, True),
        (REFUSED, False),
        (CandidateManeuver(estimate(), excluded_because="a gust"), False),
        (CandidateManeuver(NoEstimate("singular", "nothing was told")), False),
    ],
)
def test_a_manoeuvre_counts_with_an_estimate_and_without_a_reason_against_it(manoeuvre, counts):
    assert (manoeuvre.usable is not None) is counts


def test_one_input_and_several_that_cannot_be_used_are_counted_in_words():
    assert nothing_tested([]) == "No test input of the elevator has been flown."
    assert nothing_tested([REFUSED]) == "The one input of the elevator cannot be used."
    assert nothing_tested([REFUSED] * 2) == "None of the 2 inputs of the elevator can be used."
    assert nothing_tested([REFUSED, FLOWN]) == ""
