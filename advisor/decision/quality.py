"""Objections to a manoeuvre itself, before any rule compares it with others.

The checks run in this order: complete data, sound instruments, within the model, long enough, rich enough,
well explained. The first reason is the one that the crew can act on. Its consequences come after it.

Richness is information, not amplitude: the precision with which the estimate from this manoeuvre alone
predicts the pitch rate of its own input. Moving air, a slow channel, a missing vane or a gentle input all
lower that precision. Where the input has a good shape, more stick is the remedy. Standard deviations fall
with the amplitude, so that the reason states the factor.
"""

import math
from collections.abc import Iterable, Mapping
from dataclasses import replace

import numpy as np

from advisor.aircraft.aircraft import Aircraft
from advisor.aircraft.reference import PARAMETERS
from advisor.decision.envelope import (
    above,
    changed_speed,
    flown,
    incomplete,
    leapt,
    not_heard,
    outside,
    short_response,
    too_quick,
)
from advisor.decision.omitted import coupled
from advisor.decision.verdict import NO_CURE_BY_INPUT, UNTRUSTED, Reason
from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.flight.maneuvers.purpose import LEAST_PITCH_RATE_DEG_S
from advisor.flight.signals.instrument_finding import InstrumentFinding
from advisor.flight.signals.messages import FloatArray
from advisor.oem.estimate import ChannelFit, Estimate, NoEstimate
from advisor.oem.findings import findings_of
from advisor.words.digits import distinct_texts
from advisor.words.quantiles import NORMAL_95

WIDEST_PREDICTION_PERCENT = 25.0
"""Largest half-width of the predicted pitch rate's 95 % band, % of its peak. A standard deviation of 12 % in
M_δe alone gives 24. Real records that two halves of a campaign agree on have 9 to 21."""
LEAST_SIGNAL: Mapping[str, float] = {"q": 12.0, "alpha": 8.0}
"""Channel to its least ratio of the response's peak to the white part of its noise."""
LEAST_R2: Mapping[str, float] = {"q": 0.85, "alpha": 0.70}
"""Channel to the least share of its response that the model must explain, without white noise."""


def judge_quality(
    maneuver: Maneuver, estimate: Estimate | NoEstimate, aircraft: Aircraft
) -> tuple[Reason, ...]:
    """Return objections to the manoeuvre, the most important first; empty for one that the rules may judge.

    Parameters
    ----------
    maneuver
        Manoeuvre as cut from the stream.
    estimate
        Estimate from this manoeuvre alone, or the reason for its absence.
    aircraft
        Limits and calibration of the aircraft.
    """
    period_s = natural_period(maneuver, estimate)
    fits = estimate.fits[0] if isinstance(estimate, Estimate) else {}
    reasons = [*incomplete(maneuver, period_s, fits), *outside(maneuver, aircraft)]
    codes = {reason.code for reason in reasons}
    short = [] if is_informed(estimate) else short_response(maneuver, period_s)
    if maneuver.leapt_s:
        return (leapt(maneuver),)
    if maneuver.missed_s and (short or "gap" in codes):
        # Nothing else can be said of a record that the advisor itself has lost.
        return (not_heard(maneuver),)
    if codes & UNTRUSTED:
        return tuple(reasons)
    told = findings_of(estimate, aircraft) if isinstance(estimate, Estimate) else ()
    if refused := refusals((*maneuver.findings, *told)):
        return refused
    follows = [*changed_speed(maneuver, aircraft), *short, *too_quick(maneuver, period_s)]
    if codes & NO_CURE_BY_INPUT:
        # A larger input remedies no faulty record: reasons that ask for one would mislead.
        return (*reasons, *follows)
    gentle = _mended(maneuver, _too_gentle(maneuver, fits))
    if isinstance(estimate, NoEstimate):
        return (*reasons, *follows, *gentle)
    follows = [*(r for r in coupled(maneuver, estimate) if r.code not in codes), *follows]
    lacking = _badly_explained(estimate) or ([] if gentle else _mended(maneuver, _poor(maneuver, estimate)))
    if lacking and lacking[0].code == "turbulence":
        return (*reasons, *lacking, *follows)
    return (*reasons, *follows, *gentle, *lacking)


def refusals(findings: Iterable[InstrumentFinding]) -> tuple[Reason, ...]:
    """Return a reason for every contradiction of an instrument that no estimate allows for."""
    return tuple(
        Reason(
            f.code, f"{f.text}; {f.fix}", f.value if isinstance(f.value, float) else math.nan,
            f.stated if isinstance(f.stated, float) else math.nan, by_instrument=True,
        )
        for f in findings if f.refuses
    )  # fmt: skip


def natural_period(maneuver: Maneuver, estimate: Estimate | NoEstimate) -> float:
    """Return the natural period of the short-period motion in s, 2π/ω with ω² = Z_α M_q − (1 + Z_q) M_α.

    Without an estimate that predicts its own response, the period follows from the input, which crews match
    to the aircraft. It is 2.5 times the shortest step, or twice the median lobe of a multisine.
    """
    if isinstance(estimate, Estimate) and _knows_the_motion(estimate):
        square = estimate.value("Z_alpha") * estimate.value("M_q")
        square -= (1.0 + estimate.value("Z_q")) * estimate.value("M_alpha")
        if square > 0.0:
            return 2.0 * math.pi / math.sqrt(square)
    held_s = np.diff([onset for onset, _ in maneuver.span.steps])
    held_s = held_s[held_s > 0.0]  # two steps between two samples have one onset
    if len(held_s) == 0:
        return 1.0
    swept = maneuver.span.kind == "multisine"
    return 2.0 * float(np.median(held_s)) if swept else 2.5 * float(np.min(held_s))


