"""Predicted response to the campaign's own inputs, with its uncertainty, its tolerance, and the errors of an
input.

The response from trim, Eqs. (1)-(2), depends on the six derivatives common to all manoeuvres. Trims and
initial states belong to each manoeuvre and are not used. The derivatives' covariance and the exact
sensitivities of the response give the 95 % band (delta method).
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from advisor.aircraft.aircraft import CampaignPlan
from advisor.aircraft.reference import PARAMETERS, SPEED_EXPONENTS
from advisor.decision.history import CandidateManeuver
from advisor.decision.pooling import DERIVATIVES
from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.model.outputs import LOCAL, N_LOCAL, N_PARAMETERS, SHARED
from advisor.model.response import respond
from advisor.model.short_period import ShortPeriod
from advisor.oem.covariance import cramer_rao, influence
from advisor.oem.estimate import Estimate
from advisor.oem.extra import Extra
from advisor.oem.prediction import half_widths
from advisor.oem.problem import Assembly, OutputErrorProblem, Record, assemble
from advisor.oem.rows import Signal
from advisor.oem.surface import Servo
from advisor.process.arrays import FloatArray

PREDICTED = ("alpha", "q", "a_z")
"""Outputs whose prediction is judged, if measured. The pitch angle follows from q."""
MOMENTS = 200
"""Number of times at which responses are compared: 50 ms apart in a record of 10 s."""
MOST_INPUTS = 12
"""Number of the newest manoeuvres that represent all manoeuvres. Crews repeat inputs, so a limit loses little
and keeps long campaigns fast."""
_REMEMBERED = 512
"""Number of cached responses, 30 kB each."""
_SPEED_POWER = np.array([SPEED_EXPONENTS[PARAMETERS[k]] for k in DERIVATIVES], dtype=float)


class Response(NamedTuple):
    """Response from trim to one input."""

    values: FloatArray
    """Shape (3, n): α in rad, q in rad/s, and a_z over the air speed in 1/s, in the order of
    ``PREDICTED``."""
    slopes: FloatArray
    """Shape (3, n, 6): derivative of each output with respect to each of ``DERIVATIVES``."""
    after_s: FloatArray
    """Shape (n,): times in s after the first stamp of the elevator."""

    @property
    def peak(self) -> FloatArray:
        """Shape (3,): largest deviation of each output from trim."""
        return np.asarray(np.max(np.abs(self.values), axis=1))


@dataclass(frozen=True)
class Prediction:
    """Predicted response of one model to several inputs."""

    slopes: Mapping[str, FloatArray]
    """Shape (n, 6) for each output: change with each derivative in percent of its peak, at all times of all
    inputs. The change is NaN for a diverging model."""

    def percent(self, covariance: FloatArray) -> Mapping[str, float]:
        """Return the largest half-width of the 95 % band, in percent of the peak, for each output.

        Parameters
        ----------
        covariance
            Shape (6, 6): covariance of ``DERIVATIVES``, infinite on the diagonal for an unknown derivative.
            The band of an output that depends on an unknown derivative is infinite.
        """
        finite = np.isfinite(np.diag(covariance))
        inside = np.where(np.outer(finite, finite), covariance, 0.0)
        return {name: _widest(slope, inside, finite) for name, slope in self.slopes.items()}

    @property
    def percent_by_derivative(self) -> FloatArray:
        """Shape (6,): largest change of any output with each derivative, in percent of its peak per unit.

        NaN for an unknown input or a diverging model.
        """
        if not self.slopes:
            return np.full(len(DERIVATIVES), np.nan)
        return np.asarray(np.max([np.max(np.abs(slope), axis=0) for slope in self.slopes.values()], axis=0))


def _widest(slope: FloatArray, covariance: FloatArray, finite: np.ndarray) -> float:
    if not np.all(np.isfinite(slope)) or np.any(slope[:, ~finite]):
        return float("inf")
    return float(np.max(half_widths(slope, covariance), initial=0.0))


def predict(
    flown: Sequence[CandidateManeuver], derivatives: FloatArray, airspeed_m_s: float | None
) -> Prediction:
    """Return the response to the flown inputs, without outputs for unknown inputs.

    Parameters
    ----------
    derivatives
        Shape (6,): derivatives in the order of ``DERIVATIVES``.
    airspeed_m_s
        Air speed of the derivatives, m/s. None for each manoeuvre's own air speed.
    """
    slopes: dict[str, list[FloatArray]] = {}
    for candidate in flown[-MOST_INPUTS:]:
        response = response_to(candidate, derivatives, airspeed_m_s)
        for name in measured(candidate) if candidate.maneuver is not None else ():
            slopes.setdefault(name, []).append(_relative(response, PREDICTED.index(name)))
    return Prediction({name: np.concatenate(parts) for name, parts in slopes.items()})


def _relative(response: Response | None, k: int) -> FloatArray:
    if response is None or not response.peak[k] > 0.0:
        return np.full((1, len(DERIVATIVES)), np.nan)
    return np.asarray(100.0 * response.slopes[k] / response.peak[k])


def missed_percent(
    flown: CandidateManeuver, predicted: FloatArray, estimated: FloatArray, airspeed_m_s: float | None
) -> float:
    """Return the largest distance between the predicted and the estimated response to a manoeuvre, in percent
    of its peak.

    Parameters
    ----------
    predicted, found
        Shape (6,): derivatives from the earlier manoeuvres and from the manoeuvre itself, at
        ``airspeed_m_s``.

    Returns
    -------
    float
        Largest distance over all outputs. NaN for an unknown input or a diverging model.
    """
    expected = response_to(flown, predicted, airspeed_m_s)
    actual = response_to(flown, estimated, airspeed_m_s)
    if expected is None or actual is None:
        return float("nan")
    apart = np.max(np.abs(expected.values - actual.values), axis=1)
    used = [PREDICTED.index(name) for name in measured(flown)]
    with np.errstate(divide="ignore", invalid="ignore"):
        return float(np.max(100.0 * apart[used] / actual.peak[used], initial=-np.inf))


def measured(flown: CandidateManeuver) -> tuple[str, ...]:
    """Return the outputs of ``PREDICTED`` in a manoeuvre's estimate."""
    fits = flown.estimate.fits[0] if isinstance(flown.estimate, Estimate) else {}
    return tuple(name for name in PREDICTED if name in fits)


