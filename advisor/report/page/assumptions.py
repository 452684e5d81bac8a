"""Assumptions about the elevator, the instruments and the log, and the source of each channel."""

from collections.abc import Iterator

from advisor.report.page.blocks import Block, Paragraph, Section, Table, listing
from advisor.report.page.content import Content


def assumptions(content: Content) -> Section:
    """Return notes on reading and estimate, then the sources of the channels."""
    return Section("assumptions", "What was assumed", tuple(_blocks(content)))


def _blocks(content: Content) -> Iterator[Block]:
    analysis = content.analysis
    model = analysis["model"]
    said = [*analysis.get("notes", ()), *analysis["log"]["notes"], *(model["notes"] if model else ())]
    yield from listing(said) or (Paragraph("Neither the logs nor the joint estimate leave a note."),)
    logs = analysis.get("logs", [analysis["log"]])
    for flight, (name, log) in enumerate(zip(content.names, logs, strict=True)):
        rows = tuple(
            (
                channel,
                one["source"],
                one["provenance"],
                _digits(one["rate_hz"], 1),
                _digits(one["largest_gap_s"], 2),
            )
            for channel, one in log["channels"].items()
        )
        yield Table(
            f"channels-{flight}", f"Channels of {name}.",
            ("channel", "source", "provenance", "rate [Hz]", "largest gap [s]"), rows, frozenset({3, 4}),
        )  # fmt: skip


def _digits(value: float | None, digits: int) -> str:
    return "–" if value is None else f"{value:.{digits}f}"
