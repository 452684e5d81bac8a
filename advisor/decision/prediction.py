"""Predicted response to the campaign's own inputs, with its uncertainty.

The response from trim, Eqs. (1)-(2), depends on the six derivatives common to all manoeuvres. Trims and
initial states belong to each manoeuvre and are not used. The derivatives' covariance and the exact
sensitivities of the response give the 95 % band (delta method).
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from advisor.aircraft.reference import PARAMETERS, SPEED_EXPONENTS
from advisor.decision.history import CandidateManeuver
from advisor.decision.pooling import DERIVATIVES
from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.model.outputs import N_LOCAL, N_PARAMETERS, SHARED
from advisor.model.response import respond
from advisor.oem.estimate import Estimate
from advisor.oem.prediction import half_widths
from advisor.oem.problem import OutputErrorProblem, Record, assemble
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
