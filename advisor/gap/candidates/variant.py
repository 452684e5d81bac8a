"""What a candidate effect is to the fit: numbers to free, where they enter, and how small is nothing."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field

from advisor.flight.messages import FloatArray
from advisor.gap.records.flights import Flights
from advisor.gap.simulator.layout import INDEX

Values = Sequence[float] | FloatArray
Apply = Callable[[FloatArray, Values, Flights], None]
"""Write parameter values into the driving numbers, shape (manoeuvres, entries), in place."""


@dataclass(frozen=True)
class Variant:
    """One way an effect may act. An effect of the catalogue has one or several."""

    effect: str
    """Name in the catalogue."""
    block: str
    names: tuple[str, ...]
    """Parameters, as the aircraft file spells them."""
    starts: tuple[tuple[float, ...], ...]
    """Where the search begins; several where the cost has local minima."""
    steps: tuple[float, ...]
    """Finite-difference step of each parameter."""
    bounds: tuple[tuple[float, float], ...]
    smallest: float
    """Size of the first parameter below which the effect is not worth a name: 4 ms, 1 %, 0.1 deg."""
    if_beyond_doubt: float = 1.0
    """Share of it that is enough of what is there beyond doubt."""
    entries: tuple[str, ...] = ()
    """Entries of the simulation the parameters are, one to one; empty when ``apply_with`` says otherwise."""
    apply_with: Apply | None = None
    sides: tuple[str, tuple[float, ...]] | None = None
    """An entry that may take any of some values in each manoeuvre: which side the play rests on."""
    needs: frozenset[str] = field(default_factory=frozenset)
    """Slow channels without which the effect cannot be tried."""
    fixed: Mapping[str, float] = field(default_factory=dict)
    """Parameters of the aircraft file that are not searched for: the time of a step."""
    one_sided: bool = False
    """Its bounds are physics, not the range of the search: a parameter may well lie there."""
    places: tuple[str, ...] = ()
    """Parameters that say where, when or how fast, not how much: at zero they are no "no effect"."""
    prior_std: tuple[float, ...] = ()
    """Standard deviation about zero that each parameter has beforehand; none: anything goes."""
    is_nuisance: bool = False
    """Part of every model and never named: nobody's fault."""
    twin: Callable[[FloatArray, Sequence["Variant"], float], FloatArray] | None = None
    """For what derivatives imitate exactly: how all shared numbers, shape (k,), change per unit of the size
    while the motion stays the same, given the derivatives, the effects in the model and the reference speed.
    It is fitted with the aircraft file's derivatives trusted."""
    start_at_prior: Values | None = None
    """For what fitted derivatives hide altogether: where the search begins beside the aircraft file's."""
    likewise: "tuple[Variant, ...]" = ()
    """Other descriptions, so near to this one that the full fit alone decides ..."""
    carried: Callable[[FloatArray], Values] | None = None
    """... and, for one of those, its numbers from those it stands beside; None: the same numbers."""
    sets: bool = False
    """Its number is all there is of it, whatever the simulation had: not what is added."""
    inverted: bool = False
    """The aircraft file has the reciprocal of the first parameter (a rate limit, searched as slowness)."""

    @property
    def comes_at_any_time(self) -> bool:
        """Whether it is a change that may have come at any time of the flight."""
        return "at_s" in self.fixed or "at_s" in self.names

    def apply(self, p: FloatArray, values: Values, flights: Flights) -> None:
        """Write the values into ``p``, shape (manoeuvres, entries)."""
        if self.apply_with is not None:
            self.apply_with(p, values, flights)
            return
        for entry, value in zip(self.entries, values, strict=True):
            p[:, INDEX[entry]] += value
