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
"""Largest number of labels on a logarithmic axis."""
_SERIES = ((1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 6.0, 8.0), (1.0, 2.0, 5.0), (1.0,))
"""Tick values within a decade, the densest series first."""
LAYER = "layer-"
"""Beginning of a layer's name, which the page shows only if the reader chooses it."""
_DPI = 150
"""Resolution of a raster picture, dots per inch: sharp on a screen of twice the usual density."""
Shown = TypeVarTuple("Shown")
_NO_METADATA = dict.fromkeys(("Creator", "Date", "Format", "Type"))


def picture(
    name: str, width_in: float, height_in: float, paint: Callable[[Drawing, *Shown], None], *shown: *Shown
) -> Callable[[], str]:
    """Return a function that draws a picture on demand, with the parameters of :func:`draw`."""
    return lambda: _drawn(name, lambda: draw(name, width_in, height_in, paint, *shown))


def _drawn(name: str, draw_it: Callable[[], str]) -> str:
    """Return a picture, or a sentence about the error that prevented it."""
    made = attempt(f"picture {name}", draw_it)
    return f'<p class="note">{escape(str(made.problem))}</p>' if isinstance(made, FailedPart) else made


def save(
    path: Path, width_in: float, height_in: float, paint: Callable[[Drawing, *Shown], None], *shown: *Shown
) -> None:
    """Draw a figure into a file, in the format of the file's ending: svg or png.

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
    name: str, width_in: float, height_in: float, paint: Callable[[Drawing, *Shown], None], *shown: *Shown
) -> str:
    """Return a figure as an SVG element.

    Parameters
    ----------
    name
        Name of the figure in its page, which makes its ids unique.
    """
    with mpl.rc_context(_STYLE), mpl.rc_context({"svg.hashsalt": name}):
        figure = Drawing(figsize=(width_in, height_in), layout="constrained")
        FigureCanvasSVG(figure)
        paint(figure, *shown)
        out = io.StringIO()
        figure.savefig(out, format="svg", metadata=_NO_METADATA)
    return _inline(out.getvalue(), width_in)


def log_ticks(low: float, high: float) -> list[float]:
    """Return ticks of a logarithmic axis: the densest series without crowding."""
    decades = range(floor(log10(low)), ceil(log10(high)) + 1)
    ticks: list[float] = []
    for series in _SERIES:
        ticks = [m * 10.0**k for k in decades for m in series if low <= m * 10.0**k <= high]
        if len(ticks) <= _MOST_TICKS:
            break
    return ticks


def _inline(svg: str, width_in: float) -> str:
    """Return the SVG element alone, with its width; layers become classes, unused ids are dropped."""
    element = svg[svg.index("<svg") :].strip()
    element = re.sub(r' (width|height)="[\d.]+pt"', "", element, count=2)
    element = re.sub(r"<!--.*?-->\s*", "", element, flags=re.DOTALL)
    element = re.sub(rf' id="({LAYER}\w+)"', r' class="\1"', element)
    used = set(re.findall(r'(?:url\(|href=")#([^")]+)', element))
    element = re.sub(r' id="([^"]+)"', lambda m: m.group(0) if m.group(1) in used else "", element)
    return element.replace("<svg ", f'<svg style="max-width:{width_in:g}in" ', 1)
