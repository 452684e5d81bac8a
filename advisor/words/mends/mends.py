"""Base class of the remedies for a kind of record, and the rate to ask for."""

from abc import abstractmethod
from collections.abc import Mapping, Sequence
from typing import ClassVar

GOOD_HZ = 50
"""Message rate that the remedies recommend, 1/s. One period of a short-period mode of 2 Hz, typical of a
small UAV, then has 25 samples.
"""


class Mends:
    """Names of values in one kind of record, and the settings that raise their rates.

    A message has its MAVLink name, because the advisor reads every record as MAVLink messages.
    """

    names: ClassVar[Mapping[str, str]] = {}
    """Name in this kind of log of each MAVLink message, if that name differs from the message's."""

    def called(self, message: str) -> str:
        """Return the name of a message's values in this kind of record."""
        return self.names.get(message, message)

    @abstractmethod
    def faster(self, message: str) -> str:
        """Return the remedy for a slow message, as a clause without a full stop: how to obtain the message at
        ``GOOD_HZ``.
        """

    def present(self, messages: Sequence[str]) -> str:
        """Return the remedy for absent messages, as a clause without a full stop. The default is a request on
        the link.
        """
        return f"ask for {' and '.join(map(self.called, messages))} (--request-rates)" if messages else ""


def sentence(clause: str, end: str = ".") -> str:
    """Return a clause as a sentence with a capital letter and the given end."""
    return clause[:1].upper() + clause[1:] + end
