"""Expected errors of a standard manoeuvre at given rates, from the model's sensitivities.

Nothing is simulated with noise. A measurement's information follows from its sensitivity to each parameter
(Cramér-Rao). A sampled command adds an uncertainty, because the edges of the input lie between two samples.
The delays and places of instruments and the servo's lag are estimated with the derivatives, as in flight. The
flown manoeuvres give the amplitude and the noise. Their own errors, as the estimator computes them, are the
expected errors at the log's rates. The sensitivities tell how other rates change these errors.

Amplitude, noise, lag and errors of the assumed aircraft come from flown manoeuvres. A joint estimate's errors
also contain the scatter between the manoeuvres. Noise and errors therefore come from the manoeuvres' own
estimates, which contain the colour of the noise, the uncertain instruments and moving air.
"""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from advisor.aircraft.aircraft import Aircraft
from advisor.aircraft.reference import PARAMETERS
from advisor.campaign.joint_estimate import NEWEST
from advisor.decision.envelope import flown as flown_values
from advisor.decision.first_unit import frequency, matched_unit_s
from advisor.decision.prediction import foresee, local_at_trim, response_from_trim, shared_of, unmeasured
from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.model.outputs import OUTPUTS
from advisor.model.short_period import ShortPeriod
from advisor.oem.estimate import Estimate
from advisor.oem.estimator import estimate, estimate_jointly
from advisor.oem.extra import Prior
from advisor.oem.instruments import SERVO_LAG, USUAL_LAG, Instrument, extra_of, unknown_instruments
from advisor.oem.prepare import OUTPUTS as COUNTED
from advisor.oem.prior import precision_without_alpha
from advisor.oem.problem import OutputErrorProblem, Record, assemble
from advisor.oem.rows import Signal
from advisor.oem.surface import Servo
from advisor.process.arrays import FloatArray

UNITS_OF_TIME = (3, 2, 1, 1)
RESPONSE_ALPHA_DEG = 4.0
"""Largest change of the angle of attack by the expected input, deg. The change is above the noise and below
the stall.
"""
NOISE = {"alpha": np.radians(0.2), "q": np.radians(0.2), "a_z": 0.3, "theta": np.radians(0.1)}
"""Noise that is assumed without a measurement, rad, rad/s, m/s², rad. The values are typical of small
autopilots in calm air.
"""

_LEAD_IN_S = 1.0
_EDGES_S = (0.04, 0.05, 0.06, 0.07, 0.08)
"""Times that a pilot's hand needs for a step of the stick, s."""
_SHIFT_S = 2e-3

TYPICAL = ShortPeriod.from_mapping(
    {"Z_alpha": -4.0, "Z_delta_e": -0.3, "M_alpha": -40.0, "M_q": -4.0, "M_delta_e": -45.0}
)
"""Model of a fixed-wing aircraft of about 10 kg at 25 m/s, assumed where no other model is known: 7.5 rad/s,
damping 0.5."""


@dataclass(frozen=True, slots=True)
class Assumed:
    """Assumed model and noise for the expected errors."""

    model: ShortPeriod
    noise: Mapping[str, float]
    """Standard deviation of each output's measurement noise, SI, keys as in ``NOISE``."""
    source: str
    """Source of the model and the noise, in words."""
    flown_std: FloatArray | None = None
    """Standard deviations of a single manoeuvre of ``amplitude_deg``, shape (8,), from the flown manoeuvres'
    own estimates. None before the first one."""
    colour: FloatArray = field(default_factory=lambda: np.ones(len(PARAMETERS)))
    """Ratio of a single manoeuvre's errors to its Cramér-Rao bounds, shape (8,); 1 for white residuals."""
    amplitude_deg: float | None = None
    """Elevator amplitude of the flown manoeuvres on either side of trim, deg; None before the first one."""
    lag_s: float | None = None
    """Servo's lag of the flown manoeuvres, s; None before the first one."""
    aircraft: Aircraft = field(default_factory=Aircraft)
    """The crew's aircraft file, which may state the servo's lag and the vane's place."""


@dataclass(frozen=True, slots=True)
class ExpectedErrors:
    """Expected errors from one standard 3-2-1-1."""

    std: Mapping[str, float]
    """Expected standard deviation, by parameter name; NaN if these rates do not identify the parameter."""
    unit_s: float
    """One unit of time of the manoeuvre, s."""
    amplitude_deg: float
    """Elevator amplitude on either side of trim, deg."""


