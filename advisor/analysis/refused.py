"""Manoeuvres that ``advisor analyze`` refuses because of their data, which the gap does not use either."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

from advisor.aircraft.aircraft import Aircraft
from advisor.decision.axes.requirements import needed, pitch_limits
from advisor.decision.envelope import changed_speed, incomplete, short_response
from advisor.decision.first_unit import natural_period
from advisor.decision.quality import refusals
from advisor.decision.verdict import Reason
from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.oem.estimate import NoEstimate
from advisor.simulators.speed_kind import SpeedKind
from advisor.words.problems import UnusableInputError

_KNOWN = frozenset({"throttle", "rate"})
"""Reasons for a refusal that do not apply to the gap. The gap's model includes the throttle, and the gap
itself reports the effects that a slow channel hides."""
_LARGEST_SPEED_CHANGE_PERCENT = 30.0
"""Change of the air speed, %, up to which the gap scales forces with the speed, if the crew allows less.
Such a speed change alters the forces by two thirds. Manoeuvres of the generators stay below 24 %, and those
of two UAV records outside the model have 66 and 69 %."""
LEAST = 3
"""Least number of remaining manoeuvres: two for a search, and one for its check."""


@dataclass(frozen=True)
class Chosen:
    """The manoeuvres that the gap uses, and a sentence on each refused manoeuvre."""

    maneuvers: list[Maneuver]
    notes: tuple[str, ...]
    although_refused: tuple[int, ...] = ()
    """Numbers of the used manoeuvres that ``advisor analyze`` refuses."""

    def with_speed(self, kind: SpeedKind) -> "Chosen":
        """Return the choice with the kind of air speed that the motion shows."""
        return replace(self, maneuvers=kind.maneuvers, notes=(*filter(None, [kind.note]), *self.notes))


def without_refused(maneuvers: Sequence[Maneuver], aircraft: Aircraft) -> Chosen:
    """Return the manoeuvres without those that exceed the limits or have incomplete data.

    If fewer than ``LEAST`` would remain, all are used, and the sentences name the defects.

    Raises
    ------
    UnusableInputError
        A contradicted instrument or the air speed leaves no manoeuvre.
    """
    reasons = {m.number: reason for m in maneuvers if (reason := _reason(m, aircraft)) is not None}
    good = [m for m in maneuvers if m.number not in reasons]
    hopeless = [r for r in reasons.values() if r.by_instrument or r.code == "airspeed"]
    if maneuvers and len(hopeless) == len(maneuvers):
        raise UnusableInputError(
            hopeless[0].code,
            f"No manoeuvre of the log can be used. Manoeuvre {maneuvers[0].number}: {hopeless[0].text}.",
            "Fly manoeuvres that advisor analyze accepts.",
        )
    if len(good) >= LEAST:
        return Chosen(good, tuple(f"Manoeuvre {n} is not used: {r.text}." for n, r in reasons.items()))
    notes = tuple(f"advisor analyze refuses manoeuvre {n}: {r.text}." for n, r in reasons.items())
    return Chosen(list(maneuvers), notes, tuple(reasons))


def _reason(maneuver: Maneuver, aircraft: Aircraft) -> Reason | None:
    """Return the first reason to refuse a manoeuvre in ``analyze``, independent of its estimate."""
    period_s = natural_period(maneuver, NoEstimate("not_asked", "no estimate was asked for"))
    most = max(aircraft.limits.airspeed_change_percent, _LARGEST_SPEED_CHANGE_PERCENT)
    allowing = replace(aircraft, limits=replace(aircraft.limits, airspeed_change_percent=most))
    reasons = [
        *incomplete(maneuver, needed("pitch", maneuver), period_s, ("alpha",)),
        # The gap has late streams and the scale of the air speed in its own model.
        *refusals(f for f in maneuver.findings if f.quantity != "delay_s" and f.channel != "airspeed"),
        *pitch_limits(maneuver, aircraft),
        *changed_speed(maneuver, allowing),
        *(r for r in short_response(maneuver, period_s) if r.code == "aborted"),
    ]
    return next((reason for reason in reasons if reason.code not in _KNOWN), None)
