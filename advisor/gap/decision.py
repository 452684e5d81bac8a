"""One decision of the diagnosis, as the ledger keeps it: a statistic compared with its limit."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Decision:
    """One question, answered yes where the statistic is at least the limit."""

    about: str
    """Effect, block or verdict that the question is about."""
    name: str
    """The question in one or two words."""
    statistic: float
    limit: float
    unit: str
    """Unit of the statistic and of the limit."""
    parameter: str = ""
    """Parameter of the effect that the question is about; empty for any other question."""
    searched: tuple[float, float] | None = None
    """Ends of that parameter's searched range, SI."""

    @property
    def margin(self) -> float:
        """Statistic minus limit: positive where the limit is exceeded."""
        return self.statistic - self.limit

    @property
    def holds(self) -> bool:
        """Whether the statistic is at least the limit."""
        return self.statistic >= self.limit
