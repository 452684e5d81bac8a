"""Drawing of the next input at the stick: pull above trim, push below trim, and the seconds of each step."""

from collections.abc import Sequence
from math import degrees
from textwrap import fill

from advisor.decision.verdict import NextInput

_UNIT_COLUMNS = 6
"""Number of columns of the shortest step, enough for the text of its duration: ``0.4 s``."""
_LEAD = 3
"""Number of columns at trim, before the first step and after the last step."""
_PULL, _TRIM, _PUSH = 0, 1, 2
_LEVELS = (_PULL, _TRIM, _PUSH)
_SIDE_COLUMNS = 6
_LABEL = "next        "
SIDES = {"elevator": ("pull", "push"), "aileron": ("right", "left"), "rudder": ("right", "left")}
"""Names of the two directions of each control, by the control's name. The first direction is drawn above
trim, the second below.
"""


def drawn(advised: NextInput, width: int, *, large: bool) -> str:
    """Return the advice in words and the drawing of the advised input."""
    words = f"{_LABEL}{advised.advice.removeprefix('next: ')}"
    flown = advised.input
    if flown is None:
        return words
    words = f"{words}, ±{degrees(flown.amplitude_rad):.1f} deg of {flown.control}"
    words = fill(words, width, subsequent_indent=" " * len(_LABEL), break_on_hyphens=False)
    sides = SIDES[flown.control]
    if not large:
        first = sides[0] if flown.nose_up_first else sides[1]
        return f"{words}\n{'':<{len(_LABEL)}}{stick_line(flown.steps)}  {first} first"
    indent = " " * len(_LABEL)
    picture = stick_drawing(flown.steps, width - len(_LABEL), sides)
    return "\n".join([words, *(f"{indent}{line}" for line in picture.split("\n") if picture)])


def stick_drawing(
    steps: Sequence[tuple[bool, float]], width: int, sides: tuple[str, str] = ("pull", "push")
) -> str:
    """Draw the steps as a line above and below trim, with the duration of each step below.

    Parameters
    ----------
    steps
        Steps in order. Each has its direction (true for nose up, stick back, or right) and its duration, s.
    width
        Number of columns. The drawing is empty if it has no room.
    """
    shortest = min(duration for _, duration in steps)
    lengths = [round(_UNIT_COLUMNS * duration / shortest) for _, duration in steps]
    if _SIDE_COLUMNS + 2 * _LEAD + sum(lengths) > width:
        return ""
    levels = [_TRIM, *(_PULL if nose_up else _PUSH for nose_up, _ in steps), _TRIM]
    columns = [_LEAD, *lengths, _LEAD]
    rows = _line(levels, columns)
    seconds = " " * _LEAD + "".join(
        f"{duration:.1f} s".center(length) for (_, duration), length in zip(steps, lengths, strict=True)
    )
    names = (sides[0], "", sides[1])
    drawn = [f"{names[level]:<{_SIDE_COLUMNS}}{row}".rstrip() for level, row in enumerate(rows)]
    return "\n".join([*drawn, f"{'':<{_SIDE_COLUMNS}}{seconds}".rstrip()])


def stick_line(steps: Sequence[tuple[bool, float]]) -> str:
    """Draw the steps in one line, with two blocks for the shortest step: ``▁▁▁▁▁▁▔▔▔▔▁▁▔▔``."""
    shortest = min(duration for _, duration in steps)
    return "".join(
        ("▔" if nose_up else "▁") * max(round(2.0 * duration / shortest), 1) for nose_up, duration in steps
    )


def _line(levels: Sequence[int], columns: Sequence[int]) -> list[str]:
    """Return three rows with a line through the levels. The line stays on each level for its number of
    columns.
    """
    rows = [""] * len(_LEVELS)
    before = levels[0]
    for level, length in zip(levels, columns, strict=True):
        for row in _LEVELS:
            edge = _edge(row, before, level)
            rows[row] += edge + ("─" if row == level else " ") * (length - 1)
        before = level
    return rows


def _edge(row: int, before: int, level: int) -> str:
    """Return the character of a row where the line changes from one level to the next."""
    if before == level:
        return "─" if row == level else " "
    falls = before < level
    if row == before:
        return "┐" if falls else "┘"
    if row == level:
        return "└" if falls else "┌"
    return "│" if min(before, level) < row < max(before, level) else " "
