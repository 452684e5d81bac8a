"""Influences that the model of each axis omits, and the bias of the derivatives due to each.

The equations of a rigid body contain (Izz − Ixx)/Iyy·p·r in pitch, (Iyy − Izz)/Ixx·q·r in roll and
(Ixx − Iyy)/Izz·p·q in yaw. Every body has Izz ≤ Ixx + Iyy, and an aircraft has Ixx and Iyy of at most Izz.
All three factors therefore have a size of at most one (Etkin & Reid, Dynamics of Flight, 1996, ch. 4). The
moments of throttle and of other controls are estimated from the residual. So are the changes of L_r, N_p and
L_β with the angle of attack, and a moment that does not grow with V².

S holds the sensitivities of the fitted outputs with respect to the parameters. s is the response to the
omitted term with the coefficient one. W is the inverse of the noise's covariance. Near the optimum the
parameters take up

    Δθ = (SᵀWS)⁻¹·SᵀW·s

for each unit of the coefficient (omitted-variable bias; Greene, Econometric Analysis, 2012, ch. 4). An
unknown coefficient is estimated from the residual, by least squares with s as an additional column. The
residual's lag-1 correlation is removed first.

The motion is ẋ = A·x + Σ θ_k·z_k with the states x from zero, and with states, controls and one as factors z.
"""

from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from math import sqrt

import numpy as np
from scipy.linalg import expm
from scipy.special import chdtri

from advisor.decision.information import OUTLIER_BELOW
from advisor.decision.verdict import Reason
from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.model.axes.lateral import CONTROLS, Trim, state_matrix
from advisor.model.short_period import ShortPeriod
from advisor.oem.axis.estimate import AxisEstimate
from advisor.oem.estimate import ChannelFit, Estimate
from advisor.oem.instruments import COUPLING
from advisor.process.arrays import FloatArray
from advisor.words.quantities import NORMAL_95, distinct_texts, symbol


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


@dataclass(frozen=True, slots=True)
class Influence:
    """Influence that a model omits, with the remedy."""

    code: str
    what: str
    cure: str
    state: str
    """State whose derivative by time has the omitted term."""
    term: FloatArray
    """Shape (n,): omitted term for a coefficient of one, 1/s²."""
    at_most_one: bool = False
    """Whether the coefficient has a size of at most one. Otherwise the residual gives the coefficient."""


@dataclass(frozen=True, slots=True)
class Bias:
    """Bias of the parameters of an estimate due to one omitted term."""

    of_one: FloatArray
    """Shape (k,): change of the parameters for a coefficient of one."""
    coefficient: float
    """Coefficient of the omitted term, estimated from the residual."""
    ratio: float
    """Coefficient of the omitted term over its standard deviation."""


def objections_to(
    influences: Collection[Influence], linear: LinearMotion, estimate: Estimate, judged: Sequence[str]
) -> Iterator[Reason]:
    """Yield a reason for each influence that biases a judged derivative beyond its 95 % interval."""
    # The statistic is the likelihood ratio of the two models, one with the term.
    least = sqrt(float(chdtri(1, OUTLIER_BELOW)))
    for influence in influences:
        bias = bias_by(influence.term, influence.state, linear, estimate)
        if bias is not None and (influence.at_most_one or abs(bias.ratio) >= least):
            moved = bias.of_one * (1.0 if influence.at_most_one else bias.coefficient)
            yield from _beyond(estimate, moved, influence, judged)


def bias_by(term: FloatArray, state: str, linear: LinearMotion, estimate: Estimate) -> Bias | None:
    """Return the bias due to an omitted term.

    Return None for a constant term, for too short a fit, and for a model whose response overflows. A fit
    needs two samples for each parameter.

    Parameters
    ----------
    term
        Shape (n,): omitted part of a state's derivative by time for a coefficient of one, 1/s².
    """
    if len(term) < 2 or not np.ptp(term) > 0.0:
        return None
    columns = linear.columns(term, state)
    if len(term) < 2 * (columns[state].shape[1] - 1):
        return None
    outputs = [(fit, columns[name]) for name, fit in estimate.fits[0].items() if name in columns]
    if not all(np.all(np.isfinite(column)) for _, column in outputs):
        return None  # The response of a fast unstable model overflows, and tells no bias.
    taken, _, _ = _regressed([_rows(fit, linear.t, column, 0.0) for fit, column in outputs])
    # Coloured residuals make a term look significant that only follows their colour.
    _, coefficient, ratio = _regressed([_rows(fit, linear.t, column, fit.lag1) for fit, column in outputs])
    return Bias(taken[: len(estimate.theta)], coefficient, ratio)


def _regressed(outputs: list[tuple[FloatArray, FloatArray]]) -> tuple[FloatArray, float, float]:
    """Return the share of the last column that the known columns explain, the column's coefficient, and this
    coefficient over its std.
    """
    rows = np.vstack([rows for rows, _ in outputs])
    residual = np.concatenate([left for _, left in outputs])
    size = np.maximum(np.linalg.norm(rows, axis=0), 1e-300)
    others, omitted = rows[:, :-1] / size[:-1], rows[:, -1] / size[-1]
    taken = np.linalg.lstsq(others, omitted, rcond=None)[0]
    rest = omitted - others @ taken
    power = max(float(rest @ rest), 1e-300)
    coefficient = float(rest @ residual) / power
    ratio = coefficient * float(np.sqrt(power)) / max(float(np.std(residual)), 1e-300)
    return taken / size[:-1] * size[-1], coefficient / float(size[-1]), ratio


