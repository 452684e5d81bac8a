"""One manoeuvre on its own: its estimate, what speaks against it, what belongs on its verdict."""

from advisor.aircraft import Aircraft
from advisor.decision.history import Flown
from advisor.decision.quality import judge_quality
from advisor.flight.kinematics import check_alpha
from advisor.flight.maneuver import Maneuver
from advisor.flight.vehicle import closes_pitch_loop
from advisor.oem.estimator import estimate


def assess(maneuver: Maneuver, aircraft: Aircraft) -> Flown:
    """Estimate a manoeuvre and examine it, before any rule compares it with others."""
    estimated = estimate(maneuver, aircraft)
    cautions = []
    if closes_pitch_loop(maneuver.mode):
        cautions.append(
            f"flown in {maneuver.mode} with the pitch loop closed: elevator, angle of attack and pitch rate "
            "move together and are hard to tell apart"
        )
    alpha = maneuver.channels.get("alpha")
    if alpha is not None:
        cautions.append(f"angle of attack: {alpha.provenance}, from {alpha.source}")
    check = check_alpha(maneuver, aircraft.airspeed_m_s, aircraft.accelerometer.arm_m)
    if check.finding != "consistent":
        cautions.append(check.sentence)
    reasons = judge_quality(maneuver, estimated, aircraft)
    return Flown(estimated, reasons, tuple(cautions), maneuver=maneuver)
