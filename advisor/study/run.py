"""The studies by name: each gives lines to read and a document to compute with."""

from collections.abc import Callable
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np

from advisor.aircraft import CampaignPlan
from advisor.study import advised, changed, flaws, readings, stops, text
from advisor.study.campaigns import RULES, fly_campaigns, outcome
from advisor.study.figure import curve, draw, in_terminal
from advisor.study.flying import NoiseReading, Scene, as_maneuver, fly_named
from advisor.study.paper import NOISE_PERCENT, ORDER
from advisor.study.table import as_document, row

Progress = Callable[[int, int], None]
"""Told how many estimates are done, and of how many."""


@dataclass(frozen=True, slots=True)
class Report:
    """A study's result."""

    lines: list[str]
    document: dict[str, object]


def table_1(
    campaigns: int,
    seed: int,
    reading: NoiseReading = "std",
    figure: Path | None = None,
    other_readings: bool = False,
    progress: Progress | None = None,
) -> Report:
    """Return the Table 1 and Figure 5, the paper's place in them, and the flaws of its rules."""
    scene, plan = Scene(), CampaignPlan()
    maneuvers = [as_maneuver(fly_named(scene, name)) for name in ORDER]
    flown_in_all = campaigns * len(NOISE_PERCENT) + min(campaigns, flaws.MOST_CAMPAIGNS)
    advance = counter(len(ORDER) * flown_in_all, progress)
    rows, curves, compared = [], [], []
    first = None
    for noise in NOISE_PERCENT:
        flown = fly_campaigns(scene, noise, campaigns, seed, reading, advance=advance)
        first = first or flown
        for rule in RULES:
            outcomes = [outcome(campaign, rule, plan, maneuvers) for campaign in flown]
            rows.append(row(rule, noise, outcomes, scene.theta))
            if rule != "information":
                curves.append(curve(rule, noise, outcomes))
        if other_readings:
            compared += readings.compare(flown, noise)
    assert first is not None
    found = flaws.measure(first, seed, advance)
    if figure is not None:
        draw(curves, figure)
    rows.sort(key=lambda r: RULES.index(r.rule))
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
    return Report(lines, document)


def advice(campaigns: int, seed: int, progress: Progress | None = None) -> Report:
    """What following the advice saves, on two aircraft."""
    advance = counter(2 * len(advised.CASES) * campaigns, progress)
    savings = advised.measure(campaigns, seed, advance)
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
    return Report(text.savings(savings, campaigns), document)


def change(campaigns: int, seed: int, progress: Progress | None = None) -> Report:
    """Return how soon a changed aircraft is noticed, and how often an unchanged one is suspected."""
    found = changed.measure(campaigns, seed, counter(len(NOISE_PERCENT), progress))
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
    return Report(text.detections(found, campaigns), document)


def early_stops(campaigns: int, seed: int, progress: Progress | None = None) -> Report:
    """Return how often the rule ``information`` stops too early, and what each rule needs."""
    found = stops.measure(campaigns, seed, counter(len(stops.CASES), progress), stops.CASES)
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
    return Report(text.early_stops(found, campaigns), document)


def counter(total: int, progress: Progress | None) -> Callable[[int], None]:
    """Turn "so many more" into "so many of all"."""
    done = 0

    def advance(more: int) -> None:
        nonlocal done
        done += more
        if progress is not None:
            progress(done, total)

    return advance
