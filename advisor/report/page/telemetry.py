"""Quality of the telemetry: the verdict of ``advisor doctor`` on each log."""

from collections.abc import Iterator

from advisor.report.page.blocks import Block, Paragraph, Section, Table, listing
from advisor.report.page.content import Content, Document

_HEAD = ("message", "rate [Hz]", "lowest [Hz]", "renewed [Hz]", "jitter [ms]", "largest gap [s]")


def telemetry(content: Content) -> Section:
    """Return the verdict, limits with their remedies, and rates of the messages, log by log."""
    return Section("telemetry", "Telemetry", tuple(_blocks(content)))


def _blocks(content: Content) -> Iterator[Block]:
    for flight, (name, found) in enumerate(zip(content.names, content.doctor, strict=True)):
        yield Paragraph(f"{name}: {found['verdict']}.")
        yield from listing([f"{limit['text']}. Mend: {limit['fix']}." for limit in found["limits"]])
        yield from listing(list(found.get("notes", ())))
        if found["messages"]:
            rows = tuple(_row(message) for message in found["messages"])
            yield Table(f"messages-{flight}", "How the messages arrive.", _HEAD, rows, frozenset(range(1, 6)))


def _row(message: Document) -> tuple[str, ...]:
    digits = {"rate_hz": 1, "lowest_hz": 1, "renewed_hz": 1, "jitter_ms": 1, "largest_gap_s": 3}
    numbers = ("–" if message[k] is None else f"{message[k]:.{n}f}" for k, n in digits.items())
    return message["name"], *numbers
