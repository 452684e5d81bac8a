"""``reference/effects.md``: the table of effects, from its traits and from what the fit is given of each."""

from collections.abc import Iterator, Mapping

import numpy as np

from advisor.gap.effects import EFFECTS
from advisor.gap.kit.effect import BLOCKS, Effect, Said, Variant, without_sizes
from advisor.gap.verdict.causes import parameters_of
from advisor.report.facts.sizes import in_units, short
from benchmarks.pages.planned import PLANS, described

_HEAD = """# The effects that a diagnosis can name

This page is made from `advisor/gap/effects`.

{count} effects, by the block of the simulator. Each entry says:

- *Said*: the sentence of a verdict. Letters in italics stand for sizes.
- *Parameters*: names and units as in `effects:` of the aircraft file, and the range of the search. A dash
  marks a number that is not searched for.
- *Needs*: channels, or a change in the flight, without which the effect cannot be seen.
- *Apart from*: an effect that looks alike, and how to distinguish the two.

"By the flight" marks a bound that depends on the length, the heights or the air speed of the flight.
"""
_TITLES = {
    "input": "between command and surface",
    "moment_equation": "pitching moment",
    "force_equation": "lift",
    "air": "air",
    "alpha_sensor": "angle of attack",
    "pitch_rate_sensor": "pitch rate",
    "accelerometer": "accelerometer",
    "timing": "time stamps",
}
_KINDS = {
    "of_one_flight": "It belongs to one flight and is left aside where an aircraft file states it.",
    "of_one_imu": "An angle of attack that an autopilot estimates cannot show it.",
}
_CHANNELS = {"alpha": "angle of attack", "a_z": "vertical acceleration", "theta": "attitude"}
_SI_ENDINGS = {
    "_rad_s": "rad/s",
    "_per_s": "1/s",
    "_m_s": "m/s",
    "_rad": "rad",
    "_hz": "Hz",
    "_s": "s",
    "_m": "m",
}
_CHOICES = ("about_trim", "stability_only", "with_moment", "with_attitude", "with_pitch_rate")
_BY_FLIGHT = "by the flight"


def page() -> str:
    """The page as Markdown."""
    parts = [_HEAD.format(count=len(EFFECTS))]
    for block in BLOCKS:
        title = _TITLES[block]
        parts.append(f"## {title[0].upper()}{title[1:]} (`{block}`)\n")
        parts += [_section(effect) for effect in EFFECTS.values() if effect.block == block]
    return "\n".join(parts)


def _section(effect: Effect) -> str:
    lines = [f"### `{effect.name}`\n", *(f"- {said}" for said in _said(effect)), *_parameters(effect)]
    lines += [f"- *Needs*: {need}." for need in _needs(effect)]
    lines += [f"- *Apart from* {other}: {way}." for other, way in _apart(effect)]
    lines += [f"- {sentence}" for flag, sentence in _KINDS.items() if getattr(effect, flag)]
    return "\n".join(lines) + "\n"


def _said(effect: Effect) -> Iterator[str]:
    yield f"*Said*: {_sentences(effect.said)}"
    for parameter, said in effect.said_with.items():
        yield f"*Said*, with `{parameter}`: {_sentences(said)}"
    if effect.said_beyond:
        yield f"*Said*, where the simulator has some of it: {_sentences(effect.said_beyond)}"
    if effect.stated is not None:
        yield f"*Stated* in the aircraft file as `{'.'.join(effect.stated)}`."


def _sentences(said: Said) -> str:
    return " / ".join(f"{text}." for text in without_sizes(said, "*x*"))


def _parameters(effect: Effect) -> Iterator[str]:
    yield "- *Parameters*:\n"
    yield "  | parameter | unit | searched from | to |\n  |---|---|---|---|"
    for parameter in effect.keys:
        low, high = _range(effect.name, parameter)
        yield f"  | `{parameter}` | {_unit(parameter)} | {low} | {high} |"
    yield ""


def _unit(parameter: str) -> str:
    if parameter in _CHOICES:
        return "1 for yes"
    for ending, unit in _SI_ENDINGS.items():
        if parameter.endswith(ending):
            return unit
    _, unit = in_units(parameter)
    return "share" if unit == "%" or parameter.endswith("share") else unit or "1"


def _range(effect: str, parameter: str) -> tuple[str, str]:
    """Bounds of the search, from every description that has the parameter, on two flights."""
    ends = [
        [bounds for v in variants if (bounds := _bounds(v).get(parameter)) is not None]
        for variants in (described(effect, plan) for plan in PLANS)
    ]
    if not ends[0]:
        return "–", "–"
    lows, highs = ({pick(b[i] for b in of_plan) for of_plan in ends} for i, pick in ((0, min), (1, max)))
    return _figure(lows), _figure(highs)


def _figure(values: set[float]) -> str:
    shown = {short(value).replace("-", "−") for value in values}
    return "no end" if max(map(abs, values)) >= 1e8 else shown.pop() if len(shown) == 1 else _BY_FLIGHT


def _bounds(variant: Variant) -> Mapping[str, tuple[float, float]]:
    """The ends of each parameter as the aircraft file spells them."""
    ends = [
        parameters_of(variant, np.array(end), np.zeros(len(end))) for end in zip(*variant.bounds, strict=True)
    ]
    return {
        name: (min(low, high), max(low, high))
        for name in ends[0]
        if name not in variant.fixed
        for low, high in [(ends[0][name].value, ends[1][name].value)]
    }


def _needs(effect: Effect) -> Iterator[str]:
    reasons: dict[str, list[str]] = {}
    if effect.need is not None:
        reasons.setdefault(effect.need.add, []).append(effect.need.because)
    if effect.unrecorded is not None:
        _, because, add = effect.unrecorded
        reasons.setdefault(add, []).append(because)
    yield from (f"{add}; without that: “{'” or “'.join(because)}”" for add, because in reasons.items())
    if effect.need is None and effect.channel:
        yield f"the channel {_CHANNELS[effect.channel]}"
    if effect.unrecorded is None:
        yield from sorted(
            {f"the {need} in the log" for v in described(effect.name, PLANS[0]) for need in v.needs}
        )
    if not effect.of_the_stick:
        yield "something besides the elevator that varies"


def _apart(effect: Effect) -> Iterator[tuple[str, str]]:
    yield from ((f"`{other}`", way) for other, way in effect.distinguished_by.items())
    yield from (
        (f"`{other}`", its.distinguished_by[effect.name])
        for other, its in EFFECTS.items()
        if effect.name in its.distinguished_by
    )
    if effect.imitated_by is not None:
        yield effect.imitated_by
    if effect.imitated_without is not None:
        output, other, way = effect.imitated_without
        yield f"{other}, without the {_CHANNELS[output]}", way
