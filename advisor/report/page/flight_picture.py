"""Picture of the flight: channels, flight modes, manoeuvres of both axes, and selectable layers."""

from collections.abc import Iterator, Sequence
from itertools import pairwise
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure as Drawing
from matplotlib.layout_engine import ConstrainedLayoutEngine
from matplotlib.patches import Patch
from matplotlib.ticker import FuncFormatter, MaxNLocator
from matplotlib.transforms import Bbox

from advisor.campaign.state import JudgedManeuver
from advisor.flight.signals.record import Channel
from advisor.flight.signals.track import PowerOn
from advisor.flight.vehicle.modes import stays
from advisor.process.arrays import FloatArray
from advisor.report.page.blocks import Block, Content, Figure, Gallery, section
from advisor.report.page.drawing import BLACK, BLUE, LAYER, ORANGE, picture
from advisor.report.page.estimates import ANCHORS
from advisor.words.quantities import CHANNELS, CLOCK, clock

_OF_PITCH, _OF_SIDE, _OF_BOTH = (
    ("elevator", "alpha", "q"),
    ("aileron", "rudder", "p", "r"),
    ("airspeed", "height"),
)
"""Channels of the picture for each tested axis, from the top."""
_BINS, _LAYER_BINS = 500, 120
"""Number of bins in which a channel is drawn, as a row and as a layer."""
_BAND = 0.3
"""Height of the row of flight modes, relative to the height of a channel."""
_MODES = ("#dbe5ef", "#f1e3c8", "#eadcea", "#e4e4e4", "#f5dad4", "#d5ebe9")
"""Colours of the flight modes in their order of appearance."""
_LETTER_IN, _SCALE_IN, _OUTSIDE_IN = 0.062, 0.5, 1.0
"""Width of a letter in a mode's name, of a layer's scale, and of the margins, inches."""
_EXPLAINED = (
    "Elevator δe (trailing edge down positive), aileron δa, rudder δr, angle of attack α, rates p, q, r. Air "
    "speed V is as logged, height h above take-off. Shaded: manoeuvres with their numbers (R: roll and yaw), "
    "accepted ones plain, rejected ones hatched. Below: flight modes. A channel laid over the picture has "
    "the scale on the right."
)


@section("flight", "The flight in one picture")
def flight_picture(content: Content) -> Iterator[Block]:
    """Yield a picture of each power-on with a manoeuvre."""
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
        layers = tuple(name for name in CHANNELS if name in _heard(power_on))
        yield Gallery((Figure(broad, f"{where}. {_EXPLAINED}", narrow=narrow, layers=layers),))


def _heard(power_on: PowerOn) -> dict[str, Channel]:
    return {name: channel for name, channel in power_on.channels.items() if len(channel) > 1}


def _paint(drawing: Drawing, power_on: PowerOn, judged: Sequence[Sequence[JudgedManeuver]]) -> None:
    pitch, side = judged
    channels = _heard(power_on)
    if "elevator" in channels:
        channels["elevator"] = _as_judged(channels["elevator"], pitch)
    asked = (*(_OF_PITCH if pitch else ()), *(_OF_SIDE if side else ()), *_OF_BOTH)
    shown = [name for name in asked if name in channels]
    begin_s = min(float(channels[name].t[0]) for name in shown)
    end_s = max(float(channels[name].t[-1]) for name in shown)
    modes = list(stays(power_on.modes, begin_s, end_s))
    heights = [*(1.0 for _ in shown), *(_BAND for _ in modes[:1])]
    rows = drawing.subplots(len(heights), 1, sharex=True, squeeze=False, height_ratios=heights)[:, 0]
    for axes, name in zip(rows, shown, strict=False):
        _curve(axes, channels[name], _BINS, color=BLUE, linewidth=0.7)
        _mark(axes, [*(() if name in _OF_SIDE else pitch), *(() if name in _OF_PITCH else side)])
    if modes:
        _paint_modes(rows[-1], modes, drawing.get_figwidth() - _OUTSIDE_IN)
    drawing.align_ylabels(list(rows))
    rows[-1].set_xlabel(f"time ({CLOCK})")
    rows[-1].set_xlim(begin_s, end_s)
    rows[-1].xaxis.set_major_locator(MaxNLocator(8, steps=[1, 1.5, 2, 3, 6, 10]))
    rows[-1].xaxis.set_major_formatter(FuncFormatter(lambda t, _: clock(t).removesuffix(".0")))
    _number(list(rows), shown, judged)
    _lay_out(drawing)
    box = Bbox.union([axes.get_position() for axes in rows[: len(shown)]])
    for name in CHANNELS:
        if name in channels:
            _paint_layer(drawing.add_axes(box.bounds, sharex=rows[0]), channels[name])


