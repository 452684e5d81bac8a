"""Quality of the telemetry: the verdict of ``advisor doctor`` on each log."""

from collections.abc import Iterator

from advisor.report.page.blocks import Block, Paragraph, Section, listing
from advisor.report.page.content import Content
from advisor.report.result_rows import message_table


def telemetry(content: Content) -> Section:
    """Return the verdict, limits with their remedies, and rates of the messages, log by log."""
    return Section("telemetry", "Telemetry", tuple(_blocks(content)))


def _blocks(content: Content) -> Iterator[Block]:
    for flight, (name, found) in enumerate(zip(content.names, content.doctor, strict=True)):
        yield Paragraph(f"{name}: {found['verdict']}.")
        yield from listing([f"{limit['text']}. Fix: {limit['fix']}." for limit in found["limits"]])
        yield from listing(list(found.get("notes", ())))
        if found["messages"]:
            yield message_table(f"messages-{flight}", found["messages"])
