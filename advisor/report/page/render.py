"""The page of a flight from its headline to its appendix, as HTML or Markdown."""

from collections.abc import Iterator, Sequence
from functools import partial
from importlib.resources import files
from typing import Literal

import numpy as np
from jinja2 import Environment, FunctionLoader, StrictUndefined
from markupsafe import Markup
from matplotlib.figure import Figure as Drawing
from matplotlib.ticker import FuncFormatter

from advisor.analysis.vibration import FieldSum, Spectrum, Vibration
from advisor.flight.signals.record import Channel
from advisor.gap.effects import EFFECTS
from advisor.oem.notes import FOR_THE_FILE
from advisor.process.parts import FailedPart, attempt
from advisor.report.facts.estimates import untold
from advisor.report.page.blocks import (
    Block,
    Content,
    Document,
    Figure,
    Gallery,
    Paragraph,
    Part,
    Section,
    Verbatim,
    listing,
    section,
)
from advisor.report.page.drawing import BLACK, BLUE, GREY, LAYER, ORANGE, picture
from advisor.report.page.estimates import criterion, estimates, maneuvers
from advisor.report.page.fits import fits
from advisor.report.page.flight_picture import flight_picture, thinned
from advisor.report.page.flying_qualities import decided, flying, lateral
from advisor.report.page.gap import gap, glance
from advisor.report.text import Table, channel_table, joint_table, message_table
from advisor.words.quantities import CHANNELS, CLOCK, clock


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


@section("verdict", "Verdict")
def headline(content: Content) -> Iterator[Block]:
    """Yield flights, decision and evidence, estimates, and gap."""
    verdict, maneuvers = content.analysis["flight_test"], content.analysis["maneuvers"]
    accepted = [m["number"] for m in maneuvers if m["verdict"] == "accepted"]
    yield _flown(content)
    state = content.state
    sideways = state.tested_sideways is not None
    yield from decided(state)
    side = state.lateral_alone
    if side is not None and (glance_at := joint_table(side, content.aircraft.model, "lateral-glance")):
        yield glance_at
    if sideways:
        yield Paragraph(verdict["sentence"])
    if maneuvers and not sideways:
        yield Paragraph(
            f"{len(accepted)} of {len(maneuvers)} manoeuvres are accepted. The rule {verdict['rule']} "
            f"decides: {_criterion(verdict['criterion_percent'], verdict['limit_percent'])}."
        )
    joint = joint_table(state, content.aircraft.model)
    if joint is not None and state.model is not None:
        yield joint
        yield from listing(untold(state.model))
    gap = content.gap
    if gap is not None and gap["usable"]:
        yield from glance(gap)


def _flown(content: Content) -> Table:
    mass = content.aircraft.reference.mass_kg
    weighs = "mass not given" if mass is None else f"{mass:g} kg"
    rows = []
    for flight, name in enumerate(content.names):
        heard = next((log for log in content.state.flights if log.flight == flight), None)
        vehicle = heard.vehicle if heard is not None else None
        minutes, seconds = divmod(round(heard.duration_s), 60) if heard is not None else (0, 0)
        rows.append(
            (
                name,
                content.begun[flight] if flight < len(content.begun) else "–",
                f"{minutes} min {seconds} s",
                str(vehicle) if vehicle is not None else "–",
                (vehicle.firmware if vehicle is not None else None) or "–",
            )
        )
    head = ("log", "began", "duration", "vehicle", "firmware")
    return Table("flown", f"{content.aircraft.name}, {weighs}.", head, tuple(rows))


def _criterion(value: float | None, limit: float) -> str:
    if value is None:
        return f"its criterion has no value yet (limit {limit:g} %)"
    return f"its criterion is {value:.1f} % (limit {limit:g} %)"


PageFormat = Literal["html", "md"]
_PARTS: tuple[Part, ...] = (
    headline, flight_picture, gap, estimates, criterion, flying, maneuvers, fits, lateral, fields,
    vibration, telemetry, assumptions, provenance,
)  # fmt: skip

_OF_PITCH = frozenset({estimates, criterion, flying, maneuvers, fits})
"""Parts of the page that a flight without an elevator test input lacks."""


def sections(content: Content) -> list[Section]:
    """Return all sections in the order of the page."""
    state = content.state
    is_tested = bool(state.maneuvers) and state.tested_sideways is None
    made = (_made(part, content) for part in _PARTS if is_tested or part not in _OF_PITCH)
    return [section for section in made if section is not None]


def _made(part: Part, content: Content) -> Section | None:
    """Return a section, or a sentence about the error that prevented it."""
    name = part.__name__
    made = attempt(f"page, {name.replace('_', ' ')}", partial(part, content))
    if not isinstance(made, FailedPart):
        return made
    return Section(name, name.replace("_", " ").capitalize(), (Paragraph(str(made.problem), "note"),))


def page(content: Content, form: PageFormat) -> str:
    """Return the whole page as text."""
    environment = Environment(
        autoescape=form == "html", trim_blocks=True, lstrip_blocks=True, keep_trailing_newline=True,
        undefined=StrictUndefined, loader=FunctionLoader(_read),
    )  # fmt: skip
    environment.filters |= {"kind": _kind, "drawn": Markup, "cell": _cell}
    return environment.get_template(f"page.{form}.j2").render(
        title=f"{content.aircraft.name}: {', '.join(content.names)}",
        sections=sections(content),
        channels=CHANNELS,
        layer=LAYER,
        css=Markup(_read("page.css")) if form == "html" else "",
    )


def _read(name: str) -> str:
    return (files("advisor.report.page") / name).read_text(encoding="utf-8")


def _kind(block: Block) -> str:
    return type(block).__name__


def _cell(text: str) -> str:
    return text.replace("|", "\\|").replace("\n", " ")