def expect(assumed: Assumed, rates_hz: Mapping[str, float], airspeed_m_s: float | None) -> ExpectedErrors:
    """Return the expected errors of a 3-2-1-1 matched to the aircraft.

    Parameters
    ----------
    rates_hz
        Rates of new values of ``elevator``, ``q`` and, where measured, ``alpha`` and ``a_z``.
    airspeed_m_s
        Air speed for the specific force a_z, m/s. None if it is not measured; then a_z is not used.
    """
    model = assumed.model
    unit_s = matched_unit_s(model)
    edges = _LEAD_IN_S + unit_s * np.cumsum([0, *UNITS_OF_TIME])
    end_s = float(edges[-1]) + max(2.0, 10.0 * unit_s)
    outputs = [name for name in COUNTED if name in rates_hz and (name != "a_z" or airspeed_m_s)]
    both = ["alpha", "q"]
    rates = {"alpha": rates_hz["q"], **rates_hz}
    shape = assemble(_problem(edges, 1.0, end_s, rates, both, airspeed_m_s))
    unit_response = response_from_trim(_about_trim(model), shape)
    if unit_response is None:
        return ExpectedErrors(dict.fromkeys(PARAMETERS, np.nan), unit_s, np.nan)
    if assumed.amplitude_deg is not None:
        amplitude = float(np.radians(assumed.amplitude_deg))
    else:
        largest = float(np.max(np.abs(unit_response[shape.rows[0]["alpha"]])))
        amplitude = np.radians(RESPONSE_ALPHA_DEG) / largest
    std = assumed.colour * _errors(assumed, edges, amplitude, end_s, rates_hz, outputs, airspeed_m_s)
    return ExpectedErrors(
        dict(zip(PARAMETERS, std.tolist(), strict=True)), unit_s, float(np.degrees(amplitude))
    )


def at_log_rates(assumed: Assumed, rates_hz: Mapping[str, float], airspeed_m_s: float | None) -> Assumed:
    """Return the assumptions with the ratio of the flown errors to the Cramér-Rao bounds at a log's rates."""
    if assumed.flown_std is None:
        return assumed
    bounds = expect(assumed, rates_hz, airspeed_m_s).std
    ratio = assumed.flown_std / np.array([bounds[name] for name in PARAMETERS])
    return replace(assumed, colour=np.where(np.isfinite(ratio), ratio, 1.0))


def _about_trim(model: ShortPeriod) -> FloatArray:
    """Return the parameters (8,) about trim, where both constants are zero."""
    return np.where(np.isin(PARAMETERS, ("Z_0", "M_0")), 0.0, model.theta)


def _errors(
    assumed: Assumed,
    edges: FloatArray,
    amplitude: float,
    end_s: float,
    rates_hz: Mapping[str, float],
    outputs: list[str],
    airspeed_m_s: float | None,
) -> FloatArray:
    theta = _about_trim(assumed.model)
    known_s = (assumed.aircraft.elevator.lag_s, assumed.lag_s, USUAL_LAG.mean)
    servo = Servo(next(lag_s for lag_s in known_s if lag_s is not None))

    def problem(at: FloatArray) -> OutputErrorProblem:
        return _problem(at, amplitude, end_s, rates_hz, outputs, airspeed_m_s, servo)

    laid = assemble(problem(edges))
    local = local_at_trim(theta, laid)
    names = list(_estimated(unknown_instruments(problem(edges), assumed.aircraft)))
    shifts = _SHIFT_S * np.eye(len(edges))
    ends = [response_from_trim(theta, assemble(problem(edges + s))) for s in (*shifts, *-shifts)]
    if local is None or any(end is None for end in ends):
        return np.full(len(PARAMETERS), np.nan)
    extra = extra_of(problem(edges), laid, shared_of(theta), local, names)
    noise = np.array([assumed.noise.get(name, NOISE[name]) for name in OUTPUTS])
    prior = None if "alpha" in outputs else precision_without_alpha(shared_of(theta))
    expected = foresee(theta, laid, noise, prior, extra)
    if expected is None:
        return np.full(len(PARAMETERS), np.nan)
    early, late = np.array(ends[len(edges) :]), np.array(ends[: len(edges)])
    moved = (late - early) @ expected.influence / (2.0 * _SHIFT_S)
    covariance = expected.covariance + edge_error_s(rates_hz["elevator"]) ** 2 * moved.T @ moved
    result: FloatArray = np.sqrt(np.diag(covariance))
    return result


def _estimated(unknown: Iterable[Instrument]) -> Iterator[Instrument]:
    """Yield the instruments that an estimate has as parameters. A stated lag is taken as known to a tenth of
    its value, and all other stated values as exact.
    """
    for x in unknown:
        if x.stated is None:
            yield x
        elif x.name == SERVO_LAG.name and x.stated > 0.0:
            yield replace(x, prior=Prior(x.stated, x.known_to * x.stated))


def edge_error_s(rate_hz: float) -> float:
    """Return the root mean square timing error of a command's edge after sampling and linear interpolation.

    The mean covers edges of several lengths and all positions of the samples. The error is the area between
    the edge and the lines, divided by the edge's height.
    """
    interval_s = 1.0 / rate_hz
    errors = []
    for edge_s in _EDGES_S:
        reach = np.ceil(edge_s / interval_s) + 1.0
        t = np.linspace(-reach * interval_s, edge_s + reach * interval_s, 2001)
        ramp = np.clip(t / edge_s, 0.0, 1.0)
        for phase in (np.arange(20) + 0.5) / 20:
            samples = (np.arange(-reach - 1.0, 2.0 * reach + 1.0) + phase) * interval_s
            joined = np.interp(t, samples, np.clip(samples / edge_s, 0.0, 1.0))
            errors.append(np.trapezoid(joined - ramp, t))
    return float(np.sqrt(np.mean(np.square(errors))))


