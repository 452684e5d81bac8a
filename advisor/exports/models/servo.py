"""Servo between the elevator's command and its surface, as numbers that simulators need."""

from collections.abc import Mapping
from dataclasses import dataclass

from advisor.aircraft.controls import Elevator, SideControl
from advisor.gap.effects import EFFECTS


@dataclass(frozen=True)
class ExportedServo:
    """Delay, then lag, then limits of the surface; zero or None for an absent one."""

    delay_s: float = 0.0
    lag_s: float = 0.0
    """Delay with which the surface follows a ramp of the command, s. Negative: quicker than the simulator's
    own servo."""
    damping: float | None = None
    """Damping of a second-order lag with ω = 2·damping/lag_s. None: a first-order lag."""
    rate_rad_s: float | None = None
    play_rad: float = 0.0
    """Whole width of the linkage's backlash."""
    deadband_rad: float = 0.0
    """Whole width of the dead band."""
    neutral_rad: float = 0.0
    """Deflection in the middle of the dead band."""

    @property
    def is_quick(self) -> bool:
        """Whether the surface follows its command at once."""
        return self == ExportedServo()

    def lines(self) -> list[str]:
        """Return each property with its number and unit, for people."""
        said = {
            f"delay {self.delay_s:.4g} s": self.delay_s,
            f"lag {self.lag_s:.4g} s": self.lag_s,
            f"damping {self.damping or 0.0:.3g}": self.damping,
            f"rate limit {self.rate_rad_s or 0.0:.4g} rad/s": self.rate_rad_s,
            f"backlash {self.play_rad:.4g} rad": self.play_rad,
            f"dead band {self.deadband_rad:.4g} rad": self.deadband_rad,
        }
        return [text for text, size in said.items() if size]


def servo_of(control: Elevator | SideControl, effects: Mapping[str, Mapping[str, float]]) -> ExportedServo:
    """Return the servo of the aircraft file, with the further effects found."""
    found = {"delay_s": control.delay_s or 0.0, "lag_s": control.lag_s or 0.0}
    for effect, sizes in effects.items():
        for key, (part, factor) in EFFECTS[effect].servo.items():
            if key in sizes:
                found[part] = found.get(part, 0.0) + factor * sizes[key]
    return ExportedServo(**found)
