"""The study in words: Table 1 beside the paper's, where the paper lies, the flaws."""

from collections.abc import Iterable, Sequence

import numpy as np

from advisor.aircraft import PARAMETERS, CampaignPlan
from advisor.study.advised import PLAN, Saving
from advisor.study.changed import BEFORE, LOSS, Detection
from advisor.study.flaws import NOISE_PERCENT, Flaws
from advisor.study.flying import NOISE_READINGS, NoiseReading, Scene
from advisor.study.readings import ReadingResult
from advisor.study.stops import Stops
from advisor.study.table import Row

COMMON = (5.0, 95.0)
"""A single realisation between these percentiles of ours is nothing out of the ordinary."""


NAMED = CampaignPlan().parameters
"""Parameters with a tolerance of their own."""


def heading(campaigns: int, scene: Scene, reading: NoiseReading) -> list[str]:
    """What was flown."""
    degrees = np.degrees(scene.amplitude_rad)
    return [
        f"The paper's campaign, {campaigns} times: modified 3-2-1-1 and its reverse (seven manoeuvres, "
        f"{scene.unit_s:g} s steps, {degrees:.0f} deg),",
        f"{scene.duration_s:g} s at {scene.rate_hz:g} Hz, white noise on angle of attack and pitch rate; "
        f'"noise 1 %" is 1 % {NOISE_READINGS[reading]}.',
        "The paper's rules are continuous (Eqs. 10 and 12) and separate (Eqs. 11 and 12); on real flights "
        "information decides.",
        "",
    ]


def table(rows: Sequence[Row]) -> list[str]:
    """Return three lines a row: the median error, the range of the middle 80 %, the paper's error."""
    lines = [
        "Nominal error in % at the stop: median, 10 % to 90 % of the campaigns, and the paper's. "
        "Needed: median (90 %), never.",
        f"{'rule':<12}{'noise':>6}  " + "".join(f"{name:>11}" for name in PARAMETERS) + "   needed",
    ]
    for row in rows:
        low, middle, high = np.quantile(row.error_percent, [0.1, 0.5, 0.9], axis=0)
        medians = "".join(f"{m:>11.2f}" for m in middle)
        ranges = "".join(f"{f'{a:.2f}-{b:.2f}':>11}" for a, b in zip(low, high, strict=True))
        needed = f"{_count(row.needed_quantile(0.5))} ({_count(row.needed_quantile(0.9))})"
        lines.append(f"{row.rule:<12}{row.noise_percent:>5g}%  {medians}   {needed}")
        lines.append(f"{'':<20}{ranges}   {row.never_percent:.0f} % never")
        if row.paper is not None:
            paper = "".join(f"{row.paper.error_percent[name]:>11.2f}" for name in PARAMETERS)
            lines.append(f"{'':<12}{'paper':>6}  {paper}   {_count(row.paper.needed)}")
    return [*lines, ""]


def where_the_paper_lies(rows: Sequence[Row]) -> list[str]:
    """Return a sentence a row on the paper's single realisation within our distribution."""
    lines = ["Where the paper's single campaign lies among ours:"]
    for row in rows:
        if row.paper is None:
            continue
        same = 100.0 * float(np.mean([n == row.paper.needed for n in row.needed]))
        places = row.percentile_of_paper()
        below = [name for name, percentile in places.items() if percentile < COMMON[0]]
        above = [name for name, percentile in places.items() if percentile > COMMON[1]]
        words = [
            f"{len(places) - len(above) - len(below)} of 8 errors are ordinary",
            *([f"larger than nearly all of ours: {', '.join(above)}"] if above else []),
            *([f"smaller than nearly all of ours: {', '.join(below)}"] if below else []),
        ]
        ended = "never ended" if row.paper.needed is None else f"needed {row.paper.needed}"
        lines.append(
            f"  {row.rule}, {row.noise_percent:g} %: it {ended}, as {same:.0f} % of ours; {'; '.join(words)}."
        )
    return [*lines, ""]


def tolerances(rows: Sequence[Row]) -> list[str]:
    """Return how often the rule `information` was wrong."""
    lines = []
    for row in rows:
        if row.outside_tolerance_percent is not None:
            outside = {name: row.outside_tolerance_percent[PARAMETERS.index(name)] for name in NAMED}
            worst = max(outside, key=lambda name: outside[name])
            lines.append(
                f"information, {row.noise_percent:g} %: outside its tolerance at the stop "
                f"{np.mean(list(outside.values())):.1f} % of the named derivatives, at most "
                f"{outside[worst]:.1f} % ({worst})."
            )
    return [*lines, ""]


