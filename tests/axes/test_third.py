"""A third axis, described by one table here, flown and estimated by the kernel and the search of the others.

The table is that of the slow motion: speed u, path angle γ, height and thrust, moved by the throttle. The
kernel of any axis solves it, and the search of any axis estimates its derivatives.
"""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from advisor.aircraft.standard_gravity import GRAVITY_M_S2
from advisor.model.axis import CONSTANT, Axis, Term
from advisor.model.axis_response import AxisGrid, respond_axis
from advisor.oem.descent import Response, descended
from advisor.oem.estimate import NoEstimate
from advisor.oem.gauss_newton import CONVERGED
from advisor.oem.prior import about_zero
from advisor.oem.rows import Laid, Piece, Signal, lay_rows, padded

SLOW = Axis(
    states=("u", "path", "height", "thrust"),
    inputs=("throttle",),
    outputs=("u", "path", "height", "a_x", "thrust"),
    shared=(
        Term("X_u", "u", "u", 1), Term("X_thrust", "u", "thrust", 0), Term("Z_u", "path", "u", 0),
        Term("T_thrust", "thrust", "thrust", 0), Term("T_throttle", "thrust", "throttle", 0),
    ),
    constants=(Term("X_0", "u", CONSTANT, 0), Term("Z_0", "path", CONSTANT, 0)),
    biases=("a_x",),
)  # fmt: skip
TRUE = np.array([-0.08, 3.0, 0.012, -1.5, 1.2])
N = len(TRUE)
NOISE = np.array([0.02, 0.001, 0.05, 0.01, 0.005])
SPEED_M_S = 25.0
T = np.arange(0.0, 30.0, 0.1)
COUNT = len(SLOW.names.shared) + len(SLOW.names.local)


class Record(NamedTuple):
    """One flight of the slow motion."""

    throttle: Signal
    outputs: dict[str, Signal]


@dataclass(frozen=True, slots=True, kw_only=True)
class Gridded(Laid):
    """Rows of measurements with the grid of the kernel."""

    grid: AxisGrid


def flown(sign: float, seed: int) -> Record:
    """Return a step of the throttle and back, by an integration that shares no code with the kernel."""
    y = np.where((T > 4.0) & (T < 14.0), 0.2 * sign, 0.0)
    x_u, x_t, z_u, t_t, t_in = TRUE

    def rate(t: float, x: np.ndarray) -> list[float]:
        moved = float(np.interp(t, T, y))
        forward = x_u * x[0] + x_t * x[3] - GRAVITY_M_S2 * x[1]
        return [forward, z_u * x[0], SPEED_M_S * x[1], t_t * x[3] + t_in * moved]

    first = [0.3, -0.01, 2.0, 0.0]
    u, path, height, thrust = solve_ivp(rate, (T[0], T[-1]), first, t_eval=T, max_step=0.05, rtol=1e-9).y
    drawn = NOISE * np.random.default_rng(seed).standard_normal((len(T), len(NOISE)))
    clean = u, path, height, x_u * u + x_t * thrust, thrust
    series = zip(SLOW.outputs, clean, drawn.T, strict=True)
    return Record(Signal(T, y), {name: Signal(T, values + error) for name, values, error in series})


class SlowMotion:
    """The slow motion for the search of any axis."""

    names = SLOW.names

    @staticmethod
    def laid(records: tuple[Record, ...], /) -> Gridded:
        """Return the measurements as stacked rows."""
        one, states = np.ones(len(T)), len(SLOW.states)
        pieces = []
        for record in records:
            moved, slope = record.throttle.y, padded(np.diff(record.throttle.y) / np.diff(T))
            columns = {
                "step_s": padded(np.diff(T)), "ratio": one,
                "known": np.column_stack([one, -GRAVITY_M_S2 * one, SPEED_M_S * one]),
                "inputs": moved[:, None], "start": moved[:, None], "slope": slope[:, None],
            }  # fmt: skip
            pieces.append(Piece(T, record.outputs, columns))
        rows = lay_rows(pieces, SLOW.outputs)
        causes = np.zeros((len(rows.columns["step_s"]), 0, 1))
        grid = AxisGrid(
            first=rows.first, row=rows.row, place=SLOW.place, bias=SLOW.bias,
            scale=np.ones(len(SLOW.outputs)),
            turning=np.array([(0, 1, 1, -1, 1), (2, 1, 2, -1, 1)]),
            seen=np.array([(k, state, 0, -1, 1) for k, state in enumerate((0, 1, 2, states, 3))]),
            forced=np.empty((0, states)), changed=causes, changed_start=causes, changed_slope=causes,
            initial=tuple(len(SLOW.place) + k for k in range(states)), bank=-1, yaw=0, **rows.columns,
        )  # fmt: skip
        return Gridded(names=SLOW.names, free=np.arange(COUNT), grid=grid, **rows.measurements)

    @staticmethod
    def floor(_: Gridded, /) -> np.ndarray:
        """Return the least standard deviation of each output."""
        return 1e-3 * NOISE

    @staticmethod
    def begins(laid: Gridded, /) -> np.ndarray:
        """Return the time of the first event of each record, s."""
        return np.full(laid.maneuvers, T[0])

    @staticmethod
    def respond(_, laid: Gridded, shared: np.ndarray, local: np.ndarray, __, /) -> Response | None:
        """Return the response of the model; None where it diverges."""
        events = len(laid.grid.step_s)
        y, g, motion = (
            np.empty(len(laid.z)),
            np.empty((len(laid.z), COUNT)),
            np.empty((events, 2, len(SLOW.states))),
        )
        if not respond_axis(laid.grid, shared, local, y, g, motion):
            return None
        return Response(y, g, lambda: np.empty((len(y), 0)), motion[laid.grid.first[:-1], 1])


@pytest.fixture(scope="module")
def records() -> tuple[Record, ...]:
    return flown(1.0, 1), flown(-1.0, 2)


def test_a_third_axis_is_estimated_within_its_errors_from_two_flights(records):
    begin = 0.7 * TRUE, np.zeros((2, len(SLOW.names.local)))
    fit = descended(SlowMotion(), records, (), about_zero(np.zeros(N)), begin)
    assert not isinstance(fit, NoEstimate)
    assert fit.optimum.status == CONVERGED
    laid = fit.assembly
    g = fit.optimum.sensitivities / fit.optimum.noise[laid.channel][:, None]
    own = [np.where((laid.owner == m)[:, None], g[:, N:], 0.0) for m in range(2)]
    columns = np.column_stack([g[:, :N], *own])
    std = np.sqrt(np.diag(np.linalg.inv(columns.T @ columns)))[:N]
    assert np.all(np.abs(fit.optimum.shared - TRUE) < 4.0 * std)
    assert np.all(std < 0.1 * np.abs(TRUE))
    assert fit.optimum.noise == pytest.approx(NOISE, rel=0.1)


def test_the_sensitivities_of_a_third_axis_are_the_differences_of_its_outputs(records):
    motion, laid = SlowMotion(), SlowMotion.laid(records)
    at = np.concatenate([TRUE, 0.01 * np.ones(len(SLOW.names.local))])

    def outputs(x: np.ndarray) -> Response:
        found = motion.respond(records, laid, x[:N], np.tile(x[N:], (2, 1)), ())
        assert found is not None
        return found

    for k, column in enumerate(outputs(at).g.T):
        step = 1e-5 * np.eye(COUNT)[k]
        difference = (outputs(at + step).y - outputs(at - step).y) / 2e-5
        assert difference == pytest.approx(column, abs=1e-5 * np.max(np.abs(column))), SLOW.names
