"""Vehicle time for people, in one form on every screen, in every text and in every report.

Documents and files for programs give the vehicle's time in seconds since power-on.
"""

from math import isfinite

CLOCK = "minutes:seconds since power-on"
"""Unit and origin of the times that `clock` writes, for headings and help."""


def clock(seconds: float) -> str:
    """Write a time since power-on: ``3:07.5``; ``–`` where the time is not known.

    Minutes continue beyond 60, so that 60 times the minutes plus the seconds is the time in a document.

    Parameters
    ----------
    seconds
        Vehicle time, s since power-on; NaN before the vehicle's clock is heard.
    """
    if not isfinite(seconds):
        return "–"
    minutes, tenths = divmod(round(abs(seconds) * 10.0), 600)
    return f"{'-' if seconds < 0.0 and (minutes or tenths) else ''}{minutes}:{tenths / 10.0:04.1f}"


def stretch(start_s: float, end_s: float) -> str:
    """Write a stretch of vehicle time, s since power-on: ``3:07.5 to 3:19.0``."""
    return f"{clock(start_s)} to {clock(end_s)}"
