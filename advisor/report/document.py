"""The ``advisor.analyze/1`` document for scripts, in SI units, with None in place of missing values and
NaN."""

import math
from collections.abc import Mapping, Sequence
from types import MappingProxyType
from typing import Any

from advisor.aircraft.aircraft import PARAMETERS, Aircraft
from advisor.campaign.state import CampaignState, JudgedManeuver
from advisor.decision.verdict import FlightTestVerdict, RuleProgress, RuleResult
from advisor.flight.signals.instrument_finding import InstrumentFinding
from advisor.flight.stream.flights import FlightHeard
from advisor.oem.estimate import Estimate, NoEstimate
from advisor.report.qualities import coefficients_of, qualities_document, qualities_of
from advisor.words.problems import Problem

SCHEMA = "advisor.analyze/1"
NORMAL_95 = 1.959963984540054


def analysis_document(
    state: CampaignState | None,
    files: Sequence[str],
    aircraft: Aircraft,
    left_out: Mapping[int, Sequence[Problem]] = MappingProxyType({}),
    notes: Sequence[str] = (),
) -> dict[str, Any]:
    """Build the document of ``advisor analyze --json``.

    Parameters
    ----------
    state
        Campaign at the end of the logs. None when no log could be read.
    files
        Names of the logs, as given, flight by flight.
    aircraft
        Aircraft with reference data for non-dimensional coefficients.
    left_out
        Reasons for which logs do not count, by flight. ``usable`` is false when no log counts.
    notes
        Sentences on the series of logs.
    """
    several = len(files) > 1
    read = [*state.elevator_notes, *state.reader_notes, *state.mark_notes] if state else []
    heard = {one.flight: one for one in state.flights} if state else {}
    logs = [_log(heard.get(flight), file) for flight, file in enumerate(files)]

    def of_log(flight: int) -> dict[str, Any]:
        return {"log": files[flight]} if several else {}

    if several:
        for flight, log in enumerate(logs):
            log["again"] = heard[flight].again if flight in heard else 0
            log["problems"] = [_problem(problem) for problem in left_out.get(flight, ())]
    return {
        "schema": SCHEMA,
        "usable": len(left_out) < len(files),
        "problems": [
            {**_problem(problem), **of_log(flight)}
            for flight, found in sorted(left_out.items())
            for problem in found
        ],
        "log": {**logs[0], "notes": read},
        **({"logs": logs, "notes": list(notes)} if several else {}),
        "maneuvers": [{**_maneuver(m), **of_log(m.maneuver.flight)} for m in state.maneuvers]
        if state
        else [],
        "flight_test": _flight_test(state.flight_test) if state else None,
        "model": _model(state.model) if state else None,
        "coefficients": {
            name: {"value": number(coefficient.value), "std": number(coefficient.std)}
            for name, coefficient in coefficients_of(state, aircraft.reference).items()
        }
        if state
        else {},
        "flying_qualities": qualities_document(qualities_of(state, aircraft.reference)) if state else None,
        "instruments": [instrument_document(found) for found in state.instruments] if state else [],
        "estimate_from": list(state.estimate_from) if state else [],
        "activity": [
            {
                "start_boot_s": number(activity.start_s),
                "end_boot_s": number(activity.end_s),
                "reason": activity.reason,
                "text": activity.text,
                "boot": activity.boot,
                **of_log(activity.flight),
            }
            for activity in (state.activity if state else ())
        ],
        "notices": list(state.notices) if state else [],
    }


def _problem(problem: Problem) -> dict[str, Any]:
    return {"code": problem.code, "text": problem.text, "fix": problem.fix}


def _log(heard: FlightHeard | None, file: str) -> dict[str, Any]:
    vehicle = heard.vehicle if heard else None
    return {
        "file": file,
        "duration_s": number(heard.duration_s) if heard else None,
        "vehicle": vehicle
        and {
            "system": vehicle.system,
            "component": vehicle.component,
            "autopilot": vehicle.autopilot,
            "firmware": vehicle.firmware,
        },
        "channels": {
            name: {
                "source": channel.source,
                "provenance": channel.provenance,
                "rate_hz": number(channel.rate_hz),
                "largest_gap_s": number(channel.largest_gap_s),
            }
            for name, channel in (heard.channels.items() if heard else ())
        },
    }


