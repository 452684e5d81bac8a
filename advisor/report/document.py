"""The document ``advisor.analyze/1`` for scripts, in SI units. A missing or undefined number is None."""

from collections.abc import Callable, Mapping, Sequence
from types import MappingProxyType
from typing import Any

from advisor.aircraft.aircraft import Aircraft
from advisor.campaign.state import CampaignState, JudgedManeuver
from advisor.decision.crew_plan import CrewPlan
from advisor.flight.signals.instrument_finding import InstrumentFinding
from advisor.flight.stream.flights import FlightHeard
from advisor.oem.estimate import Estimate
from advisor.report.axes.lateral_document import lateral_document
from advisor.report.axis_document import concluded, fitted, flown, parameters, with_intervals
from advisor.report.qualities import coefficients_of, qualities_document, qualities_of
from advisor.words.plain import picked, plain
from advisor.words.problems import Problem

SCHEMA = "advisor.analyze/1"


def analysis_document(
    state: CampaignState | None,
    files: Sequence[str],
    aircraft: Aircraft,
    left_out: Mapping[int, Sequence[Problem]] = MappingProxyType({}),
    notes: Sequence[str] = (),
) -> dict[str, Any]:
    """Return the document of ``advisor analyze --json``.

    Parameters
    ----------
    state
        State of the campaign at the end of the logs; None if no log could be read.
    files
        Names of the logs as the user gave them, flight by flight.
    left_out
        Reasons why logs are not used, by flight. ``usable`` is false if no log is used.
    """
    several = len(files) > 1
    read = [*state.elevator_notes, *state.reader_notes, *state.mark_notes] if state else []
    heard = {log.flight: log for log in state.flights} if state else {}
    logs = [_log(heard.get(flight), file) for flight, file in enumerate(files)]

    def of_log(flight: int) -> dict[str, Any]:
        return {"log": files[flight]} if several else {}

    if several:
        for flight, log in enumerate(logs):
            log["again"] = heard[flight].again if flight in heard else 0
            log["problems"] = plain(left_out.get(flight, ()))
    return {
        "schema": SCHEMA,
        "usable": len(left_out) < len(files),
        "problems": [
            {**plain(problem), **of_log(flight)}
            for flight, several_problems in sorted(left_out.items())
            for problem in several_problems
        ]
        + [failure.entry for failure in (state.failed if state else ())],
        "log": {**logs[0], "notes": read},
        **({"logs": logs, "notes": list(notes)} if several else {}),
        **_OF_NO_CAMPAIGN,
        **(_campaign(state, aircraft, of_log) if state else {}),
        **({"lateral": lateral_document(state.lateral, aircraft)} if state and state.lateral else {}),
        "plan": _plan(state.plan if state else None),
    }


def _plan(plan: CrewPlan | None) -> dict[str, Any] | None:
    """Return the plan of both axes; None if only one axis was flown."""
    if plan is None:
        return None
    return {**picked(plan, "sentence"), "done": list(plan.done), "open": list(plan.open), "next": plan.advice}


_OF_NO_CAMPAIGN: Mapping[str, Any] = {
    "maneuvers": [], "flight_test": None, "model": None, "coefficients": {}, "flying_qualities": None,
    "instruments": [], "estimate_from": [], "activity": [], "notices": [],
}  # fmt: skip
"""Keys and values of a document without a readable log."""


def _campaign(
    state: CampaignState, aircraft: Aircraft, of_log: Callable[[int], dict[str, Any]]
) -> dict[str, Any]:
    coefficients = coefficients_of(state, aircraft.reference)
    return {
        "maneuvers": [{**_maneuver(m), **of_log(m.maneuver.flight)} for m in state.maneuvers],
        "flight_test": concluded(state.flight_test),
        "model": _model(state.model),
        "coefficients": {name: picked(c, "value std") for name, c in coefficients.items()},
        "flying_qualities": qualities_document(qualities_of(state, aircraft.reference)),
        "instruments": [instrument_document(finding) for finding in state.instruments],
        "estimate_from": list(state.estimate_from),
        "activity": [
            {
                "start_boot_s": plain(movement.start_s), "end_boot_s": plain(movement.end_s),
                **picked(movement, "reason text boot"), **of_log(movement.flight),
            }
            for movement in state.activity
        ],
        "notices": list(state.notices),
    }  # fmt: skip


def _log(heard: FlightHeard | None, file: str) -> dict[str, Any]:
    channels = heard.channels.items() if heard else ()
    return {
        "file": file,
        "duration_s": plain(heard.duration_s) if heard else None,
        "vehicle": picked(heard and heard.vehicle, "system component autopilot firmware"),
        "channels": {name: picked(c, "source provenance rate_hz largest_gap_s") for name, c in channels},
    }


def _maneuver(judged: JudgedManeuver) -> dict[str, Any]:
    estimate = judged.estimate if isinstance(judged.estimate, Estimate) else None
    prediction = estimate.prediction.items() if estimate else ()
    return {
        **picked(judged.maneuver, "number boot mode"),
        **flown(judged),
        **fitted(estimate),
        "estimates": parameters(judged.estimate),
        "outputs": list(estimate.outputs) if estimate else [],
        "filter_error": estimate.filtered if estimate else False,
        "instruments": instruments(estimate),
        "prediction_percent": {name: plain(100.0 * share) for name, share in prediction},
        "not_identifiable": dict(estimate.not_identifiable) if estimate else {},
        "identifiability": identifiability(estimate),
    }


def instruments(estimate: Estimate | None) -> dict[str, Any]:
    """Return the instrument parameters that were estimated with the derivatives, by name."""
    return {x.name: picked(x, "value std") for x in (estimate.instruments if estimate else ())}


def instrument_document(finding: InstrumentFinding) -> dict[str, Any]:
    """Return the document part about one contradiction between an instrument and the others."""
    return {
        **picked(finding, "code channel quantity stated contradicts used text fix"),
        "found": picked(finding, "value std"),
    }


def identifiability(estimate: Estimate | None) -> dict[str, Any] | None:
    """Return measures of how well the input separates the parameters."""
    if estimate is None:
        return None
    return {
        "condition": plain(estimate.condition),
        "correlated": [
            {"parameters": [first, second], "correlation": plain(value)}
            for first, second, value in estimate.correlated
        ],
    }


def _model(model: Estimate | None) -> dict[str, Any] | None:
    if model is None:
        return None
    return with_intervals(model) | {
        "reference_airspeed_m_s": plain(model.airspeed_m_s),
        "identifiability": identifiability(model),
        "instruments": instruments(model),
        "notes": list(model.notes),
    }