def _lay_out(drawing: Drawing) -> None:
    """Lay out all rows, with room for a layer's scale on the right."""
    engine = drawing.get_layout_engine()
    if isinstance(engine, ConstrainedLayoutEngine):
        engine.set(rect=(0.0, 0.0, 1.0 - _SCALE_IN / drawing.get_figwidth(), 1.0))
    drawing.draw_without_rendering()
    drawing.set_layout_engine("none")


def _curve(axes: Axes, channel: Channel, bins: int, **look: Any) -> None:
    quantity = CHANNELS[channel.name]
    t, y = thinned(channel, bins)
    axes.plot(t, y * quantity.factor, **look)
    axes.set_ylabel(quantity.label)


def _number(rows: Sequence[Axes], shown: Sequence[str], judged: Sequence[Sequence[JudgedManeuver]]) -> None:
    """Write the number of each manoeuvre above its axis' first row, as a link to its table row."""
    for axis, own, flown in (("", _OF_PITCH, judged[0]), ("R", _OF_SIDE, judged[1])):
        top = rows[next((k for k, name in enumerate(shown) if name in own), 0)]
        for judgement in flown:
            middle = 0.5 * (judgement.maneuver.span.start_s + judgement.maneuver.span.end_s)
            sign = "✓" if judgement.verdict.accepted else "✗"
            top.annotate(
                f"{axis}{judgement.maneuver.number}{sign}", (middle, 1.0), xycoords=("data", "axes fraction"),
                ha="center", va="bottom", fontsize=8, annotation_clip=False,
                url=f"#{ANCHORS[axis]}-{judgement.maneuver.number}",
            )  # fmt: skip


def _paint_modes(axes: Axes, modes: Sequence[tuple[float, float, str]], width_in: float) -> None:
    """Draw a band for each stay in a mode. A legend names the modes whose names have no room."""
    colours = {name: _MODES[k % len(_MODES)] for k, name in enumerate(dict.fromkeys(m[2] for m in modes))}
    whole_s = modes[-1][1] - modes[0][0]
    named = set()
    for begin_s, end_s, name in modes:
        axes.axvspan(begin_s, end_s, facecolor=colours[name], edgecolor=BLACK, linewidth=0.3)
        if _LETTER_IN * len(name) < (end_s - begin_s) / whole_s * width_in:
            axes.text(0.5 * (begin_s + end_s), 0.45, name, ha="center", va="center", fontsize=7)
            named.add(name)
    axes.set(ylim=(0.0, 1.0), yticks=[])
    axes.grid(visible=False)
    axes.set_ylabel("mode", rotation="horizontal", ha="right", va="center")
    rest = [Patch(facecolor=colours[name], label=name) for name in colours if name not in named]
    if rest:
        axes.figure.legend(handles=rest, loc="outside lower center", ncols=4)


def _paint_layer(axes: Axes, channel: Channel) -> None:
    """Draw a channel over the whole picture, with its scale on the right."""
    axes.set_gid(f"{LAYER}{channel.name}")
    axes.patch.set_visible(False)
    axes.grid(visible=False)
    axes.spines[["left", "bottom"]].set_visible(False)
    axes.xaxis.set_visible(False)
    axes.yaxis.tick_right()
    axes.yaxis.set_label_position("right")
    axes.tick_params(axis="y", colors=ORANGE)
    _curve(axes, channel, _LAYER_BINS, color=ORANGE, linewidth=0.9, linestyle=(0, (4, 1)))
    axes.yaxis.label.set_color(ORANGE)


def _mark(axes: Axes, judged: Sequence[JudgedManeuver]) -> None:
    for judgement in judged:
        span, accepted = judgement.maneuver.span, judgement.verdict.accepted
        look = {"facecolor": "#d7e6d5", "edgecolor": "none"}
        if not accepted:
            look = {"facecolor": "#f3dfcf", "edgecolor": ORANGE, "hatch": "//"}
        axes.axvspan(span.start_s, span.end_s, linewidth=0.0, zorder=0, **look)  # type: ignore[arg-type]


def _as_judged(channel: Channel, judged: Sequence[JudgedManeuver]) -> Channel:
    """Return the elevator with the sign that the manoeuvres use, if no calibration states the sign."""
    flown = [j.maneuver.channels["elevator"] for j in judged if "elevator" in j.maneuver.channels]
    alike = sum(
        float(np.dot(e.y - e.y.mean(), np.interp(e.t, channel.t, channel.y) - channel.y.mean()))
        for e in flown
    )
    if alike >= 0.0:
        return channel
    return Channel(channel.name, channel.t, -channel.y, channel.source, channel.provenance)


def thinned(channel: Channel, bins: int) -> tuple[FloatArray, FloatArray]:
    """Return times and values of a shorter curve through the extremes of each bin. The curve has breaks in
    gaps.

    Parameters
    ----------
    bins
        Number of bins. All bins have equal numbers of samples.
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
