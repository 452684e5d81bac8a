"""Section of the page with the fields that the reader asked for, laid over each other."""

from collections.abc import Iterator, Sequence

import numpy as np
from matplotlib.figure import Figure as Drawing
from matplotlib.ticker import FuncFormatter

from advisor.analysis.field_sums import FieldSum
from advisor.flight.signals.record import Channel
from advisor.report.page.blocks import Block, Figure, Gallery, section
from advisor.report.page.content import Content
from advisor.report.page.drawing import BLACK, BLUE, GREY, ORANGE, picture
from advisor.report.page.flight_picture import thinned
from advisor.words.vehicle_time import CLOCK, clock

_LOOKS = ((BLUE, "-"), (ORANGE, "--"), (BLACK, ":"), (GREY, "-."))
_BINS = 500
"""Number of bins in which a field is drawn."""
_SCALE_IN = 0.6
"""Width of the scale of each field after the first, inches."""
_WIDTH_IN = 7.4


@section("fields", "Fields of the log")
def fields(content: Content) -> Iterator[Block]:
    """Yield one chart of each log, in which each field has its own scale."""
    for flight, (name, asked) in enumerate(zip(content.names, content.fields, strict=False)):
        if asked:
            drawn = picture(f"fields-{flight}", _WIDTH_IN, 3.2, _paint, asked)
            caption = f"{name}: {', '.join(field.name for field in asked)}, in the log's units."
            yield Gallery((Figure(drawn, caption),))


def _paint(drawing: Drawing, asked: Sequence[FieldSum]) -> None:
    first = drawing.subplots()
    first.set_xlabel(f"time ({CLOCK})")
    first.xaxis.set_major_formatter(FuncFormatter(lambda t, _: clock(t)))
    for k, field in enumerate(asked):
        axes = first if k == 0 else first.twinx()
        colour, style = _LOOKS[k % len(_LOOKS)]
        whole = np.isfinite(field.y)
        t, y = thinned(Channel(field.name, field.t[whole], field.y[whole]), _BINS)
        axes.plot(t, y, color=colour, linestyle=style, linewidth=0.8)
        axes.set_ylabel(field.name, color=colour)
        axes.tick_params(axis="y", colors=colour)
        if k:
            axes.grid(visible=False)
            axes.spines["right"].set_visible(True)
            axes.spines["right"].set_position(("outward", 72.0 * _SCALE_IN * (k - 1)))
