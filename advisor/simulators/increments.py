"""Force and moment that effects add to a simulator: Eqs. (1)-(2) with the effects minus those without.

The parameters are entries of ``advisor.gap.simulator.layout``. An effect therefore acts in the user's
simulator as in the model in which the diagnosis found the effect.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from math import cos, exp, sqrt

from advisor.aircraft.standard_gravity import GRAVITY_M_S2
from advisor.flight.signals.messages import FloatArray
from advisor.gap.simulator.layout import DERIVATIVES, ENTRIES, INDEX
from advisor.simulators.protocol import State

CARRIED = (
    *DERIVATIVES, "Z_trim", "M_trim",
    "M_delta2", "M_delta3", "M_alpha2", "M_alpha3", "M_alpha_dot", "M_h", "M_throttle", "engine_lag_s",
    "Z_alpha2", "Z_alpha3", "stall_rad", "stall_sharpness", "lift_share", "lift_lag_s", "moment_share",
    "Z_h", "lift_h", "scale_m", "speed_power", "moment_power",
)  # fmt: skip
"""Entries that become increments."""
_HIGHEST = 3.0
"""Exponent of the ground's influence that is never exceeded below the reference height."""


@dataclass(frozen=True)
class SimulatorIncrements:
    """Increments of a simulator: an instance is an ``advisor.simulators.protocol.Increments``."""

    found: Mapping[str, float]
    """Entries of ``CARRIED`` with the effects."""
    plain: Mapping[str, float]
    """Entries of ``CARRIED`` as the simulator has them."""
    alpha_trim: float
    """Angle of attack at which the simulator is trimmed, rad."""
    reference_m_s: float
    ground_m: float
    """Height above the ground at the start of the manoeuvre, m. A simulator's own height is a density's."""
    _memory: dict[str, float] = field(default_factory=dict, compare=False, repr=False)

    def __call__(self, state: State) -> tuple[float, float]:
        """Return increments of α̇ in rad/s and of q̇ in rad/s²."""
        lagging, engine = self._remembered(state)
        state = replace(state, height_m=self.ground_m + state.height_m - self._memory["began_m"])
        z, m = self._right_side(self.found, state, lagging, engine)
        z_plain, m_plain = self._right_side(self.plain, state, state.alpha, state.throttle)
        return z - z_plain, m - m_plain

    def _remembered(self, state: State) -> tuple[float, float]:
        """Return the lagging angle of the lift and the lagging throttle of the engine, after the time since
        the last call."""
        seen = self._memory
        if not seen or state.t < seen["t"]:
            seen.update(t=state.t, lift=self.alpha_trim, engine=0.0, began_m=state.height_m)
        passed = state.t - seen["t"]
        for name, lag, towards in (
            ("lift", self.found["lift_lag_s"], state.alpha),
            ("engine", self.found["engine_lag_s"], state.throttle),
        ):
            keep = exp(-passed / lag) if lag > 0.0 else 0.0
            seen[name] = towards + keep * (seen[name] - towards)
        seen["t"] = state.t
        return seen["lift"], seen["engine"]

    def _right_side(
        self, p: Mapping[str, float], s: State, lift: float, engine: float
    ) -> tuple[float, float]:
        """Return normal force over m·V in rad/s, and pitch acceleration in rad/s²."""
        v = s.airspeed_m_s / self.reference_m_s
        power = v ** p["speed_power"]
        turning = power * v ** p["moment_power"]
        near = exp(min(-s.height_m / p["scale_m"], _HIGHEST)) if p["scale_m"] > 0.0 else 0.0
        departure = s.alpha - self.alpha_trim
        behind = s.alpha - lift
        a, turned = departure - p["lift_share"] * behind, departure - p["moment_share"] * behind
        d = s.elevator
        wing = p["Z_trim"] + (p["Z_alpha"] + (p["Z_alpha2"] + p["Z_alpha3"] * a) * a) * a
        lifting = power * v * (1.0 + p["lift_h"] * near)
        force = lifting * (
            attached(p["stall_sharpness"], s.alpha - p["stall_rad"]) * wing + p["Z_delta_e"] * d
        )
        force += v * p["Z_h"] * near + p["Z_q"] * s.q
        moment = p["M_trim"] + p["M_h"] * near
        moment += (p["M_delta_e"] + (p["M_delta2"] + p["M_delta3"] * d) * d) * d
        moment += (p["M_alpha"] + (p["M_alpha2"] + p["M_alpha3"] * departure) * departure) * turned
        rates = v * (p["M_q"] * s.q + p["M_alpha_dot"] * s.alpha_dot)
        return force, turning * v * v * moment + rates + p["M_throttle"] * engine


def attached(sharpness: float, beyond_rad: float) -> float:
    """Return the attached share of the lift beyond an angle of attack (Kirchhoff's flow); 1 without a
    sharpness."""
    if sharpness <= 0.0:
        return 1.0
    chord = 1.0 / (1.0 + exp(min(2.0 * sharpness * beyond_rad, 700.0)))
    return 0.25 * (1.0 + sqrt(chord)) ** 2


def trimmed(
    p: FloatArray, alpha: float, theta: float, speed: float, height: float, reference: float
) -> FloatArray:
    """Return driving numbers, shape (entries,), with the trim terms of steady flight in this state."""
    out = p.copy()
    e = entries_of(p)
    v = speed / reference
    near = exp(min(-height / e["scale_m"], _HIGHEST)) if e["scale_m"] > 0.0 else 0.0
    lifting = v ** (1.0 + e["speed_power"]) * (1.0 + e["lift_h"] * near)
    lifting *= attached(e["stall_sharpness"], alpha - e["stall_rad"])
    weight = GRAVITY_M_S2 / speed * cos(theta - alpha)
    out[INDEX["Z_trim"]] = -(weight + v * e["Z_h"] * near) / lifting
    out[INDEX["M_trim"]] = -e["M_h"] * near
    return out


def entries_of(p: FloatArray) -> dict[str, float]:
    """Return entries of ``CARRIED`` by name, of driving numbers of shape (entries,)."""
    return {name: float(p[k]) for k, name in enumerate(ENTRIES) if name in CARRIED}