def _problem(
    edges: FloatArray,
    amplitude: float,
    end_s: float,
    rates_hz: Mapping[str, float],
    outputs: list[str],
    airspeed_m_s: float | None,
    servo: Servo | None = None,
) -> OutputErrorProblem:
    """Return the manoeuvre in the estimator's form, with every output at its own stamps."""
    levels = amplitude * np.array([0.0, -1.0, 1.0, -1.0, 1.0, 0.0])
    half = float(np.median(_EDGES_S)) / 2.0
    corners = np.repeat(edges, 2) + np.tile([-half, half], len(edges))
    command = Signal(
        np.concatenate([[0.0], corners, [end_s]]), np.concatenate([[0.0], np.repeat(levels, 2)[1:-1], [0.0]])
    )
    measured = {name: unmeasured(end_s, 1.0 / rates_hz[name]) for name in outputs}
    speed = None if airspeed_m_s is None else Signal(np.array([0.0, end_s]), np.full(2, airspeed_m_s))
    record = Record(elevator=command, outputs=measured, airspeed=speed)
    return OutputErrorProblem(records=(record,), servo=servo or Servo())


_PLAUSIBLE_RAD_S = (0.5, 40.0)
_EXPLAINED = 0.5
_KNOWN_SHARE = 0.3
_LEAST_EFFECT = 0.02  # of M_delta_e beside the square of the natural frequency


def assumed_of(maneuvers: Sequence[Maneuver], aircraft: Aircraft) -> Assumed:
    """Return the assumed aircraft and noise, from the file's model, the flown manoeuvres, or typical
    values.
    """
    flown = estimate_jointly(maneuvers, aircraft) if maneuvers else None
    seen = Assumed(TYPICAL, NOISE, "a typical aircraft of 10 kg (yours: model in the aircraft file)")
    seen = replace(seen, aircraft=aircraft)
    if isinstance(flown, Estimate):
        seen = as_flown(seen, maneuvers, flown)
    if {"Z_alpha", "M_alpha", "M_q", "M_delta_e"} <= aircraft.model.keys():
        model = ShortPeriod.from_mapping(aircraft.model)
        return replace(seen, model=model, source="the model in the aircraft file")
    if isinstance(flown, Estimate) and is_believable(flown):
        number = len(maneuvers)
        source = f"an estimate from {number} manoeuvre{'s' if number > 1 else ''} flown"
        return replace(seen, model=ShortPeriod(flown.theta), source=source)
    return seen


def as_flown(assumed: Assumed, maneuvers: Sequence[Maneuver], joint: Estimate) -> Assumed:
    """Return the assumptions with amplitude, noise, lag and errors of the flown manoeuvres.

    Parameters
    ----------
    maneuvers
        Manoeuvres in the order flown, at least one.
    joint
        Joint estimate of the manoeuvres, which determines the servo's lag best.
    """
    newest = maneuvers[-NEWEST:]
    singles = [(m, alone) for m in newest if isinstance(alone := estimate(m, assumed.aircraft), Estimate)]
    singles = singles or [(newest[-1], joint)]
    fits = [single.fits[0] for _, single in singles]
    noise = {name: _median([fit[name].noise for fit in fits if name in fit]) for name in fits[-1]}
    amplitudes = [0.5 * float(np.degrees(np.ptp(flown_values(m, "elevator")))) for m, _ in singles]
    amplitude = _median(amplitudes)
    # Errors fall with the amplitude.
    shares = np.array(amplitudes)[:, None] / amplitude
    return replace(
        assumed,
        noise=NOISE | noise,
        amplitude_deg=amplitude,
        lag_s=joint.servo_lag_s,
        flown_std=np.median(shares * np.array([single.std for _, single in singles]), axis=0),
    )


def is_believable(flown: Estimate) -> bool:
    """Return whether an estimate may represent the aircraft. It must explain the motion, and M_α and the
    control derivative must be significant.
    """
    low, high = _PLAUSIBLE_RAD_S
    pace = frequency(ShortPeriod(flown.theta))
    moved = low < pace < high and abs(flown.value("M_delta_e")) > _LEAST_EFFECT * pace**2
    explained = all(fit.r2 > _EXPLAINED for fits in flown.fits for fit in fits.values())
    judged = [PARAMETERS.index(name) for name in ("M_alpha", "M_delta_e")]
    sharp = bool(np.all(flown.std[judged] < _KNOWN_SHARE * np.abs(flown.theta[judged])))
    return moved and explained and sharp and not {"M_alpha", "M_delta_e"} & flown.not_identifiable.keys()


def _median(values: Sequence[float]) -> float:
    return float(np.median(values))
