"""End of the page: asked fields, vibration, telemetry, assumptions, and origin of the data."""

from collections.abc import Iterator, Sequence

import numpy as np
from matplotlib.figure import Figure as Drawing
from matplotlib.ticker import FuncFormatter

from advisor.analysis.vibration import FieldSum, Spectrum, Vibration
from advisor.flight.signals.record import Channel
from advisor.gap.effects import EFFECTS
from advisor.oem.notes import FOR_THE_FILE
from advisor.report.page.blocks import (
    Block,
    Content,
    Document,
    Figure,
    Gallery,
    Paragraph,
    Section,
    Verbatim,
    listing,
    section,
)
from advisor.report.page.drawing import BLACK, BLUE, GREY, ORANGE, picture
from advisor.report.page.flight_picture import thinned
from advisor.report.table import Table, channel_table, message_table
from advisor.words.digits import CLOCK, clock


@section("telemetry", "Telemetry")
def telemetry(content: Content) -> Iterator[Block]:
    """Yield the doctor's verdict, limits with their remedies, and message rates, log by log."""
    for flight, (name, doctor) in enumerate(zip(content.names, content.doctor, strict=True)):
        yield Paragraph(f"{name}: {doctor['verdict']}.")
        yield from listing([f"{limit['text']}. Fix: {limit['fix']}." for limit in doctor["limits"]])
        yield from listing(list(doctor.get("notes", ())))
        if doctor["messages"]:
            yield message_table(f"messages-{flight}", doctor["messages"])


@section("assumptions", "What was assumed")
def assumptions(content: Content) -> Iterator[Block]:
    """Yield notes about reading and estimate, then the sources of the channels."""
    analysis = content.analysis
    model = analysis["model"]
    said = [*analysis.get("notes", ()), *analysis["log"]["notes"], *(model["notes"] if model else ())]
    said = [entered_once(note, content.gap) for note in said]
    yield from listing(said) or (Paragraph("Nothing beyond the aircraft file was assumed."),)
    for flight, (name, heard) in enumerate(zip(content.names, content.state.flights, strict=True)):
        yield channel_table(f"channels-{flight}", f"Channels of {name}.", heard.channels)


def entered_once(note: str, gap: Document | None) -> str:
    """Return a note without its line for the aircraft file, if the diagnosis names the number to enter."""
    said, line, entry = note.partition(FOR_THE_FILE)
    causes = gap["causes"] if line and gap is not None and gap["usable"] else ()
    stated = {EFFECTS[c["effect"]].stated for c in causes if c["in_model"] and c["effect"] in EFFECTS}
    if all(at is None or not entry.startswith(f"{at[0]}: {{{at[1]}:") for at in stated):
        return note
    return f"{said} The section on the gap names the number to enter in the aircraft file."


def provenance(content: Content) -> Section:
    """Return the section with hashes, versions and the command that repeats the page."""
    origin = content.origin
    return Section(
        "origin",
        "Where this comes from",
        (
            Table("files", "Input files.", ("file", "SHA-256"), tuple(origin.files.items())),
            Table("versions", "Versions.", ("program", "version"), tuple(origin.versions.items())),
            Paragraph("This command repeats the page:"),
            Verbatim(origin.command),
        ),
    )


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
    broad = picture(f"vibration-{flight}", 7.4, 1.9 * len(spectra) + 0.3, _paint_spectra, spectra)
    yield Gallery((Figure(broad, caption),))
    head = ("sensor", "x", "y", "z", "unit", "highest Hz shown")
    rows = tuple((s.name, *(f"{v:.3g}" for v in s.rms), s.unit, f"{s.highest_hz:.1f}") for s in spectra)
    title = f"Root mean square of {name} without the mean."
    yield Table(f"vibration-rms-{flight}", title, head, rows, frozenset({1, 2, 3, 5}))


def _clipped(measured: Vibration) -> str:
    if not measured.clipped:
        return "The log has no counts of clipped samples."
    return f"Clipped samples within the log: {', '.join(f'{n} {k}' for n, k in measured.clipped.items())}."


def _paint_spectra(drawing: Drawing, spectra: Sequence[Spectrum]) -> None:
    rows = drawing.subplots(len(spectra), 1, squeeze=False)[:, 0]
    for axes, psd in zip(rows, spectra, strict=True):
        for values, (name, colour, style) in zip(psd.density, _AXES, strict=True):
            axes.semilogy(psd.frequency_hz[1:], values[1:], color=colour, linestyle=style, label=name, lw=0.7)
        axes.set_title(psd.name, loc="left")
        axes.set_ylabel(f"({psd.unit})²/Hz")
    rows[0].legend(loc="upper right", ncols=3)
    rows[-1].set_xlabel("frequency, Hz")
