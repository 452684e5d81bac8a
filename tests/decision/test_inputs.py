"""Inputs a pilot can fly, and how they are said."""

from types import SimpleNamespace

import numpy as np
import pytest

from advisor.decision.history import CandidateManeuver, is_named, nothing_tested
from advisor.decision.inputs import ORDERS, StepInput, units_to_try
from advisor.decision.verdict import Reason
from advisor.oem.estimate import NoEstimate
from tests.decision.campaigns import estimate


def test_an_input_is_said_as_a_pilot_hears_it() -> None:
    spoken = StepInput("3-2-1-1", 0.4, np.radians(9.0), nose_up_first=False).spoken(np.radians(15.0))
    assert spoken == "reverse 3-2-1-1, 0.4 s steps, 60 % stick"
    assert (
        StepInput("doublet", 0.5, np.radians(1.0), True).spoken(np.radians(25.0))
        == "doublet, 0.5 s steps, 4 % stick"
    )


def test_a_3211_raises_the_nose_first_and_its_steps_last_three_two_one_and_one_units() -> None:
    elevator = StepInput("3-2-1-1", 0.5, 0.1, nose_up_first=True).elevator(0.02, 1.0, 10.0)
    middle = [0.5, 1.75, 3.0, 3.75, 4.25, 6.0]
    expected = 0.02 + 0.1 * np.array([0.0, -1.0, 1.0, -1.0, 1.0, 0.0])
    np.testing.assert_allclose(elevator.at(np.array(middle)), expected)
    assert elevator.t[-1] == 10.0


@pytest.mark.parametrize("order", ORDERS)
def test_every_input_begins_and_ends_at_trim(order: str) -> None:
    option = StepInput(order, 0.4, 0.1, nose_up_first=False)
    elevator = option.elevator(-0.03, 0.5, 0.5 + option.duration_s + 3.0)
    assert elevator.y[0] == elevator.y[-1] == -0.03
    assert np.all(np.diff(elevator.t) > 0.0)


@pytest.mark.parametrize("frequency", [1.5, 2.5, 7.0, 12.0])
def test_units_to_try_can_be_counted_by_hand_and_span_the_short_period(frequency: float) -> None:
    units = units_to_try(frequency)
    assert units[0] >= 0.2  # a pilot's hand is no faster
    np.testing.assert_allclose(units, np.round(units, 1))
    assert units[-1] > 2.5 / frequency


def test_the_shortest_unit_is_a_fifth_of_a_second() -> None:
    assert units_to_try(2.0)[0] == 0.2
    assert units_to_try(12.0)[0] == 0.2


def test_the_first_step_is_nose_up_unless_the_input_is_reversed() -> None:
    assert StepInput("2-1-1", 0.5, 0.1, True).steps == ((True, 1.0), (False, 0.5), (True, 0.5))
    assert StepInput("doublet", 0.5, 0.1, False).steps == ((False, 0.5), (True, 0.5))


def test_the_elevator_takes_a_fiftieth_of_a_second_from_step_to_step() -> None:
    moved = StepInput("doublet", 0.5, 0.1, False).elevator(0.0, 1.0, 5.0)
    np.testing.assert_allclose(
        moved.at(np.array([1.0, 1.01, 1.02, 1.5, 1.51, 1.52])), [0.0, 0.05, 0.1, 0.1, 0.0, -0.1]
    )


@pytest.mark.parametrize(
    ("percent", "said"), [(0.4, 1), (19.6, 19), (20.0, 20), (24.0, 20), (26.0, 25), (39.0, 35)]
)
def test_stick_is_said_in_steps_of_five_above_twenty_per_cent(percent: float, said: int) -> None:
    assert StepInput("doublet", 0.5, 0.01 * percent, True).stick_percent(1.0) == said


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
