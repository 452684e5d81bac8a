"""The study in words: Table 1 with the paper's numbers, and the rank of the paper's campaign among the
simulated ones.
"""

from collections.abc import Iterable, Sequence
from textwrap import wrap

import numpy as np

from advisor.aircraft.aircraft import CampaignPlan
from advisor.aircraft.reference import PARAMETERS
from advisor.bundled.study.campaigns import NOISE_READINGS, NoiseReading, Scene
from advisor.bundled.study.table import Row
from advisor.words.quantities import symbol

COMMON = (5.0, 95.0)
"""Percentiles of the simulated campaigns between which a single campaign counts as ordinary."""


_COLUMNS = 80
"""Number of columns of the narrowest terminal for which the text is made."""
_LABEL, _CELL = 12, 8
"""Characters of a label and of a number in the table: 12 + 8 · 8 are 76."""

NAMED = CampaignPlan().parameters
"""Parameters with a tolerance of their own."""


def heading(campaigns: int, scene: Scene, reading: NoiseReading) -> list[str]:
    """Return lines on the campaigns flown."""
    degrees = np.degrees(scene.amplitude_rad)
    return [
        *wrapped(
            f"The paper's campaign, {campaigns} times: modified 3-2-1-1 and its reverse (seven manoeuvres, "
            f"{scene.unit_s:g} s steps, {degrees:.0f} deg), {scene.duration_s:g} s at {scene.rate_hz:g} Hz, "
            f'white noise on angle of attack and pitch rate; "noise 1 %" is 1 % {NOISE_READINGS[reading]}.'
        ),
        *wrapped(
            "The paper's rules are continuous (Eqs. 10 and 12) and separate (Eqs. 11 and 12); "
            "on real flights the rule information decides."
        ),
        "",
    ]


def table(rows: Sequence[Row]) -> list[str]:
    """Return three lines for each row: the median error, the range of the middle 80 %, the paper's error."""
    names = "".join(f"{symbol(name):>{_CELL}}" for name in PARAMETERS)
    lines = [
        *wrapped(
            "Nominal error in % at the stop: median, 10 % and 90 % of the campaigns, and the paper's. "
            "Needed: the median number of manoeuvres, and what nine campaigns in ten need at most."
        ),
        f"{'':<{_LABEL}}{names}",
    ]
    for row in rows:
        low, middle, high = np.quantile(row.error_percent, [0.1, 0.5, 0.9], axis=0)
        paper = "" if row.paper is None else f"; paper {count(row.paper.needed)}"
        lines.append(
            f"{row.rule}, noise {row.noise_percent:g} %: needed {count(row.needed_quantile(0.5))} (9 in 10: "
            f"{count(row.needed_quantile(0.9))}), never {row.never_percent:.0f} %{paper}"
        )
        lines += [_numbers("median", middle), _numbers("10 %", low), _numbers("90 %", high)]
        if row.paper is not None:
            lines.append(_numbers("paper", [row.paper.error_percent[name] for name in PARAMETERS]))
    return [*lines, ""]


def _numbers(label: str, values: Iterable[float]) -> str:
    """Return a line of the table: one number a parameter."""
    cells = (f"{value:.2f}" if value < 1000.0 else f"{value:.2g}" for value in values)
    return f"{f'  {label}':<{_LABEL}}" + "".join(f"{cell:>{_CELL}}" for cell in cells)


def where_the_paper_lies(rows: Sequence[Row]) -> list[str]:
    """Return a sentence for each row on the paper's single campaign within the distribution of the simulated
    campaigns.
    """
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
        lines += wrapped(
            f"  {row.rule}, {row.noise_percent:g} %: it {ended}, as {same:.0f} % of ours; {'; '.join(words)}."
        )
    return [*lines, ""]


def tolerances(rows: Sequence[Row]) -> list[str]:
    """Return lines on the errors of the rule `information`."""
    lines = []
    for row in rows:
        if row.outside_tolerance_percent is not None:
            outside = {name: row.outside_tolerance_percent[PARAMETERS.index(name)] for name in NAMED}
            worst = max(outside, key=lambda name: outside[name])
            lines += wrapped(
                f"information, {row.noise_percent:g} %: outside its tolerance at the stop "
                f"{np.mean(list(outside.values())):.1f} % of the named derivatives, at most "
                f"{outside[worst]:.1f} % ({worst})."
            )
    return [*lines, ""]


def wrapped(text: str) -> list[str]:
    """Wrap a sentence into lines of 80 columns. Lines after the first are indented, and a number keeps its %
    sign.
    """
    joined = text.lstrip().replace(" %", "\N{NO-BREAK SPACE}%")
    begins = " " * (len(text) - len(text.lstrip()))
    lines = wrap(joined, _COLUMNS, initial_indent=begins, subsequent_indent="    ")
    return [line.replace("\N{NO-BREAK SPACE}", " ") for line in lines]


def count(number: int | None) -> str:
    """Return a number of manoeuvres in words: ``never`` for None."""
    return "never" if number is None else str(number)