def _maneuver(judged: JudgedManeuver) -> dict[str, Any]:
    span, verdict = judged.maneuver.span, judged.verdict
    estimate = judged.estimate if isinstance(judged.estimate, Estimate) else None
    return {
        "number": judged.maneuver.number,
        "boot": judged.maneuver.boot,
        "start_boot_s": number(span.start_s),
        "end_boot_s": number(span.end_s),
        "record_from_boot_s": number(span.record_from_s),
        "last_step_boot_s": number(span.last_step_s),
        "input": span.kind,
        "mode": judged.maneuver.mode,
        "verdict": "accepted" if verdict.accepted else "rejected",
        "sentence": verdict.sentence,
        "reasons": [
            {"code": r.code, "text": r.text, "value": number(r.value), "limit": number(r.limit)}
            for r in verdict.reasons
        ],
        "cautions": list(verdict.cautions),
        "excluded_because": judged.excluded_because,
        "notes": list(judged.notes),
        "closed_by": span.closed_by,
        "cost": number(estimate.cost) if estimate else None,
        "fit": {
            name: {"rms": number(fit.rms), "tic": number(fit.tic), "r2": number(fit.r2)}
            for name, fit in (estimate.fits[0].items() if estimate else ())
        },
        "estimates": parameters(judged.estimate),
        "outputs": list(estimate.outputs) if estimate else [],
        "filter_error": estimate.filtered if estimate else False,
        "instruments": instruments(estimate),
        "prediction_percent": {
            name: number(100.0 * share) for name, share in (estimate.prediction.items() if estimate else ())
        },
        "not_identifiable": dict(estimate.not_identifiable) if estimate else {},
        "identifiability": identifiability(estimate),
        "rules": {name: _rule(result) for name, result in verdict.rules.items()},
    }


def _rule(result: RuleResult) -> dict[str, Any]:
    return {"accepted": result.accepted, "limit": number(result.limit)}


def parameters(estimate: Estimate | NoEstimate | None) -> dict[str, Any] | None:
    """Return every parameter as ``{value, std, std_cr}``. An unidentifiable parameter has None and the
    reason."""
    if not isinstance(estimate, Estimate):
        return None
    return {
        name: {"value": None, "std": None, "std_cr": None, "reason": estimate.not_identifiable[name]}
        if name in estimate.not_identifiable
        else {"value": number(value), "std": number(std), "std_cr": number(std_cr)}
        for name, value, std, std_cr in zip(
            PARAMETERS, estimate.theta, estimate.std, estimate.std_cr, strict=True
        )
    }


def instruments(estimate: Estimate | None) -> dict[str, Any]:
    """Return parameters of the instruments that were estimated with the derivatives, by name."""
    found = estimate.instruments if estimate else ()
    return {x.name: {"value": number(x.value), "std": number(x.std)} for x in found}


def instrument_document(found: InstrumentFinding) -> dict[str, Any]:
    """Return one finding on an instrument."""
    value = found.value if isinstance(found.value, str) else number(found.value)
    stated = found.stated if isinstance(found.stated, str) else number(found.stated)
    return {
        "code": found.code,
        "channel": found.channel,
        "quantity": found.quantity,
        "stated": stated,
        "found": {"value": value, "std": number(found.std)},
        "contradicts": found.contradicts,
        "used": found.used,
        "text": found.text,
        "fix": found.fix,
    }


def identifiability(estimate: Estimate | None) -> dict[str, Any] | None:
    """Return measures of how well the input separates the parameters."""
    if estimate is None:
        return None
    return {
        "condition": number(estimate.condition),
        "correlated": [
            {"parameters": [first, second], "correlation": number(value)}
            for first, second, value in estimate.correlated
        ],
    }


def _flight_test(verdict: FlightTestVerdict) -> dict[str, Any]:
    return {
        "rule": verdict.rule,
        "decision": verdict.decision,
        "sentence": verdict.sentence,
        "criterion_percent": number(verdict.criterion_percent),
        "limit_percent": verdict.limit_percent,
        "stopped_at": verdict.stopped_at,
        "by_rule": {
            name: {
                "stopped_at": progress.stopped_at,
                "history_percent": [number(value) for value in progress.history_percent],
                **_held_to(progress),
            }
            for name, progress in verdict.by_rule.items()
        },
        "next": verdict.next
        and {
            "advice": verdict.next.advice,
            "holding_back": verdict.next.holding_back,
            "remaining_maneuvers": {
                "median": verdict.next.remaining and verdict.next.remaining.median,
                "p90": verdict.next.remaining and verdict.next.remaining.p90,
            },
        },
        "warnings": list(verdict.warnings),
    }


def _held_to(progress: RuleProgress) -> dict[str, Any]:
    """Return the quantities of the rule ``information`` with their tolerances; nothing for the other
    rules."""
    if not progress.prediction_percent and not progress.parameter_percent:
        return {}
    return {
        "prediction_percent": dict(progress.prediction_percent),
        "parameter_percent": dict(progress.parameter_percent),
    }


def _model(model: Estimate | None) -> dict[str, Any] | None:
    values: Mapping[str, Any] | None = parameters(model)
    if model is None or values is None:
        return None
    document: dict[str, Any] = {}
    for name, entry in values.items():
        ci95 = None
        if entry["value"] is not None and entry["std"] is not None:
            half = NORMAL_95 * entry["std"]
            ci95 = [entry["value"] - half, entry["value"] + half]
        document[name] = {**entry, "ci95": ci95}
    document["reference_airspeed_m_s"] = number(model.airspeed_m_s)
    document["identifiability"] = identifiability(model)
    document["instruments"] = instruments(model)
    document["notes"] = list(model.notes)
    return document


def number(value: float | None) -> float | None:
    """Return a number that JSON can hold: None for a missing, infinite or undefined value."""
    return None if value is None or not math.isfinite(value) else float(value)
