"""Linearisation of a fitted motion that unknown forces drive."""

from typing import Any, NamedTuple, Protocol

import numpy as np

from advisor.model.response import Index
from advisor.oem.descent import Motion
from advisor.process.arrays import FloatArray


class Linear(NamedTuple):
    """Linearisation of a fitted motion with s states and o outputs."""

    matrix: FloatArray
    """Shape (s, s): rates of the states by the states."""
    seen: FloatArray
    """Shape (o, s): outputs by the states."""
    air: FloatArray
    """Shape (s,): rates of the states by the gust's angle of incidence, 1/s."""
    air_seen: FloatArray
    """Shape (o,): outputs by the gust's angle of incidence."""
    forced: Index
    """Indices of the states whose rates contain a force."""

    @property
    def all_seen(self) -> FloatArray:
        """Shape (o, s + 1): outputs by the states and by the gust's angle."""
        return np.column_stack([self.seen, self.air_seen])


class DrivenMotion(Motion, Protocol):
    """Interface of an axis whose motion unknown forces drive."""

    def linear(self, problem: Any, shared: FloatArray, m: int, /) -> Linear:
        """Return the linear motion of manoeuvre ``m`` at its mean air speed."""

    def unsure(self, laid: Any, y: FloatArray, /) -> FloatArray:
        """Return the change (N, k) of the outputs ``y`` by a standard deviation of each instrument quantity
        that is not estimated."""
