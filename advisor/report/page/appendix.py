"""The end of the page: quality of the telemetry, assumptions, and the origin of everything."""

from collections.abc import Iterator

from advisor.gap.result import Value
from advisor.oem.findings import line_of
from advisor.report.gap_sizes import with_error
from advisor.report.page.blocks import Block, Paragraph, Section, Verbatim, listing
from advisor.report.page.content import Content
from advisor.report.result_rows import channel_table, message_table
from advisor.report.table import Table


def telemetry(content: Content) -> Section:
    """Return the doctor's verdict, limits with their remedies, and rates of the messages, log by log."""
    return Section("telemetry", "Telemetry", tuple(_by_log(content)))


def _by_log(content: Content) -> Iterator[Block]:
    for flight, (name, found) in enumerate(zip(content.names, content.doctor, strict=True)):
        yield Paragraph(f"{name}: {found['verdict']}.")
        yield from listing([f"{limit['text']}. Fix: {limit['fix']}." for limit in found["limits"]])
        yield from listing(list(found.get("notes", ())))
        if found["messages"]:
            yield message_table(f"messages-{flight}", found["messages"])


def assumptions(content: Content) -> Section:
    """Return notes on reading and estimate, then the sources of the channels."""
    return Section("assumptions", "What was assumed", tuple(_assumed(content)))


def _assumed(content: Content) -> Iterator[Block]:
    analysis = content.analysis
    model = analysis["model"]
    estimated = [_with_lag_of_gap(note, content) for note in (model["notes"] if model else ())]
    said = [*analysis.get("notes", ()), *analysis["log"]["notes"], *estimated]
    yield from listing(said) or (Paragraph("Neither the logs nor the joint estimate leave a note."),)
    for flight, (name, heard) in enumerate(zip(content.names, content.state.flights, strict=True)):
        yield channel_table(f"channels-{flight}", f"Channels of {name}.", heard.channels)


def _with_lag_of_gap(note: str, content: Content) -> str:
    """Return a note of the estimate; the lag to enter is the gap's, where the gap is shown and names one.

    The estimate tells by how much to delay the command; the gap tells what lag the simulator lacks.
    """
    estimate = content.state.model
    lag = None if estimate is None else estimate.instrument("servo_lag_s")
    causes = content.gap["causes"] if content.gap is not None else ()
    sizes = [c["parameters"]["lag_s"] for c in causes if c["effect"] == "actuator_lag" and c["in_model"]]
    if lag is None or not sizes:
        return note
    lacks = with_error("lag_s", Value(sizes[0]["value"], sizes[0]["std"]))
    line = f"For the aircraft file: {line_of('servo_lag_s', lag.value)}"
    return note.replace(line, f"Put into the simulator what it lacks by the gap: {lacks}.")


def provenance(content: Content) -> Section:
    """Return the section on hashes, versions and the command that repeats the page."""
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
