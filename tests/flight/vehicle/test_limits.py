"""Limits of a servo output are the stated ones where a linkage can have them, else assumed ones."""

import numpy as np
import pytest

from advisor.aircraft.aircraft import Elevator
from advisor.flight.elevator.elevator_outputs import find_elevator
from advisor.flight.elevator.mixing import commanded
from advisor.flight.signals.channels import Pulses
from advisor.flight.signals.messages import Columns
from advisor.flight.vehicle.ardupilot_wiring import ardupilot_wiring
from advisor.flight.vehicle.px4_wiring import px4_wiring
from advisor.flight.vehicle.surfaces import Scale, Surface

FUNCTION = {"SERVO2_FUNCTION": 19.0}
STATED = {"SERVO2_MIN": 1000.0, "SERVO2_TRIM": 1520.0, "SERVO2_MAX": 2000.0}


def elevator(**parameters: float) -> Surface:
    found = find_elevator(Elevator(), ardupilot_wiring({**FUNCTION, **parameters}))
    assert isinstance(found, Surface)
    return found


def scale(surface: Surface) -> Scale:
    (part,) = surface.parts
    assert isinstance(part.scale, Scale)
    return part.scale


def test_stated_limits_are_used_and_not_called_assumed() -> None:
    found = elevator(**STATED)
    assert scale(found) == Scale(1000.0, 1520.0, 2000.0)
    assert "scaled by SERVOn_MIN/TRIM/MAX" in found.said
    assert not found.doubts


def test_limits_that_no_parameter_states_are_called_assumed_by_name() -> None:
    found = elevator(SERVO2_TRIM=1520.0)
    assert scale(found) == Scale(1100.0, 1520.0, 1900.0)
    assert "SERVO2_MIN 1100 and SERVO2_MAX 1900 are assumed" in found.said
    assert "scaled by assumed limits" in found.said
    assert "SERVOn_MIN/TRIM/MAX" not in found.said


@pytest.mark.parametrize(
    ("wrong", "said"),
    [
        ({"SERVO2_MIN": 1900.0, "SERVO2_MAX": 1100.0}, "SERVO2_MIN 1900 is above SERVO2_MAX 1100"),
        ({"SERVO2_MAX": 0.0}, "SERVO2_MAX is 0, which is no pulse"),
        ({"SERVO2_TRIM": 2100.0}, "SERVO2_TRIM 2100 is above SERVO2_MAX 2000"),
        (
            {"SERVO2_MIN": 1500.0, "SERVO2_TRIM": 1500.0, "SERVO2_MAX": 1500.0},
            "SERVO2_MIN and SERVO2_MAX are both 1500",
        ),
    ],
)
def test_limits_that_contradict_each_other_are_named_with_the_remedy(wrong, said):
    found = elevator(**{**STATED, **wrong})
    assert scale(found) == Scale()
    (doubt,) = found.doubts
    assert said in doubt.text
    assert "Set SERVO2_MIN, SERVO2_TRIM and SERVO2_MAX to rising pulses" in doubt.fix


def test_an_output_of_the_aircraft_file_without_parameters_has_assumed_limits() -> None:
    found = find_elevator(Elevator(output=2), px4_wiring({}))
    assert isinstance(found, Surface)
    assert "Pulses of 1100, 1500 and 1900 us are assumed for output 2" in found.said


def test_an_output_of_px4_without_limits_has_assumed_ones() -> None:
    surfaces = {"CA_SV_CS_COUNT": 1.0, "CA_SV_CS0_TYPE": 3.0, "PWM_MAIN_FUNC2": 201.0}
    limits = {"PWM_MAIN_MIN2": 1000.0, "PWM_MAIN_MAX2": 2000.0}
    without, stated = (
        find_elevator(Elevator(), px4_wiring(parameters)) for parameters in (surfaces, surfaces | limits)
    )
    assert isinstance(without, Surface)
    assert isinstance(stated, Surface)
    assert without.doubts
    assert not stated.doubts


@pytest.mark.parametrize("turned", [False, True])
def test_a_deflection_is_linear_beyond_the_limits(turned: bool) -> None:
    scale, sent = Scale(1200.0, 1520.0, 1800.0, turned), np.array([1000.0, 1200.0, 1520.0, 1800.0, 2000.0])
    angles = np.degrees(scale.deflection(sent)) * (1.0 if turned else -1.0)
    assert angles == pytest.approx([-40.625, -25.0, 0.0, 25.0, 42.857], abs=1e-3)


def pulses(*outputs: tuple[float, ...]) -> Pulses:
    """Pulses of outputs 1, 2, ..., one tuple of samples each."""
    raw = np.zeros((len(outputs[0]), 16))
    raw[:, : len(outputs)] = np.transpose(outputs)
    n = len(raw)
    columns = Columns("SERVO_OUTPUT_RAW", 1, 1, np.arange(n), np.arange(n) * 0.02, {})
    return Pulses(columns, np.zeros(n, dtype=np.int64), raw)


def two(function_1: int, function_2: int) -> Surface:
    wiring = ardupilot_wiring({"SERVO1_FUNCTION": float(function_1), "SERVO2_FUNCTION": float(function_2)})
    found = find_elevator(Elevator(), wiring)
    assert isinstance(found, Surface)
    return found


T = np.arange(3) * 0.02


def test_of_two_elevator_outputs_the_silent_one_does_not_count() -> None:
    both = two(19, 19)
    (moved,) = commanded(
        {"elevator": both}, pulses((1500.0, 1600.0, 1700.0), (0.0, 0.0, 0.0)), T, "ardupilot"
    )
    alone = Scale().deflection(np.array([1500.0, 1600.0, 1700.0]))
    assert moved.combined().y == pytest.approx(alone)
    assert moved.source == "SERVO_OUTPUT_RAW.servo1_raw"
    assert "Output 2 carries no pulse; 1 alone counts." in moved.surface.said


def test_half_of_an_elevon_pair_is_no_elevator() -> None:
    """Its demand in roll would count as pitch."""
    pair = two(77, 78)
    assert commanded({"elevator": pair}, pulses((1500.0,) * 3, (0.0,) * 3), T, "ardupilot") == []


def test_outputs_that_a_safety_switch_silences_give_no_samples() -> None:
    (moved,) = commanded(
        {"elevator": two(19, 19)}, pulses((0.0, 0.0, 1600.0), (0.0, 0.0, 1600.0)), T, "ardupilot"
    )
    assert moved.order.tolist() == [2]
