"""Objections to a single manoeuvre, before any rule compares it with other manoeuvres.

The checks are, in order: complete data, sound instruments, model limits, length, information, fit. The crew
can act on the first reason. Reasons that follow from the first reason come after it. One function examines
every axis, with data from the axis (``decision.axes``).

Information means the precision with which the manoeuvre's own estimate predicts the response to its input.
Moving air, a slow channel, a missing vane or a gentle input lower that precision. With a well shaped input,
more stick is the remedy. Standard deviations are inversely proportional to the amplitude, so the reason
states the factor.
"""

import math
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, replace

from advisor.aircraft.aircraft import Aircraft
from advisor.decision.envelope import (
    above,
    changed_speed,
    incomplete,
    leaping_speed,
    leapt,
    moved_at_once,
    not_heard,
    short_response,
)
from advisor.decision.response import Response, explained_share, half_range
from advisor.decision.verdict import NO_CURE_BY_INPUT, UNTRUSTED, Reason
from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.flight.maneuvers.purpose import LEAST_PITCH_RATE_DEG_S
from advisor.flight.signals.trust import InstrumentFinding
from advisor.oem.estimate import ChannelFit, Estimate, NoEstimate
from advisor.words.quantities import NORMAL_95, distinct_texts

WIDEST_PREDICTION_PERCENT = 25.0
"""Largest half-width of the predicted rate's 95 % band, % of its peak. A standard deviation of 12 % in M_δe
alone gives 24 %. On real records whose two halves agree, this half-width is 9 to 21 %."""

_STEADY = "steady flight before"


@dataclass(frozen=True, slots=True)
class Examined:
    """A manoeuvre with the requirements of its axis."""

    maneuver: Maneuver
    aircraft: Aircraft
    estimate: Estimate | NoEstimate
    """Estimate from this manoeuvre alone, or the reason for a missing estimate."""
    period_s: float
    """Natural period of the motion, estimated or assumed, s."""
    needed: tuple[str, ...]
    """Channels without which no manoeuvre can be judged."""
    responses: tuple[Response, ...]
    """Outputs that respond to the moved controls. The rate that the control moves directly comes first."""
    determined: tuple[str, ...]
    """Derivatives that a test of the moved controls determines."""
    outside: tuple[Reason, ...]
    """Reasons for exceeded limits of the model."""
    bands: tuple[str, ...] = ()
    """Outputs whose prediction must be precise if the test determines its axis."""
    needless: frozenset[str] = frozenset()
    """Codes of the limits that a precise estimate makes needless. The estimate contains the influence, or
    ``lacks`` examines the bias."""
    quick: tuple[Reason, ...] = ()
    """Reasons for steps too short for the aircraft."""
    findings: tuple[InstrumentFinding, ...] = ()
    """Findings of the fit about the instruments."""
    lacks: Callable[[frozenset[str]], Iterable[Reason]] = lambda exceeded: ()
    """Function that returns reasons for influences that the model omits. The argument holds the codes of the
    needless limits that the manoeuvre exceeds."""
    modes_alone: tuple[Reason, ...] | None = None
    """Reasons for a record that determines no derivative. None if the test determines at least one
    derivative."""

    @property
    def rates(self) -> Mapping[str, Response]:
        """Response of the angular rate to each control, by the control in the pilot's hand."""
        return {response.handle: response for response in reversed(self.responses)}


def objections(x: Examined) -> tuple[Reason, ...]:
    """Return objections to a manoeuvre, the most important first; empty for one that the rules can judge."""
    maneuver, estimate = x.maneuver, x.estimate
    fits = estimate.fits[0] if isinstance(estimate, Estimate) else {}
    outside = (*x.outside, *changed_speed(maneuver, x.aircraft))
    exceeded = frozenset(reason.code for reason in outside) & x.needless
    if exceeded and _stands(x, fits):
        outside = tuple(reason for reason in outside if reason.code not in exceeded)
    reasons = [
        *incomplete(maneuver, x.needed, x.period_s, fits),
        *(r for r in outside if r.code != "airspeed"),
    ]
    codes = {reason.code for reason in reasons}
    short = [] if is_informed(x) else short_response(maneuver, x.period_s)
    if maneuver.leapt_s:
        return (leapt(maneuver),)
    if maneuver.missed_s and (short or "gap" in codes):
        # Nothing else can be said of a record that the advisor itself has lost.
        return (not_heard(maneuver),)
    if codes & UNTRUSTED:
        return tuple(reasons)
    if leaping := leaping_speed(maneuver, x.aircraft.limits.airspeed_change_percent):
        # The model reads the air speed, so that no other number of the record holds.
        return tuple(leaping)
    if refused := refusals((*maneuver.findings, *x.findings)):
        return refused
    follows = [*(r for r in outside if r.code == "airspeed"), *short, *x.quick]
    if codes & NO_CURE_BY_INPUT:
        # A larger input remedies no faulty record: reasons that ask for one would mislead.
        return (*reasons, *follows)
    # Beyond a limit of the model, noise and response are those of another motion.
    gentle = [] if reasons else _mended(maneuver, _too_gentle(x, fits))
    if isinstance(estimate, NoEstimate):
        return (*reasons, *follows, *gentle)
    codes |= {reason.code for reason in follows}
    follows = [*(r for r in x.lacks(exceeded) if r.code not in codes), *follows]
    unexplained = _badly_explained(x, estimate, _STEADY if gentle else "smaller steps")
    if unexplained and gentle:
        # The residual of a poor fit contains motion, and as noise it would ask for too large an input.
        gentle = _mended(maneuver, _too_gentle(x, {}, by_noise=False))
    lacking = unexplained or ([] if gentle else _mended(maneuver, _poor(x, estimate)))
    if lacking and lacking[0].code == "turbulence":
        return (*reasons, *lacking, *follows)
    return (*reasons, *follows, *gentle, *lacking)


