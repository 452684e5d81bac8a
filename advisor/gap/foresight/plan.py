"""A planned flight: manoeuvres made from the aircraft file, to foresee which effects they can show."""

from collections.abc import Sequence

import numpy as np

from advisor.aircraft.aircraft import Aircraft
from advisor.aircraft.reference import PARAMETERS
from advisor.flight.maneuvers.maneuver import Maneuver, Span
from advisor.flight.signals.record import Channel
from advisor.gap.candidates.catalogue import variants_for
from advisor.gap.candidates.known import base_entries, beyond_known, with_known
from advisor.gap.effects import EFFECTS
from advisor.gap.fitting.fit import EffectFit
from advisor.gap.fitting.linear import linearise
from advisor.gap.fitting.problem import EffectProblem, SearchPoint
from advisor.gap.fitting.step import solve_blocks
from advisor.gap.foresight.foresee import Foreseen, foresee
from advisor.gap.foresight.foresee_outside_fit import foresee_air, foresee_offset, impossible, speed_signature
from advisor.gap.foresight.signatures import Signatures
from advisor.gap.records.flights import PreparedManeuvers
from advisor.gap.records.prepare import prepare
from advisor.gap.records.usable import LEAST_SAMPLES
from advisor.gap.search.baseline import everywhere, prior_derivatives, with_telemetry
from advisor.gap.simulator.layout import NUISANCES, OUTPUTS, natural_frequency
from advisor.process.arrays import FloatArray
from advisor.words.problems import ConfigurationError

STEPS = {
    "3211": ((3, -0.8), (2, 1.2), (1, -1.1), (1, 1.1)),
    "rev": ((3, 0.8), (2, -1.2), (1, 1.1), (1, -1.1)),
    "doublet": ((1, -1.0), (1, 1.0)),
    "pulse": ((1, -1.0),),
}
"""Numerical: steps of each input, as pairs of time units and share of the amplitude with trailing edge down.
The steps of every input but a pulse sum to zero area, so that the aircraft returns to trim. The first step of
a ``3211`` raises the nose."""
TYPICAL_NOISE = {"alpha": np.radians(0.1), "q": np.radians(0.2), "a_z": 0.1, "theta": np.radians(0.1)}
"""Prior: standard deviations assumed for unmeasured instruments, in SI units of the channel."""
SPARED = ("alpha", "a_z", "theta", "airspeed", "climb_rate", "throttle")
"""Channels that a planned flight may lack."""
_IN_FILE = "this effect is in the aircraft file, and its values are used unchanged"
"""Remark about an effect whose shape in the aircraft file is used as stated."""
_SPACING_S = 30.0
"""Numerical: time between two manoeuvres of a plan, s."""
_HIGHEST_RATE_HZ, _LARGEST_STEP_DEG = 1000.0, 60.0
"""Record: highest rate of any telemetry, Hz, and largest deflection of any elevator, deg."""


def foresee_plan(
    aircraft: Aircraft, plan: Sequence[str], rate_hz: float, amplitude_deg: float, without: Sequence[str] = ()
) -> list[Foreseen]:
    """Return for every effect the smallest size that a plan could detect, and the similar effects.

    Returns
    -------
    One entry for each effect of the catalogue, in its order.

    Raises
    ------
    ConfigurationError
        The aircraft file has no complete ``model``, or an elevator without effect; or the plan cannot be
        flown or sampled.
    """
    derivatives = prior_derivatives(aircraft)
    if derivatives is None:
        missing = ", ".join(name for name in PARAMETERS if name not in aircraft.model)
        raise ConfigurationError(f"foresee needs the aircraft file's model; add {missing} under model.")
    if aircraft.model["M_delta_e"] == 0.0:
        raise ConfigurationError(
            "model.M_delta_e: an elevator without effect (0) shows nothing; give its derivative in 1/s²."
        )
    _refuse(plan, rate_hz, amplitude_deg, without)
    unit = min(max(2.0 / max(natural_frequency(derivatives), 1.0), 0.2), 1.5)
    speed = aircraft.stated_airspeed_m_s or 25.0
    maneuvers = [
        _maneuver(n, name, unit, np.radians(amplitude_deg) * (1.0, 0.6)[n % 2], rate_hz, speed, without)
        for n, name in enumerate(plan)
    ]
    flights = prepare(maneuvers, aircraft)
    if not len(flights):
        longest = max(float(m.channels["q"].t[-1] - m.channels["q"].t[0]) for m in maneuvers)
        raise ConfigurationError(
            f"plan: at {rate_hz:g} Hz a manoeuvre brings fewer than {LEAST_SAMPLES} samples; "
            f"plan a rate of {np.ceil(LEAST_SAMPLES / longest) + 1:g} Hz or more."
        )
    noise = np.array([TYPICAL_NOISE[c] for c in flights.channels])
    return foresee_flights(aircraft, derivatives, flights, noise, unit)


