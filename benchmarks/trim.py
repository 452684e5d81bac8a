"""Reduction of a log to the messages that the advisor reads.

``python -m benchmarks.trim IN OUT [--drop NAME,NAME]`` copies whole records, byte for byte and in
their order. Only the messages left out are missing (and their sequence numbers).
"""

import argparse
from collections.abc import Iterable
from pathlib import Path

import numpy as np

from advisor.mavlink.wire.definitions import DEFINITIONS
from advisor.mavlink.wire.frames import FrameScanner
from advisor.mavlink.wire.scan import SIGNED, STAMP_BYTES, V1


def trim(log: bytes, drop: Iterable[str] = ()) -> bytes:
    """Return the log with the records of known messages, without those in ``drop``."""
    dropped = set(drop)
    if unknown := dropped - DEFINITIONS.keys():
        raise KeyError(*sorted(unknown))
    scanner = FrameScanner(DEFINITIONS.keys() - dropped)
    columns = scanner.feed(log) + scanner.close()
    starts = np.sort(np.concatenate([column.order for column in columns])).tolist() if columns else []
    return b"".join(log[start - STAMP_BYTES : start + _frame_length(log, start)] for start in starts)


def _frame_length(log: bytes, start: int) -> int:
    if log[start] == V1:
        return 8 + log[start + 1]
    return 12 + log[start + 1] + (13 if log[start + 2] & SIGNED else 0)


def main() -> None:
    """Run the command."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.trim", description=__doc__)
    parser.add_argument("source", type=Path, metavar="IN")
    parser.add_argument("target", type=Path, metavar="OUT")
    parser.add_argument("--drop", default="", metavar="NAME,NAME", help="messages to leave out as well")
    arguments = parser.parse_args()
    drop = set(filter(None, arguments.drop.split(",")))
    if unknown := drop - DEFINITIONS.keys():
        parser.error(
            f"--drop: {', '.join(sorted(unknown))} is left out anyway, or no message; take it off the list"
        )
    trimmed = trim(arguments.source.read_bytes(), drop)
    arguments.target.write_bytes(trimmed)


if __name__ == "__main__":
    main()
