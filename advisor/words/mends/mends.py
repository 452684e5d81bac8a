"""Interface of the remedies for every kind of record."""

from collections.abc import Sequence
from typing import Protocol

GOOD_HZ = 50
"""Rate to ask for, 1/s. A short period of 2 Hz, typical of an aircraft of some kg, then has 25 samples."""


class Mends(Protocol):
    """Names of values in one kind of record, and the settings that raise their rates.

    Messages are named as in MAVLink's definitions, because every record is read as such messages.
    """

    def called(self, message: str) -> str:
        """Return the name under which users of this record know the values of a message."""

    def faster(self, message: str) -> str:
        """Return a clause without a full stop on how to obtain a message's values at ``GOOD_HZ``."""

    def present(self, messages: Sequence[str]) -> str:
        """Return a clause without a full stop on how to obtain the values of messages at all."""


def sentence(clause: str, end: str = ".") -> str:
    """Return a clause as a sentence: with a capital letter and the given end."""
    return clause[:1].upper() + clause[1:] + end
