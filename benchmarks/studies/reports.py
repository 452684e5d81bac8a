"""Studies beside the paper's: each divided into tasks, with the report that the results make."""

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import asdict

import numpy as np

from advisor.bundled.study.campaigns import RULES
from advisor.bundled.study.run import Study, StudyReport
from advisor.bundled.study.text import count, wrapped
from benchmarks.studies import advised, changed, covered, stops
from benchmarks.studies.forecast import Score, score


def advice(campaigns: int, seed: int) -> Study[advised.Pair, tuple[int, int]]:
    """Return the study of the manoeuvres that the advice saves, on two aircraft."""
    pairs = advised.pairs(campaigns, seed)

    def report(results: Sequence[tuple[int, int]]) -> StudyReport:
        savings = advised.savings(pairs, results)
        entries = [
            {
                "aircraft": s.aircraft,
                "noise_percent": s.noise_percent,
                "same_excursion": s.same_excursion,
                "standard": {"mean": float(np.mean(s.standard)), "median": float(np.median(s.standard))},
                "advised": {"mean": float(np.mean(s.advised)), "median": float(np.median(s.advised))},
                "fewer_percent": s.percent,
            }
            for s in savings
        ]
        document = {"schema": "advisor.study.advice/1", "campaigns": campaigns, "rows": entries}
        return StudyReport(_savings(savings, campaigns), document)

    return Study(pairs, advised.fly, report)


def change(campaigns: int, seed: int) -> Study[changed.ChangedBlock, changed.Noticed]:
    """Return the study of changed aircraft: how soon noticed, and how often suspected without a change."""
    flown = changed.change_blocks(campaigns, seed)

    def report(results: Sequence[changed.Noticed]) -> StudyReport:
        found = changed.detections(flown, results)
        entries = [
            {
                "noise_percent": d.noise_percent,
                "lost": d.lost,
                "suspected_percent": d.suspected_percent,
                "confirmed_percent": d.confirmed_percent,
                "sigma": None if np.isnan(d.sigma) else d.sigma,
            }
            for d in found
        ]
        document = {"schema": "advisor.study.change/1", "campaigns": campaigns, "rows": entries}
        return StudyReport(_detections(found, campaigns), document)

    return Study(flown, changed.notice, report)


def coverage(campaigns: int, seed: int) -> Study[covered.Drawn, covered.Outcome]:
    """Return the study of whole campaigns with errors of instruments and telemetry."""

    def report(results: Sequence[covered.Outcome]) -> StudyReport:
        groups = {"all": list(results)} | {
            said: [one for one in results if one.drawn.statement == said] for said in covered.STATEMENTS
        }
        stopped = [one for one in results if one.stop is not None]
        far_off = [one for one in results if one.far_off]
        counted: dict[str, object] = {
            "coverage_percent": {name: covered.coverage_percent(group) for name, group in groups.items()},
            "stops": len(stopped),
            "false_stops": sum(one.stopped_falsely for one in stopped),
            "lag_far_off": {
                "campaigns": len(far_off),
                "stops": sum(one.stop is not None for one in far_off),
                "false_stops": sum(one.stopped_falsely for one in far_off),
                "contradicted": sum("elevator_lag_s" in one.right for one in far_off),
            },
            "contradictions": {
                "right": dict(Counter(code for one in results for code in one.right)),
                "wrong": dict(Counter(code for one in results for code in one.wrong)),
            },
            "forecast": asdict(_forecast(results)),
        }
        document = {"schema": "advisor.study.coverage/1", "campaigns": campaigns, **counted}
        rows = [one.document for one in results]
        return StudyReport(_coverage(groups), document | {"rows": rows})

    return Study(covered.draws(campaigns, seed), covered.fly, report)


def early_stops(campaigns: int, seed: int) -> Study[stops.StopsBlock, stops.Stops]:
    """Return the study of early stops by the rule ``information``, and of the manoeuvres that each rule
    needs."""
    flown = stops.stop_blocks(campaigns, seed, stops.CASES)

    def report(results: Sequence[stops.Stops]) -> StudyReport:
        found = stops.by_case(results)
        entries = [
            {
                **asdict(s.case),
                "needed": {
                    rule: {"median": s.median_needed(rule), "never_percent": s.never_percent(rule)}
                    for rule in RULES
                },
                "stops": len(s.error_percent),
                "false_percent": s.false_percent if s.error_percent else None,
                "forecast_kept_percent": s.kept_percent if s.promises else None,
                "error_percent": {"median": s.error_quantile(0.5), "p95": s.error_quantile(0.95)},
            }
            for s in found
        ]
        document = {"schema": "advisor.study.stops/1", "campaigns": campaigns, "rows": entries}
        return StudyReport(_stops(found, campaigns), document)

    return Study(flown, stops.fly, report)


