"""A decision of the diagnosis as the ledger holds it: a number against its limit."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Decision:
    """One question, answered yes where the statistic reaches the limit."""

    about: str
    """The effect, the block or the verdict in question."""
    name: str
    """The question in a word or two."""
    statistic: float
    limit: float
    unit: str
    """What both numbers count."""

    @property
    def margin(self) -> float:
        """By how much the limit is exceeded; below zero: by how much it is missed."""
        return self.statistic - self.limit

    @property
    def holds(self) -> bool:
        """Whether the answer is yes."""
        return self.statistic >= self.limit
