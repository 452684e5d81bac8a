"""What a set of cases consists of: classes and effects by quota, in an order that the seed shuffles."""

from dataclasses import dataclass

import numpy as np

from .catalogue import EFFECTS, NAMED, OUTSIDE
from .effects import Effect

SHARES = {"none": 0.20, "one": 0.45, "two": 0.08, "parameters": 0.07, "outside": 0.20}


@dataclass(frozen=True)
class Assignment:
    """The class of one case and the effects it shall have."""

    kind: str
    effects: tuple[Effect, ...] = ()

    @property
    def names(self) -> set[str]:
        """Names of the effects."""
        return {effect.name for effect in self.effects}


def _turns(effects: tuple[Effect, ...], count: int, rng: np.random.Generator) -> list[Effect]:
    """Each effect as often as any other, in random order."""
    order: list[Effect] = []
    while len(order) < count:
        order += [effects[k] for k in rng.permutation(len(effects))]
    return order[:count]


def _pair(rng: np.random.Generator) -> tuple[Effect, Effect]:
    """Two named effects that enter in different blocks."""
    while True:
        first, second = (NAMED[k] for k in rng.choice(len(NAMED), 2, replace=False))
        if first.block != second.block:
            return first, second


def _quota(count: int) -> dict[str, int]:
    numbers = {kind: int(count * share) for kind, share in SHARES.items()}
    by_remainder = sorted(SHARES, key=lambda kind: numbers[kind] - count * SHARES[kind])
    for kind in by_remainder[: count - sum(numbers.values())]:
        numbers[kind] += 1
    return numbers


def assignments(count: int, seed: int, only: str | None = None) -> list[Assignment]:
    """One assignment a case; `only` is a class or the name of one effect."""
    rng = np.random.default_rng([seed, 0])
    if only in EFFECTS:
        effect = EFFECTS[only]
        kind = "one" if effect in NAMED else "outside"
        return [Assignment(kind, (effect,))] * count
    if only is not None and only not in SHARES:
        raise ValueError(f"neither a class ({', '.join(SHARES)}) nor an effect: {only}")
    numbers = _quota(count) if only is None else {kind: count if kind == only else 0 for kind in SHARES}
    cases = [Assignment("none")] * numbers["none"] + [Assignment("parameters")] * numbers["parameters"]
    cases += [Assignment("one", (effect,)) for effect in _turns(NAMED, numbers["one"], rng)]
    cases += [Assignment("two", _pair(rng)) for _ in range(numbers["two"])]
    cases += [Assignment("outside", (effect,)) for effect in _turns(OUTSIDE, numbers["outside"], rng)]
    return [cases[k] for k in rng.permutation(len(cases))]