def foresee_flights(
    aircraft: Aircraft, derivatives: FloatArray, flights: PreparedManeuvers, noise: FloatArray, unit_s: float
) -> list[Foreseen]:
    """Return for every effect the smallest size that prepared manoeuvres could detect.

    Only the stamps, commands and slow channels of the given manoeuvres are used.

    Parameters
    ----------
    derivatives
        Shape (6,): derivatives about which the model is linearised.
    noise
        Shape (channels,): standard deviation of each channel's noise.
    unit_s
        Time unit of the input in s; a gust lasts two time units.
    """
    variants = variants_for(flights)
    entries = with_known(base_entries(aircraft), aircraft.effects, flights, variants)
    problem = EffectProblem(flights, entries, prior_derivatives=derivatives)
    own = np.zeros((len(flights), len(NUISANCES)))
    own[:, NUISANCES.index("Z_trim")] = [f.level_lift for f in flights.flights]
    point = with_telemetry(everywhere(SearchPoint(derivatives, own), flights), flights)
    linear = linearise(problem, point)
    step = solve_blocks(problem, linear, 1.0 / noise, point)
    owns = step.owns(step.shared)
    residuals = tuple(b.after(step.shared, own) for b, own in zip(linear, owns, strict=True))
    fitted = EffectFit(point, noise, 0.0, residuals, residuals, step.information, linear, 0)
    signatures = Signatures(problem, fitted, noise)
    speed_signatures = [speed_signature(problem, fitted, signatures)] if flights.speed_measured else []
    wanted = beyond_known(aircraft.effects, variants)
    foreseen = [
        *foresee(problem, fitted, wanted, noise, speed_signatures),
        *foresee_air(problem, fitted, signatures, unit_s),
        foresee_offset(problem, noise),
    ]
    sought = {v.effect for v in wanted}
    in_file = {v.effect: v.names[0] for v in variants if v.effect not in sought}
    foreseen += [Foreseen(effect, name, float("inf"), (), _IN_FILE) for effect, name in in_file.items()]
    by_effect = {f.effect: f for f in foreseen}
    return [by_effect.get(effect) or impossible(effect, flights) for effect in EFFECTS]


def _refuse(plan: Sequence[str], rate_hz: float, amplitude_deg: float, without: Sequence[str]) -> None:
    unknown = [name for name in plan if name not in STEPS]
    if unknown or not plan:
        what = f"{unknown[0]!r} is none of" if unknown else "name at least one of"
        raise ConfigurationError(f"plan: {what} {', '.join(STEPS)}.")
    if len(plan) < 2:
        raise ConfigurationError(
            "plan: one manoeuvre proves no cause, because none is left to hold out; plan at least two."
        )
    if not (0.0 < rate_hz <= _HIGHEST_RATE_HZ and 0.0 < amplitude_deg <= _LARGEST_STEP_DEG):
        raise ConfigurationError(
            f"plan: the rate must be above zero and at most {_HIGHEST_RATE_HZ:g} Hz, "
            f"the amplitude above zero and at most {_LARGEST_STEP_DEG:g} deg."
        )
    foreign = [name for name in without if name not in SPARED]
    if foreign:
        raise ConfigurationError(f"without: {foreign[0]!r} is none of {', '.join(SPARED)}.")


def _maneuver(
    n: int, name: str, unit: float, amplitude: float, rate_hz: float, speed: float, without: Sequence[str]
) -> Maneuver:
    """Return stamps and command of a planned manoeuvre, whose outputs have stamps but no values."""
    start, length = 1.0, 1.0 + unit * sum(width for width, _ in STEPS[name])
    end = length + max(10.0 * unit, 3.0)
    t = np.arange(0.0, end, 1.0 / rate_hz) + _SPACING_S * n
    command = np.zeros(len(t))
    at = _SPACING_S * n + start
    for width, level in STEPS[name]:
        command[(t >= at) & (t < at + width * unit)] = amplitude * level
        at += width * unit
    rng = np.random.default_rng(n)
    channels = {"elevator": Channel("elevator", t, command, "plan", "commanded")}

    def add(channel: str, y: FloatArray) -> None:
        if channel not in without:
            channels[channel] = Channel(channel, t, y, "plan", "measured")

    for channel in OUTPUTS:
        add(channel, 1e-6 * rng.standard_normal(len(t)))
    # The throttle is closed once after every input, which shows the pitching moment of thrust.
    add("airspeed", np.full(len(t), speed * (1.0 + 0.02 * (-1) ** n)))
    add("climb_rate", np.zeros(len(t)))
    add("throttle", np.where(t > t[0] + length, 0.1, 0.0))
    span = Span(t[0], t[0] + start, t[0] + length, t[-1], "other", (), "end of log")
    return Maneuver(n + 1, 0, span, channels)
