"""Model of both axes for other programs, as flown or as a diagnosis improved it.

Without further logs, the last third of the manoeuvres is held out. The other manoeuvres improve the
simulator, as ``--out`` and ``--export`` do. One procedure decides for both axes which parts of the
improvement are kept. Each axis simulates the held-out manoeuvres (``ImprovedAxis``).
"""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np

from advisor.aircraft.aircraft import Aircraft
from advisor.aircraft.reference import SIDE_PARAMETERS
from advisor.campaign.state import CampaignState, LateralState
from advisor.exports.models.improvement import (
    STILL_AIR,
    ExportedServo,
    Improvement,
    improvement_of,
    is_told,
    servo_of,
    zero_said,
)
from advisor.flight.instruments.atmosphere import AirData, air_flown
from advisor.gap.result import Diagnosis, Value
from advisor.model.axes.lateral import LATERAL, Trim
from advisor.oem.axis.estimate import AxisEstimate
from advisor.oem.axis.search import WITHOUT_FORCE
from advisor.process.arrays import FloatArray
from advisor.process.atomic_file import write_atomically
from advisor.report.improved import file_content, improved_file, text_of
from advisor.report.qualities import trim_of
from advisor.words.problems import ConfigurationError
from advisor.words.quantities import NORMAL_95


@dataclass(frozen=True)
class SideModel:
    """Model of roll and yaw for other programs."""

    values: Mapping[str, Value]
    """Derivatives that are known, by the names of ``SIDE_PARAMETERS``."""
    untold: Mapping[str, str]
    """Reason why the flight does not determine a derivative, by the derivative's name."""
    trim: Trim
    """Trimmed flight condition of the lateral model. The trim's air speed is of the kind that ``air``
    states."""
    air: AirData = STILL_AIR
    servos: Mapping[str, ExportedServo] = field(default_factory=dict)
    """Servo of the aileron and of the rudder."""
    flown: bool = True
    """Whether the derivatives come from a flight instead of the aircraft file."""
    beyond_keys: tuple[str, ...] = ()
    """Effects of the diagnosis that no key of the aircraft file states."""

    @property
    def true_airspeed_m_s(self) -> float:
        """True air speed of the derivatives, m/s."""
        return self.air.true_speed(self.trim.airspeed_m_s)

    @property
    def zeros(self) -> tuple[str, ...]:
        """Known derivatives that do not differ significantly from zero."""
        return tuple(name for name, value in self.values.items() if not is_told(value))

    @property
    def left_out(self) -> tuple[str, ...]:
        """Sentences about derivatives that are not exported."""
        return (*(f"{p}: {reason}" for p, reason in self.untold.items()), *map(zero_said, self.zeros))

    def number(self, parameter: str) -> float:
        """Return a derivative for other programs; 0 if insignificant or unknown."""
        value = self.values.get(parameter)
        return value.value if value is not None and is_told(value) else 0.0

    @property
    def numbers(self) -> FloatArray:
        """Shape (15,), the derivatives in the order of ``SIDE_PARAMETERS``."""
        return np.array([self.number(name) for name in SIDE_PARAMETERS])

    def half(self, parameter: str) -> float:
        """Return the half-width of a known derivative's 95 % interval."""
        return NORMAL_95 * self.values[parameter].std


@dataclass(frozen=True)
class FlownModel:
    """Models of pitch, roll and yaw from a flight. None for an axis without an estimate."""

    aircraft: Aircraft
    """Aircraft file with its own servos and with the user's simulator."""
    pitch: Improvement | None
    side: SideModel | None
    diagnosis: Diagnosis | None = None
    """Diagnosis that improved the pitch axis."""
    unchanged: bool = False
    """Whether a diagnosis found neither a cause nor a wrong derivative."""

    @property
    def name(self) -> str:
        return self.aircraft.name

    @property
    def beyond_keys(self) -> tuple[str, ...]:
        """Effects that the improved aircraft file lacks."""
        return () if self.side is None else self.side.beyond_keys


def flown_model(state: CampaignState, aircraft: Aircraft) -> FlownModel:
    """Return the model of a campaign at its end.

    Raises
    ------
    ConfigurationError
        No manoeuvre of either axis is accepted, or none determines the derivatives.
    """
    model = _in_one_air(FlownModel(aircraft, _pitch(state, aircraft), side_flown(state.lateral, aircraft)))
    if model.pitch is None and model.side is None:
        raise ConfigurationError(
            "--export: the accepted manoeuvres determine the derivatives of no axis; fly the input that "
            "advisor analyze names."
        )
    return model


def improved_model(diagnosis: Diagnosis, aircraft: Aircraft, side: SideModel | None) -> FlownModel:
    """Return the pitch model that a diagnosis improved, together with the roll and yaw model.

    Raises
    ------
    ConfigurationError
        The diagnosis has no air speed.
    """
    pitch = improvement_of(diagnosis, aircraft)
    side = side or _side_of_file(pitch)
    return _in_one_air(FlownModel(aircraft, pitch, side, diagnosis, unchanged=not diagnosis.improves))


def _in_one_air(model: FlownModel) -> FlownModel:
    """Return the model with one ratio of true to read air speed, that of the elevator's fit."""
    pitch, side = model.pitch, model.side
    if pitch is None or side is None:
        return model
    excess = pitch.air.excess or side.air.excess
    return replace(
        model,
        pitch=replace(pitch, air=replace(pitch.air, excess=excess)),
        side=replace(side, air=replace(side.air, excess=excess)),
    )


