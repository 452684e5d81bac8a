"""Usual names of a table's columns, with the unit at the end of a name: ``alpha_deg``, ``V [kt]``."""

import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from advisor.aircraft.standard_gravity import GRAVITY_M_S2

NAMES: Mapping[str, str] = {
    "time": "time t timestamp seconds elapsed t_boot time_boot",
    "elevator": "elevator de delta_e elev dele ele",
    "aileron": "aileron da delta_a ail dela",
    "rudder": "rudder dr delta_r rud delr",
    "q": "q pitch_rate pitchspeed pitchrate",
    "p": "p roll_rate rollspeed rollrate",
    "r": "r yaw_rate yawspeed yawrate",
    "alpha": "alpha aoa alfa angle_of_attack",
    "beta": "beta ssa aos sideslip angle_of_sideslip",
    "theta": "theta pitch pitch_angle",
    "bank": "bank phi roll bank_angle roll_angle",
    "a_x": "a_x ax accx acc_x xacc",
    "a_y": "a_y ay accy acc_y yacc",
    "a_z": "a_z az accz acc_z zacc",
    "airspeed": "airspeed tas true_airspeed vtas v vt ktas",
    "indicated_airspeed": "indicated_airspeed ias cas eas kias kcas keas",
    "height": "height alt altitude h alt_msl",
    "climb_rate": "climb_rate climb vertical_speed",
    "throttle": "throttle thr",
}
"""Usual names of each quantity in small letters, by the quantity's key in the section ``columns``."""
LOADS: Mapping[str, tuple[str, float]] = {
    "nx": ("a_x", GRAVITY_M_S2), "ny": ("a_y", GRAVITY_M_S2), "nz": ("a_z", -GRAVITY_M_S2)
}  # fmt: skip
"""Quantity of each load factor, with the factor to m/s². A normal load factor is positive upward."""
ANGLES = frozenset({"elevator", "aileron", "rudder", "alpha", "beta", "theta", "bank"})
RATES = frozenset({"q", "p", "r"})
_DEG = 0.017453292519943295
_KNOT, _FOOT, _KM_H = 0.514444, 0.3048, 1.0 / 3.6
_ANGLE = {"rad": 1.0, "deg": _DEG, "degrees": _DEG}
_RATE = {
    "rad_s": 1.0, "rads": 1.0, "radps": 1.0, "rad": 1.0, "deg_s": _DEG, "degs": _DEG, "dps": _DEG, "deg": _DEG
}  # fmt: skip
_SPEED = {
    "m_s": 1.0, "mps": 1.0, "ms": 1.0, "kt": _KNOT, "kts": _KNOT, "knots": _KNOT, "km_h": _KM_H, "kmh": _KM_H,
    "ft_s": _FOOT, "fps": _FOOT,
}  # fmt: skip
_FORCE = {"m_s2": 1.0, "mss": 1.0, "m_ss": 1.0, "g": GRAVITY_M_S2, "ft_s2": _FOOT}
UNITS: Mapping[str, Mapping[str, float]] = {
    "time": {"s": 1.0, "sec": 1.0, "seconds": 1.0, "ms": 1e-3, "us": 1e-6},
    **dict.fromkeys(ANGLES, _ANGLE),
    **dict.fromkeys(RATES, _RATE),
    **dict.fromkeys(("a_x", "a_y", "a_z"), _FORCE),
    **dict.fromkeys(("airspeed", "indicated_airspeed", "climb_rate"), _SPEED),
    "height": {"m": 1.0, "ft": _FOOT, "feet": _FOOT},
    "throttle": {"percent": 0.01, "pct": 0.01, "1": 1.0},
}
"""Factor from a unit to SI, by quantity and by the end of a column's name."""
_KNOTS_IN_NAME = frozenset({"ktas", "kias", "kcas", "keas"})


@dataclass(frozen=True, slots=True)
class NamedColumn:
    """A column of a table whose name says its quantity."""

    column: str
    factor: float | None
    """Factor from the column to SI; None for a name without a unit."""


def plain_name(column: str) -> str:
    """Return a name in small letters with single underscores: ``Alpha [deg]`` becomes ``alpha_deg``.

    Only the last part of a name with dots counts, which is the field of a structure.
    """
    return re.sub(r"[^a-z0-9]+", "_", column.rsplit(".", 1)[-1].lower()).strip("_")


def unit_of(quantity: str, column: str) -> float | None:
    """Return the factor of the unit at the end of a column's name; None for a name without a unit."""
    name = plain_name(column)
    fits = [unit for unit in UNITS[quantity] if name.endswith(f"_{unit}")]
    if fits:
        return UNITS[quantity][max(fits, key=len)]
    return _KNOT if name in _KNOTS_IN_NAME else None


def recognised_columns(columns: Iterable[str]) -> dict[str, NamedColumn]:
    """Return the columns that usual names identify, by quantity. The first of two equal names counts."""
    by_quantity: dict[str, NamedColumn] = {}
    for column in columns:
        for quantity, names in NAMES.items():
            stem = _without_unit(quantity, plain_name(column))
            if stem in names.split() and quantity not in by_quantity:
                by_quantity[quantity] = NamedColumn(column, unit_of(quantity, column))
        load = LOADS.get(plain_name(column).removesuffix("_g"))
        if load is not None:
            by_quantity.setdefault(load[0], NamedColumn(column, load[1]))
    return by_quantity


def _without_unit(quantity: str, name: str) -> str:
    fits = [unit for unit in UNITS[quantity] if name.endswith(f"_{unit}")]
    return name.removesuffix(f"_{max(fits, key=len)}") if fits else name


def is_flight(columns: Iterable[str]) -> bool:
    """Return whether the names of columns include a time, an angular rate and a control surface."""
    keys = recognised_columns(columns).keys()
    return "time" in keys and bool(keys & RATES) and bool(keys & {"elevator", "aileron", "rudder"})
