import numpy as np
import pytest

from advisor.aircraft.aircraft import Aircraft, Elevator
from advisor.oem.estimator import estimate, large_steps, sharpened, with_edges
from advisor.oem.problem import OutputErrorProblem, Record
from advisor.oem.rows import Signal
from advisor.oem.solution import solve
from tests.oem.builders import UAV, flown, maneuver, simulate, trim_alpha, trim_elevator

RATE = 50.0


def flown_between_stamps(seed, share, sign, noise=0.02):
    """Return the small aircraft's manoeuvre; steps happen at ``share`` of the interval between stamps."""
    rng = np.random.default_rng(seed)
    t = np.arange(0.0, 8.0, 1.0 / RATE)
    fine = np.arange(0.0, 8.0, 0.0005)
    trim = trim_elevator(UAV)

    def command(stamps):
        y = np.full(len(stamps), trim)
        for edge, level in ((1.0, 0.8), (2.2, -1.2), (3.0, 1.1), (3.4, -1.1), (3.8, 0.0)):
            y[stamps > edge - 1e-9 + share / RATE] = trim + 0.02 * sign * level
        return y

    x = simulate(UAV, [trim_alpha(UAV), 0.0], fine, command(fine), t[1:-1])
    outputs = {
        name: Signal(t[1:-1], x[:, c] + noise * x[:, c].std() * rng.standard_normal(len(x)))
        for name, c in (("alpha", 0), ("q", 1))
    }
    return Record(Signal(t, command(t)), outputs)


@pytest.mark.parametrize("share", [0.05, 0.95])
def test_steps_between_stamps_do_not_pass_for_other_derivatives(share):
    plain = solve(OutputErrorProblem(tuple(flown_between_stamps(k, share, (-1) ** k) for k in range(2))))
    found = with_edges(plain)
    off = np.abs(found.theta - UAV) / np.sqrt(np.diag(found.covariance)[:8])
    assert np.all(off < 4.0)
    assert np.max(np.abs(plain.theta - UAV) / np.sqrt(np.diag(plain.covariance)[:8])) > 8.0


def test_steps_in_the_middle_between_stamps_are_told_from_ramps():
    plain = solve(
        OutputErrorProblem(tuple(flown_between_stamps(k, 0.5, (-1) ** k, noise=0.01) for k in range(2)))
    )
    found = with_edges(plain)
    off = np.abs(found.theta - UAV) / np.sqrt(np.diag(found.covariance)[:8])
    assert np.all(off < 3.5)
    assert np.max(np.abs(plain.theta - UAV) / np.sqrt(np.diag(plain.covariance)[:8])) > 4.0


def test_a_command_that_is_linear_between_stamps_is_left_alone():
    flight = flown(UAV, unit_s=0.4, noise=0.02, length_s=8.0)
    signals = {n: Signal(c.t, c.y) for n, c in flight.channels.items()}
    plain = solve(OutputErrorProblem((Record(signals["elevator"], {n: signals[n] for n in ("alpha", "q")}),)))
    assert with_edges(plain) is plain


def test_large_steps_are_those_that_stand_alone():
    t = np.arange(10.0)
    y = np.array([0.0, 0.0, 1.0, 1.0, 1.02, 0.5, 0.0, 0.0, -1.0, -1.0])
    assert large_steps(Signal(t, y)).interval == (1, 7)
    assert large_steps(Signal(t, np.zeros(10))).interval == ()


def test_a_sharpened_command_keeps_its_levels():
    t, y = np.arange(5.0), np.array([0.0, 0.0, 2.0, 2.0, 2.0])
    made = sharpened(Signal(t, y), large_steps(Signal(t, y)))
    np.testing.assert_allclose(made.at(np.array([1.4, 1.6])), [0.0, 2.0])


@pytest.mark.parametrize("held", [False, True])
def test_a_smooth_command_is_held_or_linear_as_the_data_say(held):
    rng = np.random.default_rng(1)
    t = np.arange(0.0, 8.0, 1.0 / RATE)
    u = trim_elevator(UAV) + 0.01 * (np.sin(3.0 * t) + np.sin(7.0 * t) + np.sin(11.0 * t))
    fine = np.arange(0.0, 8.0 - 1.0 / RATE, 0.001)
    command = u[np.searchsorted(t, fine + 1e-9, side="right") - 1] if held else np.interp(fine, t, u)
    stamps = t[1:-2] + 0.007
    x = simulate(UAV, [trim_alpha(UAV), 0.0], fine, command, stamps)
    noise = 0.03 * x[:, :2].std(axis=0) * rng.standard_normal((len(x), 2))
    channels = {"alpha": (stamps, x[:, 0] + noise[:, 0]), "q": (stamps, x[:, 1] + noise[:, 1])}
    found = estimate(maneuver(1, (t, u), channels), Aircraft(elevator=Elevator(lag_s=0.0)))
    assert np.all(np.abs(found.theta - UAV) < 4.0 * found.std)
