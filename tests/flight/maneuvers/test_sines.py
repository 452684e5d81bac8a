"""Commands of sines are curves between their samples; every other command is as it was recorded."""

import numpy as np
import pytest

from advisor.flight.maneuvers.maneuver import InputKind, Maneuver, Span
from advisor.flight.maneuvers.stepped_input import command_of
from advisor.flight.signals.record import Channel

T = np.arange(0.0, 5.0, 0.02)
HZ = 2.8


def flown(kind: InputKind) -> Maneuver:
    """Return a manoeuvre whose elevator is a sine, sampled 50 times a second."""
    sine = np.sin(2.0 * np.pi * HZ * T)
    span = Span(0.0, 0.5, 4.5, 5.0, kind, (), "quiet")
    return Maneuver(1, 0, span, {"elevator": Channel("elevator", T, sine, "servo", "commanded")})


def size(command: Channel) -> float:
    """Return the size of the sine that the lines between the corners of a command draw."""
    t = np.linspace(0.5, 4.5, 20_001)
    wave = np.interp(t, command.t, command.y)
    columns = np.column_stack([np.sin(2.0 * np.pi * HZ * t), np.cos(2.0 * np.pi * HZ * t)])
    return float(np.hypot(*np.linalg.lstsq(columns, wave, rcond=None)[0]))


def test_lines_between_samples_lose_a_hundredth_of_a_sine_and_corners_a_thousandth_of_it():
    # (pi f / f_s)^2 / 3 of a sine lies outside the lines between its samples.
    assert 1.0 - size(command_of(flown("other"), "elevator")) == pytest.approx(0.0103, abs=0.001)
    assert 1.0 - size(command_of(flown("multisine"), "elevator")) < 0.001


def test_steps_stay_as_they_were_recorded():
    maneuver = flown("3-2-1-1")
    assert command_of(maneuver, "elevator") is maneuver.channels["elevator"]
