"""Judging the manoeuvre itself, before any rule compares it with others.

Whole, inside the model, rich enough, well explained, in this order: the first reason is the
one the crew can act on, and what follows from it comes after it.

Richness is information, not amplitude: the corrected standard deviations of the derivatives
that every campaign needs, beside their natural size on this aircraft. Where they are too
large for an input of a good shape, more stick is the cure, and the reason says how much more,
since standard deviations fall with the amplitude.
"""

import math
from collections.abc import Mapping

import numpy as np

from advisor.aircraft import PARAMETERS, Aircraft
from advisor.beside import beside
from advisor.decision.envelope import changed_speed, flown, incomplete, outside, too_quick
from advisor.decision.verdict import Reason
from advisor.flight.maneuver import Maneuver
from advisor.flight.messages import FloatArray
from advisor.flight.record import Channel
from advisor.oem.estimate import ChannelFit, Estimate, NoEstimate
from advisor.oem.identifiability import natural_size

LARGEST_STD_PERCENT: Mapping[str, float] = {"M_alpha": 12.0, "M_delta_e": 12.0, "Z_alpha": 15.0, "M_q": 25.0}
"""Largest corrected standard deviation, as a percentage of the derivative's natural size."""
LEAST_SIGNAL: Mapping[str, float] = {"q": 12.0, "alpha": 8.0}
"""Least peak of the response over the white part of its noise."""
LEAST_PITCH_RATE_DEG_S = 1.0
"""Below this peak the response drowns in what no model holds, however quiet the sensor."""
LEAST_R2: Mapping[str, float] = {"q": 0.85, "alpha": 0.70}
"""Least share of the response that the model must explain, white noise left out of account."""
LARGEST_UNREST_PERCENT = 8.0
"""Largest pitch rate that the elevator does not explain while it is at rest, beside the peak."""


def judge_quality(
    maneuver: Maneuver, estimate: Estimate | NoEstimate, aircraft: Aircraft
) -> tuple[Reason, ...]:
    """What speaks against this manoeuvre, the most telling first; empty when the rules may have it.

    Parameters
    ----------
    maneuver
        Data as cut from the stream.
    estimate
        The estimate from this manoeuvre alone, or why there is none.
    aircraft
        Its limits and calibration.
    """
    period_s = natural_period(maneuver, estimate)
    reasons = [*incomplete(maneuver, period_s), *outside(maneuver, aircraft)]
    if any(reason.code == "missing" for reason in reasons):
        return tuple(reasons)
    fits = estimate.fits[0] if isinstance(estimate, Estimate) else {}
    rough = _rough_air(maneuver, fits)
    reasons += [*rough, *changed_speed(maneuver, aircraft), *too_quick(maneuver, period_s)]
    reasons += _too_gentle(maneuver, fits)
    if isinstance(estimate, NoEstimate) or rough:
        return tuple(reasons)
    return (*reasons, *(_badly_explained(fits) or _poor(maneuver, estimate, reasons)))


def natural_period(maneuver: Maneuver, estimate: Estimate | NoEstimate) -> float:
    """Natural period of the short period in s, 2π/ω with ω² = Z_α M_q − (1 + Z_q) M_α.

    Where there is no estimate of a stable aircraft, two and a half of the shortest step, or two of
    a multisine's median lobes: the inputs of a test are matched to the aircraft.
    """
    if isinstance(estimate, Estimate):
        square = estimate.value("Z_alpha") * estimate.value("M_q")
        square -= (1.0 + estimate.value("Z_q")) * estimate.value("M_alpha")
        if square > 0.0:
            return 2.0 * math.pi / math.sqrt(square)
    onsets = [onset for onset, _ in maneuver.span.steps]
    if len(onsets) < 2:
        return 1.0
    swept = maneuver.span.kind == "multisine"
    return 2.0 * float(np.median(np.diff(onsets))) if swept else 2.5 * float(np.min(np.diff(onsets)))


def _too_gentle(maneuver: Maneuver, fits: Mapping[str, ChannelFit]) -> list[Reason]:
    """The response hardly stands out of the noise."""
    wanting = []
    for name, least in LEAST_SIGNAL.items():
        peak = _peak(maneuver, name)
        noise = _white(fits[name].residual if name in fits else maneuver.channels[name].y)
        wanting.append((least * noise / peak if peak > 0.0 else math.inf, name))
    rate = math.degrees(_peak(maneuver, "q"))
    wanting.append((LEAST_PITCH_RATE_DEG_S / rate if rate > 0.0 else math.inf, "q"))
    factor, name = max(wanting)
    if factor <= 1.0:
        return []
    what, unit = ("pitch rate", "deg/s") if name == "q" else ("angle of attack", "deg")
    peak = math.degrees(_peak(maneuver, name))
    limit = peak * factor if peak > 0.0 else LEAST_PITCH_RATE_DEG_S
    shown, least_peak = beside(peak, limit, 2, "g")
    text = f"too gentle, {what} {shown} {unit} (at least {least_peak}); use about {_times(factor)} the stick"
    return [Reason("amplitude", text, peak, limit)]


