"""A control that follows the motion is no cause of it."""

from dataclasses import replace

import numpy as np
import pytest

from advisor.flight.maneuvers.excitation import external_share
from advisor.model.axes.lateral import LATERAL
from advisor.oem.axis.problem import AxisProblem
from advisor.oem.rows import Signal
from tests.oem.axis.builders import JET, aileron_doublet, flown, rudder_doublet
from tests.oem.axis.test_solution import WITHOUT_VANE, place, solved

T = np.arange(0.0, 15.0, 0.025)
DAMPED = {**JET, **{f"{axis}_r": JET[f"{axis}_r"] + 0.4 * JET[f"{axis}_delta_r"] for axis in "YLN"}}
"""The jet with a yaw damper of 0.4 rad of rudder per rad/s."""
RATE = Signal(T, np.sin(2.0 * T))


def damped():
    """Return an aileron test in which a damper moves the rudder, and feet by a little."""
    feet = Signal(T, rudder_doublet(T).y / 60.0)
    rate = flown(DAMPED, aileron=aileron_doublet(T), rudder=feet).outputs["r"]
    noise = np.random.default_rng(5)
    record = flown(DAMPED, aileron=aileron_doublet(T), rudder=feet, measured=WITHOUT_VANE, rng=noise)
    rudder = Signal(T, feet.y + 0.4 * np.interp(T, rate.t, rate.y))
    return AxisProblem(LATERAL, (replace(record, inputs={**record.inputs, "rudder": rudder}),))


def test_a_rudder_that_opposes_the_yaw_rate_has_no_external_part():
    assert external_share([(Signal(T, 0.3 * RATE.y), RATE)], -1.6) == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize("rudder", [Signal(T, -0.3 * RATE.y), Signal(T, 0.0 * T)])
def test_a_rudder_that_drives_the_yaw_rate_or_rests_follows_nothing(rudder):
    assert external_share([(rudder, RATE)], -1.6) == 1.0


def test_one_gain_serves_all_records():
    pairs = [(Signal(T, gain * RATE.y), RATE) for gain in (0.1, 0.5)]
    assert external_share(pairs, -1.6) == pytest.approx(1.0 - 0.3**2 / 0.13)


def test_a_dampers_rudder_tells_its_own_derivative_by_its_external_part_alone():
    solution, j = solved(damped()), place("N_delta_r")
    share = external_share([(r.inputs["rudder"], r.outputs["r"]) for r in solution.problem.records], -1.6)
    assert share < 0.5
    assert solution.widened[j, j] == pytest.approx(solution.scattered[j, j] / share, rel=0.3)


def test_the_error_of_a_dampers_rudder_is_an_error_of_the_yaw_damping():
    solution, j = solved(damped()), place("N_r")
    assert solution.widened[j, j] > 1.5 * solution.scattered[j, j]


def test_a_flown_rudder_keeps_its_errors():
    record = flown(JET, rudder=rudder_doublet(T), measured=WITHOUT_VANE, rng=np.random.default_rng(5))
    solution, j = solved(AxisProblem(LATERAL, (record,))), place("N_delta_r")
    assert solution.widened[j, j] < 1.2 * solution.scattered[j, j]
