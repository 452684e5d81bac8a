"""What a movement of the elevator was: an input, or an activity with its reason."""

import numpy as np
import pytest

from advisor.flight.maneuvers.excitation import excitation
from advisor.flight.maneuvers.maneuver import Maneuver, Span
from advisor.flight.maneuvers.purpose import Because, judged
from advisor.flight.signals.record import Channel
from tests.flight.elevator.elevators import PATTERNS, coloured, slewed, steps
from tests.rows import row

DEG = np.radians(1.0)
T = np.arange(0.0, 12.0, 0.02)
INPUT = -2.0 * DEG * steps(T, 2.0, 0.5, PATTERNS["3-2-1-1"])


def flown(elevator, gain=(0.0, 0.0), gust=0.0, mode="MANUAL", airspeed=25.0, without=(), seed=1):
    """A record of an aircraft with a short period of 3 rad/s.

    ``gain`` feeds pitch rate and pitch angle back to the elevator; ``gust`` is the standard deviation of an
    angle of attack that moving air adds, rad.
    """
    rng = np.random.default_rng(seed)
    air = gust * coloured(rng, T, 0.5)
    alpha, q, theta = np.zeros(len(T)), np.zeros(len(T)), np.zeros(len(T))
    moved = np.array(elevator)
    for i in range(1, len(T)):
        moved[i - 1] += gain[0] * q[i - 1] + gain[1] * theta[i - 1]
        felt = alpha[i - 1] + air[i - 1]
        alpha[i] = alpha[i - 1] + 0.02 * (-1.5 * felt + q[i - 1])
        q[i] = q[i - 1] + 0.02 * (-6.0 * felt - 2.0 * q[i - 1] - 10.0 * moved[i - 1])
        theta[i] = theta[i - 1] + 0.02 * q[i - 1]
    q = q + 0.1 * DEG * rng.standard_normal(len(T))
    values = {"elevator": moved, "q": q, "theta": theta, "airspeed": np.full(len(T), airspeed)}
    channels = {name: Channel(name, T, y) for name, y in values.items() if name not in without}
    onsets = (2.0, 3.5, 4.5, 5.0, 5.5)
    levels = (2.0, -2.0, 2.0, -2.0, 0.0)
    shape = tuple((onset, level * DEG) for onset, level in zip(onsets, levels, strict=True))
    return Maneuver(1, 0, Span(1.0, 2.0, 5.5, 12.0, "other", shape, "quiet"), channels, mode)


def reason(maneuver):
    because = judged(maneuver)
    return because.reason if isinstance(because, Because) else None


FIGHTS = {"gain": (0.2, 0.3), "gust": 0.02}


@row("an input that the pitch rate shows is one", {}, None)
@row("the pitch rate alone will do", {"without": ("theta", "airspeed")}, None)
@row("without a pitch rate nobody can say that it was none", {"without": ("q",)}, None)
@row("an aircraft without an air speed sensor flies all the same", {"airspeed": 0.0}, None)
@row("an input counts in gusts that a loop fights", FIGHTS, None)
@row("an input counts in the gusts of an unknown mode", FIGHTS | {"mode": "mode 77"}, None)
@row("a take-off by the autopilot is no input", {"gain": (0.2, 0.3), "mode": "TAKEOFF"}, "autopilot")
def test_what_a_movement_was(changes, because):
    assert reason(flown(INPUT, **changes)) == because


@pytest.mark.parametrize("airspeed", [0.0, 0.5])
def test_a_stick_stirred_on_the_ground_is_no_input(airspeed):
    standing = flown(INPUT, airspeed=airspeed)
    still = Channel("q", T, 0.05 * DEG * np.sin(T))
    channels = {**standing.channels, "q": still}
    assert reason(Maneuver(1, 0, standing.span, channels, "MANUAL")) == "ground"


def test_a_correction_is_told_with_its_size_and_the_least():
    because = judged(flown(0.05 * INPUT))
    assert isinstance(because, Because)
    assert because.reason == "small"
    assert "(at least 1)" in because.text


def test_an_elevator_that_the_aircraft_does_not_answer_tells_nothing():
    deaf = flown(np.zeros(len(T)), gust=0.05)
    channels = {**deaf.channels, "elevator": Channel("elevator", T, INPUT)}
    because = judged(Maneuver(1, 0, deaf.span, channels, "MANUAL"))
    assert isinstance(because, Because)
    assert because.reason == "no_information"


def test_a_loop_that_fights_gusts_tells_nothing_of_the_short_period():
    alone = [excitation(flown(np.zeros(len(T)), (0.3, 0.5), gust=0.04, seed=seed)) for seed in range(5)]
    assert np.median([found.external_error for found in alone]) > 0.3
    assert (
        reason(flown(np.zeros(len(T)), gain=(0.3, 0.5), gust=0.04, mode="mode 77", seed=0))
        == "no_information"
    )


@pytest.mark.parametrize("mode", ["CRUISE", "FBWA", "Stabilized"])
def test_in_a_closed_loop_sharp_steps_are_an_input_and_all_else_is_the_autopilots(mode):
    assert reason(flown(INPUT, gain=(0.2, 0.3), mode=mode)) is None
    because = judged(flown(slewed(T, INPUT, 0.5), gain=(0.2, 0.3), mode=mode))
    assert isinstance(because, Because)
    assert because.reason == "autopilot"
    assert because.text == f"the elevator moved in {mode} without the sharp steps of a test; not a test input"


def test_the_error_falls_as_the_input_grows():
    errors = [excitation(flown(size * INPUT, gust=0.02)).relative_error for size in (0.5, 1.0, 2.0)]
    assert errors[0] > 1.5 * errors[1] > 2.0 * errors[2]


def test_a_canard_excites_as_well_as_an_elevator():
    usual = flown(INPUT)
    turned = {**usual.channels, "elevator": Channel("elevator", T, -usual.channels["elevator"].y)}
    assert excitation(Maneuver(1, 0, usual.span, turned, "MANUAL")).external_error == pytest.approx(
        excitation(usual).external_error, rel=1e-6
    )
