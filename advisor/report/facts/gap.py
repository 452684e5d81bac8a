"""Sentences about a gap: its size, its reduction, its place, and the derivatives that differ."""

from collections.abc import Sequence
from math import isnan

from advisor.gap.alternative import Weighed
from advisor.gap.result import ComparedDerivative, Gap, MissingLaw, Shrink, Where
from advisor.gap.verdict.text import in_words, place
from advisor.report.facts.sizes import before_after, has_grown, short
from advisor.words.quantities import (
    CHANNELS,
    NORMAL_95,
    PARAMETERS,
    SIDE_PARAMETERS,
    decimals_for,
    maneuvers_said,
    signed,
    with_half,
)

_QUANTITIES = {**PARAMETERS, **SIDE_PARAMETERS}
_WORTH_SAYING = 0.005
"""Fraction of a gap below which a sentence omits the fraction, because the text would say 0 %."""


def size_of_gap(verdict: str, gap: Gap) -> str:
    """Return the gap of the simulator as given and after the corrections: ``gap 119 → 0.116 times ...``."""
    before, after = short(gap.before), short(gap.after)
    if verdict == "untested":
        return f"residual of the fitted model: {after} times the noise floor's power"
    if isnan(gap.after):
        return f"gap {before} times the noise floor's power; no manoeuvre can be held out"
    if verdict == "none":
        return f"gap {before} times the noise floor's power"
    return f"gap {before_after(gap.before, gap.after)} times the noise floor's power"


def shrink_said(shrink: Shrink, gap: Gap) -> str:
    """Return the sentence about the gap's reduction, with the 95 % interval and the held-out manoeuvres.

    The gap after the corrections includes the flight's nuisance parameters. An export cannot contain them,
    and its gap can be larger. The sentence states a larger gap if the two differ in two digits.
    """
    kept_out = f"on held-out {maneuvers_said(shrink.holdout)}"
    if shrink.percent < 0.0:
        noise = ", both below the noise" if max(shrink.before, shrink.after) < 1.0 else ""
        return f"larger {kept_out}: {short(shrink.before)} → {short(shrink.after)}{noise}"
    low, high = shrink.ci95_percent
    larger = float(f"{shrink.after:.2g}") > float(f"{gap.after:.2g}")
    left = f"; the corrections alone leave {short(shrink.after)}" if larger else ""
    return f"{shrink.percent:.1f} % less (95 %: {low:.1f} to {high:.1f}) {kept_out}{left}"


def where_said(where: Where, shrink: Shrink | None) -> str:
    """Return the place of a gap: ``in the lift, 93 % of the gap``. The fraction is omitted if a reduction of
    the gap is stated.
    """
    says = shrink is None and where.share >= _WORTH_SAYING
    return f"{place(where.block)}{f', {100 * where.share:.0f} % of the gap' if says else ''}"


def grown_said(verdict: str, gap: Gap) -> str:
    """Return the channels and manoeuvres whose gap has grown; empty for none, or if nothing is changed."""
    if verdict == "none":
        return ""
    given, left = gap.by_channel, gap.by_channel_after
    channels = [CHANNELS[name].symbol for name, after in left.items() if has_grown(after, given[name])]
    numbers = [number for number, before, after in gap.by_maneuver if has_grown(after, before)]
    grown = [*channels, *([maneuvers_said(numbers)] if numbers else [])]
    return f"the gap is larger than before in {', '.join(grown)}" if grown else ""


LAWS = {
    "Z": ("force", "1/s"), "M": ("moment", "rad/s²"),
    "Y": ("side force", "1/s"), "L": ("rolling moment", "rad/s²"), "N": ("yawing moment", "rad/s²"),
}  # fmt: skip
"""Force or moment that each equation can lack, with its unit, by the letter of the equation."""
_OVER = {
    "q": "pitch rate", "alpha": "angle of attack", "delta_e": "elevator deflection", "t": "time of flight",
    "beta": "sideslip", "p": "roll rate", "r": "yaw rate",
    "delta_a": "aileron deflection", "delta_r": "rudder deflection",
}  # fmt: skip


def law_said(law: MissingLaw) -> str:
    """Return the sentence about an effect that no candidate explains: the variable on which it depends, and
    the nearest formula.
    """
    what, unit = LAWS[law.equation]
    depends = f"The missing {what} depends most on the {_OVER[law.variable]}"
    said = f"{depends}, which explains {100.0 * law.share:.0f} % of the residual"
    if not law.nearest:
        return f"{said}."
    half = NORMAL_95 * law.coefficient.std
    if abs(law.coefficient.value) < half:
        return f"{said}; no simple formula fits it."
    about = f"about {with_half(law.coefficient.value, half)} · {law.nearest} {unit}, next to a line"
    return f"{said}: {about}; {law.runner_up} comes next."


def changed(compared: ComparedDerivative) -> str:
    """Return the text of one derivative: the simulator's value, the flight's value with its error, and the
    change.
    """
    quantity = _QUANTITIES[compared.name]
    given, value, half = (quantity.factor * x for x in (compared.given, compared.found.value, compared.half))
    share = ""
    if compared.percent is not None:
        share = f" ({'+' if compared.percent > 0.0 else ''}{signed(compared.percent, 0)} %)"
    said = f"{quantity.symbol} {signed(given, decimals_for(half))} → {with_half(value, half)}"
    return f"{said} {quantity.unit.removesuffix('1')}".rstrip() + share


def changes(derivatives: Sequence[ComparedDerivative]) -> list[str]:
    """Return a line for each derivative that differs, then one line with all derivatives that agree."""
    agree = [_QUANTITIES[derivative.name].symbol for derivative in derivatives if not derivative.differs]
    lines = [changed(derivative) for derivative in derivatives if derivative.differs]
    return [*lines, *([f"{', '.join(agree)} agree{'s' if len(agree) == 1 else ''}"] if agree else [])]


def heading(d: Weighed) -> str:
    """Return the heading above the reasons for a diagnosis; empty without reasons."""
    if d.answer is None or not d.why:
        return ""
    stated = {e.alternative.label: in_words(e.alternative) for e in d.evidence}
    answer, rival = in_words(d.answer), stated[d.rival]
    return f"why {answer}, and not {rival}: parts of the log odds, in nats"