def response_to(
    flown: CandidateManeuver, derivatives: FloatArray, airspeed_m_s: float | None
) -> Response | None:
    """Return the response from trim to a manoeuvre's input at the manoeuvre's speed.

    The slopes are with respect to the derivatives at ``airspeed_m_s``. None for an unknown input or
    derivative, or for a diverging model.
    """
    if flown.maneuver is None or not np.all(np.isfinite(derivatives)):
        return None
    elevator = flown.maneuver.channels["elevator"]
    heard = np.isfinite(elevator.y)
    stamps, moved = elevator.t[heard], elevator.y[heard] - trim_of(flown.maneuver)
    scale = np.ones(len(DERIVATIVES))
    speed = airspeed_in(flown.maneuver)
    if speed is not None and airspeed_m_s is not None:
        scale = (speed / airspeed_m_s) ** _SPEED_POWER
    response = _respond(
        np.asarray(stamps - stamps[0], float).tobytes(),
        np.asarray(moved, float).tobytes(),
        flown.servo,
        tuple((derivatives * scale).tolist()),
    )
    return None if response is None else response._replace(slopes=response.slopes * scale)


def trim_of(maneuver: Maneuver) -> float:
    """Return the elevator deflection before the first step, rad."""
    elevator, span = maneuver.channels["elevator"], maneuver.span
    lead = elevator.cut(span.record_from_s, span.start_s)
    return float(np.nanmedian(lead.y if len(lead) else elevator.y[:1]))


def airspeed_in(maneuver: Maneuver) -> float | None:
    """Return the mean air speed of a manoeuvre, m/s; None without a measurement."""
    channel = maneuver.channels.get("airspeed")
    speed = float(np.nanmean(channel.y)) if channel is not None and np.any(np.isfinite(channel.y)) else 0.0
    return speed if speed > 0.0 else None


def _horizon(command: Signal, derivatives: tuple[float, ...]) -> float:
    """Return the length of time over which a response is compared, s."""
    # A pilot corrects an unstable aircraft within the time in which a deviation doubles.
    z_alpha, z_q, _, m_alpha, m_q, _ = derivatives
    trace, determinant = z_alpha + m_q, z_alpha * m_q - (1.0 + z_q) * m_alpha
    growth = 0.5 * (trace + np.sqrt(max(trace**2 - 4.0 * determinant, 0.0)))
    if growth <= 0.0:
        return float(command.t[-1])
    size = np.abs(command.y)
    onset = command.t[np.argmax(size >= 0.5 * np.max(size))]
    return float(min(command.t[-1], onset + np.log(2.0) / growth))


