"""The flight in one picture: controls, motion, air speed and height, with the manoeuvres of both axes."""

from collections.abc import Iterator, Sequence
from itertools import pairwise

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure as Drawing
from matplotlib.ticker import FuncFormatter, MaxNLocator

from advisor.campaign.state import JudgedManeuver
from advisor.flight.signals.messages import FloatArray
from advisor.flight.signals.power_on import PowerOn
from advisor.flight.signals.record import Channel
from advisor.report.page.blocks import Block, Figure, Gallery, Section
from advisor.report.page.content import Content
from advisor.report.page.drawing import BLUE, ORANGE, picture
from advisor.words.quantities import CHANNELS
from advisor.words.vehicle_time import CLOCK, clock

_OF_PITCH, _OF_SIDE, _OF_BOTH = (
    ("elevator", "alpha", "q"),
    ("aileron", "rudder", "p", "r"),
    ("airspeed", "height"),
)
"""Channels by the axis that was tested, from above."""
_BINS = 500
_EXPLAINED = (
    "Elevator δe (trailing edge down positive), aileron δa, rudder δr, angle of attack α, rates p, q, r. Air "
    "speed V is as logged, height h above take-off. Shaded: manoeuvres with their numbers (R: roll and yaw), "
    "accepted ones plain, rejected ones hatched."
)


def flight_picture(content: Content) -> Section | None:
    """Return a picture of each power-on that holds a manoeuvre; None without one."""
    drawn = tuple(_blocks(content))
    return Section("flight", "The flight in one picture", drawn) if drawn else None


def _blocks(content: Content) -> Iterator[Block]:
    side = content.state.lateral
    both = (content.state.maneuvers, side.maneuvers if side is not None else ())
    for flight, power_on in content.power_ons:
        here = [[j for j in axis if j.maneuver.power_on == (flight, power_on.boot)] for axis in both]
        if not any(here):
            continue
        name = f"flight-{flight}-{power_on.boot}"
        broad = picture(name, 7.4, 5.4, _paint, power_on, here)
        narrow = picture(f"{name}-narrow", 3.8, 5.4, _paint, power_on, here)
        later = f", power-on {power_on.boot + 1}" if power_on.boot else ""
        where = f"{content.names[flight]}{later}"
        yield Gallery((Figure(broad, f"{where}. {_EXPLAINED}", narrow=narrow),))


def _paint(drawing: Drawing, power_on: PowerOn, judged: Sequence[Sequence[JudgedManeuver]]) -> None:
    pitch, side = judged
    channels = {name: channel for name, channel in power_on.channels.items() if len(channel) > 1}
    asked = (*(_OF_PITCH if pitch else ()), *(_OF_SIDE if side else ()), *_OF_BOTH)
    shown = [name for name in asked if name in channels]
    rows = drawing.subplots(len(shown), 1, sharex=True, squeeze=False)[:, 0]
    for axes, name in zip(rows, shown, strict=True):
        quantity = CHANNELS[name]
        channel = _as_judged(channels[name], pitch)
        t, y = thinned(channel, _BINS)
        axes.plot(t, y * quantity.factor, color=BLUE, linewidth=0.7)
        axes.set_ylabel(quantity.label)
        _mark(axes, [*(() if name in _OF_SIDE else pitch), *(() if name in _OF_PITCH else side)])
    drawing.align_ylabels(list(rows))
    rows[-1].set_xlabel(f"time ({CLOCK})")
    rows[-1].xaxis.set_major_locator(MaxNLocator(8, steps=[1, 1.5, 2, 3, 6, 10]))
    rows[-1].xaxis.set_major_formatter(FuncFormatter(lambda t, _: clock(t)))
    for one, axis, own in (*((one, "", _OF_PITCH) for one in pitch), *((one, "R", _OF_SIDE) for one in side)):
        top = rows[next((k for k, name in enumerate(shown) if name in own), 0)]
        middle = 0.5 * (one.maneuver.span.start_s + one.maneuver.span.end_s)
        sign = "✓" if one.verdict.accepted else "✗"
        top.annotate(
            f"{axis}{one.maneuver.number}{sign}", (middle, 1.0), xycoords=("data", "axes fraction"),
            ha="center", va="bottom", fontsize=8, annotation_clip=False,
        )  # fmt: skip


def _mark(axes: Axes, judged: Sequence[JudgedManeuver]) -> None:
    for one in judged:
        span, accepted = one.maneuver.span, one.verdict.accepted
        look = {"facecolor": "#d7e6d5", "edgecolor": "none"}
        if not accepted:
            look = {"facecolor": "#f3dfcf", "edgecolor": ORANGE, "hatch": "//"}
        axes.axvspan(span.start_s, span.end_s, linewidth=0.0, zorder=0, **look)  # type: ignore[arg-type]


def _as_judged(channel: Channel, judged: Sequence[JudgedManeuver]) -> Channel:
    """Return the elevator with the sign of the manoeuvres, where only they showed the sign."""
    flown = [j.maneuver.channels["elevator"] for j in judged if "elevator" in j.maneuver.channels]
    if channel.name != "elevator" or not flown:
        return channel
    alike = sum(
        float(np.dot(e.y - e.y.mean(), np.interp(e.t, channel.t, channel.y) - channel.y.mean()))
        for e in flown
    )
    if alike >= 0.0:
        return channel
    return Channel(channel.name, channel.t, -channel.y, channel.source, channel.provenance)


def thinned(channel: Channel, bins: int) -> tuple[FloatArray, FloatArray]:
    """Return times and values that draw an equal line: lowest and highest of each bin, and breaks in gaps.

    Parameters
    ----------
    bins
        Stretches of equal numbers of samples.
    """
    t, y = channel.t, channel.y
    if len(t) > 2 * bins:
        edges = np.linspace(0, len(t), bins + 1).astype(int)
        kept = sorted({i for a, b in pairwise(edges) for i in _extremes(y[a:b], int(a))})
        t, y = t[kept], y[kept]
    gaps = np.flatnonzero(np.diff(t) > max(2.0, 20.0 * float(np.median(np.diff(t))) if len(t) > 1 else 2.0))
    return np.insert(t, gaps + 1, t[gaps]), np.insert(y, gaps + 1, np.nan)


def _extremes(y: FloatArray, offset: int) -> tuple[int, int]:
    return offset + int(np.argmin(y)), offset + int(np.argmax(y))
