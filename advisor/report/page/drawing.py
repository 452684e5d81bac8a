"""Reproducible drawing: SVG without date, foreign font or script."""

import io
import re
from collections.abc import Callable
from html import escape
from math import ceil, floor, log10
from pathlib import Path
from typing import Any, TypeVarTuple

import matplotlib as mpl
from matplotlib.backends.backend_svg import FigureCanvasSVG
from matplotlib.figure import Figure as Drawing

from advisor.process.atomic_file import write_atomically
from advisor.process.parts import FailedPart, attempt

BLUE, ORANGE, GREY, BLACK = "#0b5394", "#b45f06", "#9a9a9a", "#222222"
"""Colours that also differ in lightness. Lines that differ in colour also differ in style."""
_STYLE: Any = {
    "svg.fonttype": "none",
    "font.family": "sans-serif",
    "font.sans-serif": ["DejaVu Sans"],
    "font.size": 8.0,
    "axes.titlesize": 8.5,
    "axes.linewidth": 0.6,
    "axes.edgecolor": "#666666",
    "axes.grid": True,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "grid.linewidth": 0.4,
    "grid.color": "#dddddd",
    "lines.linewidth": 1.1,
    "hatch.linewidth": 0.4,
    "xtick.major.width": 0.5,
    "ytick.major.width": 0.5,
    "legend.frameon": False,
    "legend.fontsize": 7.5,
    "path.simplify": True,
    "path.simplify_threshold": 0.2,
}
_MOST_TICKS = 8
"""Most labels of a logarithmic axis."""
_SERIES = ((1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 6.0, 8.0), (1.0, 2.0, 5.0), (1.0,))
"""Labels within a decade, the densest first."""
LAYER = "layer-"
"""Beginning of the name of a layer, which the page shows only when the reader chooses it."""
_DPI = 150
"""Dots per inch of a picture in dots: sharp on a screen of twice the usual density."""
Shown = TypeVarTuple("Shown")
_NO_METADATA = dict.fromkeys(("Creator", "Date", "Format", "Type"))


def picture(
    name: str,
    width_in: float,
    height_in: float,
    paint: Callable[[Drawing, *Shown], None],
    *shown: *Shown,
) -> Callable[[], str]:
    """Return a picture that is drawn on demand, with the parameters of :func:`draw`."""
    return lambda: _drawn(name, lambda: draw(name, width_in, height_in, paint, *shown))


def _drawn(name: str, draw_it: Callable[[], str]) -> str:
    """Return a picture, or in its place the sentence on the fault that ended it."""
    made = attempt(f"picture {name}", draw_it)
    return f'<p class="note">{escape(str(made.problem))}</p>' if isinstance(made, FailedPart) else made


def save(
    path: Path,
    width_in: float,
    height_in: float,
    paint: Callable[[Drawing, *Shown], None],
    *shown: *Shown,
) -> None:
    """Draw a figure into a file, whose ending names the format: svg or png.

    Raises
    ------
    OSError
        The file cannot be written.
    """
    form = path.suffix.lower().removeprefix(".")
    with mpl.rc_context(_STYLE), mpl.rc_context({"svg.hashsalt": path.name}):
        figure = Drawing(figsize=(width_in, height_in), layout="constrained")
        paint(figure, *shown)
        out = io.BytesIO()
        figure.savefig(out, format=form, dpi=_DPI, metadata=_NO_METADATA if form == "svg" else None)
    write_atomically(path, out.getvalue())


def draw(
    name: str,
    width_in: float,
    height_in: float,
    paint: Callable[[Drawing, *Shown], None],
    *shown: *Shown,
) -> str:
    """Draw a figure as an SVG element.

    Parameters
    ----------
    name
        Name of the figure in its page, which makes the ids within the picture unique.
    paint
        Draws axes and lines on the empty figure.
    shown
        Further arguments of ``paint``.
    """
    with mpl.rc_context(_STYLE), mpl.rc_context({"svg.hashsalt": name}):
        figure = Drawing(figsize=(width_in, height_in), layout="constrained")
        FigureCanvasSVG(figure)
        paint(figure, *shown)
        out = io.StringIO()
        figure.savefig(out, format="svg", metadata=_NO_METADATA)
    return _inline(out.getvalue(), width_in)


def log_ticks(low: float, high: float) -> list[float]:
    """Return ticks of a logarithmic axis: the densest series that does not crowd the axis."""
    decades = range(floor(log10(low)), ceil(log10(high)) + 1)
    ticks: list[float] = []
    for series in _SERIES:
        ticks = [m * 10.0**k for k in decades for m in series if low <= m * 10.0**k <= high]
        if len(ticks) <= _MOST_TICKS:
            break
    return ticks


def _inline(svg: str, width_in: float) -> str:
    """Return the SVG element alone, as wide as its place allows.

    Layers become classes, which several pictures of a page share. Of the ids only those referred to stay.
    """
    element = svg[svg.index("<svg") :].strip()
    element = re.sub(r' (width|height)="[\d.]+pt"', "", element, count=2)
    element = re.sub(r"<!--.*?-->\s*", "", element, flags=re.DOTALL)
    element = re.sub(rf' id="({LAYER}\w+)"', r' class="\1"', element)
    used = set(re.findall(r'(?:url\(|href=")#([^")]+)', element))
    element = re.sub(r' id="([^"]+)"', lambda m: m.group(0) if m.group(1) in used else "", element)
    return element.replace("<svg ", f'<svg style="max-width:{width_in:g}in" ', 1)
