"""What is known of an effect beforehand, by its name in the catalogue and whatever way it is described."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Trait:
    """An effect of the catalogue, without its numbers."""

    block: str
    """Part of the simulator that it belongs to."""
    channel: str = ""
    """Output without which it cannot be tried; empty where any will do."""
    steady: bool = False
    """One number for a whole flight. A bias may wander a little, and is one all the same."""
    of_one_flight: bool = False
    """Came at some time of one flight, and says nothing of another."""
    kinked: bool = False
    """Between command and surface, and not linear."""
    by_nature: bool = False
    """What every aircraft has to some degree, or what takes its shape: faint, it is no finding."""
    of_any_airframe: bool = False
    """Bends, and fuel that is burnt: what of it changes next to nothing is no cause."""


TRAITS = {
    "actuator_lag": Trait("input", steady=True),
    "actuator_rate_limit": Trait("input", kinked=True),
    "actuator_backlash": Trait("input", kinked=True),
    "actuator_deadband": Trait("input", kinked=True),
    "transport_delay": Trait("input", steady=True),
    "elevator_nonlinearity": Trait("moment_equation", by_nature=True, of_any_airframe=True),
    "nonlinear_pitching_moment": Trait("moment_equation", by_nature=True, of_any_airframe=True),
    "thrust_moment": Trait("moment_equation", by_nature=True),
    "cg_shift": Trait("moment_equation", of_one_flight=True, of_any_airframe=True),
    "alpha_dot": Trait("moment_equation", by_nature=True),
    "nonlinear_lift": Trait("force_equation", by_nature=True, of_any_airframe=True),
    "unsteady_lift": Trait("force_equation", by_nature=True),
    "mass_change": Trait("force_equation", of_one_flight=True, of_any_airframe=True),
    "icing": Trait("force_equation", of_one_flight=True, by_nature=True),
    "airspeed_variation": Trait("force_equation", by_nature=True),
    "ground_effect": Trait("force_equation", by_nature=True),
    "turbulence": Trait("air", of_one_flight=True),
    "gust": Trait("air", of_one_flight=True),
    "alpha_lag": Trait("alpha_sensor", "alpha", steady=True),
    "alpha_scale": Trait("alpha_sensor", "alpha", steady=True),
    "alpha_bias": Trait("alpha_sensor", "alpha"),
    "alpha_vane_offset": Trait("alpha_sensor", "alpha"),
    "pitch_rate_bias": Trait("pitch_rate_sensor"),
    "pitch_rate_scale": Trait("pitch_rate_sensor", steady=True),
    "structural_mode": Trait("pitch_rate_sensor", by_nature=True),
    "accelerometer_offset": Trait("accelerometer", "a_z"),
    "alpha_skew": Trait("timing", "alpha", steady=True),
    "pitch_rate_skew": Trait("timing", steady=True),
    "accelerometer_skew": Trait("timing", "a_z", steady=True),
    "attitude_skew": Trait("timing", "theta", steady=True),
}
"""Every effect of the catalogue, in its order."""

STEADY = frozenset(name for name, trait in TRAITS.items() if trait.steady)
OF_ONE_FLIGHT = frozenset(name for name, trait in TRAITS.items() if trait.of_one_flight)
KINKED = frozenset(name for name, trait in TRAITS.items() if trait.kinked)
BY_NATURE = frozenset(name for name, trait in TRAITS.items() if trait.by_nature)
OF_ANY_AIRFRAME = frozenset(name for name, trait in TRAITS.items() if trait.of_any_airframe)
