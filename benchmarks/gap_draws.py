"""Flights that the diagnosis is scored on: every generator, in strata of kinds and of telemetry.

In the strata of the world all natural numbers of telemetry act in every flight together
(``benchmarks.sealed.world``). ArduPlane flies where its simulator lies next to the checkout.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Protocol, cast

from benchmarks.arduplane_generator.cases import cases as arduplane
from benchmarks.arduplane_generator.simulator import is_here
from benchmarks.by_hand.cases import cases as by_hand
from benchmarks.sealed.world import in_the_world
from benchmarks.second_generator.cases import cases as second
from benchmarks.third_generator.files import cases as third
from sim.blind.draw import GROUPS, Group
from sim.blind.generate import draw
from sim.blind.natural import SHARE
from sim.sealed.cases import SealedCase


class Draw(Protocol):
    """Flights of a generator."""

    def __call__(
        self, count: int, seed: int, only: str | None, natural_share: float, noise_factor: float = 0.0
    ) -> Iterator[SealedCase]:
        """Yield flights of one kind, or of all kinds; a share of the flights has natural nuisances.

        With a ``noise_factor`` filters act in every flight, and the noise is smaller by down to that factor.
        """


def _own(
    count: int, seed: int, only: str | None, natural_share: float, noise_factor: float = 0.0
) -> Iterator[SealedCase]:
    return draw(count, seed, GROUPS if only is None else (cast(Group, only),), natural_share, noise_factor)


def _arduplane(
    count: int, seed: int, only: str | None, natural_share: float, noise_factor: float = 0.0
) -> Iterator[SealedCase]:
    """Yield flights of ArduPlane, whose telemetry is natural in every flight."""
    return arduplane(count, seed, only)


DRAWS: Mapping[str, Draw] = {"own": _own, "second": second, "third": third, "by hand": by_hand} | (
    {"arduplane": _arduplane} if is_here() else {}
)
"""Flights of each generator by number, seed, kind, and share with natural nuisances."""
LEAST_NOISE = 0.2
"""Least share of a generator's noise in the strata of the world: down to .5 % of the peaks."""
WORLDLY = ("own", "second", "third", "by hand")
"""Generators whose telemetry is made like the world's by ``in_the_world``. ArduPlane's is so already."""


@dataclass(frozen=True)
class Stratum:
    """Kinds of flights that are drawn together."""

    only: str | None
    """Kind of the flights; None for all in the generator's mixture."""
    share: float
    """Number of flights relative to the first stratum."""
    in_world: bool = False
    """Whether all natural numbers act in every flight."""


STRATA = (
    Stratum(None, 1.0), Stratum("outside", 0.4), Stratum("none", 0.2),
    Stratum(None, 0.4, in_world=True), Stratum("none", 0.4, in_world=True),
)  # fmt: skip


def drawn(
    each: int, seed: int, generators: Sequence[str] = tuple(DRAWS), only_world: bool = False
) -> Iterator[tuple[str, SealedCase]]:
    """Yield the flights of every generator and stratum with their names, in turns over the generators."""
    for number, stratum in enumerate(STRATA):
        if only_world and not stratum.in_world:
            continue
        count, own_seed = max(round(stratum.share * each), 1), seed + number
        streams = [(name, _flights(name, stratum, count, own_seed)) for name in generators]
        for _ in range(count):
            for name, stream in streams:
                if (case := next(stream, None)) is not None:
                    yield f"{name}/{own_seed}/{case.name}", case


def _flights(generator: str, stratum: Stratum, count: int, seed: int) -> Iterator[SealedCase]:
    """Yield the flights of one generator and stratum."""
    if not stratum.in_world:
        yield from DRAWS[generator](count, seed, stratum.only, SHARE)
    elif generator in WORLDLY:
        for case in DRAWS[generator](count, seed, stratum.only, 1.0, LEAST_NOISE):
            yield in_the_world(case, seed)
