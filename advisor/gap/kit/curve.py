"""Nonlinear curves over an angle, either about the trim of each manoeuvre or about one common angle.

A linear model uses deviations from trim only, but a wing's or an elevator's curve depends on the angle.
Manoeuvres at different speeds have different trims, so each covers another part of one curve.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from advisor.gap.kit.variant import Values, Variant
from advisor.gap.records.flights import PreparedManeuvers
from advisor.gap.simulator.layout import INDEX
from advisor.process.arrays import FloatArray

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
