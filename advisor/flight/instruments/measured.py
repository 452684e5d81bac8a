"""A measured value with its error, and the mean of several."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

import numpy as np

from advisor.flight.instruments.alpha_offset import weighted


@dataclass(frozen=True, slots=True)
class Measured:
    """A value and its standard deviation."""

    value: float
    std: float


Evidence = Mapping[str, Measured]
"""Name of a quantity to its measured value."""


def pooled(several: Iterable[Evidence]) -> dict[str, Measured]:
    """Return the weighted mean of every quantity over the records that tell it.

    Scatter between records that exceeds their stated errors widens the error.
    """
    together: dict[str, list[Measured]] = {}
    for evidence in several:
        for name, measured in evidence.items():
            if np.isfinite(measured.value) and measured.std > 0.0:
                together.setdefault(name, []).append(measured)
    return {
        name: Measured(*weighted([m.value for m in found], [m.std for m in found]))
        for name, found in together.items()
    }
