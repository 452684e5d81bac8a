"""Section of the page about vibration: spectra of the inertial sensors, and clipped samples."""

from collections.abc import Iterator, Sequence

from matplotlib.figure import Figure as Drawing

from advisor.analysis.vibration import Spectrum, Vibration
from advisor.report.page.blocks import Block, Figure, Gallery, Paragraph, section
from advisor.report.page.content import Content
from advisor.report.page.drawing import BLACK, BLUE, ORANGE, picture
from advisor.report.table import Table

_AXES = (("x", BLUE, "-"), ("y", ORANGE, "--"), ("z", BLACK, ":"))


@section("vibration", "Vibration")
def vibration(content: Content) -> Iterator[Block]:
    """Yield spectra, their root mean squares, and clipped samples, log by log."""
    for flight, measured in enumerate(content.vibration):
        if measured is None or not (measured.spectra or measured.clipped):
            continue
        if measured.spectra:
            yield from _shown(flight, content.names[flight], measured.spectra)
        yield Paragraph(_clipped(measured))


def _shown(flight: int, name: str, spectra: Sequence[Spectrum]) -> Iterator[Block]:
    caption = (
        f"{name}. Power spectral density of x (solid), y (dashed) and z (dotted); median of the segments."
    )
    broad = picture(f"vibration-{flight}", 7.4, 1.9 * len(spectra) + 0.3, _paint, spectra)
    yield Gallery((Figure(broad, caption),))
    head = ("sensor", "x", "y", "z", "unit", "highest Hz shown")
    rows = tuple((s.name, *(f"{v:.3g}" for v in s.rms), s.unit, f"{s.highest_hz:.1f}") for s in spectra)
    title = f"Root mean square of {name} without the mean."
    yield Table(f"vibration-rms-{flight}", title, head, rows, frozenset({1, 2, 3, 5}))


def _clipped(measured: Vibration) -> str:
    if not measured.clipped:
        return "The log has no counts of clipped samples."
    return f"Clipped samples within the log: {', '.join(f'{n} {k}' for n, k in measured.clipped.items())}."


def _paint(drawing: Drawing, spectra: Sequence[Spectrum]) -> None:
    rows = drawing.subplots(len(spectra), 1, squeeze=False)[:, 0]
    for axes, psd in zip(rows, spectra, strict=True):
        for values, (name, colour, style) in zip(psd.density, _AXES, strict=True):
            axes.semilogy(psd.frequency_hz[1:], values[1:], color=colour, linestyle=style, label=name, lw=0.7)
        axes.set_title(psd.name, loc="left")
        axes.set_ylabel(f"({psd.unit})²/Hz")
    rows[0].legend(loc="upper right", ncols=3)
    rows[-1].set_xlabel("frequency, Hz")