def _pitch(state: CampaignState, aircraft: Aircraft) -> Improvement | None:
    estimate = state.model
    if estimate is None or estimate.airspeed_m_s is None or estimate.not_identifiable:
        return None
    values = zip(estimate.names, estimate.theta.tolist(), estimate.std.tolist(), strict=True)
    joined = [m.maneuver for m in state.maneuvers if m.maneuver.number in state.estimate_from]
    return Improvement(
        name=aircraft.name,
        model={name: Value(value, std) for name, value, std in values},
        prior=aircraft.model,
        airspeed_m_s=estimate.airspeed_m_s,
        servo=replace(
            servo_of(aircraft.elevator, {}), lag_s=estimate.servo_lag_s or aircraft.elevator.lag_s or 0.0
        ),
        effects={},
        reference=aircraft.reference,
        elevator=aircraft.elevator,
        air=air_flown(joined, aircraft.reference.air_temperature_c),
    )


def side_flown(lateral: LateralState | None, aircraft: Aircraft) -> SideModel | None:
    """Return the roll and yaw model from the accepted manoeuvres; None if they determine no force."""
    model = lateral.model if lateral is not None else None
    if lateral is None or model is None or model.airspeed_m_s is None:
        return None
    if WITHOUT_FORCE in model.not_identifiable.values():
        return None
    joined = [m.maneuver for m in lateral.maneuvers if m.maneuver.number in lateral.estimate_from]
    air = air_flown(joined, aircraft.reference.air_temperature_c)
    return side_of(model, trim_of(joined, model.airspeed_m_s), air, aircraft)


def side_of(estimate: AxisEstimate, trim: Trim, air: AirData, aircraft: Aircraft) -> SideModel:
    """Return the roll and yaw model of an estimate, with the air speed and servos from its fit."""
    estimated = zip(SIDE_PARAMETERS, estimate.theta.tolist(), estimate.std.tolist(), strict=True)
    excess, _ = estimate.nuisances.get("airspeed_excess", (0.0, 0.0))
    return SideModel(
        {name: Value(value, std) for name, value, std in estimated if name not in estimate.not_identifiable},
        estimate.not_identifiable,
        trim,
        replace(air, excess=excess),
        {name: _servo(estimate, name, aircraft) for name in LATERAL.inputs},
    )


def _servo(estimate: AxisEstimate, control: str, aircraft: Aircraft) -> ExportedServo:
    stated = getattr(aircraft, control)
    lag_s, _ = estimate.nuisances.get(f"{control}_lag_s", (stated.lag_s or 0.0, 0.0))
    return ExportedServo(delay_s=stated.delay_s or 0.0, lag_s=lag_s)


def _side_of_file(pitch: Improvement) -> SideModel | None:
    """Return the roll and yaw model of the aircraft file at the pitch model's air speed; None without one."""
    values = {name: Value(pitch.prior[name], 0.0) for name in SIDE_PARAMETERS if name in pitch.prior}
    if not values:
        return None
    untold = {n: "neither flown nor in the file" for n in SIDE_PARAMETERS if n not in values}
    return SideModel(values, untold, Trim(pitch.airspeed_m_s), pitch.air, flown=False)


def file_text(model: FlownModel) -> str:
    """Return the text of the aircraft file."""
    return text_of(file_of(model))


def write_file(model: FlownModel, path: Path) -> None:
    """Write the aircraft file as a whole."""
    write_atomically(path, file_text(model))


def file_of(model: FlownModel) -> dict[str, Any]:
    """Return the aircraft file with all known derivatives, and with the servos of aileron and rudder."""
    aircraft, side = _with_servos(model.aircraft, model.side), model.side
    if model.diagnosis is not None:
        content = dict(improved_file(model.diagnosis, aircraft))
    elif model.pitch is not None:
        pitch = model.pitch
        flown = replace(aircraft, elevator=replace(aircraft.elevator, lag_s=pitch.servo.lag_s or None))
        numbers = {name: value.value for name, value in pitch.model.items()}
        content = file_content(flown, pitch.air.read_speed(pitch.airspeed_m_s), numbers, aircraft.effects)
    else:
        content = file_content(aircraft, aircraft.reference_airspeed_m_s, aircraft.model, aircraft.effects)
    if side is not None:
        read = side.air.read_speed(side.trim.airspeed_m_s)
        content.setdefault("reference_airspeed_m_s", round(read, 4))
        content["model"] = content["model"] | _at(side, content["reference_airspeed_m_s"] / read)
    return content


def _with_servos(aircraft: Aircraft, side: SideModel | None) -> Aircraft:
    """Return the aircraft with the known lag and delay of each roll and yaw servo."""
    changed: dict[str, Any] = {}
    for name, servo in (side.servos if side is not None else {}).items():
        control = getattr(aircraft, name)
        changed[name] = replace(
            control, lag_s=_known(servo.lag_s, control.lag_s), delay_s=_known(servo.delay_s, control.delay_s)
        )
    return replace(aircraft, **changed)


def _known(estimated: float, stated: float | None) -> float | None:
    return round(estimated, 6) if estimated else stated


def _at(side: SideModel, faster: float) -> Mapping[str, float]:
    """Return the roll and yaw derivatives at ``faster`` times the air speed of the model."""
    powers = {term.name: term.power for term in LATERAL.shared}
    return {name: float(f"{value.value * faster ** powers[name]:.6g}") for name, value in side.values.items()}
