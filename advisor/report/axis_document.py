"""Parts of the document ``advisor.analyze/1`` that every axis has, in SI units."""

from typing import Any

from advisor.campaign.state import JudgedManeuver
from advisor.decision.verdict import FlightTestVerdict, Remaining
from advisor.oem.estimate import Estimate
from advisor.words.plain import picked, plain
from advisor.words.quantiles import NORMAL_95


def flown(judged: JudgedManeuver) -> dict[str, Any]:
    """Return the times of a manoeuvre, its input, and its verdict."""
    span, verdict = judged.maneuver.span, judged.verdict
    return {
        "start_boot_s": plain(span.start_s),
        "end_boot_s": plain(span.end_s),
        "record_from_boot_s": plain(span.record_from_s),
        "last_step_boot_s": plain(span.last_step_s),
        "input": span.kind,
        "closed_by": span.closed_by,
        "verdict": "accepted" if verdict.accepted else "rejected",
        **picked(verdict, "sentence reasons cautions rules"),
        **picked(judged, "excluded_because notes"),
    }


def concluded(verdict: FlightTestVerdict) -> dict[str, Any]:
    """Return stop or continue, every rule's criterion, and the next input."""
    following = verdict.next
    return {
        **picked(verdict, "rule decision sentence criterion_percent limit_percent stopped_at warnings"),
        "by_rule": {
            # Only the rule ``information`` holds quantities to their tolerances.
            name: picked(progress, "stopped_at history_percent hindsight_stopped_at hindsight_percent")
            | (
                picked(progress, "prediction_percent parameter_percent")
                if progress.prediction_percent or progress.parameter_percent
                else {}
            )
            for name, progress in verdict.by_rule.items()
        },
        "next": following
        and {
            **picked(following, "advice holding_back"),
            "remaining_maneuvers": picked(following.remaining or Remaining(None, None), "median p90"),
        },
    }


def fitted(estimate: Estimate | None) -> dict[str, Any]:
    """Return the cost of an estimate, and measures of the fit for each output."""
    fits = estimate.fits[0].items() if estimate else ()
    return {
        "cost": plain(estimate.cost) if estimate else None,
        "fit": {name: picked(fit, "rms tic r2") for name, fit in fits},
    }


def parameters(estimate: object) -> dict[str, Any] | None:
    """Return every parameter as ``{value, std, std_cr}``. A parameter that is not identifiable has the value
    None and a reason.
    """
    if not isinstance(estimate, Estimate):
        return None
    return {
        name: {"value": None, "std": None, "std_cr": None, "reason": estimate.not_identifiable[name]}
        if name in estimate.not_identifiable
        else {"value": plain(value), "std": plain(std), "std_cr": plain(std_cr)}
        for name, value, std, std_cr in zip(
            estimate.names, estimate.theta, estimate.std, estimate.std_cr, strict=True
        )
    }


def terms_of(estimate: Estimate) -> dict[str, Any]:
    """Return the coefficients of the terms that the user added, with their 95 % intervals and their gains in
    log likelihood.
    """
    return {
        term.name: {
            **picked(term, "value std"),
            "ci95": [term.value - NORMAL_95 * term.std, term.value + NORMAL_95 * term.std],
            "log_likelihood_gained": plain(term.gained),
        }
        for term in estimate.terms
    }


def with_intervals(estimate: Estimate) -> dict[str, Any]:
    """Return every parameter with its 95 % interval ``ci95``; the interval is None if unknown."""
    document: dict[str, Any] = {}
    for name, entry in (parameters(estimate) or {}).items():
        if name in estimate.fixed:
            document[name] = {**entry, "ci95": [entry["value"], entry["value"]], "fixed": True}
            continue
        ci95 = None
        if entry["value"] is not None and entry["std"] is not None:
            half = NORMAL_95 * entry["std"]
            ci95 = [entry["value"] - half, entry["value"] + half]
        document[name] = {**entry, "ci95": ci95}
    return document | terms_of(estimate)
