"""Manoeuvres that the analysis refuses are not used for the diagnosis, and are named.

Only objections that hold for every model count here. A bad fit is no objection, because the diagnosis asks
why the model does not fit. Nor is what the diagnosis has in its model: thrust, a changed air speed, a short
free response, a late stream.
"""

from collections.abc import Sequence
from dataclasses import replace

from advisor.aircraft.aircraft import Aircraft
from advisor.decision.envelope import changed_speed, incomplete, outside, short_response
from advisor.decision.quality import natural_period, refusals
from advisor.decision.verdict import UNTRUSTED, Reason
from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.oem.estimate import NoEstimate
from advisor.words.problems import UnusableInputError

_LARGEST_SPEED_CHANGE_PERCENT = 30.0
"""Change of the air speed, %, up to which the diagnosis scales forces with the speed, where the crew allows
less. Forces change by two thirds. Manoeuvres of the generators stay below 24 %, and those of two UAV records
outside the model have 66 and 69 %."""
_NO_ESTIMATE = NoEstimate("not_asked", "No estimate from one manoeuvre is needed.")


def usable_for_gap(maneuvers: Sequence[Maneuver], aircraft: Aircraft) -> tuple[list[Maneuver], list[str]]:
    """Return the manoeuvres that are not refused, and a sentence for each refused one.

    Raises
    ------
    UnusableInputError
        Every manoeuvre is refused.
    """
    objections = [(m, next(iter(_objections(m, aircraft)), None)) for m in maneuvers]
    refused = [(m, reason) for m, reason in objections if reason is not None]
    if maneuvers and len(refused) == len(maneuvers):
        raise UnusableInputError(
            refused[0][1].code,
            f"No manoeuvre of the log can serve. Manoeuvre {refused[0][0].number}: {refused[0][1].text}.",
            "Fly manoeuvres that advisor analyze accepts.",
        )
    said = [f"Left out: manoeuvre {m.number}: {reason.text}." for m, reason in refused]
    return [m for m, reason in objections if reason is None], said


def _objections(maneuver: Maneuver, aircraft: Aircraft) -> list[Reason]:
    """Return the objections to a manoeuvre that no model answers."""
    most = max(aircraft.limits.airspeed_change_percent, _LARGEST_SPEED_CHANGE_PERCENT)
    allowing = replace(aircraft, limits=replace(aircraft.limits, airspeed_change_percent=most))
    period_s = natural_period(maneuver, _NO_ESTIMATE)
    return [
        *(r for r in incomplete(maneuver, period_s, ()) if r.code in UNTRUSTED),
        *refusals(f for f in maneuver.findings if f.quantity != "delay_s"),
        *(r for r in outside(maneuver, aircraft) if r.code != "throttle"),
        *changed_speed(maneuver, allowing),
        *(r for r in short_response(maneuver, period_s) if r.code == "aborted"),
    ]
