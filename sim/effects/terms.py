"""Effects of an aircraft file: the linear aircraft with the terms and components a diagnosis added.

Components (actuators, instruments, timing, air) are those of :mod:`sim.effects.catalogue`;
aerodynamic effects are terms of the linear equations.
"""

import math
from collections.abc import Callable, Mapping
from typing import Any

from sim.effects.air import Gusts
from sim.effects.catalogue import CATALOGUE
from sim.effects.changes import FieldChange, Onset
from sim.effects.kit import Kit, Sizes
from sim.linear import ShortPeriod
from sim.motion import Motion

Term = Callable[[Kit, Any, Sizes, float], None]
"""Fits a term: kit, linear aircraft, parameters, and the boot time at which the log begins (s)."""


class Drift:
    """A derivative that changes steadily with time: factor 1 + rate · t."""

    def __init__(self, names: tuple[str, ...], rate_per_s: float, from_s: float, inverse: bool) -> None:
        self.names, self.rate, self.from_s, self.inverse = names, rate_per_s, from_s, inverse
        self._plain: dict[str, float] | None = None

    def apply(self, time_s: float, motion: Motion, engine: Any) -> None:
        """Set the derivatives for ``time_s``."""
        if self._plain is None:
            self._plain = {name: float(engine.record[name][0]) for name in self.names}
        factor = 1.0 + self.rate * max(time_s - self.from_s, 0.0)
        for name, plain in self._plain.items():
            engine.record[name] = plain / factor if self.inverse else plain * factor


def _fields(**names: str) -> Term:
    """A term whose parameters (keys) are fields of the linear aircraft's record (values)."""

    def fit(kit: Kit, engine: Any, sizes: Sizes, boot_s: float) -> None:
        for parameter, field in names.items():
            if parameter in sizes:
                engine.record[field] = sizes[parameter]

    return fit


def _between_maneuvers(names: tuple[str, ...], inverse: bool) -> Term:
    def fit(kit: Kit, engine: Any, sizes: Sizes, boot_s: float) -> None:
        first_s = kit.planned[0].start_s if kit.planned else 0.0
        if "rate_per_s" in sizes:
            kit.fittings.plant.append(Drift(names, sizes["rate_per_s"], first_s, inverse))
        if "step" in sizes:
            share = 1.0 / (1.0 + sizes["step"]) - 1.0 if inverse else sizes["step"]
            onset = Onset(sizes.get("at_s", boot_s + kit.middle_s) - boot_s, sizes.get("over_s", 0.0))
            kit.fittings.plant.append(FieldChange(onset, dict.fromkeys(names, share), {}))

    return fit


def _ice(kit: Kit, engine: Any, sizes: Sizes, boot_s: float) -> None:
    onset = Onset(sizes.get("at_s", boot_s + kit.middle_s) - boot_s, sizes.get("over_s", 0.0))
    factors = {name: value for name, value in sizes.items() if name not in ("at_s", "over_s")}
    kit.fittings.plant.append(FieldChange(onset, factors, {}))


def _speed(kit: Kit, engine: Any, sizes: Sizes, boot_s: float) -> None:
    engine.record["speed_scaled"] = engine.record["gravity"] = 1.0
    engine.record["speed_power"] = sizes.get("exponent", 0.0)


def _gust(kit: Kit, engine: Any, sizes: Sizes, boot_s: float) -> None:
    times = (sizes.get("at_s", boot_s + kit.middle_s) - boot_s,)
    kit.fittings.air.append(Gusts(sizes.get("amplitude_m_s", 0.0), sizes.get("length_m", 1.0), times))


_DERIVATIVES = tuple(name for name in ShortPeriod.__dataclass_fields__ if not name.endswith("_0"))

TERMS: Mapping[str, tuple[frozenset[str], Term]] = {
    "nonlinear_lift": (
        frozenset({"Z_alpha2", "Z_alpha3", "stall_rad", "sharpness"}),
        _fields(
            Z_alpha2="Z_alpha2",
            Z_alpha3="Z_alpha3",
            stall_rad="stall_alpha",
            sharpness="stall_sharpness",
        ),
    ),
    "nonlinear_pitching_moment": (
        frozenset({"M_alpha2", "M_alpha3"}),
        _fields(M_alpha2="M_alpha2", M_alpha3="M_alpha3"),
    ),
    "elevator_nonlinearity": (
        frozenset({"M_delta2", "M_delta3"}),
        _fields(M_delta2="M_delta2", M_delta3="M_delta3"),
    ),
    "alpha_dot": (frozenset({"M_alpha_dot"}), _fields(M_alpha_dot="M_alpha_dot")),
    "thrust_moment": (
        frozenset({"M_throttle", "lag_s", "M_thrust", "washed_share", "blown_share"}),
        _fields(
            M_throttle="M_throttle",
            lag_s="throttle_lag",
            M_thrust="M_thrust",
            washed_share="washed_share",
            blown_share="blown_share",
        ),
    ),
    "unsteady_lift": (frozenset({"share", "lag_s"}), _fields(share="unsteady_share", lag_s="unsteady_lag")),
    "ground_effect": (
        frozenset({"Z_h", "lift_h", "M_h", "scale_m"}),
        _fields(Z_h="Z_h", lift_h="lift_h", M_h="M_h", scale_m="ground_scale"),
    ),
    "airspeed_variation": (frozenset({"change", "exponent"}), _speed),
    "cg_shift": (
        frozenset({"rate_per_s", "step", "at_s", "over_s"}),
        _between_maneuvers(("M_alpha",), inverse=False),
    ),
    "mass_change": (
        frozenset({"rate_per_s", "step", "at_s", "over_s"}),
        _between_maneuvers(_DERIVATIVES, inverse=True),
    ),
    "gust": (frozenset({"amplitude_m_s", "length_m", "at_s"}), _gust),
    "icing": (frozenset({"Z_alpha", "Z_delta_e", "M_alpha", "M_delta_e", "at_s", "over_s"}), _ice),
}
"""Effects that are terms of the equations: their parameters, and how they are fitted."""


def problems_with(effects: Mapping[str, Sizes]) -> list[str]:
    """Say what in an aircraft file's ``effects`` cannot be flown."""
    problems = []
    for name, sizes in effects.items():
        if name in TERMS:
            known: frozenset[str] = TERMS[name][0]
        elif name in CATALOGUE:
            known = frozenset(CATALOGUE[name].sizes)
        else:
            problems.append(f"effects.{name}: unknown effect")
            continue
        problems += [
            f"effects.{name}.{key}: unknown parameter, choose from {', '.join(sorted(known))}"
            for key in sizes
            if key not in known
        ]
    return problems


def fit_terms(kit: Kit, engine: Any, effects: Mapping[str, Sizes], boot_s: float) -> None:
    """Fit every effect of an aircraft file to a linear aircraft."""
    for name, sizes in effects.items():
        if name in TERMS:
            TERMS[name][1](kit, engine, sizes, boot_s)
            continue
        kind = CATALOGUE[name]
        if kind.fit is None:
            continue
        whole = {**dict.fromkeys(kind.sizes, 0.0), **sizes}
        if not all(math.isfinite(value) for value in whole.values()):
            continue
        kind.fit(kit, whole)
