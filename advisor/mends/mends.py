"""What every kind of record can say about itself."""

from collections.abc import Sequence
from typing import Protocol

GOOD_HZ = 50
"""Rate to ask for, 1/s: a short period of 2 Hz, as of an aircraft of some kg, then has 25 samples."""


class Mends(Protocol):
    """Names of values in one kind of record, and the settings that make them come faster.

    Messages are named as in MAVLink's definitions: every record is read as such messages.
    """

    def called(self, message: str) -> str:
        """Name under which users of this record know the values of a message."""

    def faster(self, message: str) -> str:
        """Return a clause without a full stop: how the values of a message come at ``GOOD_HZ``."""

    def present(self, messages: Sequence[str]) -> str:
        """Return a clause without a full stop: how the values of messages come at all."""


def sentence(clause: str, end: str = ".") -> str:
    """Return a clause with a capital at its beginning and an end."""
    return clause[:1].upper() + clause[1:] + end
