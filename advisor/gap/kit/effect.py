"""An effect of the catalogue: all that the program states about an effect, in one object, with its variants.

Each module of ``advisor.gap.effects`` makes one ``Effect``. The search, the aircraft file, the sentences, the
pages, the user's simulator and the exports read that object.

A linear model uses deviations from trim only, but a wing's or an elevator's curve depends on the angle.
Manoeuvres at different speeds have different trims, so each covers another part of one curve.
"""

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial

import numpy as np

from advisor.gap.records.flights import PreparedManeuvers
from advisor.gap.simulator.layout import INDEX, OUTPUTS, SKEWS
from advisor.process.arrays import FloatArray

Values = Sequence[float] | FloatArray
Apply = Callable[[FloatArray, Values, PreparedManeuvers], None]
"""Function that writes parameter values into the simulator inputs, shape (manoeuvres, entries), in place."""


@dataclass(frozen=True)
class Variant:
    """One description of an effect for a fit. An effect of the catalogue has one or several variants."""

    effect: str
    """Name of the effect in the catalogue."""
    block: str
    names: tuple[str, ...]
    """Names of the effect's parameters, in the spelling of the aircraft file."""
    starts: tuple[tuple[float, ...], ...]
    """Starting values of the search; several where the cost has local minima."""
    steps: tuple[float, ...]
    """Finite-difference step of each parameter."""
    bounds: tuple[tuple[float, float], ...]
    smallest: float
    """Least size of the first parameter in a plan's forecast: 4 ms, 1 %, 0.1 deg."""
    entries: tuple[str, ...] = ()
    """Simulator entries that equal the parameters one to one; empty where ``apply_with`` is given."""
    apply_with: Apply | None = None
    sides: tuple[str, tuple[float, ...]] | None = None
    """Simulator entry with a choice of values in each manoeuvre, such as the side on which the play rests."""
    needs: frozenset[str] = field(default_factory=frozenset)
    """Slow channels without which the effect cannot be tried."""
    fixed: Mapping[str, float] = field(default_factory=dict)
    """Parameters of the aircraft file that are not searched for, such as the time of a step."""
    places: tuple[str, ...] = ()
    """Parameters of position, time or rate instead of size. A size of zero does not mean that the effect is
    absent."""
    prior_std: tuple[float, ...] = ()
    """Prior standard deviation of each parameter about zero; empty for a flat prior."""
    is_nuisance: bool = False
    """Whether the parameters are nuisance parameters, which are part of every model and never named."""
    likewise: "tuple[Variant, ...]" = ()
    """Alternative variants, so similar that only a full fit can decide."""
    sets: bool = False
    """Whether the parameter replaces the simulator's value instead of adding to it."""
    in_file: Mapping[str, tuple[str, float]] = field(default_factory=dict)
    """Parameter, and factor from the file's number to the parameter, for each name in the aircraft file. An
    empty mapping means that the file holds the parameters unchanged."""
    inverted: bool = False
    """Whether the aircraft file holds the reciprocal of the first parameter, as for a rate limit."""

    @property
    def comes_at_any_time(self) -> bool:
        """Whether the effect is a change that may have occurred at any time of the flight."""
        return "at_s" in self.fixed or "at_s" in self.names

    def apply(self, p: FloatArray, values: Values, flights: PreparedManeuvers) -> None:
        """Write the parameter values into ``p``, shape (manoeuvres, entries)."""
        if self.apply_with is not None:
            self.apply_with(p, values, flights)
            return
        for entry, value in zip(self.entries, values, strict=True):
            p[:, INDEX[entry]] += value


_TRIMS_DIFFER = 0.1
"""Least difference of the trims, as a share of the largest deviation from trim, that distinguishes the two
kinds of curve."""


@dataclass(frozen=True, slots=True)
class Curve:
    """Terms of a force or of the pitching moment in powers of one variable, at constant dynamic pressure."""

    variable: str
    """Variable of the curve, ``alpha``, ``delta_e`` or ``alpha_dot``, in rad or rad/s."""
    powers: Mapping[str, int]
    """Power of the variable for each parameter. The first letter of a parameter is Z for force and M for
    moment."""

    @property
    def slope(self) -> str:
        """Derivative of the linear term with respect to the variable."""
        return f"{next(iter(self.powers))[0]}_{self.variable}"


def bending(variant: Variant, curve: Curve) -> Callable[[PreparedManeuvers], Sequence[Variant]]:
    """Return a function that makes the variant of an effect whose only form is a curve."""
    return partial(_only_bent, variant, curve)


