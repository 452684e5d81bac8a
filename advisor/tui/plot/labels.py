"""Tick labels placed on a grid of characters."""

from math import ceil, floor

from advisor.tui.plot.axis import Axis, LogAxis


def whole(axis: Axis) -> Axis:
    """Return the axis with ticks at whole numbers only."""
    return Axis(floor(axis.low), ceil(axis.high), max(1.0, round(axis.step)))


def down_the_side(axis: Axis | LogAxis, rows: int, gutter: int) -> list[str]:
    """Return the labels of the y axis, one string of ``gutter`` characters for each row, highest value
    first."""
    column = [" " * gutter] * rows
    for tick, label in zip(axis.ticks, axis.labels, strict=True):
        row = round((axis.high - tick) / (axis.high - axis.low) * (rows - 1))
        column[row] = label.rjust(gutter - 1) + " "
    return column


def along_the_foot(axis: Axis, name: str, gutter: int, width: int) -> str:
    """Return the labels of the x axis on one line with the axis's name at its end. Crowded labels are left
    out."""
    line = [" "] * width
    columns = width - gutter
    room_until = width - len(name) - 1
    free_from = gutter
    for tick, label in zip(axis.ticks, axis.labels, strict=True):
        centre = gutter + round((tick - axis.low) / (axis.high - axis.low) * (columns - 1))
        at = max(centre - len(label) // 2, gutter)
        if at >= free_from and at + len(label) <= room_until:
            line[at : at + len(label)] = label
            free_from = at + len(label) + 1
    line[room_until + 1 :] = name
    return "".join(line)[:width]