@lru_cache(maxsize=_REMEMBERED)
def _respond(t: bytes, elevator: bytes, servo: Servo, derivatives: tuple[float, ...]) -> Response | None:
    """Return the response to an elevator command, given as bytes so that results can be cached."""
    command = Signal(np.frombuffer(t), np.frombuffer(elevator))
    moments = np.linspace(command.t[0], _horizon(command, derivatives), MOMENTS)
    still = Signal(moments, np.zeros(MOMENTS))
    record = Record(command, dict.fromkeys(PREDICTED, still), gravity_z=still)
    assembly = assemble(OutputErrorProblem((record,), servo=servo))
    y, g = np.empty(len(assembly.z)), np.empty((len(assembly.z), N_PARAMETERS))
    shared = np.array([*derivatives, *np.zeros(len(SHARED) - len(derivatives))])
    if not respond(assembly.grid, shared, np.zeros((1, N_LOCAL)), y, g):
        return None
    rows = [assembly.rows[0][name] for name in PREDICTED]
    # The columns of the shared parameters stand first, in the order of DERIVATIVES.
    return Response(
        np.array([y[r] for r in rows]),
        np.array([g[r, : len(DERIVATIVES)] for r in rows]),
        moments - command.t[0],
    )


UNMEASURED = 1e3
"""Noise of an unmeasured angle of attack, rad. With this noise α adds no information."""


@dataclass(frozen=True, slots=True)
class Instruments:
    """Sampling and noise of the outputs, and the servo between stick and surface."""

    step_s: tuple[float, float]
    """Time between samples of α and of q, s."""
    noise: tuple[float, float]
    """Standard deviations of the noise of α in rad and of q in rad/s."""
    servo: Servo
    specific_force: tuple[float, float] | None = None
    """Time between samples of a_z in s, and the noise of a_z divided by the air speed in 1/s. None if a_z is
    not used."""


@dataclass(frozen=True, slots=True)
class Expectation:
    """Expected errors and excursion of a manoeuvre."""

    covariance: FloatArray
    """Shape (8, 8): Cramér-Rao bound, in the order of ``PARAMETERS``."""
    alpha_excursion: float
    """Largest deviation of α from its initial value, rad."""
    influence: FloatArray
    """Shape (n, 8): change of the estimate with each sample."""

    @property
    def std(self) -> FloatArray:
        """Shape (8,): expected standard deviations."""
        return np.sqrt(np.diag(self.covariance))


def expect(theta: FloatArray, elevator: Signal, instruments: Instruments) -> Expectation | None:
    """Return the expected errors of the eight parameters from one manoeuvre with this elevator.

    Parameters
    ----------
    theta
        Shape (8,): present estimate of the aircraft.
    elevator
        Elevator command including trim; the record begins in the model's equilibrium.

    Returns
    -------
    Expectation or None
        None if the input cannot separate the parameters, or the model diverges.
    """
    steps = dict(zip(("alpha", "q"), instruments.step_s, strict=True))
    if instruments.specific_force is not None:
        steps["a_z"] = instruments.specific_force[0]
    outputs = {name: unmeasured(float(elevator.t[-1]), step) for name, step in steps.items()}
    problem = OutputErrorProblem(
        (Record(elevator, outputs),), servo=instruments.servo, airspeed_may_be_off=False
    )
    force = instruments.specific_force[1] if instruments.specific_force else 0.0
    return foresee(theta, assemble(problem), np.array([*instruments.noise, force, 0.0]))


def unmeasured(end_s: float, step_s: float) -> Signal:
    """Return stamps and zero values for an output of an input that is not flown yet."""
    t = np.arange(0.0, end_s, step_s)
    return Signal(t, np.zeros_like(t))


def foresee(
    theta: FloatArray,
    assembly: Assembly,
    noise: FloatArray,
    prior: FloatArray | None = None,
    extra: Extra | None = None,
) -> Expectation | None:
    """Return the expected errors of one manoeuvre at the stamps of an assembly.

    Parameters
    ----------
    theta
        Shape (8,): model of the aircraft.
    noise
        Shape (4,): standard deviation of each output's noise.
    prior
        Precision of the parameters before the flight, as in :func:`advisor.oem.covariance.influence`.
    extra
        Additional estimated parameters, such as a servo's lag.

    Returns
    -------
    Expectation or None
        None if the input cannot separate the parameters, or the model diverges.
    """
    sensitivities = np.empty((len(assembly.z), N_PARAMETERS))
    y = response_from_trim(theta, assembly, sensitivities)
    effect = None if y is None else influence(assembly, sensitivities, noise, extra, prior)
    if y is None or effect is None:
        return None
    alpha = y[assembly.rows[0]["alpha"]] if "alpha" in assembly.rows[0] else np.zeros(1)
    excursion = float(np.max(np.abs(alpha - alpha[0])))
    effect = effect.first(len(theta))
    covariance = cramer_rao(assembly, effect.rows, noise) + effect.prior_covariance
    return Expectation(covariance, excursion, effect.rows)


