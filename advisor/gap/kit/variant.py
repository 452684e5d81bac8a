"""A candidate effect in a fit: its free parameters, the entries they change, and the least size."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field

from advisor.gap.records.flights import PreparedManeuvers
from advisor.gap.simulator.layout import INDEX
from advisor.process.arrays import FloatArray

Values = Sequence[float] | FloatArray
Apply = Callable[[FloatArray, Values, PreparedManeuvers], None]
"""Function that writes parameter values into the simulator inputs, shape (manoeuvres, entries), in place."""


@dataclass(frozen=True)
class Variant:
    """One description of an effect for a fit. An effect of the catalogue has one or several variants."""

    effect: str
    """Name of the effect in the catalogue."""
    block: str
    names: tuple[str, ...]
    """Names of the effect's parameters, in the spelling of the aircraft file."""
    starts: tuple[tuple[float, ...], ...]
    """Starting values of the search; several where the cost has local minima."""
    steps: tuple[float, ...]
    """Finite-difference step of each parameter."""
    bounds: tuple[tuple[float, float], ...]
    smallest: float
    """Least size of the first parameter in a plan's forecast: 4 ms, 1 %, 0.1 deg."""
    entries: tuple[str, ...] = ()
    """Simulator entries that equal the parameters one to one; empty where ``apply_with`` is given."""
    apply_with: Apply | None = None
    sides: tuple[str, tuple[float, ...]] | None = None
    """Simulator entry with a choice of values in each manoeuvre, such as the side on which the play rests."""
    needs: frozenset[str] = field(default_factory=frozenset)
    """Slow channels without which the effect cannot be tried."""
    fixed: Mapping[str, float] = field(default_factory=dict)
    """Parameters of the aircraft file that are not searched for, such as the time of a step."""
    places: tuple[str, ...] = ()
    """Parameters of position, time or rate instead of size. A size of zero does not mean that the effect is
    absent."""
    prior_std: tuple[float, ...] = ()
    """Prior standard deviation of each parameter about zero; empty for a flat prior."""
    is_nuisance: bool = False
    """Whether the parameters are nuisance parameters, which are part of every model and never named."""
    likewise: "tuple[Variant, ...]" = ()
    """Alternative variants, so similar that only a full fit can decide."""
    sets: bool = False
    """Whether the parameter replaces the simulator's value instead of adding to it."""
    in_file: Mapping[str, tuple[str, float]] = field(default_factory=dict)
    """Parameter, and factor from the file's number to the parameter, for each name in the aircraft file. An
    empty mapping means that the file holds the parameters unchanged."""
    inverted: bool = False
    """Whether the aircraft file holds the reciprocal of the first parameter, as for a rate limit."""

    @property
    def comes_at_any_time(self) -> bool:
        """Whether the effect is a change that may have occurred at any time of the flight."""
        return "at_s" in self.fixed or "at_s" in self.names

    def apply(self, p: FloatArray, values: Values, flights: PreparedManeuvers) -> None:
        """Write the parameter values into ``p``, shape (manoeuvres, entries)."""
        if self.apply_with is not None:
            self.apply_with(p, values, flights)
            return
        for entry, value in zip(self.entries, values, strict=True):
            p[:, INDEX[entry]] += value
