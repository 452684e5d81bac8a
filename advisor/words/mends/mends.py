"""Base class of the remedies for a kind of record, and the rate to ask for."""

from abc import abstractmethod
from collections.abc import Mapping, Sequence
from typing import ClassVar

GOOD_HZ = 50
"""Message rate that the remedies recommend, 1/s. A short period of 2 Hz, typical of an aircraft of some kg,
then has 25 samples."""


class Mends:
    """Names of values in one kind of record, and the settings that raise their rates.

    Messages are named as in MAVLink's definitions, because every record is read as such messages.
    """

    names: ClassVar[Mapping[str, str]] = {}
    """Name of each MAVLink message in this kind of log, by the message, if the names differ."""

    def called(self, message: str) -> str:
        """Return the name under which users of this record know the values of a message."""
        return self.names.get(message, message)

    @abstractmethod
    def faster(self, message: str) -> str:
        """Return a clause without a full stop on how to obtain a message's values at ``GOOD_HZ``."""

    def present(self, messages: Sequence[str]) -> str:
        """Return a clause without a full stop on how to obtain the values of messages at all: on a link, a
        request."""
        return f"ask for {' and '.join(map(self.called, messages))} (--request-rates)" if messages else ""


def sentence(clause: str, end: str = ".") -> str:
    """Return a clause as a sentence: with a capital letter and the given end."""
    return clause[:1].upper() + clause[1:] + end
