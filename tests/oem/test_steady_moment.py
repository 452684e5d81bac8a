"""A moment that does not scale with the square of the air speed does not pass for other derivatives."""

from dataclasses import replace

import numpy as np
import pytest

from advisor.aircraft.aircraft import Aircraft, Elevator
from advisor.model.outputs import N_PARAMETERS
from advisor.model.response import respond
from advisor.oem.instrument_fit import fit_instruments
from advisor.oem.instruments import unknown_instruments
from advisor.oem.problem import OutputErrorProblem, Record, assemble
from advisor.oem.rows import Signal
from advisor.oem.solution import solve
from tests.oem.builders import JET, elevator_3211, trim_alpha, trim_elevator

KNOWN = Aircraft(elevator=Elevator(lag_s=0.0))
T = np.arange(0.0, 14.0, 0.04)
THRUST_RAD = 0.015
SLOWS = Signal(T, np.interp(T, [0.0, 2.0, 14.0], [100.0, 100.0, 85.0]))
STEADY = Signal(T, np.full(len(T), 100.0))


def flight(airspeed, reference):
    """Return a 3-2-1-1 of the jet with a thrust that 0.015 rad of elevator balance at 100 m/s."""
    command = Signal(T, elevator_3211(T, trim=trim_elevator(JET), amplitude=0.03))
    record = Record(command, {"alpha": Signal(T, 0.0 * T), "q": Signal(T, 0.0 * T)}, airspeed=airspeed)
    problem = OutputErrorProblem((record,), reference, steady_moment_rad=THRUST_RAD)
    grid, rows = (assembly := assemble(problem)).grid, assembly.rows[0]
    shared = np.array([*JET[1:4], *JET[5:8], 0.0])
    local = np.array([[JET[0], JET[4], trim_alpha(JET), 0.0, 0.0, 0.0, 0.0]])
    y = np.empty(len(assembly.z))
    respond(grid, shared, local, y, np.empty((0, N_PARAMETERS)))
    rng = np.random.default_rng(1)
    outputs = {name: Signal(T, y[at] + 2e-4 * rng.standard_normal(len(T))) for name, at in rows.items()}
    return replace(problem, records=(replace(record, outputs=outputs),), steady_moment_rad=0.0)


def instruments_of(problem):
    return [x for x in unknown_instruments(problem, KNOWN) if x.name != "servo_lag_s"]


def test_thrust_off_the_centre_of_gravity_does_not_bias_the_derivatives_of_a_slowing_aircraft():
    problem = flight(SLOWS, 100.0)
    plain = solve(problem)
    found = fit_instruments(plain, instruments_of(problem))
    std = np.sqrt(np.diag(found.solution.covariance))[5:8]
    assert np.all(np.abs(found.solution.theta[5:8] - JET[5:8]) < 3.0 * std)
    assert np.max(np.abs(plain.theta[5:8] - JET[5:8]) / std) > 5.0
    steady = next(x for x in found.identified if x.instrument.name == "steady_moment_rad")
    assert steady.found.value == pytest.approx(THRUST_RAD, abs=3.0 * steady.found.std)


def test_at_a_constant_air_speed_no_such_moment_is_sought():
    assert "steady_moment_rad" not in {x.name for x in instruments_of(flight(STEADY, None))}