def _knows_the_motion(estimate: Estimate) -> bool:
    """Return whether an estimate predicts its own response and has a significant stiffness."""
    stiffness = PARAMETERS.index("M_alpha")
    known = abs(float(estimate.theta[stiffness])) > float(estimate.std[stiffness])
    return known and estimate.prediction.get("q", 0.0) < 1.0


def is_informed(estimate: Estimate | NoEstimate) -> bool:
    """Return whether a manoeuvre determines the short period, whatever the shape of its end.

    The bands of all predicted outputs are narrow, and the intervals of stiffness, damping and control exclude
    zero. Without a free response these intervals are wider, and a short tail that they allow does no harm.
    """
    if isinstance(estimate, NoEstimate) or not estimate.prediction:
        return False
    known = all(
        abs(estimate.value(name)) > NORMAL_95 * float(estimate.std[PARAMETERS.index(name)])
        for name in ("M_alpha", "M_q", "M_delta_e")
    )
    return known and 100.0 * max(estimate.prediction.values()) <= WIDEST_PREDICTION_PERCENT


def _too_gentle(maneuver: Maneuver, fits: Mapping[str, ChannelFit]) -> list[Reason]:
    """Return a reason where the response hardly exceeds the noise."""
    wanting = []
    for name, least in LEAST_SIGNAL.items():
        if name not in (fits or ("q",)):
            continue
        peak = half_range(maneuver, name)
        noise = white_part(fits[name].residual if name in fits else maneuver.channels[name].y)
        wanting.append((least * noise / peak if peak > 0.0 else math.inf, name))
    rate = math.degrees(half_range(maneuver, "q"))
    wanting.append((LEAST_PITCH_RATE_DEG_S / rate if rate > 0.0 else math.inf, "q"))
    factor, name = max(wanting)
    if factor <= 1.0:
        return []
    what, unit = ("pitch rate", "deg/s") if name == "q" else ("angle of attack", "deg")
    peak = math.degrees(half_range(maneuver, name))
    limit = peak * factor if peak > 0.0 else LEAST_PITCH_RATE_DEG_S
    shown, least_peak = distinct_texts(peak, limit, 2, "g")
    text = f"too gentle, {what} {shown} {unit} (at least {least_peak}); use about {_times(factor)} the stick"
    return [Reason("amplitude", text, peak, limit)]


def _badly_explained(estimate: Estimate) -> list[Reason]:
    """Return a reason where residuals are not noise, so that the model does not hold for the manoeuvre.

    In moving air the angle of attack of a vane shows the air, which no model of the aircraft explains.
    """
    reasons = []
    for name, least in LEAST_R2.items():
        fit = estimate.fits[0].get(name)
        if fit is None or (name == "alpha" and estimate.filtered):
            continue
        noise = white_part(fit.residual) ** 2
        spread = float(np.var(fit.measured)) - noise
        explained = 1.0 - max(0.0, fit.rms**2 - noise) / spread if spread > 0.0 else 1.0
        if explained < least:
            what = "pitch rate" if name == "q" else "angle of attack"
            shown, limit = distinct_texts(100.0 * max(0.0, explained), 100.0 * least)
            moving = estimate.gust_rad is not None
            cure = "fly it in calmer air" if moving else "smaller steps, steady flight before, calm air"
            text = f"the model explains {shown} % of {what} (at least {limit}); {cure}"
            reasons.append(Reason("turbulence" if moving else "fit", text, explained, least))
    return reasons


def _poor(maneuver: Maneuver, estimate: Estimate) -> list[Reason]:
    """Return a reason where an estimate predicts too little of its own response."""
    value = 100.0 * estimate.prediction.get("q", math.inf)
    more = _times(value / WIDEST_PREDICTION_PERCENT) if math.isfinite(value) else "more of"
    code, cure = "information", f"use about {more} the stick"
    if estimate.gust_rad is not None:
        code, cure = "turbulence", f"fly it in calmer air, or with about {more} the stick"
    elif maneuver.span.kind == "pulse":
        cure = "fly a 3-2-1-1: this input tells too little of the response"
    text = "the pitch rate is predicted to {} % of its peak only (limit {}); " + cure
    return above(code, value, WIDEST_PREDICTION_PERCENT, text)


def _mended(maneuver: Maneuver, reasons: list[Reason]) -> list[Reason]:
    """Return the reasons with the remedy of a faulty channel in place of a larger input."""
    if not maneuver.distrusts:
        return reasons
    wrong = maneuver.distrusts[0]
    return [replace(r, text=f"{r.text.partition('; ')[0]}; {wrong.text}: {wrong.fix}") for r in reasons]


def half_range(maneuver: Maneuver, name: str) -> float:
    """Return half the range of a channel during the manoeuvre."""
    y = flown(maneuver, name)
    return float(np.ptp(y)) / 2.0 if len(y) else 0.0


def white_part(values: FloatArray) -> float:
    """Return the standard deviation of the white part of a signal, from second differences."""
    if len(values) < 3:
        return 0.0
    return float(np.std(np.diff(values, 2))) / math.sqrt(6.0)


def _times(factor: float) -> str:
    """Return the advised factor on the amplitude: a tenth more than needed, rounded to a size that a hand can
    fly."""
    return f"{min(5.0, max(1.2, 1.1 * factor)):.1f} times"
