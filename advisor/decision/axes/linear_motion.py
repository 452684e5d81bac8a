"""Linear motion of one axis about straight flight, and the sensitivities of its outputs by every parameter.

The motion is ẋ = A·x + Σ θ_k·z_k with the states x from zero, and with states, controls and one as factors z.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
from scipy.linalg import expm

from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.model.axes.lateral import CONTROLS, Trim, state_matrix
from advisor.model.short_period import ShortPeriod
from advisor.oem.estimate import Estimate
from advisor.process.arrays import FloatArray


@dataclass(frozen=True)
class Motion:
    """Names of the quantities in the linear motion of one axis."""

    equations: str
    """Letter of each equation, in the order of the states. The first equation is that of the force."""
    states: tuple[str, ...]
    force: str
    """Output with the specific force."""
    clock: str
    """Channel at whose stamps the motion is computed."""
    controls: Mapping[str, str]
    """Name of each control, by the ending of its derivatives."""
    turns: Mapping[str, str]
    """Moment of each control, by the name of the control."""
    system: Callable[[FloatArray, Trim], FloatArray]
    """Function that returns A for the derivatives and a steady flight."""


PITCH = Motion(
    "ZM", ("alpha", "q"), "a_z", "q", {"delta_e": "elevator"}, {"elevator": "M_delta_e"},
    lambda theta, _: ShortPeriod(theta).a,
)  # fmt: skip
SIDE = Motion(
    "YLN", ("beta", "p", "r", "bank"), "a_y", "p", CONTROLS,
    {"aileron": "L_delta_a", "rudder": "N_delta_r"}, state_matrix,
)  # fmt: skip


class LinearMotion:
    """Motion of a manoeuvre with the derivatives of an estimate, at some stamps."""

    def __init__(self, motion: Motion, maneuver: Maneuver, estimate: Estimate, t: FloatArray) -> None:
        self.motion, self.t = motion, t
        self._channels = {name: c for name, c in maneuver.channels.items() if len(c) > 1}
        self._speed = max(self._mean("airspeed", estimate.airspeed_m_s or 1.0), 1.0)
        constants = tuple(f"{letter}_0" for letter in motion.equations)
        self._names = (*estimate.names, *(name for name in constants if name not in estimate.names))
        theta = np.where(np.isfinite(estimate.theta), estimate.theta, 0.0)
        self._theta = dict(zip(estimate.names, theta.tolist(), strict=True))
        trim = Trim(self._speed, self._mean("alpha", 0.0), self._mean("theta", 0.0))
        self._system = motion.system(theta, trim)
        self._inputs = {name: self._moved(name, estimate.servo_lag_s) for name in motion.controls.values()}
        driving = np.zeros((len(motion.states), len(t), 1))
        for row, letter in enumerate(motion.equations):
            for ending, control in motion.controls.items():
                driving[row, :, 0] += self._theta[f"{letter}_{ending}"] * self._inputs[control]
        with np.errstate(over="ignore", invalid="ignore"):
            states = driven(self._system, t, driving)[:, :, 0]
        self.states: Mapping[str, FloatArray] = dict(zip(motion.states, states, strict=True))
        """Deviation of each state from its steady value, shape (n,), by the name of the state."""

    def measured(self, name: str) -> FloatArray | None:
        """Return a channel at the stamps, shape (n,); None for a missing channel."""
        channel = self._channels.get(name)
        return None if channel is None else np.interp(self.t, channel.t, channel.y)

    def change(self, state: str) -> FloatArray:
        """Return the derivative of a state by time, shape (n,)."""
        return np.asarray(np.gradient(self.states[state], self.t))

    def columns(self, term: FloatArray, state: str) -> dict[str, FloatArray]:
        """Return the sensitivities of each output, shape (n, m), with those by an omitted term last.

        The first columns are the parameters of the estimate in their order. Constants of the equations and
        initial states follow.

        Parameters
        ----------
        term
            Shape (n,): omitted part of a state's derivative by time for a coefficient of one, 1/s².
        state
            State whose derivative has the omitted part.
        """
        motion, count = self.motion, len(self.motion.states)
        parameters = len(self._names)
        inputs = np.zeros((count, len(self.t), parameters + count + 1))
        for k, name in enumerate(self._names):
            letter, _, factor = name.partition("_")
            inputs[motion.equations.index(letter), :, k] = self._factor(factor)
        inputs[motion.states.index(state), :, -1] = term
        initial = np.zeros((count, inputs.shape[2]))
        initial[range(count), range(parameters, parameters + count)] = 1.0
        by_state = [self._theta.get(f"{motion.equations[0]}_{name}", 0.0) for name in motion.states]
        with np.errstate(over="ignore", invalid="ignore"):
            states = driven(self._system, self.t, inputs, initial)
            force = inputs[0] + np.tensordot(by_state, states, 1)
        force[:, -1] -= inputs[0, :, -1]  # A turn of the path is no force.
        return {**dict(zip(motion.states, states, strict=True)), motion.force: self._speed * force}

    def late(self, control: str) -> dict[str, FloatArray]:
        """Return the sensitivities, with an additional last column for the lateness of a control."""
        turns = self.motion.turns[control]
        term = self._theta[turns] * np.gradient(self._inputs[control], self.t)
        return self.columns(term, self.motion.states[self.motion.equations.index(turns[0])])

    def _factor(self, name: str) -> FloatArray:
        if name in self.motion.controls:
            return self._inputs[self.motion.controls[name]]
        return self.states[name] if name in self.states else np.ones(len(self.t))

    def _mean(self, name: str, otherwise: float) -> float:
        return float(np.mean(self._channels[name].y)) if name in self._channels else otherwise

    def _moved(self, name: str, lag_s: float) -> FloatArray:
        y = self.measured(name)
        return np.zeros(len(self.t)) if y is None else behind(self.t, y - y[0], lag_s)


def sensitivities(
    motion: Motion, maneuver: Maneuver, estimate: Estimate
) -> tuple[FloatArray, dict[str, FloatArray]]:
    """Return the stamps of the axis' clock, and the sensitivities of the outputs there, shape (n, m) each.

    The last columns are the lateness of each control, which every record determines anew.
    """
    t = maneuver.channels[motion.clock].t
    linear = LinearMotion(motion, maneuver, estimate, t)
    first, *others = (linear.late(control) for control in motion.turns)
    return t, {
        name: np.nan_to_num(np.column_stack([column, *(late[name][:, -1] for late in others)]))
        for name, column in first.items()
    }


def driven(
    system: FloatArray, t: FloatArray, inputs: FloatArray, initial: FloatArray | None = None
) -> FloatArray:
    """Return the states, shape (k, n, m), of the linear system for m sets of inputs, shape (k, n, m)."""
    states = np.zeros_like(inputs)
    if initial is not None:
        states[:, 0] = initial
    step_s = float(np.median(np.diff(t)))
    step = expm(system * step_s)
    for k in range(1, len(t)):
        held = states[:, k - 1] + 0.5 * step_s * inputs[:, k - 1]
        states[:, k] = step @ held + 0.5 * step_s * inputs[:, k]
    return states


def behind(t: FloatArray, command: FloatArray, lag_s: float) -> FloatArray:
    """Return the deflection over time of a servo with a first-order lag, s, for a command that begins at
    zero.
    """
    if not lag_s > 0.0:
        return command
    return driven(np.array([[-1.0 / lag_s]]), t, (command / lag_s)[None, :, None])[0, :, 0]
