"""Is the forecast right: how many more manoeuvres a campaign needed, against what was said each time."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise
from math import inf


@dataclass(frozen=True, slots=True)
class Forecast:
    """Forecast after a manoeuvre: further manoeuvres until the stop."""

    flown: int
    """Number of manoeuvres flown when the forecast was said."""
    median: int | None
    p90: int | None
    """Number that nine of ten campaigns do not exceed; None: no end in sight."""


@dataclass(frozen=True, slots=True)
class Score:
    """Forecasts of campaigns against what came."""

    checked: int
    """Number of forecasts whose truth is known."""
    kept: int
    """Number among them in which the stop came within the stated 90 %, and not where no end was in sight."""
    followed: int
    """Number of pairs of forecasts, one after another."""
    jumped: int
    """Number among them in which the median moved by more than the first one's own band."""


def score(campaigns: Sequence[tuple[Sequence[Forecast], int | None, int]]) -> Score:
    """Score campaigns.

    Parameters
    ----------
    campaigns
        Forecasts of each campaign, the number of manoeuvres at its stop (None without one), and the number
        flown in all.
    """
    kept = [held for one in campaigns for held in _kept(*one)]
    jumps = [_jumped(a, b) for forecasts, *_ in campaigns for a, b in pairwise(forecasts) if _told(a, b)]
    return Score(len(kept), sum(kept), len(jumps), sum(jumps))


def _kept(forecasts: Sequence[Forecast], stop: int | None, flown: int) -> Iterator[bool]:
    """Yield whether each forecast held.

    A stop denies that no end was in sight. Without a stop only a forecast that has run out is known to be
    wrong.
    """
    for one in forecasts:
        most = inf if one.p90 is None else one.p90
        if stop is not None:
            yield one.median is not None and stop - one.flown <= most
        elif flown - one.flown >= most:
            yield False


def _told(one: Forecast, following: Forecast) -> bool:
    return one.median is not None and one.p90 is not None and following.median is not None


def _jumped(one: Forecast, following: Forecast) -> bool:
    assert one.median is not None
    assert one.p90 is not None
    assert following.median is not None
    moved = following.flown + following.median - (one.flown + one.median)
    return abs(moved) > max(one.p90 - one.median, 1)
