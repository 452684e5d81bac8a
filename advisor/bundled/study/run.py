"""The studies by name: each divided into tasks, with the report that the results make."""

from collections.abc import Sequence
from dataclasses import asdict

import numpy as np

from advisor.bundled.study import advised, changed, flaws, readings, stops, text
from advisor.bundled.study.campaigns import RULES, CampaignBlock, CampaignResults, joined, judge, table_blocks
from advisor.bundled.study.figure import curve, in_terminal
from advisor.bundled.study.flying import NoiseReading, Scene
from advisor.bundled.study.paper import NOISE_PERCENT
from advisor.bundled.study.plan import Study, StudyReport
from advisor.bundled.study.table import as_document, row


def table_1(
    campaigns: int, seed: int, reading: NoiseReading = "std", other_readings: bool = False
) -> Study[CampaignBlock, CampaignResults]:
    """Return the study of Table 1 and Figure 5, the paper's place in them, and the flaws of its rules."""
    scene = Scene()
    levels = [table_blocks(scene, noise, campaigns, seed, reading, other_readings) for noise in NOISE_PERCENT]
    near_zero = flaws.near_zero_blocks(campaigns, seed)

    def report(results: Sequence[CampaignResults]) -> StudyReport:
        left = iter(results)
        judged = {
            noise: [next(left) for _ in level] for noise, level in zip(NOISE_PERCENT, levels, strict=True)
        }
        found = flaws.measure(judged[NOISE_PERCENT[0]], list(left))
        outcomes = {(rule, noise): joined(judged[noise], rule) for rule in RULES for noise in NOISE_PERCENT}
        rows = [row(rule, noise, several, scene.theta) for (rule, noise), several in outcomes.items()]
        curves = [
            curve(rule, noise, several)
            for (rule, noise), several in outcomes.items()
            if rule != "information"
        ]
        compared = [
            result
            for noise in NOISE_PERCENT
            for result in readings.compare([block.needed for block in judged[noise]], noise)
        ]
        lines = [
            *text.heading(campaigns, scene, reading),
            *text.table(rows),
            *text.where_the_paper_lies(rows),
            *text.tolerances(rows),
            *(line for rule in RULES[:2] for line in [*in_terminal(curves, rule), ""]),
            *text.flaws(found),
            *(text.readings(compared) if compared else []),
        ]
        document = as_document(rows, campaigns) | {
            "noise_reading": reading,
            "flaws": asdict(found),
            "figure_5": [asdict(c) for c in curves],
        }
        return StudyReport(lines, document, tuple(curves))

    return Study([block for level in (*levels, near_zero) for block in level], judge, report)


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
        return StudyReport(text.savings(savings, campaigns), document)

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
        return StudyReport(text.detections(found, campaigns), document)

    return Study(flown, changed.notice, report)


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
                "error_percent": {"median": s.error_quantile(0.5), "p95": s.error_quantile(0.95)},
            }
            for s in found
        ]
        document = {"schema": "advisor.study.stops/1", "campaigns": campaigns, "rows": entries}
        return StudyReport(text.early_stops(found, campaigns), document)

    return Study(flown, stops.fly, report)
