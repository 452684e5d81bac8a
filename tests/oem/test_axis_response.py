import numpy as np
import pytest
from scipy.linalg import expm, expm_frechet

from advisor.model.axes.lateral import LATERAL
from advisor.model.axis_response import AxisGrid, respond_axis
from advisor.model.response import respond
from advisor.oem.axis.motion import AxisMotion
from advisor.oem.axis.parameter import Parameter
from advisor.oem.axis.problem import AxisProblem, causes_of, lay_out
from advisor.oem.extra import Prior
from advisor.oem.problem import OutputErrorProblem, Record, assemble
from advisor.oem.rows import Signal
from tests.oem.axis.builders import JET, TRIM, aileron_doublet, flown, rudder_doublet, vector

T = np.arange(0.0, 8.0, 0.025)
INITIAL = (0.002, 0.01, -0.004, 0.05)
OPEN = {"_".join(place): place for place in LATERAL.open}
UNSEEN = np.empty((0, 2, 4))


def responding(assembly, shared, local, sensitivities=False):
    rows, width = len(assembly.z), LATERAL.count + len(OPEN) + len(LATERAL.inputs) + 1
    y, g = np.empty(rows), np.empty((rows if sensitivities else 0, width))
    assert respond_axis(assembly.grid, shared, local, y, g, UNSEEN)
    return y, g


@pytest.fixture(scope="module")
def lateral():
    record = flown(JET, aileron=aileron_doublet(T), rudder=rudder_doublet(T), seconds=8.0, initial=INITIAL)
    local = np.zeros((1, len(LATERAL.names.local)))
    local[0, :3], local[0, 3:7] = list(TRIM.values()), INITIAL
    return lay_out(AxisProblem(LATERAL, (record,)), causes_of(LATERAL)), local


def test_the_kernel_agrees_with_an_independent_integration(lateral):
    assembly, local = lateral
    y, _ = responding(assembly, vector(JET), local)
    for name, rows in assembly.rows[0].items():
        size = np.ptp(assembly.z[rows])
        assert np.max(np.abs(y[rows] - assembly.z[rows])) < 1e-5 * size, name


def test_sensitivities_are_the_derivatives_of_the_outputs(lateral):
    assembly, local = lateral
    everything = np.concatenate([vector(JET), local[0]])
    _, g = responding(assembly, vector(JET), local, sensitivities=True)
    for j in range(len(everything)):
        step = np.zeros(len(everything))
        step[j] = 1e-5
        ends = [
            responding(assembly, x[:15], x[15:][None, :])[0] for x in (everything + step, everything - step)
        ]
        by_difference = (ends[0] - ends[1]) / 2e-5
        scale = np.max(np.abs(g[:, j])) + 1e-9
        assert np.max(np.abs(by_difference - g[:, j])) < 1e-5 * scale, j


@pytest.mark.parametrize("name", OPEN)
def test_the_column_of_an_open_number_is_the_slope_of_the_outputs(lateral, name):
    local = lateral[1]
    record = flown(JET, aileron=aileron_doublet(T), rudder=rudder_doublet(T), seconds=8.0, initial=INITIAL)
    at = dict(zip(LATERAL.instruments, (0.03, 0.02, 1.5, 0.4), strict=True))
    problem, motion = AxisProblem(LATERAL, (record,), values=at), AxisMotion(LATERAL)

    def outputs(step):
        moved = motion.laid(problem.having(OPEN[name], at[OPEN[name]] + step))
        return responding(moved, vector(JET), local)[0]

    excess = Parameter(OPEN[name], Prior(0.0, 1.0))
    answer = motion.respond(problem, motion.laid(problem), vector(JET), local, [excess])
    slope = (outputs(1e-5) - outputs(-1e-5)) / 2e-5
    column = answer.columns()[:, 0]
    assert np.max(np.abs(column - slope)) < 1e-5 * np.max(np.abs(slope))


def test_the_motion_has_the_states_and_their_rates(lateral):
    assembly, local = lateral
    events = len(assembly.grid.step_s)
    y, motion = np.empty(len(assembly.z)), np.empty((events, 2, 4))
    assert respond_axis(assembly.grid, vector(JET), local, y, np.empty((0, LATERAL.count)), motion)
    np.testing.assert_array_equal(motion[assembly.grid.row[0] >= 0, 0, 1], y[assembly.rows[0]["p"]])
    by_difference = np.gradient(motion[:, 0], 0.025, axis=0)
    free = slice(220, 300)
    np.testing.assert_allclose(motion[free, 1], by_difference[free], atol=2e-3)


