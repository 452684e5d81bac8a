"""The ``advisor.analyze/1`` document: what scripts read. SI units, NaN never, None where there is nothing."""

import math
from collections.abc import Mapping, Sequence
from typing import Any

from advisor.aircraft import PARAMETERS, Aircraft
from advisor.campaign_state import CampaignState, JudgedManeuver
from advisor.decision.verdict import FlightTestVerdict, RuleProgress, RuleResult
from advisor.oem.coefficients import coefficients
from advisor.oem.estimate import Estimate, NoEstimate
from advisor.problems import Problem

SCHEMA = "advisor.analyze/1"
NORMAL_95 = 1.959963984540054


def analysis_document(
    state: CampaignState | None, file: str, aircraft: Aircraft, problems: Sequence[Problem] = ()
) -> dict[str, Any]:
    """Build the document of ``advisor analyze --json``.

    Parameters
    ----------
    state
        The campaign at the end of the log; None when the log could not be read at all.
    file
        Name of the log, as given.
    aircraft
        Its reference data make non-dimensional coefficients of the model.
    problems
        Why the log cannot be used; with any, ``usable`` is false.
    """
    return {
        "schema": SCHEMA,
        "usable": not problems,
        "problems": [{"code": p.code, "text": p.text, "fix": p.fix} for p in problems],
        "log": _log(state, file),
        "maneuvers": [_maneuver(m) for m in state.maneuvers] if state else [],
        "flight_test": _flight_test(state.flight_test) if state else None,
        "model": _model(state.model) if state else None,
        "coefficients": {
            name: {"value": number(coefficient.value), "std": number(coefficient.std)}
            for name, coefficient in coefficients(state.model, aircraft.reference).items()
        }
        if state and state.model
        else {},
        "estimate_from": list(state.estimate_from) if state else [],
        "activity": [
            {
                "start_boot_s": number(activity.start_s),
                "end_boot_s": number(activity.end_s),
                "reason": activity.reason,
                "text": activity.text,
                "boot": activity.boot,
            }
            for activity in (state.activity if state else ())
        ],
        "notices": list(state.notices) if state else [],
    }


def _log(state: CampaignState | None, file: str) -> dict[str, Any]:
    vehicle = state.vehicle if state else None
    return {
        "file": file,
        "duration_s": number(state.duration_s) if state else None,
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
            for name, channel in (state.channels.items() if state else ())
        },
        "notes": [*state.elevator_notes, *state.reader_notes, *state.mark_notes] if state else [],
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
    """Every parameter as ``{value, std, std_cr}``; one that is not identifiable has None and its reason."""
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
    """Parameters of the instruments that were estimated with the derivatives, by name."""
    found = estimate.instruments if estimate else ()
    return {x.name: {"value": number(x.value), "std": number(x.std)} for x in found}


def identifiability(estimate: Estimate | None) -> dict[str, Any] | None:
    """How well the input told the parameters apart."""
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
                "median": verdict.next.remaining.median,
                "p90": verdict.next.remaining.p90,
            },
        },
        "warnings": list(verdict.warnings),
    }


def _held_to(progress: RuleProgress) -> dict[str, Any]:
    """What the rule information weighs, each beside its tolerance; nothing for the other rules."""
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
    """A number JSON can hold: None for what is missing, infinite or not a number."""
    return None if value is None or not math.isfinite(value) else float(value)
