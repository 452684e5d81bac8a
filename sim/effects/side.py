"""Effects of roll and yaw as components of the bundled aircraft, named by control or channel and effect."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import partial

import numpy as np

from ..atmosphere import DrydenTurbulence
from ..fittings import Fittings
from ..loading import ScenarioError
from ..motion import Motion
from ..sensors import Reading
from ..servo import FirstOrderServo, Mechanism, TransportDelay
from .actuator import Backlash, Deadband, RateLimit
from .instruments import Scaled
from .kit import Sizes


@dataclass
class SideKit:
    """Parts of a lateral flight to which an effect is added."""

    seed: int
    mechanisms: dict[str, list[Mechanism]] = field(default_factory=lambda: {"aileron": [], "rudder": []})
    """Stages between command and surface, by control."""
    fittings: Fittings = field(default_factory=Fittings)
    torque_rad: float = 0.0
    """Roll due to the propeller at full throttle, as an equivalent deflection of the aileron, rad."""
    swing: float = 0.0
    """Amplitude of the throttle's slow swing, 0..1."""
    side_gusts: DrydenTurbulence | None = None


class AccelerometerAhead:
    """An accelerometer ahead of the centre of gravity, which also reads x·ṙ."""

    def __init__(self, arm_m: float) -> None:
        self.arm_m = arm_m
        self._before: float | None = None

    def apply(self, motion: Motion, reading: Reading, dt: float) -> None:
        """Add the acceleration due to the change of the yaw rate."""
        now, before = reading.r, self._before
        self._before = now
        if before is not None and dt > 0.0:
            reading.a_y += self.arm_m * (now - before) / dt


@dataclass(frozen=True)
class SideKind:
    """One effect with moderate sizes, SI."""

    sizes: Mapping[str, float]
    fit: Callable[[SideKit, Sizes], None]


def _mechanism(control: str, make: Callable[..., Mechanism], kit: SideKit, sizes: Sizes) -> None:
    kit.mechanisms[control].append(make(*sizes.values()))


def _late(channel: str, kit: SideKit, sizes: Sizes) -> None:
    kit.fittings.skews[channel] = sizes["skew_s"]


def _scaled(channel: str, kit: SideKit, sizes: Sizes) -> None:
    kit.fittings.sensors.append(Scaled(channel, scale=sizes["scale"]))


def _arm(kit: SideKit, sizes: Sizes) -> None:
    kit.fittings.sensors.append(AccelerometerAhead(sizes["arm_m"]))


def _propeller(kit: SideKit, sizes: Sizes) -> None:
    kit.torque_rad, kit.swing = sizes["aileron_rad"], sizes["swing"]


def _gusts(kit: SideKit, sizes: Sizes) -> None:
    generator = np.random.default_rng([kit.seed, 33])
    kit.side_gusts = DrydenTurbulence(sizes["sigma_v_m_s"], sizes["length_m"], generator)


_SERVO: dict[str, tuple[dict[str, float], Callable[..., Mechanism]]] = {
    "actuator_lag": ({"lag_s": 0.06}, FirstOrderServo),
    "transport_delay": ({"delay_s": 0.08}, TransportDelay),
    "actuator_rate_limit": ({"rate_rad_s": 0.8}, RateLimit),
    "actuator_backlash": ({"half_width_rad": 0.01}, Backlash),
    "actuator_deadband": ({"half_width_rad": 0.01, "neutral_rad": 0.0}, Deadband),
}
SIDE: dict[str, SideKind] = {
    **{
        f"{control}_{name}": SideKind(sizes, partial(_mechanism, control, make))
        for control in ("aileron", "rudder")
        for name, (sizes, make) in _SERVO.items()
    },
    **{f"{name}_skew": SideKind({"skew_s": 0.06}, partial(_late, name)) for name in ("p", "r", "phi", "a_y")},
    **{f"{name}_scale": SideKind({"scale": 0.1}, partial(_scaled, name)) for name in ("p", "r", "a_y")},
    "accelerometer_offset": SideKind({"arm_m": 0.3}, _arm),
    "propeller_roll": SideKind({"aileron_rad": 0.05, "swing": 0.04}, _propeller),
    "side_turbulence": SideKind({"sigma_v_m_s": 0.3, "length_m": 60.0}, _gusts),
}
"""Component of each lateral effect, by the effect's name."""


def side_kit(seed: int, effects: Mapping[str, Sizes]) -> SideKit:
    """Return the parts of a lateral flight with effects.

    Raises
    ------
    ScenarioError
        An effect or one of its parameters is unknown.
    """
    kit = SideKit(seed)
    for name, given in effects.items():
        if name not in SIDE:
            raise ScenarioError(
                [f"effects.{name}: unknown effect of roll and yaw, choose from {', '.join(SIDE)}"]
            )
        known = SIDE[name].sizes
        if wrong := sorted(given.keys() - known.keys()):
            raise ScenarioError(
                [f"effects.{name}.{wrong[0]}: unknown parameter, choose from {', '.join(known)}"]
            )
        SIDE[name].fit(kit, {**known, **given})
    return kit