def _savings(found: Sequence[advised.Saving], campaigns: int) -> list[str]:
    """Return lines on manoeuvres needed with and without the advice."""
    lines = wrapped(
        f"Manoeuvres until the response is known to {advised.PLAN.tolerance_percent:g} % of its peak, the "
        f"named derivatives accordingly (rule information), {campaigns} campaigns each, repeating the "
        "standard 3-2-1-1 in alternating directions, and flying what was advised:"
    )
    for one in found:
        limits = (
            "angle of attack as in the standard input" if one.same_excursion else "within the usual limits"
        )
        lines += wrapped(
            f"  {one.aircraft}, noise {one.noise_percent:g} %, {limits}: {np.mean(one.standard):.1f} and "
            f"{np.mean(one.advised):.1f} on average (median {np.median(one.standard):.0f} and "
            f"{np.median(one.advised):.0f}): {one.percent:.0f} % fewer."
        )
    return lines


def _detections(found: Sequence[changed.Detection], campaigns: int) -> list[str]:
    """Return lines on changes noticed, and on false alarms."""
    lines = [f"Something changed, {campaigns} campaigns each:"]
    for one in found:
        if one.lost is None:
            lines += wrapped(
                f"  noise {one.noise_percent:g} %, nothing changed: suspected in "
                f"{one.suspected_percent:.1f} %, confirmed in {one.confirmed_percent:.1f} %."
            )
        else:
            lines += wrapped(
                f"  noise {one.noise_percent:g} %, {one.lost} loses {100 * changed.LOSS:.0f} % after "
                f"{changed.BEFORE} manoeuvres: suspected at once in {one.suspected_percent:.1f} %, confirmed "
                f"and named after two in {one.confirmed_percent:.1f} % ({one.sigma:.0f} sigma)."
            )
    return lines


def _stops(found: Sequence[stops.Stops], campaigns: int) -> list[str]:
    """Return lines on false stops of the rule ``information``, and on manoeuvres needed under each rule."""
    lines = wrapped(
        "Stops of the rule information. False: the predicted response is wrong by more than the tolerance; "
        "error: how wrong it is in 95 % of the stops at most. "
        f"Needed by {campaigns} campaigns of seven manoeuvres: median (share without stop)."
    )
    for one in found:
        case, error = one.case, one.error_quantile(0.95)
        wrong = "no stop" if error is None else f"false {one.false_percent:.1f} %, error {error:.2f} %"
        needed = ", ".join(
            f"{rule} {count(one.median_needed(rule))} ({one.never_percent(rule):.0f} %)"
            for rule in ("information", "continuous", "separate")
        )
        lines += wrapped(
            f"{case.name}, noise {case.noise_percent:g} %, tolerance {case.tolerance_percent:g} %: {wrong}"
        )
        lines += wrapped(f"  needed: {needed}")
        if one.promises:
            lines += wrapped(f"  forecast for nine campaigns in ten: held by {one.kept_percent:.0f} %")
    return lines


def _forecast(found: Sequence[covered.Outcome]) -> Score:
    """Return the score of all forecasts."""
    return score([(one.forecasts, one.stop.after if one.stop else None, one.flown) for one in found])


def _coverage(groups: Mapping[str, Sequence[covered.Outcome]]) -> list[str]:
    """Return lines on the intervals that hold, on false stops, and on findings that contradict."""
    everything = groups["all"]
    lines = wrapped(
        "Share of the model's 95 % intervals that hold the truth (goal 93 to 97 %), with errors of servo, "
        "instruments and telemetry drawn from priors:"
    )
    for said, group in groups.items():
        told = "all campaigns" if said == "all" else f"lag of the servo {said}"
        shares = ", ".join(
            f"{name} {percent:.0f} %" for name, percent in covered.coverage_percent(group).items()
        )
        lines += wrapped(f"  {told}, {sum(bool(one.off) for one in group)} of {len(group)}: {shares}")
    for told, group in (
        ("Stops", everything),
        ("Stops where the stated lag is off by 30 % or more", [o for o in everything if o.far_off]),
    ):
        stopped = [one for one in group if one.stop is not None]
        false = sum(one.stopped_falsely for one in stopped)
        lines += wrapped(f"{told}: {len(stopped)} in {len(group)} campaigns, false {false}.")
    for told, codes in (
        ("rightly", [code for one in everything for code in one.right]),
        ("wrongly", [code for one in everything for code in one.wrong]),
    ):
        each = ", ".join(f"{code} {number}" for code, number in sorted(Counter(codes).items()))
        lines += wrapped(f"Findings that contradict {told}: {len(codes)}{f' ({each})' if each else ''}.")
    told_ahead = _forecast(everything)
    lines += wrapped(
        f"Forecasts: the stop came within the stated 90 % after {told_ahead.kept} of {told_ahead.checked} "
        f"(goal 85 to 95 %); {told_ahead.jumped} of {told_ahead.followed} jumped by more than their band."
    )
    return lines