def response_from_trim(
    theta: FloatArray, assembly: Assembly, sensitivities: FloatArray | None = None
) -> FloatArray | None:
    """Return the outputs (n,) of one manoeuvre that begins in equilibrium; None for a diverging model.

    Parameters
    ----------
    sensitivities
        Array (n, N_PARAMETERS) that receives the sensitivities. None if sensitivities are not needed.
    """
    local = local_at_trim(theta, assembly)
    if local is None:
        return None
    y = np.empty(len(assembly.z))
    wanted = np.empty((0, N_PARAMETERS)) if sensitivities is None else sensitivities
    return y if respond(assembly.grid, shared_of(theta), local, y, wanted) else None


def local_at_trim(theta: FloatArray, assembly: Assembly) -> FloatArray | None:
    """Return the local parameters (1, N_LOCAL) of a manoeuvre that begins in equilibrium; else None."""
    model = ShortPeriod(theta)
    try:
        begin = -np.linalg.solve(model.a, model.b * assembly.grid.elevator[0] + model.c)
    except np.linalg.LinAlgError:
        return None
    local = np.zeros((1, N_LOCAL))
    for name, value in zip(("Z_0", "M_0", "alpha_initial", "q_initial"), (*model.c, *begin), strict=True):
        local[0, LOCAL.index(name)] = value
    return local


def shared_of(theta: FloatArray) -> FloatArray:
    """Return the parameters that manoeuvres share, in the order of ``SHARED``, with zero for instruments."""
    return np.array([theta[PARAMETERS.index(s)] if s in PARAMETERS else 0.0 for s in SHARED])


NEAR_ZERO = 3.0
"""Multiple of the prediction's tolerance below which a derivative's whole effect is near zero."""

SHARE = 2.0
"""Tolerance of a derivative as a multiple of the prediction's tolerance.

An error of 5 to 9 % in M_alpha alone moves the response by 5 % of its peak; in Z_alpha, 7 to 13 %. The
percentages are from three flights of a real autopilot and from a research jet. The frequency changes with
the square root of the stiffness. M_delta_e scales the whole response, so the prediction's band limits its
error more strictly.
"""
LEAST = 1e-12
"""Least tolerance, in any unit. Data without noise would otherwise give a tolerance of zero."""


def tolerances(theta: FloatArray, prediction: Prediction, plan: CampaignPlan) -> FloatArray:
    """Return the tolerance for each parameter's 95 % half-width.

    The tolerance is the larger of two numbers. The first number is ``SHARE`` times ``plan.tolerance_percent``
    of the parameter. The second is the change that alters the short period's frequency or damping by
    ``plan.tolerance_percent``. For a derivative near zero, a share of its value would be smaller than any
    relevant change. Near zero the tolerance is δ, the change that alone moves the response by its tolerance.
    δ fades linearly up to 3·δ. An entry of ``plan.tolerance`` replaces the computed tolerance. Noise is not
    included, because a bad manoeuvre must not widen a tolerance.

    Returns
    -------
    FloatArray
        Shape (8,): tolerance in each parameter's unit. The tolerance is infinite for a derivative without
        effect on the response.
    """
    size = np.abs(theta)
    tolerance: FloatArray = 0.01 * plan.tolerance_percent * SHARE * size
    for name, change in _moving_the_short_period(theta).items():
        k = PARAMETERS.index(name)
        tolerance[k] = np.fmax(tolerance[k], 0.01 * plan.tolerance_percent * change)
    inside = list(DERIVATIVES)
    with np.errstate(divide="ignore"):
        enough = plan.tolerance_percent / prediction.percent_by_derivative
    tolerance[inside] = np.fmax(tolerance[inside], enough - size[inside] / NEAR_ZERO)
    tolerance = np.fmax(tolerance, LEAST)
    for name, value in plan.tolerance.items():
        tolerance[PARAMETERS.index(name)] = value
    return tolerance


def _moving_the_short_period(theta: FloatArray) -> Mapping[str, float]:
    """Return the change of each derivative for a relative change of 1 in frequency or damping."""
    # ω² = Z_α·M_q - (1 + Z_q)·M_α and 2·ζ·ω = -(Z_α + M_q).
    z_alpha, z_q, m_alpha, m_q = (theta[PARAMETERS.index(n)] for n in ("Z_alpha", "Z_q", "M_alpha", "M_q"))
    damping = abs(z_alpha + m_q)
    stiffness = abs(z_alpha * m_q - (1.0 + z_q) * m_alpha)
    return {"Z_alpha": damping, "M_q": damping, "M_alpha": 2.0 * stiffness}
