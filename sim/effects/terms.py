"""Effects in an aircraft file: terms and components that a diagnosis added to the linear aircraft.

Components (actuators, instruments, timing, air) are those of :mod:`sim.effects.catalogue`. Aerodynamic
effects are terms of the linear equations.
"""

import math
from collections.abc import Callable, Mapping
from typing import Any

from ..airframe import GRAVITY_M_S2
from ..linear import ShortPeriod
from ..motion import Motion
from .air import Gusts
from .catalogue import CATALOGUE
from .changes import FieldChange, Onset
from .kit import Kit, Sizes

Term = Callable[[Kit, Any, Sizes, float], None]
"""Function that adds a term to the linear aircraft. Its arguments are kit, linear aircraft, parameters, and
the boot time of the log's start (s)."""


class MoreMass:
    """Change of mass and inertia in flight. The factors divide the moments and all forces except the
    weight."""

    def __init__(self, mass: Callable[[float], float], inertia: Callable[[float], float]) -> None:
        self.mass, self.inertia = mass, inertia
        """Relative growth of mass and of inertia over time."""
        self._plain: dict[str, float] | None = None

    def apply(self, time_s: float, motion: Motion, engine: Any) -> None:
        """Set the model's parameters for ``time_s``."""
        if self._plain is None:
            self._plain = {name: float(engine.record[name][0]) for name in ShortPeriod.__dataclass_fields__}
        mass, inertia = 1.0 + self.mass(time_s), 1.0 + self.inertia(time_s)
        for name, plain in self._plain.items():
            weight = _weight(engine) if name == "Z_0" else 0.0
            engine.record[name] = weight + (plain - weight) / (inertia if name.startswith("M_") else mass)


def _weight(engine: Any) -> float:
    """Return the weight's part of Z_0, 1/s. The other part of Z_0 is aerodynamic."""
    return GRAVITY_M_S2 / float(engine.record["speed_ref"][0])


def _onset(kit: Kit, sizes: Sizes, boot_s: float) -> Onset:
    """Return the onset of a change: by default in the middle of the flight."""
    return Onset(sizes.get("at_s", boot_s + kit.middle_s) - boot_s, sizes.get("over_s", 0.0))


def _fields(none_at: str = "", **names: str) -> Term:
    """Return a term that sets fields of the linear aircraft's record, by the parameters' names.

    If the parameter ``none_at``, such as a lag or a length, is zero, there is no term.
    """

    def fit(kit: Kit, engine: Any, sizes: Sizes, boot_s: float) -> None:
        if sizes.get(none_at) == 0.0:
            return
        for parameter, field in names.items():
            if parameter in sizes:
                engine.record[field] = sizes[parameter]

    return fit


def _more_mass(kit: Kit, engine: Any, sizes: Sizes, boot_s: float) -> None:
    if "rate_per_s" in sizes:

        def drift(t: float) -> float:
            return sizes["rate_per_s"] * max(t - kit.first_s, 0.0)

        kit.fittings.plant.append(MoreMass(drift, drift))
    if "step" in sizes:
        onset = _onset(kit, sizes, boot_s)
        mass, inertia = sizes["step"], sizes.get("inertia", sizes["step"])
        kit.fittings.plant.append(
            MoreMass(lambda t: mass * onset.share(t), lambda t: inertia * onset.share(t))
        )


def _moved_weight(kit: Kit, engine: Any, sizes: Sizes, boot_s: float) -> None:
    """Move the centre of gravity, so that all aerodynamic force gets an additional arm.

    Sizes are relative changes of M_α. With ``stability_only`` only M_α changes, as in textbooks.
    """
    model = {name: float(engine.record[name][0]) for name in ShortPeriod.__dataclass_fields__}
    arm = model["M_alpha"] / model["Z_alpha"] if model["Z_alpha"] else 0.0
    carried = model["Z_0"] - _weight(engine)
    further = {"M_0": arm * carried, "M_q": arm * model["Z_q"], "M_delta_e": arm * model["Z_delta_e"]}
    if sizes.get("stability_only", 0.0) > 0.0:
        # The aircraft is trimmed anew: the moment of the trimmed angle changes with the stability.
        further = {"M_0": -model["M_alpha"] * float(engine.record["alpha_ref"][0])}

    def change(onset: Onset, by: float) -> None:
        offsets = {name: by * moment for name, moment in further.items()}
        kit.fittings.plant.append(FieldChange(onset, {"M_alpha": by}, offsets))

    if "rate_per_s" in sizes:
        lasts_s = max(kit.duration_s - kit.first_s, 1.0)
        change(Onset(kit.first_s, lasts_s), sizes["rate_per_s"] * lasts_s)
    if "step" in sizes:
        change(_onset(kit, sizes, boot_s), sizes["step"])


