"""Which output is the elevator, and what its pulses mean."""

import numpy as np
import pytest

from advisor.aircraft.aircraft import Elevator, ElevatorOutput, SideControl
from advisor.flight.elevator.elevator_outputs import find_elevator, find_side_control
from advisor.flight.vehicle.ardupilot_wiring import ardupilot_wiring
from advisor.flight.vehicle.surfaces import Surface, driven
from advisor.words.problems import Problem
from tests.rows import row

PLANE = {"SERVO1_FUNCTION": 4.0, "SERVO2_FUNCTION": 19.0, "SERVO4_FUNCTION": 21.0}


def side(name, parameters):
    return find_side_control(name, SideControl(), ardupilot_wiring(parameters))


def found(elevator, parameters):
    surface = find_elevator(elevator, ardupilot_wiring(parameters))
    assert isinstance(surface, Surface), surface
    return surface


def refused(elevator, parameters):
    problem = find_elevator(elevator, ardupilot_wiring(parameters))
    assert isinstance(problem, Problem), problem
    return problem


def degrees(surface, *pulses):
    return np.degrees(surface.deflection(np.array(pulses, dtype=float).reshape(len(pulses), -1))).tolist()


def test_the_output_with_function_19_is_the_elevator():
    surface = found(Elevator(), PLANE)
    assert surface.outputs == (2,)
    assert not surface.calibrated
    assert "25 deg" in surface.said


UNEVEN = {"SERVO2_TRIM": 1400.0, "SERVO2_MAX": 2000.0}


@row("more pulse is trailing edge up", {}, (1100, 1500, 1900), [25, 0, -25])
@row("more pulse of a reversed output is down", {"SERVO2_REVERSED": 1.0}, (1100, 1500, 1900), [-25, 0, 25])
@row("an uneven trim gives each side its own scale", UNEVEN, (1250, 1400, 1700), [12.5, 0, -12.5])
def test_an_elevator_without_a_calibration_is_read_by_its_parameters(parameters, pulses, angles):
    assert degrees(found(Elevator(), PLANE | parameters), *pulses) == pytest.approx(angles)


def test_a_calibration_is_linear_between_its_pairs_and_does_not_extrapolate():
    elevator = Elevator(output=5, calibration=((1900, 20.0), (1100, -30.0), (1500, 0.0)))
    surface = found(elevator, {})
    assert degrees(surface, 1300, 1500, 1700) == pytest.approx([-15, 0, 10])
    assert degrees(surface, 900, 2100) == pytest.approx([-30, 20])


def test_nothing_known_is_refused_with_what_to_set():
    problem = refused(Elevator(), {})
    assert problem.code == "no_elevator"
    assert "elevator.output" in problem.fix


def test_functions_without_an_elevator_are_refused():
    problem = refused(Elevator(), {"SERVO1_FUNCTION": 4.0})
    assert "No output" in problem.text


@pytest.mark.parametrize("functions", [(77, 78), (79, 80)])
def test_elevons_and_v_tails_are_read_as_the_mean_of_both_halves(functions):
    left, right = functions
    surface = found(Elevator(), {"SERVO1_FUNCTION": left, "SERVO5_FUNCTION": right, "SERVO5_REVERSED": 1.0})
    assert surface.outputs == (1, 5)
    both_up, only_roll = [1900, 1100], [1700, 1700]
    assert degrees(surface, both_up, only_roll) == pytest.approx([-25, 0])


def test_one_half_of_a_mixed_pair_is_refused_by_name():
    asked = refused(Elevator(output=1), {"SERVO1_FUNCTION": 77.0, "SERVO2_FUNCTION": 78.0})
    alone = refused(Elevator(), {"SERVO1_FUNCTION": 79.0})
    assert "elevon" in asked.text
    assert "V-tail" in alone.text


def test_one_half_of_a_mixed_pair_is_read_as_the_aircraft_file_calibrates_it_and_said_so():
    elevator = Elevator(output=2, calibration=((1000, 20.0), (2000, -20.0)))
    surface = found(elevator, {"SERVO1_FUNCTION": 77.0, "SERVO2_FUNCTION": 78.0})
    assert degrees(surface, [1250]) == pytest.approx([10.0])
    assert "one half of a mixed elevon pair" in surface.said


PAIR = {"SERVO1_FUNCTION": 77.0, "SERVO2_FUNCTION": 78.0, "SERVO1_REVERSED": 1.0, "SERVO2_REVERSED": 0.0}
ONE_WAY = ((1000.0, -25.0), (1500.0, 0.0), (2000.0, 25.0))
"""More pulse is trailing edge down."""