def test_the_short_period_described_as_an_axis_is_its_closed_form():
    t = np.arange(0.0, 4.0, 0.02)
    elevator = Signal(t, np.where((t > 0.5) & (t < 1.5), 0.05, 0.0))
    still = Signal(t, np.zeros(len(t)))
    closed = assemble(OutputErrorProblem((Record(elevator, {"alpha": still, "q": still, "theta": still}),)))
    shared = np.array([-1.0, -0.05, -0.1, -5.0, -1.5, -7.0, 0.0])
    local = np.array([[0.04, 0.47, 0.05, 0.01, 0.02, 0.0, 0.0]])
    expected = np.empty(len(closed.z))
    assert respond(closed.grid, shared, local, expected, np.empty((0, 14)))
    n, events = 4, len(t)  # one state stands still
    turning = np.array([(0, 1, 0, -1, 1), (2, 1, 0, -1, 1)])
    seen = np.array([(k, k, 0, -1, 1) for k in range(3)])
    still_causes = np.zeros((events, 0, 1))
    # α̇ by α, q, δe; q̇ by α, q, δe; then the constants of both.
    place = np.array([(0, 0, 1), (0, 1, 0), (0, 4, 1), (1, 0, 2), (1, 1, 1), (1, 4, 2), (0, 5, 1), (1, 5, 2)])
    grid = AxisGrid(
        factor=np.empty((0, 0)), forced=np.empty((0, 4)),
        first=np.array([0, events]), step_s=closed.grid.step_s[closed.grid.kind],
        ratio=np.ones(events), inputs=elevator.y[:, None], start=elevator.y[:, None],
        slope=closed.grid.slope[:, None], changed=still_causes, changed_start=still_causes,
        changed_slope=still_causes, known=np.ones((events, 1)), turning=turning, seen=seen,
        scale=np.ones(3), row=closed.grid.row[[0, 1, 3]], place=place, bias=np.full(3, -1),
        initial=(8, 9, 10, 11), bank=-1, yaw=0,
    )  # fmt: skip
    y = np.empty(len(closed.z))
    assert respond_axis(grid, shared[:6], local[:, :6], y, np.empty((0, 12)), np.empty((0, 2, n)))
    np.testing.assert_allclose(y, expected, atol=1e-7)


@pytest.mark.parametrize("step_s", [1e-6, 0.004, 0.05, 0.4])
def test_a_step_of_any_length_is_the_exponential_of_its_matrix(step_s):
    rng = np.random.default_rng(3)
    a, first = rng.uniform(-2.5, 2.5, (4, 4)), rng.uniform(-1.0, 1.0, 4)
    none = np.zeros((2, 0, 1))
    grid = AxisGrid(
        factor=np.empty((0, 0)), forced=np.empty((0, 4)),
        first=np.array([0, 2]), step_s=np.full(2, step_s), ratio=np.ones(2), inputs=np.ones((2, 1)),
        start=np.ones((2, 1)), slope=np.zeros((2, 1)), changed=none, changed_start=none, changed_slope=none,
        known=np.ones((2, 1)), turning=np.zeros((0, 5), np.int64),
        seen=np.array([(k, k, 0, -1, 1) for k in range(4)]), scale=np.ones(4),
        row=np.array([(-1, k) for k in range(4)]),
        place=np.array([(i, j, 0) for i in range(4) for j in range(4)]), bias=np.full(4, -1),
        initial=(16, 17, 18, 19), bank=-1, yaw=0,
    )  # fmt: skip
    y, g = np.empty(4), np.empty((4, 20))
    assert respond_axis(grid, a.ravel(), first[None, :], y, g, np.empty((0, 2, 4)))
    whole = expm(step_s * a)
    moved = step_s * np.max(np.sum(np.abs(a), axis=1))
    np.testing.assert_allclose(y, whole @ first, atol=5e-5 * moved)
    np.testing.assert_allclose(g[:, 16:], whole, atol=5e-5 * moved)
    for k, (i, j, _) in enumerate(grid.place):
        change = np.zeros((4, 4))
        change[i, j] = step_s
        exact = expm_frechet(step_s * a, change, compute_expm=False) @ first
        np.testing.assert_allclose(g[:, k], exact, atol=5e-5 * moved)


def test_a_model_that_runs_away_is_no_response(lateral):
    assembly, local = lateral
    wild = vector(JET | {"L_p": 80.0})
    y = np.empty(len(assembly.z))
    assert not respond_axis(assembly.grid, wild, local, y, np.empty((0, LATERAL.count)), UNSEEN)