def refusals(findings: Iterable[InstrumentFinding]) -> tuple[Reason, ...]:
    """Return a reason for every contradiction of an instrument that no estimate corrects."""
    return tuple(
        Reason(
            f.code, f"{f.text}; {f.fix}", f.value if isinstance(f.value, float) else math.nan,
            f.stated if isinstance(f.stated, float) else math.nan, by_instrument=True,
        )
        for f in findings if f.refuses
    )  # fmt: skip


def is_informed(x: Examined) -> bool:
    """Return whether a manoeuvre determines its axis, even with a short free response.

    The outputs' bands must be narrow, and the intervals of stiffness, damping and control must exclude zero.
    A short free response widens these intervals, and does no harm if they remain narrow enough.
    """
    estimate = x.estimate
    if isinstance(estimate, NoEstimate) or not x.bands or not estimate.prediction:
        return False
    determined = all(
        name not in estimate.not_identifiable
        and abs(estimate.value(name)) > NORMAL_95 * float(estimate.std[estimate.names.index(name)])
        for name in x.determined
    )
    widest = max(estimate.prediction[name] for name in x.bands)
    return determined and 100.0 * widest <= WIDEST_PREDICTION_PERCENT


def _stands(x: Examined, fits: Mapping[str, ChannelFit]) -> bool:
    """Return whether an estimate explains its manoeuvre and predicts the response to its input."""
    if isinstance(x.estimate, NoEstimate) or _too_gentle(x, fits):
        return False
    return not (_badly_explained(x, x.estimate, _STEADY) or _poor(x, x.estimate))


def _too_gentle(x: Examined, fits: Mapping[str, ChannelFit], by_noise: bool = True) -> list[Reason]:
    """Return a reason if the response hardly exceeds the noise, in any output and for every control.

    The response to several controls at once has no peak of one control. In this case the precision of the
    estimate decides.
    """
    if moved_at_once(x.maneuver) and is_informed(x):
        return []
    seen = x.responses if fits else tuple(x.rates.values())
    wanting: dict[str, tuple[float, Response]] = {}
    for response in seen:
        measured = response.output in (fits or x.needed)
        factor = response.factor(x.maneuver, fits, by_noise) if measured else 0.0
        if factor > wanting.get(response.handle, (0.0, response))[0]:
            wanting[response.handle] = factor, response
    factor, worst = min(wanting.values(), key=lambda pair: pair[0], default=(0.0, None))
    if worst is None or factor <= 1.0:
        return []
    peak = math.degrees(half_range(x.maneuver, worst.output))
    limit = peak * factor if peak > 0.0 else LEAST_PITCH_RATE_DEG_S
    shown, least = distinct_texts(peak, limit, 2, "g")
    text = (
        f"too gentle, {worst.said} {shown} {worst.unit} (at least {least});"
        f" use about {_times(factor)} the {worst.handle}"
    )
    return [Reason("amplitude", text, peak, limit)]


def _badly_explained(x: Examined, estimate: Estimate, first: str) -> list[Reason]:
    """Return a reason if residuals are not noise, because the model is not valid for the manoeuvre.

    Parameters
    ----------
    first
        The first remedy is smaller steps, unless the response hardly exceeds its noise.
    """
    # In moving air the angle of attack of a vane shows the air, which no model of the aircraft explains.
    reasons = []
    for response in x.responses:
        fit = estimate.fits[0].get(response.output)
        if fit is None or (response.output == "alpha" and estimate.filtered):
            continue
        explained = explained_share(fit)
        if explained < response.least_r2:
            shown, limit = distinct_texts(100.0 * max(0.0, explained), 100.0 * response.least_r2)
            moving = estimate.gust_rad is not None
            steady = "" if first == _STEADY else f", {_STEADY}"
            cure = "fly it in calmer air" if moving else f"{first}{steady}, calm air"
            text = f"the model explains {shown} % of {response.said} (at least {limit}); {cure}"
            reasons.append(Reason("turbulence" if moving else "fit", text, explained, response.least_r2))
    return reasons


def _poor(x: Examined, estimate: Estimate) -> list[Reason]:
    """Return a reason if an estimate predicts its own response too imprecisely."""
    if x.modes_alone is not None:
        return list(x.modes_alone)
    bands = {name: estimate.prediction.get(response.output, math.inf) for name, response in x.rates.items()}
    if not bands:
        return []
    widest = max(bands, key=lambda name: bands[name])
    value = 100.0 * bands[widest]
    more = _times(value / WIDEST_PREDICTION_PERCENT) if math.isfinite(value) else "more of"
    code, cure = "information", f"use about {more} the {widest}"
    if estimate.gust_rad is not None:
        code, cure = "turbulence", f"fly it in calmer air, or with about {more} the {widest}"
    elif x.maneuver.span.kind == "pulse":
        cure = "fly a 3-2-1-1: this input shows too little of the response"
    text = f"the {x.rates[widest].said} is predicted to {{}} % of its peak only (limit {{}}); {cure}"
    return above(code, value, WIDEST_PREDICTION_PERCENT, text)


def _mended(maneuver: Maneuver, reasons: list[Reason]) -> list[Reason]:
    """Return the reasons with the remedy of a faulty channel instead of a larger input."""
    if not maneuver.distrusts:
        return reasons
    wrong = maneuver.distrusts[0]
    return [replace(r, text=f"{r.text.partition('; ')[0]}; {wrong.text}: {wrong.fix}") for r in reasons]


def _times(factor: float) -> str:
    """Return the advised factor on the amplitude: a tenth more than needed, rounded for a hand."""
    return f"{min(5.0, max(1.2, 1.1 * factor)):.1f} times"