def _rows(fit: ChannelFit, t: FloatArray, columns: FloatArray, lag1: float) -> tuple[FloatArray, FloatArray]:
    """Return an output's sensitivities and residual over its std, without the correlation ``lag1``."""
    at_fit = np.stack([np.interp(fit.t, t, column) for column in columns.T], axis=1)
    keep = min(max(lag1, 0.0), 0.99)
    rows, left = (both[1:] - keep * both[:-1] for both in (at_fit, fit.residual))
    spread = max(float(np.std(left)), 1e-3 * fit.noise, 1e-300)
    return rows / spread, left / spread


def _beyond(estimate: Estimate, bias: FloatArray, omitted: Influence, judged: Sequence[str]) -> list[Reason]:
    """Return a reason with the derivative whose bias exceeds its interval most; empty without one."""
    half = NORMAL_95 * estimate.std
    places = {name: estimate.names.index(name) for name in judged if name not in estimate.not_identifiable}
    share = {name: abs(float(bias[k]) / float(half[k])) for name, k in places.items() if half[k] > 0.0}
    name = max(share, key=lambda name: share[name], default="")
    if not name or share[name] <= 1.0:
        return []
    shown, most = distinct_texts(share[name], 1.0, 1)
    text = (
        f"{omitted.what} may move {symbol(name)} by {shown} times its interval (limit {most}); {omitted.cure}"
    )
    return [Reason(omitted.code, text, share[name], 1.0)]


PITCH_JUDGED = ("M_alpha", "M_q", "M_delta_e", "Z_alpha")
"""Derivatives of pitch whose bias is examined."""
SIDE_JUDGED = ("L_p", "L_delta_a", "N_beta", "N_r", "N_delta_r")
"""Derivatives whose bias is examined: those that a test of aileron or rudder determines."""


def coupled(maneuver: Maneuver, estimate: Estimate, exceeded: Collection[str] = ()) -> list[Reason]:
    """Return a reason for each omitted influence that biases a derivative of pitch beyond its 95 % interval.

    Parameters
    ----------
    exceeded
        Codes of the limits that the manoeuvre exceeds. Air speed, aileron and rudder are examined beyond
        their limits only.
    """
    linear = LinearMotion(PITCH, maneuver, estimate, estimate.fits[0]["q"].t)
    examined = {"coupling", "throttle", *exceeded} - (set() if carries_speed(estimate) else {"airspeed"})
    examined -= {"coupling"} if carries_coupling(estimate) else set()
    influences = [influence for influence in _on_pitch(linear) if influence.code in examined]
    return list(objections_to(influences, linear, estimate, PITCH_JUDGED))


def side_coupled(maneuver: Maneuver, estimate: AxisEstimate, exceeded: Collection[str]) -> list[Reason]:
    """Return a reason for each omitted influence that biases a derivative of roll or yaw beyond its 95 %
    interval.

    Parameters
    ----------
    exceeded
        Codes of the limits that the manoeuvre exceeds. Within all limits no influence is examined.
    """
    if not exceeded:
        return []
    linear = LinearMotion(SIDE, maneuver, estimate, estimate.fits[0]["p"].t)
    left_out = () if estimate.scales_with_speed else ("airspeed",)
    influences = [influence for influence in _on_the_sides(linear) if influence.code not in left_out]
    judged = [name for name in SIDE_JUDGED if SIDE.controls.get(name[2:], "") in ("", *estimate.flown)]
    return list(objections_to(influences, linear, estimate, judged))


def _on_pitch(linear: LinearMotion) -> Iterator[Influence]:
    p, r = linear.measured("p"), linear.measured("r")
    if p is not None and r is not None:
        cure = "let roll and yaw die down before the first step"
        yield Influence("coupling", "rolling and yawing", cure, "q", p * r, True)
    yield from _by_speed(linear, "q")
    cures = {"throttle": "leave the throttle where it is"}
    for control in ("throttle", "aileron", "rudder"):
        moved = linear.measured(control)
        if moved is not None:
            cure = cures.get(control, f"use less {control}")
            yield Influence(control, f"the {control}'s pitching moment", cure, "q", moved)


def _on_the_sides(linear: LinearMotion) -> Iterator[Influence]:
    q, alpha = (_deviation(linear.measured(name)) for name in ("q", "alpha"))
    if q is not None:
        for state, rate in (("p", "r"), ("r", "p")):
            term = q * linear.states[rate]
            yield Influence("coupling", "pitching with rolling", "hold the nose still", state, term, True)
    if alpha is not None:
        for state, factor in (("p", "r"), ("r", "p"), ("p", "beta")):
            term = alpha * linear.states[factor]
            yield Influence("alpha", "the changing angle of attack", "keep the nose where it is", state, term)
    yield from _by_speed(linear, "p", "r")


def _by_speed(linear: LinearMotion, *states: str) -> Iterator[Influence]:
    """Yield the moments that do not grow with V²."""
    speed = linear.measured("airspeed")
    if speed is not None:
        growth = speed / float(np.mean(speed)) - 1.0
        for state in states:
            cure = "smaller steps, from steady speed"
            yield Influence("airspeed", "the changing air speed", cure, state, growth * linear.change(state))


def _deviation(y: FloatArray | None) -> FloatArray | None:
    return None if y is None else np.asarray(y - np.mean(y))


def has_banking(maneuver: Maneuver) -> bool:
    """Return whether a record contains all channels by which a bank changes the motion in pitch."""
    return {"p", "r", "bank", "beta", "theta"} <= maneuver.channels.keys()


def carries_coupling(estimate: Estimate) -> bool:
    """Return whether the model of an estimate contains the moment of rolling with yawing."""
    return estimate.found is not None and COUPLING.name in estimate.found.names


def carries_speed(estimate: Estimate) -> bool:
    """Return whether the derivatives of an estimate grow with the measured air speed."""
    return estimate.airspeed_m_s is not None