def _ice(kit: Kit, engine: Any, sizes: Sizes, boot_s: float) -> None:
    onset = _onset(kit, sizes, boot_s)
    factors = {name: value for name, value in sizes.items() if name not in ("at_s", "over_s")}
    kit.fittings.plant.append(FieldChange(onset, factors, {}))


def _speed(kit: Kit, engine: Any, sizes: Sizes, boot_s: float) -> None:
    engine.record["speed_scaled"] = engine.record["gravity"] = 1.0
    power = sizes.get("exponent", 0.0)
    engine.record["speed_power"] = power
    engine.record["moment_power"] = sizes.get("exponent_M", power) - power


def _gust(kit: Kit, engine: Any, sizes: Sizes, boot_s: float) -> None:
    """Add a gust with its peak at ``at_s``, by default of the usual length."""
    length = sizes.get("length_m", 0.0) or CATALOGUE["gust"].sizes["length_m"]
    peak_s = sizes.get("at_s", boot_s + kit.middle_s) - boot_s
    speed = float(engine.record["speed_ref"][0])
    begins_s = peak_s - 0.5 * length / speed
    kit.fittings.air.append(Gusts(sizes.get("amplitude_m_s", 0.0), length, (begins_s,)))


_ONSET = frozenset({"rate_per_s", "step", "at_s", "over_s"})

TERMS: Mapping[str, tuple[frozenset[str], Term]] = {
    "nonlinear_lift": (
        frozenset({"Z_alpha2", "Z_alpha3", "about_rad", "stall_rad", "sharpness"}),
        _fields(
            Z_alpha2="Z_alpha2",
            Z_alpha3="Z_alpha3",
            about_rad="Z_about",
            stall_rad="stall_alpha",
            sharpness="stall_sharpness",
        ),
    ),
    "nonlinear_pitching_moment": (
        frozenset({"M_alpha2", "M_alpha3", "about_rad"}),
        _fields(M_alpha2="M_alpha2", M_alpha3="M_alpha3", about_rad="M_about"),
    ),
    "elevator_nonlinearity": (
        frozenset({"M_delta2", "M_delta3", "about_rad"}),
        _fields(M_delta2="M_delta2", M_delta3="M_delta3", about_rad="delta_about"),
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
    "unsteady_lift": (
        frozenset({"share", "lag_s", "with_moment"}),
        _fields("lag_s", share="unsteady_share", lag_s="unsteady_lag", with_moment="unsteady_moment"),
    ),
    "ground_effect": (
        frozenset({"Z_h", "lift_h", "M_h", "scale_m"}),
        _fields("scale_m", Z_h="Z_h", lift_h="lift_h", M_h="M_h", scale_m="ground_scale"),
    ),
    "airspeed_variation": (frozenset({"change", "exponent", "exponent_M"}), _speed),
    "cg_shift": (_ONSET | {"stability_only"}, _moved_weight),
    "mass_change": (_ONSET | {"inertia"}, _more_mass),
    "gust": (frozenset({"amplitude_m_s", "length_m", "at_s"}), _gust),
    "icing": (frozenset({"Z_alpha", "Z_delta_e", "M_alpha", "M_delta_e", "at_s", "over_s"}), _ice),
}
"""Effects that are terms of the equations, with their parameters and their fitting functions."""


def problems_with(effects: Mapping[str, Sizes]) -> list[str]:
    """Return the mistakes in the ``effects`` of an aircraft file."""
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
    """Add every effect of an aircraft file to a linear aircraft."""
    for name, sizes in effects.items():
        if name in TERMS:
            TERMS[name][1](kit, engine, sizes, boot_s)
            continue
        kind = CATALOGUE[name]
        if kind.fit is None:
            continue
        # A size that is not given is zero, except for the length of moving air, which has its usual value.
        whole = {**dict.fromkeys(kind.sizes, 0.0), **sizes}
        if "length_m" in whole:
            whole["length_m"] = whole["length_m"] or kind.sizes["length_m"]
        if not all(math.isfinite(value) for value in whole.values()):
            continue
        kind.fit(kit, whole)
