"""A test input through an autopilot's pitch loop: found where an external input is seen, and then fitted as
well as in MANUAL."""

import numpy as np
import pytest

from advisor.aircraft.aircraft import Aircraft
from advisor.decision.axes.requirements import judge
from advisor.flight.maneuvers.maneuver import Maneuver, Span
from advisor.flight.maneuvers.markers import SWEPT
from advisor.flight.maneuvers.purpose import Because, judged
from advisor.flight.signals.record import Channel
from advisor.oem.estimator import estimate

DEG = np.radians(1.0)
STEP_S = 0.02
STEPS = ((2.0, -2.0), (3.5, 2.0), (4.5, -2.0), (5.0, 2.0), (5.5, 0.0))
TRUE = {"M_alpha": -6.0, "M_q": -2.0, "M_delta_e": -10.0}
LOOP = (0.2, 0.6)
"""Gains of the autopilot's loop: elevator by pitch rate, s, and by pitch angle."""


def channels_of(demand, loop=LOOP, gust=0.0):
    """The motion of an aircraft with a demand on top of a loop, in gusts of this angle of attack, rad."""
    rng = np.random.default_rng(4)
    t = STEP_S * np.arange(len(demand))
    air = gust * np.convolve(rng.standard_normal(len(t)), np.ones(25) / 5.0, "same")
    elevator, alpha, q, theta = demand.copy(), np.zeros(len(t)), np.zeros(len(t)), np.zeros(len(t))
    for i in range(1, len(t)):
        elevator[i - 1] += loop[0] * q[i - 1] + loop[1] * theta[i - 1]
        felt = alpha[i - 1] + air[i - 1]
        alpha[i] = alpha[i - 1] + STEP_S * (-1.5 * felt + q[i - 1])
        moment = TRUE["M_alpha"] * felt + TRUE["M_q"] * q[i - 1] + TRUE["M_delta_e"] * elevator[i - 1]
        q[i] = q[i - 1] + STEP_S * moment
        theta[i] = theta[i - 1] + STEP_S * q[i - 1]
    noise = 0.05 * DEG * rng.standard_normal((2, len(t)))
    values = {"elevator": elevator, "alpha": alpha + noise[0], "q": q + noise[1], "theta": theta}
    return {name: Channel(name, t, y) for name, y in values.items()}


def stepped(mode, loop):
    demand = np.zeros(600)
    for onset, level in STEPS:
        demand[int(onset / STEP_S) :] = level * DEG
    shape = tuple((onset, level * DEG) for onset, level in STEPS)
    span = Span(1.0, 2.0, 5.5, 11.9, "3-2-1-1", shape, "quiet")
    return Maneuver(1, 0, span, channels_of(demand, loop), mode)


def swept(size_deg, mode="FBWA", gust=0.0, closed_by=SWEPT):
    """ArduPlane's chirp of the elevator over 20 s, 0.3 to 3 Hz, faded in and out."""
    t = STEP_S * np.arange(1100)
    run = np.clip(t - 1.0, 0.0, 20.0)
    phase = 2.0 * np.pi * 0.3 * 20.0 / np.log(10.0) * (10.0 ** (run / 20.0) - 1.0)
    fade = np.clip(run / 3.0, 0.0, 1.0) * np.clip(20.0 - run, 0.0, 1.0)
    demand = size_deg * DEG * fade * np.sin(phase)
    span = Span(0.0, 1.0, 21.0, 21.9, "other", ((1.0, size_deg * DEG), (21.0, 0.0)), closed_by)
    return Maneuver(1, 0, span, channels_of(demand, gust=gust), mode)


def right(maneuver):
    fitted = estimate(maneuver, Aircraft())
    assert judge("pitch", maneuver, fitted, Aircraft()) == ()
    return all(fitted.value(name) == pytest.approx(true, rel=0.08) for name, true in TRUE.items())


@pytest.mark.parametrize("mode", ["STABILIZE", "FBWA", "FBWB", "CRUISE"])
@pytest.mark.parametrize("loop", [(0.1, 0.2), LOOP])
def test_steps_in_a_closed_loop_are_found(mode, loop):
    assert not isinstance(judged(stepped(mode, loop)), Because)


@pytest.mark.parametrize("loop", [(0.1, 0.2), LOOP])
def test_steps_in_a_closed_loop_give_right_derivatives(loop):
    assert right(stepped("FBWA", loop))


@pytest.mark.parametrize("mode", ["STABILIZE", "FBWA", "FBWB", "CRUISE"])
def test_a_sweep_of_system_id_is_found_in_a_closed_loop(mode):
    assert not isinstance(judged(swept(2.0, mode)), Because)


def test_a_sweep_of_system_id_gives_right_derivatives():
    assert right(swept(2.0))


def test_a_sweep_that_nothing_announces_is_the_loops_own():
    because = judged(swept(2.0, closed_by="quiet"))
    assert isinstance(because, Because)
    assert "without the sharp steps of a test" in because.text


def test_a_sweep_of_another_axis_is_named_in_one_line():
    """The pitch loop answers gusts while SystemID sweeps the ailerons."""
    because = judged(swept(0.0, gust=2.0 * DEG))
    assert isinstance(because, Because)
    assert because.reason == "autopilot"
    assert because.text.startswith(
        "SystemID ran in FBWA, and the elevator's effect on the pitch rate is known"
    )


def test_a_sweep_in_hover_is_no_test_of_the_wing():
    because = judged(swept(2.0, "QHOVER"))
    assert isinstance(because, Because)
    assert because.reason == "hover"
