"""The model of a flight for other programs: short period, roll and yaw, as estimated."""

from dataclasses import dataclass

from advisor.aircraft.aircraft import Aircraft
from advisor.campaign.state import CampaignState
from advisor.exports.models.improvement import Improvement
from advisor.exports.models.servo import servo_of
from advisor.flight.instruments.atmosphere import air_flown
from advisor.flight.signals.standard_atmosphere import standard_height
from advisor.gap.result import Value
from advisor.model.lateral import Trim
from advisor.oem.estimate import Estimate
from advisor.oem.lateral_estimate import LateralEstimate
from advisor.oem.lateral_solution import WITHOUT_FORCE
from advisor.report.lateral_qualities import trim_of
from advisor.words.problems import ConfigurationError


@dataclass(frozen=True)
class SideModel:
    """Roll and yaw as estimated."""

    found: LateralEstimate
    trim: Trim
    height_m: float = 0.0
    """Height in the standard atmosphere with the density of the air flown in, m; 0 where unknown."""


@dataclass(frozen=True)
class FlownModel:
    """Both axes of a flight. None for an axis without an estimate."""

    name: str
    pitch: Improvement | None
    side: SideModel | None


def flown_model(state: CampaignState, aircraft: Aircraft) -> FlownModel:
    """Return the model of a campaign at its end.

    Raises
    ------
    ConfigurationError
        No manoeuvre of either axis is accepted, or their derivatives are not told.
    """
    pitch = None
    if state.model is not None and state.model.airspeed_m_s is not None and not state.model.not_identifiable:
        pitch = _pitch(state.model, state.model.airspeed_m_s, aircraft)
    found = FlownModel(aircraft.name, pitch, _side(state, aircraft))
    if found.pitch is None and found.side is None:
        raise ConfigurationError(
            "--export: the accepted manoeuvres tell the derivatives of neither axis; fly the input that the "
            "analysis names."
        )
    return found


def _pitch(estimate: Estimate, airspeed_m_s: float, aircraft: Aircraft) -> Improvement:
    values = zip(estimate.names, estimate.theta.tolist(), estimate.std.tolist(), strict=True)
    return Improvement(
        name=aircraft.name,
        model={name: Value(value, std) for name, value, std in values},
        prior=aircraft.model,
        airspeed_m_s=airspeed_m_s,
        servo=servo_of(aircraft.elevator, {}),
        effects={},
        reference=aircraft.reference,
        elevator=aircraft.elevator,
    )


def _side(state: CampaignState, aircraft: Aircraft) -> SideModel | None:
    lateral = state.lateral
    model = lateral.model if lateral is not None else None
    if lateral is None or model is None or model.estimate.airspeed_m_s is None:
        return None
    if WITHOUT_FORCE in model.estimate.not_identifiable.values():
        return None
    joined = [one.maneuver for one in lateral.maneuvers if one.maneuver.number in lateral.estimate_from]
    density = air_flown(joined, aircraft.reference.air_temperature_c).density_kg_m3
    return SideModel(model, trim_of(joined, model.estimate.airspeed_m_s), float(standard_height(density)))