def _only_bent(variant: Variant, curve: Curve, flights: PreparedManeuvers) -> Sequence[Variant]:
    return (bent(variant, curve, flights),)


def bent(variant: Variant, curve: Curve, flights: PreparedManeuvers) -> Variant:
    """Return ``variant``, a square and a cube about each trim, with a curve about one common angle as
    alternative."""
    if curve.variable == "delta_e":
        moved = [f.u - f.u_trim for f in flights.flights]
    elif "alpha" in flights.channels:
        moved = [f.outputs["alpha"].y - f.alpha_trim for f in flights.flights]
    else:
        return variant
    trims = _trims_of(curve, flights)
    usual = float(np.median(trims))
    if np.max(np.abs(np.array(trims) - usual)) < _TRIMS_DIFFER * max(float(np.max(np.abs(m))) for m in moved):
        return variant
    return replace(variant, likewise=(_about(usual, variant, curve),))


def as_in_file(variant: Variant, curve: Curve | None, parameters: Mapping[str, float]) -> Variant:
    """Return a curve about the angle that an aircraft file states, whatever the trims of the flights."""
    if curve is None or "about_rad" not in parameters or variant.names != tuple(curve.powers):
        return variant
    return _about(parameters["about_rad"], variant, curve)


def _trims_of(curve: Curve, flights: PreparedManeuvers) -> list[float]:
    return [f.u_trim if curve.variable == "delta_e" else f.alpha_trim for f in flights.flights]


def _about(angle_rad: float, variant: Variant, curve: Curve) -> Variant:
    """Return a variant with (x + D)² and (x + D)³ expanded in x, D being trim minus the angle."""
    slope, square, cube = (INDEX[entry] for entry in (curve.slope, *curve.powers))

    def bend(p: FloatArray, values: Values, flights: PreparedManeuvers) -> None:
        offset = np.array(_trims_of(curve, flights)) - angle_rad
        p[:, slope] += (2.0 * values[0] + 3.0 * values[1] * offset) * offset
        p[:, square] += values[0] + 3.0 * values[1] * offset
        p[:, cube] += values[1]

    return replace(variant, entries=(), apply_with=bend, fixed={"about_rad": angle_rad})


Said = str | tuple[str, str]
"""Sentence about an effect, with its sizes. A second sentence is used for a negative first parameter, and
shows sizes without sign. Sizes are written as ``{parameter:.0f}``; the suffix ``_ms``, ``_deg``, ``_percent``
or ``_power`` sets the unit."""
BLOCKS = (
    "input", "moment_equation", "force_equation", "air", "alpha_sensor", "pitch_rate_sensor", "accelerometer",
    "timing",
)  # fmt: skip
"""Blocks of a simulator that effects belong to, in their order on every page."""
ANY = float("-inf")
"""Least allowed value of a parameter that may have any value."""


@dataclass(frozen=True, slots=True)
class Need:
    """Reason why an effect cannot be detected, and the measurement that would detect it."""

    because: str
    add: str


@dataclass(frozen=True, kw_only=True, slots=True)
class Effect:
    """An effect of the catalogue."""

    name: str
    """Name of the effect, and of its module."""
    block: str
    """Block of the simulator that the effect belongs to, of ``BLOCKS``."""
    keys: Mapping[str, float]
    """Least allowed value of each parameter in the aircraft file."""
    variants: Callable[[PreparedManeuvers], Sequence[Variant]]
    """Function that returns the effect's variants in a fit, with parameters, bounds and priors. The function
    returns no variant if the effect is judged outside the fits."""
    said: Said
    said_with: Mapping[str, Said] = field(default_factory=dict)
    """Sentence for each parameter that only some variants of the effect have."""
    said_or: str = ""
    """Words for the effect as an alternative to a similar effect; empty if it is only listed."""
    said_beyond: Said = ""
    """Sentence if the simulator already has some of the effect; empty if ``said`` is used."""
    channel: str = ""
    """Output without which the effect cannot be tried; empty if any output suffices."""
    stated: tuple[str, str] | None = None
    """Section and key of the aircraft file that state the effect's size in the simulator."""
    outside_fits: Callable[[PreparedManeuvers], bool] | None = None
    """Function that returns whether the effect can be judged outside the fits; None for other effects."""
    of_one_flight: bool = False
    """Whether the effect belongs to one flight and does not occur in another."""
    of_one_imu: bool = False
    """Whether an α that an autopilot computes from its own rates and accelerations cannot show the effect."""
    of_the_stick: bool = True
    """Whether the elevator alone can show the effect; otherwise another input must vary."""
    need: Need | None = None
    """Requirement for the detection of the effect, if its channel or its cause may be missing."""
    unrecorded: tuple[str, str, str] | None = None
    """Slow channel that shows the effect, with the reason and the remedy if it was not recorded."""
    without_speed: tuple[str, str] | None = None
    """Reason and remedy if the air speed sensor reads almost nothing."""
    imitated_by: tuple[str, str] | None = None
    """Cause outside the catalogue that looks like the effect, and the measurement that distinguishes both."""
    imitated_without: tuple[str, str, str] | None = None
    """Output, cause that looks like the effect without that output, and the measurement that distinguishes
    both."""
    distinguished_by: Mapping[str, str] = field(default_factory=dict)
    """Measurement that distinguishes the effect from a similar one, by the similar effect's name."""
    curve: Curve | None = None
    """Form of the effect in an export of force and moment; None where no format supports it."""
    servo: Mapping[str, tuple[str, float]] = field(default_factory=dict)
    """Field of ``ExportedServo`` to which each parameter adds in an export of the servo, and the factor."""