def flaws(found: Flaws) -> list[str]:
    """What users of the paper's rules must know."""
    return [
        "Two flaws of the paper's rules:",
        f"  separate computation rejects {found.thrown_away_percent:.0f} % of equally good manoeuvres: a new "
        "cost is as likely above the median of the earlier ones as below.",
        f"  a parameter near zero keeps Eq. (12) from falling: with Z_q = 0 and {NOISE_PERCENT:g} % noise, "
        f"{found.near_zero_never_percent:.0f} % of {found.near_zero_campaigns} campaigns never end; the rule "
        f"information ends them after {_count(found.near_zero_information)} (median).",
        "",
    ]


def readings(results: Iterable[ReadingResult]) -> list[str]:
    """Return how other readings of the paper fare."""
    lines = [
        "Other readings of the rules: median needed, never, share of campaigns that need exactly what the "
        "paper's did",
    ]
    lines += [
        f"  {r.reading:<26}{r.rule:<12}{r.noise_percent:>4g} %  median {_count(r.median):>5}  never "
        f"{r.never_percent:3.0f} %  as the paper {r.as_paper_percent:3.0f} %"
        for r in results
    ]
    return [*lines, ""]


def savings(found: Sequence[Saving], campaigns: int) -> list[str]:
    """Return manoeuvres needed with and without the advice."""
    lines = [
        f"Manoeuvres until the response is known to {PLAN.tolerance_percent:g} % of its peak, the named "
        f"derivatives accordingly (rule information), {campaigns} campaigns each,",
        "repeating the standard 3-2-1-1 in alternating directions, and flying what was advised:",
    ]
    for one in found:
        limits = (
            "angle of attack as in the standard input" if one.same_excursion else "within the usual limits"
        )
        lines.append(
            f"  {one.aircraft}, noise {one.noise_percent:g} %, {limits}: {np.mean(one.standard):.1f} and "
            f"{np.mean(one.advised):.1f} on average (median {np.median(one.standard):.0f} and "
            f"{np.median(one.advised):.0f}): {one.percent:.0f} % fewer."
        )
    return lines


def detections(found: Sequence[Detection], campaigns: int) -> list[str]:
    """Return changes noticed, and false alarms."""
    lines = [f"Something changed, {campaigns} campaigns each:"]
    for one in found:
        if one.lost is None:
            lines.append(
                f"  noise {one.noise_percent:g} %, nothing changed: suspected in "
                f"{one.suspected_percent:.1f} %, confirmed in {one.confirmed_percent:.1f} %."
            )
        else:
            lines.append(
                f"  noise {one.noise_percent:g} %, {one.lost} loses {100 * LOSS:.0f} % after {BEFORE} "
                f"manoeuvres: suspected at once in {one.suspected_percent:.1f} %, confirmed and named "
                f"after two in {one.confirmed_percent:.1f} % ({one.sigma:.0f} sigma)."
            )
    return lines


def early_stops(found: Sequence[Stops], campaigns: int) -> list[str]:
    """Return false stops of the rule ``information``, and manoeuvres needed beside those of the paper's
    rules."""
    lines = [
        "Stops of the rule information. False: the predicted response is wrong by more than the",
        f"tolerance. Needed by {campaigns} campaigns of seven manoeuvres: median (share without stop).",
        f"{'case':<26}{'noise':>6}{'tolerance':>10}{'false':>8}{'error, 95 %':>13}"
        f"{'information':>14}{'continuous':>14}{'separate':>14}",
    ]
    for one in found:
        case, error = one.case, one.error_quantile(0.95)
        needed = "".join(
            f"{f'{_count(one.median_needed(rule))} ({one.never_percent(rule):.0f} %)':>14}"
            for rule in ("information", "continuous", "separate")
        )
        false, size = ("-", "-") if error is None else (f"{one.false_percent:.1f} %", f"{error:.2f} %")
        asked = f"{case.noise_percent:>4g} %{case.tolerance_percent:>8g} %"
        lines.append(f"{case.name:<26}{asked}{false:>8}{size:>13}{needed}")
    return lines


def _count(number: int | None) -> str:
    return "never" if number is None else str(number)
