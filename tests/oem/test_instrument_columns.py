"""Derivatives by instruments and by times of steps are those of a problem that is laid out anew."""

from dataclasses import replace
from itertools import product

import numpy as np
import pytest

from advisor.model.outputs import N_PARAMETERS
from advisor.model.response import respond
from advisor.oem import surface
from advisor.oem.estimator import Edges, _by_edges, _edged, large_steps
from advisor.oem.instrument_columns import instrument_columns
from advisor.oem.instruments import BY_NAME
from advisor.oem.problem import assemble
from advisor.oem.rows import Signal
from advisor.oem.solution import search
from advisor.oem.surface import Servo
from tests.oem.builders import UAV
from tests.oem.test_kernel import problem_with_everything

SHARED = np.append(UAV[[1, 2, 3, 5, 6, 7]], 0.04)
LOCAL = np.array([[0.05, 0.4, 0.05, 0.1, 0.02, 0.01, 0.2], [0.03, 0.5, 0.04, -0.1, 0.1, -0.02, 0.1]])
STEP = 1e-6


@pytest.fixture(autouse=True)
def fine_grid(monkeypatch):
    """Draw the surface so finely that no line between its points hides a difference."""
    monkeypatch.setattr(surface, "LONGEST_STEP_S", 1e-3)


def problem(lag_s=0.0, held=False, steady=False):
    """Return two records that begin with the pitch rate; the air speed is constant where ``steady``."""
    whole = problem_with_everything()
    records = []
    for record in whole.records:
        q = record.outputs["q"]
        outputs = {**record.outputs, "q": Signal(np.append(0.05, q.t), np.append(0.0, q.y))}
        record = replace(record, outputs=outputs, held=held)
        if steady:
            speed = Signal(record.airspeed.t, np.full(len(record.airspeed.t), 26.0))
            record = replace(record, airspeed=speed, normal_gravity=None)
        records.append(record)
    return replace(whole, records=tuple(records), servo=Servo(lag_s, 0.013))


def outputs(of):
    assembly = assemble(of)
    y = np.empty(len(assembly.z))
    respond(assembly.grid, SHARED, LOCAL, y, np.empty((0, N_PARAMETERS)))
    return y


def relative_error(of, name):
    """Return the largest difference between a column and the slope of the outputs, over the largest slope."""
    x = BY_NAME[name]
    ends = [outputs(x.write(of, x.read(of) + sign * STEP)) for sign in (1.0, -1.0)]
    slope = (ends[0] - ends[1]) / (2.0 * STEP)
    column = instrument_columns(of, assemble(of), SHARED, LOCAL, [name])[:, 0]
    return np.max(np.abs(column - slope)) / np.max(np.abs(slope))


@pytest.mark.parametrize("name", ["vane_arm_m", "accelerometer_arm_m", "steady_moment_rad"])
def test_the_column_of_an_instrument_that_moves_no_stamp_is_the_slope_of_the_outputs(name):
    assert relative_error(problem(0.05), name) < 1e-6


@pytest.mark.parametrize("lag_s", [0.0, 0.02, 0.1])
@pytest.mark.parametrize("held", [False, True])
def test_the_column_of_a_late_command_is_the_slope_of_the_outputs(lag_s, held):
    assert relative_error(problem(lag_s, held, steady=True), "command_delay_s") < 2e-3


@pytest.mark.parametrize("held", [False, True])
def test_the_column_of_a_lag_is_the_slope_of_the_outputs(held):
    assert relative_error(problem(0.05, held), "servo_lag_s") < 1e-6


def test_the_column_of_a_late_angle_of_attack_is_the_slope_of_the_angle_of_attack():
    assert relative_error(problem(steady=True), "alpha_delay_s") < 1e-5


def test_without_a_lag_a_short_lag_acts_like_a_delay():
    of = problem()
    lag, delay = instrument_columns(of, assemble(of), SHARED, LOCAL, ["servo_lag_s", "command_delay_s"]).T
    np.testing.assert_array_equal(lag, delay)


@pytest.mark.parametrize("lag_s", [0.0, 0.05])
def test_the_column_of_a_step_is_the_slope_of_the_outputs_by_its_time(lag_s):
    plain = problem(lag_s, steady=True)
    t = np.arange(0.0, 6.0, 0.1)
    commands = [Signal(t, 0.03 * ((t > 1.05) & (t < 3.05 + k))) for k in range(2)]
    records = [replace(r, elevator=u) for r, u in zip(plain.records, commands, strict=True)]
    edges = [large_steps(record.elevator) for record in records]
    assert [len(e.interval) for e in edges] == [2, 2]
    of = _edged(plain, edges, records)
    _, optimum = search(of, begin=(SHARED, LOCAL))
    columns = _by_edges(of, assemble(of), optimum._replace(shared=SHARED, local=LOCAL), edges)
    for m, j in product(range(2), range(2)):
        ends = []
        for sign in (1.0, -1.0):
            moved = [Edges(e.interval, e.stamps, e.time.copy()) for e in edges]
            moved[m].time[j] += sign * 1e-4
            ends.append(outputs(_edged(plain, moved, records)))
        slope = (ends[0] - ends[1]) / 2e-4
        np.testing.assert_allclose(columns[:, 2 * m + j], slope, atol=2e-3 * np.max(np.abs(slope)))
