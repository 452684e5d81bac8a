"""Which outputs make the elevator, and what the user reads of them, on hand-made wiring."""

import pytest

from advisor.aircraft.aircraft import Elevator, ElevatorOutput
from advisor.flight.elevator.elevator_outputs import find_elevator
from advisor.flight.vehicle.ardupilot_wiring import ardupilot_wiring
from advisor.flight.vehicle.surfaces import Surface
from advisor.words.problems import Problem

CALIBRATION = ((1000.0, 25.0), (2000.0, -25.0))
AUTO = Elevator()


def found(elevator: Elevator = AUTO, **parameters: float) -> Surface:
    """The elevator of an ArduPlane with these parameters."""
    answer = find_elevator(elevator, ardupilot_wiring(parameters))
    assert isinstance(answer, Surface), answer
    return answer


def refused(elevator: Elevator = AUTO, **parameters: float) -> Problem:
    answer = find_elevator(elevator, ardupilot_wiring(parameters))
    assert isinstance(answer, Problem), answer
    return answer


def listing(*outputs: ElevatorOutput) -> Elevator:
    return Elevator(outputs=outputs)


def test_one_output_is_no_mean() -> None:
    assert found(SERVO2_FUNCTION=19).said.startswith("No elevator.calibration: output 2 (SERVOn_FUNCTION 19)")


def test_two_outputs_of_one_function_are_a_mean() -> None:
    assert found(SERVO2_FUNCTION=19, SERVO4_FUNCTION=19).said.startswith(
        "The elevator is the mean of outputs 2 and 4 (SERVOn_FUNCTION 19)."
    )


def test_a_pair_is_called_by_its_name_and_its_other_axis_cancels() -> None:
    said = found(SERVO1_FUNCTION=77, SERVO2_FUNCTION=78).said
    assert "(elevon pair); their effects in roll cancel" in said


def test_an_output_that_passes_the_stick_through_is_called_so() -> None:
    assert "(radio channel 2, passed through)" in found(SERVO2_FUNCTION=1).said


def test_unequal_shares_are_told_one_by_one() -> None:
    listed = listing(ElevatorOutput(1, weight=3.0), ElevatorOutput(2, weight=1.0))
    assert "75 % of output 1 and 25 % of output 2" in found(listed).said
    assert "the mean of outputs" in found(listing(ElevatorOutput(1), ElevatorOutput(2))).said


def test_a_list_of_one_is_one_output_and_a_list_of_two_has_shares() -> None:
    assert found(listing(ElevatorOutput(3, CALIBRATION))).said == ""
    assert [part.share for part in found(listing(ElevatorOutput(1), ElevatorOutput(2))).parts] == [0.5, 0.5]


@pytest.mark.parametrize(
    ("output", "parameters", "sure"),
    [
        (ElevatorOutput(1, CALIBRATION), {}, True),
        (ElevatorOutput(1), {"SERVO1_FUNCTION": 19, "SERVO1_REVERSED": 0}, True),
        (ElevatorOutput(1), {"SERVO1_FUNCTION": 19}, False),
        (ElevatorOutput(1), {"SERVO1_FUNCTION": 4, "SERVO1_REVERSED": 0}, False),
        (ElevatorOutput(1), {"SERVO1_REVERSED": 0}, False),
    ],
)
def test_a_sign_is_sure_by_a_calibration_or_by_function_and_direction(output, parameters, sure):
    first, _ = found(listing(output, ElevatorOutput(2)), **parameters).parts
    assert first.sure is sure


@pytest.mark.parametrize(
    ("parameters", "is_half"),
    [
        ({"SERVO2_FUNCTION": 78}, True),
        ({"SERVO2_FUNCTION": 19}, False),
        ({"SERVO2_FUNCTION": 24}, False),
        ({}, False),
    ],
)
def test_only_a_half_that_pitches_is_refused_alone(parameters: dict[str, float], is_half: bool) -> None:
    given = Elevator(output=2)
    if is_half:
        assert "one half of a mixed elevon pair" in refused(given, **parameters).text
    else:
        assert found(given, **parameters).outputs == (2,)


def test_of_a_list_with_one_half_the_other_axis_is_said_to_count_as_elevator() -> None:
    lone = listing(ElevatorOutput(1, CALIBRATION), ElevatorOutput(3, CALIBRATION))
    both = listing(ElevatorOutput(1, CALIBRATION), ElevatorOutput(2, CALIBRATION))
    pair = {"SERVO1_FUNCTION": 77.0, "SERVO2_FUNCTION": 78.0}
    assert "Only one side of the elevon pair is among them" in found(lone, **pair).said
    assert "Only one side" not in found(both, **pair).said