def test_one_calibration_of_an_elevon_pair_counts_for_both_halves_each_in_its_own_sense():
    surface = found(Elevator(calibration=ONE_WAY), PAIR | {"SERVO2_TRIM": 1520.0})
    assert surface.calibrated
    both_down, only_roll = [1700, 1320], [1700, 1720]
    assert degrees(surface, both_down, only_roll) == pytest.approx([10, 0])
    assert "taken for output 1 and carried over to 2" in surface.said
    assert "the other way round for 2 (SERVOn_REVERSED)" in surface.said


def test_one_calibration_of_an_elevon_pair_needs_to_know_what_is_reversed():
    problem = refused(
        Elevator(calibration=ONE_WAY), {n: v for n, v in PAIR.items() if n != "SERVO2_REVERSED"}
    )
    assert "SERVO2_REVERSED" in problem.text
    assert "elevator.outputs" in problem.fix


def test_several_elevons_on_one_side_weigh_as_much_as_the_one_on_the_other():
    surface = found(Elevator(), {"SERVO1_FUNCTION": 77.0, "SERVO2_FUNCTION": 78.0, "SERVO3_FUNCTION": 78.0})
    assert degrees(surface, [1700, 1300, 1300]) == pytest.approx([0])


def test_elevons_and_a_plain_elevator_are_read_together():
    surface = found(Elevator(), PAIR | {"SERVO5_FUNCTION": 19.0, "SERVO5_REVERSED": 0.0})
    assert surface.outputs == (1, 2, 5)
    assert degrees(surface, [1500, 1500, 1900]) == pytest.approx([-12.5])
    assert degrees(surface, [1700, 1700, 1500]) == pytest.approx([0])


def test_listed_outputs_are_the_weighted_mean_of_their_own_calibrations_and_said_so():
    outputs = (
        ElevatorOutput(6, ((1000.0, -10.0), (2000.0, 10.0))),
        ElevatorOutput(20, ((1000.0, 40.0), (2000.0, -40.0)), 0.25),
    )
    surface = found(Elevator(outputs=outputs), PLANE)
    assert surface.outputs == (6, 20)
    assert surface.ports == (0, 1)
    assert degrees(surface, [1750, 1250]) == pytest.approx([(5 + 0.25 * 20) / 1.25])
    assert "80 % of output 6 and 20 % of output 20" in surface.said
    assert not surface.unsure


def test_the_sense_of_an_output_is_told_by_a_calibration_or_by_its_function_and_reversed():
    listed = Elevator(outputs=(ElevatorOutput(1), ElevatorOutput(2), ElevatorOutput(3)))
    surface = found(listed, PAIR | {"SERVO3_FUNCTION": 24.0, "SERVO3_REVERSED": 0.0})
    assert surface.unsure == (3,)


def test_outputs_beyond_16_are_in_the_second_bank():
    surface = found(Elevator(output=18), {})
    assert surface.ports == (1,)


def test_aileron_and_rudder_are_found_where_the_parameters_say():
    assert side("aileron", PLANE).outputs == (1,)
    assert side("rudder", PLANE).outputs == (4,)
    assert side("rudder", {}) is None


def test_more_pulse_rolls_to_the_right_which_is_negative_and_reversed_the_other_way():
    pulse = np.array([[1900.0]])
    assert np.degrees(side("aileron", PLANE).deflection(pulse)[0]) == pytest.approx(-25.0)
    turned = side("aileron", PLANE | {"SERVO1_REVERSED": 1.0})
    assert np.degrees(turned.deflection(pulse)[0]) == pytest.approx(25.0)


def test_flaperons_are_no_elevator():
    assert refused(Elevator(), {"SERVO1_FUNCTION": 24.0, "SERVO2_FUNCTION": 25.0})


def test_the_aircraft_file_calibrates_the_aileron():
    stated = SideControl(output=1, calibration=((1000.0, 25.0), (2000.0, -25.0)))
    surface = find_side_control("aileron", stated, ardupilot_wiring({}))
    assert np.degrees(surface.deflection(np.array([[2000.0]]))[0]) == pytest.approx(-25.0)


def test_idle_outputs_carry_no_pulse():
    pulses = np.array([[0.0], [65535.0], [900.0], [1500.0]])
    assert driven(pulses, "ardupilot").all(axis=1).tolist() == [False, False, True, True]
    assert driven(pulses, "px4").all(axis=1).tolist() == [False, False, False, True]


def test_outputs_that_pass_other_radio_channels_through_are_named():
    problem = refused(Elevator(), {"SERVO3_FUNCTION": 1.0, "SERVO6_FUNCTION": 57.0})
    assert "output 3 passes radio channel 3 through" in problem.text
    assert "output 6 passes radio channel 7 through" in problem.text