def _rough_air(maneuver: Maneuver, fits: Mapping[str, ChannelFit]) -> list[Reason]:
    """The aircraft moves although the elevator rests: before the first step, late in the free response."""
    span, q = maneuver.span, maneuver.channels["q"]
    before = q.cut(span.record_from_s, span.start_s)
    peak = max(_peak(maneuver, "q"), 1e-9)
    if len(before) < 5 or _beyond_noise(_detrended(before), before.y) < 0.005 * LARGEST_UNREST_PERCENT * peak:
        return []
    unexplained = _detrended(before)
    if "q" in fits:
        fit = fits["q"]
        rest = (fit.t < span.start_s) | (fit.t > 0.5 * (span.last_step_s + span.end_s))
        unexplained = fit.residual[rest]
    unrest = 100.0 * _beyond_noise(unexplained, q.y) / peak
    if unrest <= LARGEST_UNREST_PERCENT:
        return []
    shown, most = beside(unrest, LARGEST_UNREST_PERCENT)
    text = (
        f"rough air, {shown} % of the pitch rate comes with the elevator at rest (limit {most}); "
        "fly it in calmer air"
    )
    return [Reason("turbulence", text, unrest, LARGEST_UNREST_PERCENT)]


def _detrended(channel: Channel) -> FloatArray:
    """Values less their straight line."""
    t = channel.t - channel.t[0]
    return channel.y - np.polyval(np.polyfit(t, channel.y, 1), t)


def _beyond_noise(values: FloatArray, channel: FloatArray) -> float:
    """Root mean square of what is more than the white noise of the channel."""
    return math.sqrt(max(0.0, float(np.mean(values**2)) - _white(channel) ** 2))


def _badly_explained(fits: Mapping[str, ChannelFit]) -> list[Reason]:
    """Residuals that are no noise: the model does not hold for what was flown."""
    reasons = []
    for name, least in LEAST_R2.items():
        fit = fits[name]
        noise = _white(fit.residual) ** 2
        spread = float(np.var(fit.measured)) - noise
        explained = 1.0 - max(0.0, fit.rms**2 - noise) / spread if spread > 0.0 else 1.0
        if explained < least:
            what = "pitch rate" if name == "q" else "angle of attack"
            shown, limit = beside(100.0 * max(0.0, explained), 100.0 * least)
            text = (
                f"the model explains {shown} % of {what} (at least {limit}); "
                "smaller steps, steady flight before, calm air"
            )
            reasons.append(Reason("fit", text, explained, least))
    return reasons


def _poor(maneuver: Maneuver, estimate: Estimate, already: list[Reason]) -> list[Reason]:
    """Derivatives that this manoeuvre leaves too uncertain, the worst of them."""
    sizes = natural_size(estimate.theta)
    percent = {
        name: 100.0 * float(estimate.std[PARAMETERS.index(name)]) / sizes[name]
        if sizes[name] > 0.0
        else math.inf
        for name in LARGEST_STD_PERCENT
    }
    worst = max(percent, key=lambda name: percent[name] / LARGEST_STD_PERCENT[name])
    value, limit = percent[worst], LARGEST_STD_PERCENT[worst]
    if value <= limit or any(reason.code == "amplitude" for reason in already):
        return []
    cure = f"use about {_times(value / limit)} the stick"
    if maneuver.span.kind == "pulse":
        cure = "fly a 3-2-1-1: this input tells too little of it"
    shown, most = beside(value, limit)
    text = f"{worst} known to {shown} % only (limit {most}); {cure}"
    return [Reason("information", text, value, limit)]


def _peak(maneuver: Maneuver, name: str) -> float:
    """Half the range of a channel while the manoeuvre was flown."""
    y = flown(maneuver, name)
    return float(np.ptp(y)) / 2.0 if len(y) else 0.0


def _white(values: FloatArray) -> float:
    """Standard deviation of the part that is new in every sample: from second differences."""
    if len(values) < 3:
        return 0.0
    return float(np.std(np.diff(values, 2))) / math.sqrt(6.0)


def _times(factor: float) -> str:
    """Advice on amplitude: a tenth more than needed, in a size a hand can tell."""
    return f"{min(5.0, max(1.2, 1.1 * factor)):.1f} times"
