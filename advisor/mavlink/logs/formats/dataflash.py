"""ArduPilot's own log (``.bin``)."""

import re

from advisor.mavlink.ardupilot.ardupilot_log import read_dataflash
from advisor.mavlink.logs.formats import LogFormat
from advisor.mavlink.records import dataflash, record_scan
from advisor.words.problems import Problem

_TEXT_LOG = re.compile(rb"^FMT, ?\d+, ?\d+, ?\w+, ?\w+, ?\w+", re.MULTILINE)
"""Pattern of a record definition as text. Ground stations write a few lines about the vehicle before the
first."""


def _begins_at(beginning: bytes) -> int | None:
    at = 0 if beginning.startswith(record_scan.HEADER) else dataflash.first_definition(beginning)
    return at if at >= 0 else None


def _text_log(name: str, beginning: bytes) -> Problem | None:
    if not _TEXT_LOG.search(beginning):
        return None
    text = f"{name} is a DataFlash log written as text."
    return Problem("text_log", text, "Give the .bin that it was made from.")


FORMAT = LogFormat(
    holds="DataFlash records",
    given="an ArduPilot .bin",
    ending=".bin",
    begins_at=_begins_at,
    read=lambda path, wanted, starts_at, scanner: read_dataflash(path, wanted),
    refusal=_text_log,
)
