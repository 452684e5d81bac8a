from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from scipy.signal import cont2discrete

from advisor.aircraft.aircraft import Aircraft, Elevator
from advisor.aircraft.reference import PARAMETERS
from advisor.decision.first_unit import frequency
from advisor.doctor.expectation import (
    NOISE,
    TYPICAL,
    UNITS_OF_TIME,
    Assumed,
    _estimated,
    edge_error_s,
    expect,
)
from advisor.model.short_period import ShortPeriod
from advisor.oem.extra import Prior
from advisor.oem.instrument_fit import fit_instruments
from advisor.oem.instruments import SERVO_LAG, unknown_instruments
from advisor.oem.problem import OutputErrorProblem, Record
from advisor.oem.rows import Signal
from advisor.oem.solution import Solution, solve

ASSUMED = Assumed(TYPICAL, NOISE, "a test")
JET = ShortPeriod.from_mapping(
    {"Z_alpha": -0.483, "Z_q": 0.104, "Z_delta_e": 0.676, "M_alpha": -4.93, "M_q": -2.01, "M_delta_e": -7.21}
)


def stated(lag_s: float | None) -> Assumed:
    """Return the assumptions of an aircraft file with a servo's lag."""
    return replace(ASSUMED, aircraft=Aircraft(elevator=Elevator(lag_s=lag_s)))


def flown(model, unit_s, amplitude, dice, late_s=0.0):
    """A 3-2-1-1 integrated by scipy on a fine grid, read at 50 Hz with noise, its command stamped late."""
    step_s = 0.002
    edges = 1.0 + unit_s * np.cumsum([0, *UNITS_OF_TIME])
    t = np.arange(0.0, edges[-1] + max(2.0, 10.0 * unit_s), step_s)
    command = np.zeros_like(t)
    for k, sign in enumerate((-1.0, 1.0, -1.0, 1.0)):
        command[(t >= edges[k]) & (t < edges[k + 1])] = sign * amplitude
    a, b, *_ = cont2discrete((model.a, model.b[:, None], np.eye(2), np.zeros((2, 1))), step_s, "foh")
    c = cont2discrete((model.a, model.b[:, None], np.eye(2), np.zeros((2, 1))), step_s, "foh")[2:4]
    state, outputs = np.zeros(2), np.empty((len(t), 2))
    for i, u in enumerate(command):
        outputs[i] = c[0] @ state + c[1][:, 0] * u
        state = a @ state + b[:, 0] * u
    read = slice(None, None, 10)
    measured = {
        name: Signal(t[read], outputs[read, k] + dice.normal(0.0, NOISE[name], len(t[read])))
        for k, name in enumerate(("alpha", "q"))
    }
    return Record(elevator=Signal(t + late_s, command), outputs=measured)


def test_many_fits_with_noise_and_a_natural_lateness_scatter_as_expected() -> None:
    """Telemetry is late by 15 ms and half an interval of the command (standard deviation)."""
    expected = expect(stated(0.0), {"elevator": 500.0, "alpha": 50.0, "q": 50.0}, None)
    dice = np.random.default_rng(11)
    estimates = []
    for _ in range(40):
        late_s = dice.normal(0.0, 0.016)
        record = flown(TYPICAL, expected.unit_s, np.radians(expected.amplitude_deg), dice, late_s)
        problem = OutputErrorProblem(records=(record,))
        plain = solve(problem)
        assert isinstance(plain, Solution)
        unknown = unknown_instruments(problem, Aircraft(elevator=Elevator(lag_s=0.0)))
        estimates.append(fit_instruments(plain, unknown).solution.theta)
    scatter = np.std(estimates, axis=0)
    ratio = scatter / np.array([expected.std[name] for name in PARAMETERS])
    # 40 values tell a standard deviation to 11 %; edges take a fiftieth of a second here, none there.
    assert np.all((ratio > 0.7) & (ratio < 1.35)), dict(zip(PARAMETERS, ratio, strict=True))


def test_a_servo_whose_lag_the_file_leaves_open_tells_less_of_the_moment() -> None:
    rates = {"elevator": 50.0, "alpha": 50.0, "q": 50.0}
    known, left_open = (expect(assumed, rates, None) for assumed in (stated(0.05), ASSUMED))
    assert left_open.std["M_delta_e"] > 1.05 * known.std["M_delta_e"]


