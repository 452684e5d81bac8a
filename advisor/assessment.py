"""One manoeuvre on its own: its estimate, what speaks against it, what belongs on its verdict."""

import math

from advisor.aircraft import PARAMETERS, Aircraft
from advisor.decision.history import Flown
from advisor.decision.judge import COLOURED
from advisor.decision.quality import judge_quality
from advisor.flight.kinematics import check_alpha
from advisor.flight.maneuver import Maneuver
from advisor.flight.marked_input import MARKED
from advisor.flight.vehicle import closes_pitch_loop
from advisor.oem.estimate import Estimate, NoEstimate
from advisor.oem.estimator import estimate
from advisor.oem.filter_error import filter_error_estimate
from advisor.oem.solution import Method
from advisor.oem.turbulence import turbulence_in

UNEXPLAINED = 0.004
"""Share of the pitch rate's variance that moving air leaves unexplained at the least."""


def assess(maneuver: Maneuver, aircraft: Aircraft, method: Method = "gauss-newton") -> Flown:
    """Estimate a manoeuvre and examine it, before any rule compares it with others."""
    estimated = estimate(maneuver, aircraft, method=method)
    opinion, air = _second_opinion(maneuver, estimated, aircraft)
    return Flown(
        estimated,
        judge_quality(maneuver, estimated, aircraft),
        (*_cautions(maneuver, aircraft), *air),
        maneuver=maneuver,
        second_opinion=opinion,
        air_moved=bool(air),  # it is spoken of only then
    )


def _cautions(maneuver: Maneuver, aircraft: Aircraft) -> list[str]:
    cautions = []
    if maneuver.span.closed_by in MARKED.values():
        cautions.append(maneuver.span.closed_by)
    if closes_pitch_loop(maneuver.mode):
        cautions.append(
            f"flown in {maneuver.mode} with the pitch loop closed: elevator, angle of attack and pitch rate "
            "move together and are hard to tell apart"
        )
    alpha = maneuver.channels.get("alpha")
    if alpha is not None:
        cautions.append(f"angle of attack: {alpha.provenance}, from {alpha.source}")
    check = check_alpha(
        maneuver, aircraft.airspeed_m_s, aircraft.accelerometer.arm_m, aircraft.alpha.vane_arm_m
    )
    if check.finding != "consistent":
        cautions.append(check.sentence)
    return cautions


def _second_opinion(
    maneuver: Maneuver, estimated: Estimate | NoEstimate, aircraft: Aircraft
) -> tuple[Estimate | None, tuple[str, ...]]:
    """Filter error where the air moved: output error takes what the air does for noise of the instruments."""
    if isinstance(estimated, NoEstimate):
        return None, ()
    fit = estimated.fits[0]["q"]
    if fit.lag1 < COLOURED or 1.0 - fit.r2 < UNEXPLAINED:
        return None, ()
    found = turbulence_in(estimated, maneuver.channels["alpha"].provenance != "derived")
    if not found.present:
        return None, ()
    size = f"gusts of {math.degrees(found.gust_angle):.1f} deg"
    if estimated.airspeed_m_s is not None:
        size += f" ({found.gust_angle * estimated.airspeed_m_s:.1f} m/s)"
    opinion = filter_error_estimate([maneuver], aircraft, estimated, found)
    if isinstance(opinion, NoEstimate):
        return None, (f"turbulence, {size}: output error is out of its validity, and filter error failed",)
    values = ", ".join(
        f"{name} {opinion.value(name):.3g} ± {2.0 * opinion.std[PARAMETERS.index(name)]:.2g} "
        f"instead of {estimated.value(name):.3g}"
        for name in ("M_alpha", "M_delta_e")
    )
    return opinion, (f"turbulence, {size}: output error is out of its validity; filter error gives {values}",)
