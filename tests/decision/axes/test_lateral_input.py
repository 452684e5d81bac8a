"""The size of the next aileron or rudder input, on hand-made numbers."""

from math import inf, radians
from types import SimpleNamespace

import numpy as np
import pytest

from advisor.aircraft.aircraft import Aircraft, SideControl
from advisor.decision.axes.lateral_stop import FlownInput, next_lateral
from advisor.decision.verdict import Reason
from advisor.flight.signals.record import Channel
from tests.campaign.side_builders import estimate, judged

AIRCRAFT = Aircraft()


def advised(control="aileron", percent=inf, flown=(), accepted=(), aircraft=AIRCRAFT):
    return next_lateral(control, percent, accepted, flown, aircraft, "L_p")


def aileron(deg, bank_deg, remedy=""):
    return FlownInput("aileron", radians(deg), radians(bank_deg), remedy)


def test_the_first_input_is_gentle_and_says_so():
    assert (
        advised().advice
        == "next: aileron doublet, 1.0 s steps, 10 % stick, to begin gently, then stick still"
    )


def test_a_poor_estimate_asks_for_more_stick_by_a_build_up_of_one_half():
    found = advised(percent=300.0, flown=[aileron(5.0, 10.0)], accepted=[estimate("aileron")])
    assert found.input.amplitude_rad == pytest.approx(radians(7.5))


def test_the_bank_s_limit_bounds_the_next_input():
    found = advised(percent=300.0, flown=[aileron(5.0, 36.0)])
    assert found.input.amplitude_rad <= radians(5.0 * 0.9 * 45.0 / 36.0)


def test_a_bank_beyond_its_limit_asks_for_less_and_repeats_the_remedy():
    found = advised(flown=[aileron(10.0, 60.0, "less aileron, or shorter")])
    assert found.input.amplitude_rad == pytest.approx(radians(6.25))
    assert "25 % stick, then stick still; less aileron, or shorter" in found.advice


def test_a_refused_input_grows_only_where_it_was_too_gentle():
    refused = advised(percent=300.0, flown=[aileron(5.0, 10.0, "leave the throttle where it is")])
    assert refused.input.amplitude_rad == pytest.approx(radians(5.0))
    gentle = FlownInput("aileron", radians(5.0), radians(10.0), "use about 1.4 times the aileron", asked=1.3)
    assert advised(flown=[gentle]).input.amplitude_rad == pytest.approx(radians(6.5), rel=0.05)
    assert "times" not in advised(flown=[gentle]).advice


def test_a_control_at_the_end_of_its_travel_is_asked_for_less_by_a_number():
    end = Reason("saturation", "aileron at the end of its travel; use less stick", 69.0, 0.0)
    moved = Channel("aileron", np.arange(3.0), np.radians([-25.0, 25.0, -25.0]), "SERVO_OUTPUT_RAW")
    maneuver = SimpleNamespace(channels={"aileron": moved})
    found = advised(flown=[FlownInput.of(maneuver, [end])])
    assert found.input.amplitude_rad == pytest.approx(radians(25.0 / 1.5), rel=0.05)
    assert "use less stick" not in found.advice


def test_the_travel_of_the_file_is_100_percent_of_the_stick():
    small = Aircraft(aileron=SideControl(calibration=((1000.0, 10.0), (2000.0, -10.0))))
    assert advised(aircraft=small).input.amplitude_rad == pytest.approx(radians(1.0))


def test_steps_of_the_rudder_last_half_a_dutch_roll_once_it_is_known():
    found = advised("rudder", accepted=[estimate("aileron")])
    assert found.advice.startswith("next: rudder doublet, 1.8 s steps, 10 % pedal")
    assert found.input.control == "rudder"


def test_the_control_and_the_size_of_a_flown_input_are_read_from_its_record():
    one = FlownInput.of(judged(1, "rudder").maneuver, ())
    assert (one.control, one.amplitude_rad, one.bank_rad) == (
        "rudder",
        pytest.approx(0.07),
        pytest.approx(0.3, rel=0.01),
    )