@pytest.mark.parametrize(("lag_s", "std_s"), [(None, 0.05), (0.2, 0.02)])
def test_a_stated_lag_is_known_to_a_tenth_of_itself(lag_s: float | None, std_s: float) -> None:
    (lag,) = _estimated([replace(SERVO_LAG, stated=lag_s, prior=Prior(0.05, 0.05))])
    assert lag.prior is not None
    assert lag.prior.std == pytest.approx(std_s)


def test_a_stated_lag_of_zero_holds() -> None:
    assert list(_estimated([replace(SERVO_LAG, stated=0.0, prior=Prior(0.05, 0.05))])) == []


def test_the_amplitude_and_the_lag_of_flown_manoeuvres_take_the_place_of_assumed_ones() -> None:
    rates = {"elevator": 50.0, "alpha": 50.0, "q": 50.0}
    small, large = (expect(replace(stated(0.0), amplitude_deg=deg), rates, None) for deg in (1.0, 4.0))
    assert (small.amplitude_deg, large.amplitude_deg) == (pytest.approx(1.0), pytest.approx(4.0))
    assert small.std["M_alpha"] > 2.0 * large.std["M_alpha"]
    quick, slow = (expect(replace(ASSUMED, lag_s=lag_s), rates, None) for lag_s in (0.01, 0.2))
    assert slow.std["M_delta_e"] > 1.2 * quick.std["M_delta_e"]


def test_the_manoeuvre_moves_the_angle_of_attack_as_far_as_it_says() -> None:
    expected = expect(ASSUMED, {"elevator": 50.0, "alpha": 50.0, "q": 50.0}, None)
    quiet = np.random.default_rng(0)
    record = flown(TYPICAL, expected.unit_s, np.radians(expected.amplitude_deg), quiet)
    peak = np.degrees(np.max(np.abs(record.outputs["alpha"].y)))
    assert peak == pytest.approx(4.0, abs=0.8)


@pytest.mark.parametrize("channel", ["elevator", "alpha", "q"])
def test_a_slower_channel_never_helps_and_costs_something(channel: str) -> None:
    rates = {"elevator": 50.0, "alpha": 50.0, "q": 50.0}
    errors = [
        np.array(list(expect(ASSUMED, {**rates, channel: rate}, None).std.values()))
        for rate in (50.0, 20.0, 10.0, 4.0)
    ]
    for faster, slower in pairwise(errors):
        assert np.all(slower > 0.97 * faster)
    assert np.max(errors[-1] / errors[0]) > 1.5


def test_the_information_of_four_times_the_samples_halves_the_error() -> None:
    slow = expect(ASSUMED, {"elevator": 1000.0, "alpha": 50.0, "q": 50.0}, None)
    fast = expect(ASSUMED, {"elevator": 1000.0, "alpha": 200.0, "q": 200.0}, None)
    for name in PARAMETERS:
        assert slow.std[name] / fast.std[name] == pytest.approx(2.0, rel=0.1)


def test_more_outputs_teach_more() -> None:
    few = expect(ASSUMED, {"elevator": 50.0, "alpha": 20.0, "q": 50.0}, 25.0)
    more = expect(ASSUMED, {"elevator": 50.0, "alpha": 20.0, "q": 50.0, "a_z": 50.0, "theta": 50.0}, 25.0)
    assert more.std["Z_alpha"] < few.std["Z_alpha"]
    assert more.std["Z_delta_e"] < few.std["Z_delta_e"]


def test_four_hertz_serves_no_small_aircraft_but_ten_serve_a_jet() -> None:
    """Error of the stiffness beside the stiffness."""
    small = expect(ASSUMED, {"elevator": 4.0, "alpha": 4.0, "q": 4.0}, None)
    jet = expect(Assumed(JET, NOISE, ""), {"elevator": 10.0, "alpha": 10.0, "q": 10.0}, None)
    assert small.std["M_alpha"] > 0.2 * 40.0
    assert jet.std["M_alpha"] < 0.05 * 4.93


def test_slow_samples_leave_an_edge_anywhere_between_them() -> None:
    assert edge_error_s(1.0) == pytest.approx(1.0 / np.sqrt(12.0), rel=0.08)
    assert edge_error_s(200.0) < 1e-4


def test_an_aircraft_without_a_natural_frequency_still_has_a_pace() -> None:
    unstable = ShortPeriod.from_mapping({"Z_alpha": -1.0, "M_alpha": 5.0, "M_q": -1.0, "M_delta_e": -5.0})
    assert np.isnan(unstable.natural_frequency)
    assert frequency(unstable) == pytest.approx(1.0 + np.sqrt(5.0), rel=1e-6)
    assert frequency(JET) == pytest.approx(JET.natural_frequency)
