"""One manoeuvre alone: its estimate, the objections to it, and the cautions for its verdict."""

import math

from advisor.aircraft.aircraft import Aircraft
from advisor.decision.axes.requirements import judge
from advisor.decision.envelope import is_speed_carried, with_gap
from advisor.decision.first_unit import natural_period
from advisor.decision.history import CandidateManeuver
from advisor.decision.verdict import Reason
from advisor.flight.instruments.kinematics import check_alpha
from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.flight.maneuvers.markers import MARKED
from advisor.flight.vehicle.modes import closes_pitch_loop
from advisor.oem.estimate import Estimate, NoEstimate
from advisor.oem.estimator import estimate
from advisor.oem.surface import Servo
from advisor.process.parts import INTERNAL, FailedPart


def assess(maneuver: Maneuver, aircraft: Aircraft) -> CandidateManeuver:
    """Estimate a manoeuvre and examine it, before any rule compares it with other manoeuvres."""
    estimated = estimate(maneuver, aircraft)
    return CandidateManeuver(
        estimated,
        judge("pitch", maneuver, estimated, aircraft),
        tuple(cautions_of(maneuver, estimated, aircraft)),
        maneuver=maneuver,
        air_moved=isinstance(estimated, Estimate) and estimated.gust_rad is not None,
        servo=_servo(estimated, aircraft),
    )


def failed(maneuver: Maneuver, part: FailedPart) -> CandidateManeuver:
    """Return a manoeuvre whose estimate or examination was ended by a fault of the advisor."""
    return CandidateManeuver(untold(part), (objection(part),), maneuver=maneuver)


def untold(part: FailedPart) -> NoEstimate:
    """Return the missing estimate of a part that was ended by a fault of the advisor."""
    return NoEstimate(INTERNAL, str(part.problem))


def objection(part: FailedPart) -> Reason:
    """Return the reason against a manoeuvre that has no verdict because of a fault of the advisor."""
    return Reason(INTERNAL, str(part.problem), math.nan, math.nan)


def _servo(estimated: Estimate | NoEstimate, aircraft: Aircraft) -> Servo:
    """Return the servo of the estimate, from the aircraft file or identified from the record."""
    lag_s = aircraft.elevator.lag_s or 0.0
    if isinstance(estimated, Estimate):
        lag_s = estimated.servo_lag_s
    return Servo(lag_s, aircraft.elevator.delay_s or 0.0)


def cautions_of(maneuver: Maneuver, estimated: Estimate | NoEstimate, aircraft: Aircraft) -> list[str]:
    """Return cautions for the reader of an estimate. These cautions have no effect on the verdict."""
    cautions = list(maneuver.data_notes)
    if maneuver.span.closed_by in MARKED.values():
        cautions.append(maneuver.span.closed_by)
    if closes_pitch_loop(maneuver.mode):
        cautions.append(
            f"flown in {maneuver.mode} with the pitch loop closed: elevator, angle of attack and pitch rate "
            "move together and are hard to distinguish"
        )
    if not isinstance(estimated, Estimate):
        return cautions
    cautions += _carried_speed(maneuver, estimated, aircraft)
    alpha = maneuver.channels.get("alpha")
    if alpha is not None and "alpha" in estimated.outputs:
        cautions.append(f"angle of attack: {alpha.provenance}, from {alpha.source}")
        cautions += _uncertain_alpha(maneuver, estimated, aircraft)
    if estimated.gust_rad is not None and _shows(estimated, estimated.gust_rad):
        cautions.append(_moving_air(estimated, estimated.gust_rad))
    return cautions


def _shows(estimated: Estimate, gust_rad: float) -> bool:
    """Return whether the gusts differ from zero in the digits that people read."""
    size = math.degrees(gust_rad) if estimated.airspeed_m_s is None else gust_rad * estimated.airspeed_m_s
    return round(size, 1) > 0.0


def _uncertain_alpha(maneuver: Maneuver, estimated: Estimate, aircraft: Aircraft) -> list[str]:
    """Return doubts about the angle of attack that the fit does not consider, from kinematics."""
    if estimated.instrument("vane_arm_m") or estimated.instrument("alpha_delay_s"):
        return []
    check = check_alpha(
        maneuver, aircraft.airspeed_m_s, aircraft.accelerometer.arm_m, aircraft.alpha.vane_arm_m
    )
    return [] if check.finding == "consistent" else [check.sentence]


def _carried_speed(maneuver: Maneuver, estimated: Estimate, aircraft: Aircraft) -> list[str]:
    """Return a sentence about an air speed that the accelerometers carry across a gap of its sensor."""
    channel = maneuver.channels.get("airspeed")
    if channel is None or aircraft.airspeed_m_s is not None or not is_speed_carried(maneuver):
        return []
    gaps = with_gap([channel], maneuver, natural_period(maneuver, estimated))
    return [f"{gap.fact}: its changes there are integrated from the accelerometers" for gap in gaps]


def _moving_air(estimated: Estimate, gust_rad: float) -> str:
    size = f"{math.degrees(gust_rad):.1f} deg"
    if estimated.airspeed_m_s is not None:
        size += f" ({gust_rad * estimated.airspeed_m_s:.1f} m/s)"
    how = (
        "filter error takes this into account"
        if estimated.filtered
        else "filter error failed, so output error is used"
    )
    return f"moving air, gusts of {size}: {how}"