def without_sizes(said: Said, size: str) -> tuple[str, ...]:
    """Return the sentences with ``size`` in place of every number."""
    both = (said,) if isinstance(said, str) else said
    return tuple(re.sub(r"\{\w+:[^}]*\}", size, text) for text in both)


def always(*variants: Variant) -> Callable[[PreparedManeuvers], Sequence[Variant]]:
    """Return a function that returns ``variants`` for any flights."""
    return partial(_given, variants)


def _given(variants: Sequence[Variant], _: PreparedManeuvers) -> Sequence[Variant]:
    return variants


def not_fitted(_: PreparedManeuvers) -> Sequence[Variant]:
    """Return no variant, because the effect is judged outside the fits."""
    return ()


LEAST_S = 0.004
FILTERED_S = 0.02
"""Least delay or lag that is named, s: a fifth of a sample at 50 Hz, and the delay of an autopilot's
filters."""
SMALL_ANGLE_RAD = 0.00175
"""Least angle that is named, rad (0.1 deg): no linkage has less play."""
ARM_M, _OF_A_DELAY = 0.02, 0.75
"""Least arm that is named, m, and the share of the least delay that gives the least arm over the air
speed."""


def least_delay_s(flights: PreparedManeuvers) -> float:
    """Return the least delay or lag of an instrument that is named, s.

    An autopilot's own estimates have passed its filters, and the delay of a filter is no fault.
    """
    return FILTERED_S if flights.alpha_is_derived else LEAST_S


def least_arm_m(flights: PreparedManeuvers) -> float:
    """Return the least arm of an instrument that is named, m.

    In a turning flight path, a vane ahead of the centre of gravity makes α late by arm over speed. The
    accelerometer's position has an equal effect, and the gyro's filter adds three quarters of the least
    delay.
    """
    return max(ARM_M, _OF_A_DELAY * least_delay_s(flights) * flights.reference_m_s)


UNFILTERED = (
    "a filter of that channel with an equal delay",
    "log the channel as its sensor reads it, before any filter",
)
"""Cause that looks like a late channel, and the measurement that distinguishes both."""


def skewed(effect: str, channel: str) -> Callable[[PreparedManeuvers], Sequence[Variant]]:
    """Return a function that describes the skew of one channel as the only form of an effect."""
    return partial(_only_skew, effect, channel)


def _only_skew(effect: str, channel: str, flights: PreparedManeuvers) -> Sequence[Variant]:
    return (skew_of(effect, channel, flights),)


def skew_of(effect: str, channel: str, flights: PreparedManeuvers) -> Variant:
    """Return the error of one channel's stamps, s, positive where the channel is late."""
    apply = partial(_whole_skew, SKEWS[OUTPUTS.index(channel)])
    return replace(skew_beyond(effect, least_delay_s(flights)), apply_with=apply, sets=True)


def skew_beyond(effect: str, least_s: float) -> Variant:
    """Return the variant for the skew of any channel, named if at least ``least_s``, s."""
    return Variant(
        effect, "timing", ("skew_s",), ((0.02,), (-0.02,), (0.1,), (-0.1,)), (1e-3,), ((-0.4, 0.4),), least_s
    )


def _whole_skew(entry: str, p: FloatArray, values: Values, _: PreparedManeuvers) -> None:
    """Set the total skew of a channel, including the delay of a filter."""
    p[:, INDEX[entry]] = values[0]
