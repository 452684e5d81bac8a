"""Place of the gap: part of the manoeuvres, frequencies, manoeuvre."""

from collections.abc import Iterator
from itertools import zip_longest

from rich.text import Text

from advisor.gap.result import Gap
from advisor.report.gap_sizes import before_after, short

_BAR = 12
_EIGHTHS = "▏▎▍▌▋▊▉"
_AS_LOUD_AS_NOISE = 1.0
"""Least gap that fills a bar. A smaller gap must not look large."""
_LEFT = 38
"""Columns for the text left of the bars."""


def whereabouts(gap: Gap) -> Text:
    """Return phases next to frequencies, then every manoeuvre before and after, with bars in proportion."""
    lines = [*_beside(list(_phases(gap)), list(_bands(gap))), "", *_maneuvers(gap)]
    return Text("\n".join(lines), no_wrap=True, overflow="crop")


def _phases(gap: Gap) -> Iterator[str]:
    yield "gap by phase, before"
    largest = max(gap.by_phase.values(), default=0.0)
    for phase, value in gap.by_phase.items():
        yield f"{phase:14s}{short(value):>8s} {_gap_bar(value, largest)}"


def _bands(gap: Gap) -> Iterator[str]:
    yield "power of the error of q, before"
    for low, high, share in gap.by_band_hz:
        band = f"{low:g} to {high:g} Hz"
        yield f"{band:>11s}{100.0 * share:4.0f} % {_bar(share)}"


def _maneuvers(gap: Gap) -> Iterator[str]:
    yield "gap by manoeuvre, before → after"
    largest = max((before for _, before, _ in gap.by_maneuver), default=0.0)
    cells = [
        f"{number:3d} {_gap_bar(before, largest):{_BAR}s} {before_after(before, after)}"
        for number, before, after in gap.by_maneuver
    ]
    half = (len(cells) + 1) // 2
    yield from _beside(cells[:half], cells[half:])


def _beside(left: list[str], right: list[str]) -> Iterator[str]:
    for one, other in zip_longest(left, right, fillvalue=""):
        yield f"{one:{_LEFT}s}{other}".rstrip()


def _gap_bar(value: float, largest: float) -> str:
    return _bar(value / max(largest, _AS_LOUD_AS_NOISE))


def _bar(share: float) -> str:
    full, eighths = divmod(round(8 * _BAR * share), 8)
    return "█" * full + _EIGHTHS[:eighths][-1:]
