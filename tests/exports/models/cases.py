"""An improvement whose numbers are all different, for the tests of every format."""

from dataclasses import replace

from advisor.aircraft.aircraft import Aircraft, Elevator
from advisor.aircraft.reference import Reference
from advisor.exports.models.flown import FlownModel, SideModel
from advisor.exports.models.improvement import STILL_AIR, ExportedServo, Improvement
from advisor.flight.instruments.atmosphere import AirData
from advisor.flight.signals.track import standard_density, standard_pressure
from advisor.gap.result import Value

MODEL = {
    "Z_0": 0.21, "Z_alpha": -4.6, "Z_q": -0.03, "Z_delta_e": -0.31,
    "M_0": 1.3, "M_alpha": -41.0, "M_q": -5.2, "M_delta_e": -62.0,
}  # fmt: skip
REFERENCE = Reference(mass_kg=10.0, wing_area_m2=0.8, chord_m=0.3, iyy_kg_m2=0.9)
CALIBRATION = ((1100.0, -24.0), (1500.0, 2.0), (1900.0, 24.0))


def air_at(height_m: float | None, excess: float = 0.0) -> AirData:
    """Air of the standard atmosphere, in which the true air speed is known."""
    if height_m is None:
        return STILL_AIR
    return AirData(float(standard_density(standard_pressure(height_m))), "height", "true", excess=excess)


def flown(pitch: Improvement | None = None, side: SideModel | None = None, **changes: object) -> FlownModel:
    """The model of both axes, with the reference and the calibrations of the pitch axis."""
    aircraft = Aircraft("glider", elevator=pitch.elevator, reference=pitch.reference) if pitch else Aircraft()
    return replace(FlownModel(aircraft, pitch, side), **changes)  # type: ignore[arg-type]


def improvement(**changes: object) -> Improvement:
    """The improvement of a 10 kg aircraft at 25 m/s, with a lag of 80 ms; any field may be changed."""
    plain = Improvement(
        name="glider",
        model={name: Value(value, abs(value) / 50.0) for name, value in MODEL.items()},
        prior={},
        airspeed_m_s=25.0,
        servo=ExportedServo(lag_s=0.08),
        effects={},
        reference=REFERENCE,
        elevator=Elevator(calibration=CALIBRATION),
        air=air_at(1100.0),
    )
    return replace(plain, **changes)  # type: ignore[arg-type]
