"""Pitch model for every format: the estimated model, the prior model, the servo, and other effects."""

import re
from collections.abc import Mapping
from dataclasses import dataclass, field

from advisor.aircraft.aircraft import Aircraft, Elevator, SideControl
from advisor.aircraft.reference import Reference
from advisor.aircraft.standard_gravity import GRAVITY_M_S2
from advisor.flight.instruments.atmosphere import AirData
from advisor.flight.signals.track import SEA_LEVEL_DENSITY_KG_M3
from advisor.gap.candidates.known import less_of_the_servo, together
from advisor.gap.effects import EFFECTS
from advisor.gap.result import Diagnosis, Value, spelled
from advisor.oem.coefficients import Coefficient, scales
from advisor.words.problems import ConfigurationError
from advisor.words.quantities import NORMAL_95


@dataclass(frozen=True)
class ExportedServo:
    """Servo with delay, then lag, then limits of the surface; zero or None for a missing part."""

    delay_s: float = 0.0
    lag_s: float = 0.0
    """Delay of the surface behind a ramp of the command, s. A negative value means that the surface is
    quicker than the simulator's own servo.
    """
    damping: float | None = None
    """Damping ratio of a second-order lag with ω = 2·damping/lag_s. None for a first-order lag."""
    rate_rad_s: float | None = None
    play_rad: float = 0.0
    """Full width of the linkage's play, rad."""
    deadband_rad: float = 0.0
    """Full width of the dead band, rad."""
    neutral_rad: float = 0.0
    """Deflection at the centre of the dead band, rad."""

    @property
    def is_quick(self) -> bool:
        """Whether the surface follows its command at once."""
        return self == ExportedServo()

    def lines(self) -> list[str]:
        """Return each property of the servo with its value and unit, for people."""
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
    """Return the servo of the aircraft file, combined with the effects found."""
    servo = {"delay_s": control.delay_s or 0.0, "lag_s": control.lag_s or 0.0}
    for effect, sizes in effects.items():
        for key, (part, factor) in EFFECTS[effect].servo.items():
            if key in sizes:
                servo[part] = servo.get(part, 0.0) + factor * sizes[key]
    return ExportedServo(**servo)


SLOPES = ("Z_alpha", "Z_q", "Z_delta_e", "M_alpha", "M_q", "M_delta_e")
"""Names of the derivatives among the eight parameters."""
REFERENCE_KEYS = ("mass_kg", "wing_area_m2", "chord_m", "iyy_kg_m2")
STILL_AIR = AirData(SEA_LEVEL_DENSITY_KG_M3, "sea level", "true")
"""Air of a model without a flight."""


def is_told(value: Value) -> bool:
    """Return whether the 95 % interval of a derivative excludes zero."""
    return abs(value.value) > NORMAL_95 * value.std


@dataclass(frozen=True)
class Improvement:
    """Improved simulator's pitch model, independent of any format."""

    name: str
    model: Mapping[str, Value]
    """Values of the eight parameters at ``airspeed_m_s``, SI."""
    prior: Mapping[str, float]
    """Prior values of the simulator's parameters, as far as known."""
    airspeed_m_s: float
    """Air speed of the derivatives, m/s, of the kind that ``air`` states."""
    servo: ExportedServo
    """Delay, lag and limits between command and surface."""
    effects: Mapping[str, Mapping[str, float]]
    """Effects other than those of the servo, by the keys of the aircraft file."""
    reference: Reference = field(default_factory=Reference)
    elevator: Elevator = field(default_factory=Elevator)
    air: AirData = STILL_AIR

    @property
    def true_airspeed_m_s(self) -> float:
        """True air speed of the derivatives, m/s."""
        return self.air.true_speed(self.airspeed_m_s)

    @property
    def untold(self) -> tuple[str, ...]:
        """Sentences about derivatives that do not differ significantly from zero."""
        return tuple(zero_said(name) for name in SLOPES if not is_told(self.model[name]))

    def number(self, parameter: str) -> float:
        """Return a parameter for other programs, with an insignificant derivative as zero."""
        value = self.model[parameter]
        return value.value if parameter not in SLOPES or is_told(value) else 0.0

    def differs(self, parameter: str, prior: float) -> bool:
        """Return whether the 95 % interval of a parameter excludes a prior value."""
        value = self.model[parameter]
        return abs(prior - value.value) > NORMAL_95 * value.std

    def coefficients(self) -> Mapping[str, Coefficient]:
        """Return the eight non-dimensional coefficients, per radian. C_L_0 and C_m_0 are values at zero
        angles.

        C_L_0 follows from Z_0 = g/V - q̄·S·C_L0/(m·V), without the part of the thrust in the lift direction.

        Raises
        ------
        ConfigurationError
            A required quantity of ``reference`` is missing. The error message names the missing quantity.
        """
        require_reference(self.reference, REFERENCE_KEYS)
        scale = scales(self.airspeed_m_s, self.reference, self.air)
        weight = GRAVITY_M_S2 / self.true_airspeed_m_s
        force, moment = scale["C_L_alpha"][1], scale["C_m_alpha"][1]
        lift, pitch = self.model["Z_0"], self.model["M_0"]
        coefficients = {
            "C_L_0": Coefficient(force * (lift.value - weight), abs(force) * lift.std),
            "C_m_0": Coefficient(moment * pitch.value, abs(moment) * pitch.std),
        }
        for name, (parameter, factor) in scale.items():
            std = self.model[parameter].std
            coefficients[name] = Coefficient(factor * self.number(parameter) + 0.0, abs(factor) * std)
        return coefficients


