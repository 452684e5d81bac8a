"""Assumptions about the elevator, the instruments and the log, and the source of each channel."""

from collections.abc import Iterator

from advisor.report.page.blocks import Block, Paragraph, Section, listing
from advisor.report.page.content import Content
from advisor.report.result_rows import channel_table


def assumptions(content: Content) -> Section:
    """Return notes on reading and estimate, then the sources of the channels."""
    return Section("assumptions", "What was assumed", tuple(_blocks(content)))


def _blocks(content: Content) -> Iterator[Block]:
    analysis = content.analysis
    model = analysis["model"]
    said = [*analysis.get("notes", ()), *analysis["log"]["notes"], *(model["notes"] if model else ())]
    yield from listing(said) or (Paragraph("Neither the logs nor the joint estimate leave a note."),)
    for flight, (name, heard) in enumerate(zip(content.names, content.state.flights, strict=True)):
        yield channel_table(f"channels-{flight}", f"Channels of {name}.", heard.channels)
