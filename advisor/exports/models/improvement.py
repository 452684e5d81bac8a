"""Basis of every format: the model found, the prior model, the servo, and other effects."""

from collections.abc import Mapping
from dataclasses import dataclass, field

from advisor.aircraft.aircraft import Aircraft
from advisor.aircraft.controls import Elevator
from advisor.aircraft.reference import Reference
from advisor.aircraft.standard_gravity import GRAVITY_M_S2
from advisor.exports.models.servo import ExportedServo, servo_of
from advisor.flight.signals.standard_atmosphere import standard_density, standard_pressure
from advisor.gap.candidates.known import less_of_the_servo, together
from advisor.gap.effects import EFFECTS
from advisor.gap.result import Diagnosis, Value
from advisor.oem.coefficients import Coefficient, scales
from advisor.words.problems import ConfigurationError
from advisor.words.quantiles import NORMAL_95

SLOPES = ("Z_alpha", "Z_q", "Z_delta_e", "M_alpha", "M_q", "M_delta_e")
"""The derivatives among the eight parameters."""
REFERENCE_KEYS = ("mass_kg", "wing_area_m2", "chord_m", "iyy_kg_m2")


@dataclass(frozen=True)
class Improvement:
    """The improved simulator, independent of any format."""

    name: str
    model: Mapping[str, Value]
    """The eight parameters at ``airspeed_m_s``, SI."""
    prior: Mapping[str, float]
    """Prior model of the simulator: any of the eight parameters, none where unknown."""
    airspeed_m_s: float
    servo: ExportedServo
    """Delay, lag and limits between command and surface."""
    effects: Mapping[str, Mapping[str, float]]
    """Effects other than those of the servo, by the keys of the aircraft file."""
    reference: Reference = field(default_factory=Reference)
    elevator: Elevator = field(default_factory=Elevator)
    height_m: float | None = None
    """Height in the standard atmosphere with the density of the air flown in, m. None: unknown."""

    @property
    def density_note(self) -> str:
        """Sentence on the air density of the coefficients."""
        unknown = "sea level, as the log has no height"
        where = unknown if self.height_m is None else f"{self.height_m:.0f} m, by the air flown in"
        return f"Air density {self.density_kg_m3:.4f} kg/m3, of the standard atmosphere at {where}."

    @property
    def density_kg_m3(self) -> float:
        """Air density of the International Standard Atmosphere's troposphere, kg/m³."""
        return float(standard_density(standard_pressure(self.height_m or 0.0)))

    def interval95(self, parameter: str) -> tuple[float, float]:
        """Return the 95 % interval of one of the eight parameters."""
        found = self.model[parameter]
        return found.value - NORMAL_95 * found.std, found.value + NORMAL_95 * found.std

    def differs(self, parameter: str, prior: float) -> bool:
        """Return whether the flight contradicts a prior value, which then lies outside the 95 % interval."""
        low, high = self.interval95(parameter)
        return not low <= prior <= high

    def coefficients(self) -> Mapping[str, Coefficient]:
        """Return the eight non-dimensional coefficients, per radian. C_L_0 and C_m_0 hold at zero angles.

        C_L_0 follows from Z_0 = g/V - q̄·S·C_L0/(m·V), without the part of the thrust in the lift direction.

        Raises
        ------
        ConfigurationError
            A quantity of ``reference`` is missing. The message names the quantity.
        """
        require_reference(self.reference, REFERENCE_KEYS)
        scale = scales(self.airspeed_m_s, self.reference, self.density_kg_m3)
        weight = GRAVITY_M_S2 / self.airspeed_m_s
        force, moment = scale["C_L_alpha"][1], scale["C_m_alpha"][1]
        lift, pitch = self.model["Z_0"], self.model["M_0"]
        found = {
            "C_L_0": Coefficient(force * (lift.value - weight), abs(force) * lift.std),
            "C_m_0": Coefficient(moment * pitch.value, abs(moment) * pitch.std),
        }
        for name, (parameter, factor) in scale.items():
            value = self.model[parameter]
            found[name] = Coefficient(factor * value.value, abs(factor) * value.std)
        return found


def improvement_of(diagnosis: Diagnosis, aircraft: Aircraft) -> Improvement:
    """Return the improvement of the simulator by a diagnosis.

    Raises
    ------
    ConfigurationError
        The diagnosis has no air speed, without which no derivative can be exported.
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
        height_m=diagnosis.height_m,
    )


def require_reference(reference: Reference, keys: tuple[str, ...]) -> None:
    """Refuse an aircraft file without the quantities that coefficients need.

    Raises
    ------
    ConfigurationError
        Keys of ``reference`` are missing. The message names them.
    """
    missing = [key for key in keys if getattr(reference, key) is None]
    if missing:
        raise ConfigurationError(
            f"--export: non-dimensional coefficients need {', '.join(missing)}; "
            f"give {'them' if len(missing) > 1 else 'it'} under reference: in the aircraft file."
        )