def improvement_of(diagnosis: Diagnosis, aircraft: Aircraft) -> Improvement:
    """Return the improvement of the simulator by a diagnosis.

    Raises
    ------
    ConfigurationError
        The diagnosis has no air speed, which every derivative's export needs.
    """
    if diagnosis.reference_airspeed_m_s is None:
        raise ConfigurationError(
            "--export needs the air speed flown: log it, or give airspeed_m_s in the aircraft file."
        )
    flown, effects = less_of_the_servo(aircraft, together(aircraft.effects, diagnosis.effects))
    return Improvement(
        name=aircraft.name,
        model=diagnosis.model,
        prior=aircraft.model,
        airspeed_m_s=diagnosis.reference_airspeed_m_s,
        servo=servo_of(flown.elevator, effects),
        effects={name: values for name, values in effects.items() if not EFFECTS[name].servo},
        reference=aircraft.reference,
        elevator=aircraft.elevator,
        air=diagnosis.air or STILL_AIR,
    )


def air_note(air: AirData) -> str:
    """Return the sentences about a density and the kind of an air speed."""
    height = air.height_m
    unknown = "sea level, as the log has no height"
    where = unknown if height is None else f"{height:.0f} m, by the air flown in"
    density = f"Air density {air.density_kg_m3:.4f} kg/m3, of the standard atmosphere at {where}."
    return f"{density} {air.speed_note}"


def zero_said(parameter: str) -> str:
    """Return the statement that a derivative is exported as zero."""
    return f"{parameter}, which is not distinguished from zero and is 0"


def require_reference(reference: Reference, keys: tuple[str, ...]) -> None:
    """Refuse an aircraft file without the quantities that coefficients need.

    Raises
    ------
    ConfigurationError
        Keys of ``reference`` are missing. The error message names the missing keys.
    """
    missing = missing_reference(reference, keys)
    if missing:
        raise ConfigurationError(
            f"--export: non-dimensional coefficients need {', '.join(missing)}; "
            f"give {'them' if len(missing) > 1 else 'it'} under reference: in the aircraft file."
        )


def missing_reference(reference: Reference, keys: tuple[str, ...]) -> tuple[str, ...]:
    """Return the keys that an aircraft file does not state."""
    return tuple(key for key in keys if getattr(reference, key) is None)


@dataclass(frozen=True)
class Exported:
    """Content of one file before it is written."""

    text: str
    left_out: tuple[str, ...] = ()
    """Names of effects in sentences that the text does not contain."""
    beside: tuple[str, ...] = ()
    """Texts of additional files that the format writes next to this file."""


def effects_beside(improvement: Improvement, *carried: str) -> tuple[str, ...]:
    """Return the effects that are neither servo effects nor supported by a format."""
    return tuple(spelled(effect) for effect in improvement.effects if effect not in carried)


def commented(lines: list[str], mark: str) -> str:
    """Return lines as a comment, each after the comment mark of a language."""
    return "".join(f"{mark} {line}".rstrip() + "\n" for line in lines)


def xml_comment(text: str) -> str:
    """Return an XML comment, which cannot contain two successive hyphens."""
    return f"<!-- {re.sub('-(?=-)', '- ', text)} -->"
