"""The document ``advisor.analyze/1`` for scripts, in SI units. A missing or undefined number is None."""

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from types import MappingProxyType
from typing import Any

from advisor.aircraft.aircraft import Aircraft
from advisor.campaign.state import CampaignState, JudgedManeuver, LateralState
from advisor.decision.verdict import CrewPlan, FlightTestVerdict, Remaining
from advisor.flight.signals.trust import InstrumentFinding
from advisor.flight.stream.flights import FlightHeard
from advisor.oem.axis.estimate import AxisEstimate
from advisor.oem.estimate import Estimate
from advisor.report.qualities import (
    coefficients_of,
    levels_document,
    levels_of,
    qualities_document,
    qualities_of,
    tests_document,
    tests_of,
)
from advisor.words.plain import picked, plain
from advisor.words.problems import Problem
from advisor.words.quantities import NORMAL_95


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


_quality = partial(picked, names="value std ci95")


def lateral_document(state: LateralState, aircraft: Aircraft) -> dict[str, Any]:
    """Return the block ``lateral`` of ``advisor analyze --json``, in SI units."""
    model = state.model
    return {
        "maneuvers": [_side_maneuver(judged) for judged in state.maneuvers],
        "flight_test": concluded(state.flight_test),
        "model": _side_model(model),
        "modes": _modes(model) if model else None,
        "levels": levels_document(levels_of(state)),
        "qualification": tests_document(tests_of(state, aircraft)),
        "not_identifiable": dict(model.not_identifiable) if model else {},
        "estimate_from": list(state.estimate_from),
    }


def _side_maneuver(judged: JudgedManeuver) -> dict[str, Any]:
    estimate = judged.estimate if isinstance(judged.estimate, AxisEstimate) else None
    entry = flown(judged)
    del entry["record_from_boot_s"]
    return {
        **picked(judged.maneuver, "number flight boot mode"),
        **entry,
        **fitted(estimate),
        "estimates": _with_values(estimate) if estimate else None,
        "modes": _modes(estimate) if estimate else None,
        "not_identifiable": dict(estimate.not_identifiable) if estimate else {},
    }


def _with_values(estimate: Estimate) -> dict[str, Any]:
    """Return every identifiable derivative with its 95 % interval."""
    return {name: entry for name, entry in with_intervals(estimate).items() if "reason" not in entry}


def _side_model(model: AxisEstimate | None) -> dict[str, Any] | None:
    if model is None:
        return None
    return {
        **_with_values(model),
        "reference_airspeed_m_s": plain(model.airspeed_m_s),
        "instruments": {
            name: {"value": plain(value), "std": plain(std)} for name, (value, std) in model.nuisances.items()
        },
    }


def _modes(estimate: AxisEstimate) -> dict[str, Any]:
    modes = estimate.modes
    return {
        "dutch_roll": {
            "omega": _quality(modes.get("dutch_roll_omega")),
            "zeta": _quality(modes.get("dutch_roll_zeta")),
        },
        "roll": {"time_constant": _quality(modes.get("roll_time_constant"))},
        "spiral": {"pole": _quality(modes.get("spiral_pole"))},
        "left_out": dict(estimate.modes_left_out),
    }
