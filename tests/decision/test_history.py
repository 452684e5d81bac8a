"""Which inputs a crew can be asked to repeat."""

from types import SimpleNamespace

import pytest

from advisor.decision.history import CandidateManeuver, is_named
from tests.decision.campaigns import estimate


@pytest.mark.parametrize(("kind", "named"), [("3-2-1-1", True), ("other", False)])
def test_a_crew_can_repeat_an_input_whose_shape_has_a_name(kind, named):
    maneuver = SimpleNamespace(span=SimpleNamespace(kind=kind))
    assert is_named(CandidateManeuver(estimate(), maneuver=maneuver)) == named


def test_an_input_of_which_nothing_is_kept_counts_as_named():
    assert is_named(CandidateManeuver(estimate()))
