"""Non-dimensional coefficients from the derivatives, for known geometry and mass.

V is the true air speed and q̄ = ½·ρ·V² the dynamic pressure. Rates are divided by 2·V/c, and the drag in the
lift direction is neglected (Etkin & Reid, *Dynamics of Flight*, Table 4.4):

    Z_α = -q̄·S·C_Lα/(m·V)          M_α = q̄·S·c·C_mα/I_yy
    Z_q = -q̄·S·c·C_Lq/(2·m·V²)     M_q = q̄·S·c²·C_mq/(2·V·I_yy)
    Z_δe = -q̄·S·C_Lδe/(m·V)        M_δe = q̄·S·c·C_mδe/I_yy

C_mq includes C_mα̇, because still air does not distinguish both.
"""

from collections.abc import Mapping
from dataclasses import dataclass

from advisor.aircraft.reference import PARAMETERS, Reference
from advisor.flight.instruments.atmosphere import AirData
from advisor.oem.estimate import Estimate

CONVENTION = "per radian; rates as q·c/(2·V) with the true air speed V"


@dataclass(frozen=True, slots=True)
class Coefficient:
    """A non-dimensional derivative, per radian."""

    value: float
    std: float


def coefficients(estimate: Estimate, reference: Reference, air: AirData) -> Mapping[str, Coefficient]:
    """Return the coefficients by name; without reference data or air speed a coefficient is missing.

    Parameters
    ----------
    estimate
        Derivatives at the air speed ``estimate.airspeed_m_s``.
    reference
        Mass, wing area, chord and pitching inertia; a missing value leaves out its coefficients.
    air
        Air density, and the ratio of true to logged air speed.
    """
    if estimate.airspeed_m_s is None:
        return {}
    return {
        name: Coefficient(
            factor * estimate.value(parameter), abs(factor) * float(estimate.std[PARAMETERS.index(parameter)])
        )
        for name, (parameter, factor) in scales(estimate.airspeed_m_s, reference, air).items()
        if parameter not in estimate.not_identifiable
    }


def scales(airspeed_m_s: float, reference: Reference, air: AirData) -> Mapping[str, tuple[str, float]]:
    """Return the derivative of each coefficient and the factor between both, by the coefficient's name (Table
    4.4).

    Coefficients without reference data are left out. ``airspeed_m_s`` is of the kind that ``air`` states,
    such as true or indicated.
    """
    area, chord, mass, inertia = (
        reference.wing_area_m2,
        reference.chord_m,
        reference.mass_kg,
        reference.iyy_kg_m2,
    )
    if area is None:
        return {}
    speed, pressure = air.true_speed(airspeed_m_s), air.dynamic_pressure(airspeed_m_s)
    scale: dict[str, tuple[str, float]] = {}
    if mass is not None:
        force = -mass * speed / (pressure * area)
        scale |= {"C_L_alpha": ("Z_alpha", force), "C_L_delta_e": ("Z_delta_e", force)}
        if chord is not None:
            scale["C_L_q"] = ("Z_q", force * 2.0 * speed / chord)
    if inertia is not None and chord is not None:
        moment = inertia / (pressure * area * chord)
        scale |= {"C_m_alpha": ("M_alpha", moment), "C_m_delta_e": ("M_delta_e", moment)}
        scale["C_m_q"] = ("M_q", moment * 2.0 * speed / chord)
    return scale
