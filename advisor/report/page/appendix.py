"""End of the page: quality of the telemetry, assumptions, and origin of the data."""

from collections.abc import Iterator

from advisor.gap.effects import EFFECTS
from advisor.oem.notes import FOR_THE_FILE
from advisor.report.page.blocks import Block, Paragraph, Section, Verbatim, listing, section
from advisor.report.page.content import Content, Document
from advisor.report.result_rows import channel_table, message_table
from advisor.report.table import Table


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
