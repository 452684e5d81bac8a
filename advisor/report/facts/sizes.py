"""Sizes of effects and derivatives in units for people: milliseconds, degrees, per cent, metres."""

import math
from collections.abc import Mapping

from advisor.gap.result import Value
from advisor.words.quantities import NORMAL_95, PARAMETERS, with_half

_DEG = math.degrees(1.0)
_ENDINGS = {
    "_rad_s": (_DEG, "deg/s"),
    "_per_s": (6000.0, "%/min"),
    "_m_s": (1.0, "m/s"),
    "_rad": (_DEG, "deg"),
    "_hz": (1.0, "Hz"),
    "_s": (1e3, "ms"),
    "_m": (1.0, "m"),
}
"""Factor from SI and unit for people, by the ending of a parameter's name. The longest matching ending
applies."""
_OWN_UNITS = {"at_s": (1.0, "s"), "over_s": (1.0, "s"), "omega_rad_s": (0.5 / math.pi, "Hz")}
"""Parameters whose unit for people does not follow from the name's ending."""
_LEAST, _ROUNDING = 1e-3, 1e-9
"""Gap below which the text says "<", and gap below which only rounding is left."""
_SHARES = frozenset({"scale", "step", "inertia", "change", "share", "damping", "lift_h", "airspeed_excess"})
_ICE = frozenset({"Z_alpha", "Z_delta_e", "M_alpha", "M_delta_e"})
"""Names of ice parameters, which are relative changes of derivatives."""
_OF_DERIVATIVES = {
    "Z_alpha2": "s⁻¹rad⁻¹", "Z_alpha3": "s⁻¹rad⁻²", "Z_h": "s⁻¹",
    "M_alpha2": "s⁻²rad⁻¹", "M_alpha3": "s⁻²rad⁻²", "M_delta2": "s⁻²rad⁻¹", "M_delta3": "s⁻²rad⁻²",
    "M_alpha_dot": "s⁻¹", "M_thrust": "s⁻²", "M_throttle": "s⁻²", "M_h": "s⁻²",
    "gain": "s⁻¹", "displacement_gain": "s⁻¹", "sharpness": "rad⁻¹",
}  # fmt: skip
_SYMBOLS = {
    "Z_alpha2": "Z_α²", "Z_alpha3": "Z_α³", "M_alpha2": "M_α²", "M_alpha3": "M_α³",
    "M_delta2": "M_δe²", "M_delta3": "M_δe³", "M_alpha_dot": "M_α̇", "M_thrust": "M_thrust",
    "M_throttle": "M_throttle", "M_h": "M_h", "Z_h": "Z_h", "omega_rad_s": "frequency",
    "skew_s": "lateness", **{name: PARAMETERS[name].symbol for name in _ICE},
}  # fmt: skip
"""Name for people of each parameter whose name in the file is hard to read."""
_SIGNED = frozenset({"scale", "step", "inertia", "change", "skew_s", "bias_rad", "bias_rad_s", *_ICE})
"""Parameters whose sign is stated."""


_IN_WORDS = {
    "with_pitch_rate": "the pitch rate, too",
    "with_moment": "the moment, too",
    "with_attitude": "the attitude, too",
    "stability_only": "of the stability alone",
}
"""Words for each parameter that has no size."""


def short(x: float) -> str:
    """Return a number with three digits, without powers of ten up to thousands; a dash for NaN."""
    if math.isnan(x):
        return "–"
    if abs(x) < _LEAST:
        return "0" if abs(x) < _ROUNDING else "<0.001"
    return f"{x:,.0f}" if 1e3 <= abs(x) < 1e7 else f"{x:.3g}"


WORSE = "▲"
"""Mark of a gap that has grown."""


def before_after(before: float, after: float) -> str:
    """Return two gaps as ``6.1 → 0.09``, with a mark if the gap has grown."""
    return f"{short(before)} → {marked(after, before)}"


def marked(after: float, before: float) -> str:
    """Return the gap after the corrections, with a mark if the gap has grown."""
    return f"{short(after)} {WORSE}" if has_grown(after, before) else short(after)


def has_grown(after: float, before: float) -> bool:
    """Return whether the printed digits show a larger gap than before."""
    return after > before and short(after) != short(before)


def in_units(parameter: str) -> tuple[float, str]:
    """Return the factor from SI and the displayed unit of a parameter."""
    if parameter in _SHARES or parameter in _ICE:
        return 100.0, "%"
    if parameter in _OF_DERIVATIVES:
        return 1.0, _OF_DERIVATIVES[parameter]
    if parameter in _OWN_UNITS:
        return _OWN_UNITS[parameter]
    for ending, shown in _ENDINGS.items():
        if parameter.endswith(ending):
            return shown
    return 1.0, ""


def with_error(parameter: str, value: Value) -> str:
    """Return a size with the half-width of its 95 % interval: ``30 ± 12 ms``."""
    factor, unit = in_units(parameter)
    number, half = factor * value.value, abs(factor * NORMAL_95 * value.std)
    plus = "+" if parameter in _SIGNED and number > 0.0 else ""
    if not math.isfinite(half) or half == 0.0:
        return f"{plus}{number:.3g} {unit}".replace("-", "−").rstrip()
    return f"{plus}{with_half(number, half)} {unit}".rstrip()


def sizes_of(parameters: Mapping[str, Value]) -> list[str]:
    """Return the lines of a cause's parameters, with names if there are several."""
    words = [text for name, text in _IN_WORDS.items() if name in parameters]
    shown = {name: with_error(name, value) for name, value in parameters.items() if name not in _IN_WORDS}
    if len(shown) == 1:
        return [*shown.values(), *words]
    return [*(f"{named(name)} {text}" for name, text in shown.items()), *words]


def named(parameter: str) -> str:
    """Return the name of a parameter for people, without its unit."""
    if parameter in _SYMBOLS:
        return _SYMBOLS[parameter]
    for ending in _ENDINGS:
        if parameter.endswith(ending):
            return parameter.removesuffix(ending).replace("_", " ")
    return parameter.replace("_", " ")
