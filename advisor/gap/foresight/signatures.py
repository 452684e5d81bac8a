"""Signature of an effect: its response in the data, without the part that other parameters imitate.

The length of a signature, in standard deviations of the noise, gives the smallest detectable size. The angle
between two signatures shows how easily one effect is confused with the other. Parameters with a prior, such
as the edges of the command, are eliminated with their prior as additional rows. Lengths and angles of
signatures are therefore those of the marginal likelihood. Latency may absorb an effect too, but only within
its bounds.
"""

from collections.abc import Sequence

import numpy as np

from advisor.gap.fitting.fit import EffectFit
from advisor.gap.fitting.problem import EffectProblem, row_weights
from advisor.gap.kit.effect import Variant
from advisor.process.arrays import FloatArray

_RANK = 1e-7
"""Numerical: relative singular value below which a direction of the shared parameters is ignored."""


class Signatures:
    """Signatures at a point of the model: responses without the part that all parameters can imitate."""

    def __init__(self, problem: EffectProblem, fitted: EffectFit, noise: FloatArray) -> None:
        self.problem = problem
        self.filtered = problem.knows_the_noise
        self.rows = 0
        self._weights, self._own, shared = [], [], []
        for i, block in enumerate(fitted.linear):
            w = row_weights(problem, i, 1.0 / noise)
            self._weights.append(w)
            self.rows += len(w)
            both = np.vstack([block.own * w[:, None], np.diag(np.sqrt(block.prior))])
            self._own.append(np.linalg.qr(both / (np.linalg.norm(both, axis=0) + 1e-300))[0])
            shared.append(self._freed_of_own(i, block.shared * w[:, None]))
        stacked = np.concatenate(shared)
        late = _latency_at(fitted)
        rest = np.delete(stacked, [] if late is None else late, axis=1)
        U, size, _ = np.linalg.svd(rest / (np.linalg.norm(rest, axis=0) + 1e-300), full_matrices=False)
        self._shared = U[:, size > _RANK * size[0]]
        self._latency = np.zeros(len(stacked)) if late is None else self._freed_of_shared(stacked[:, late])
        now = 0.0 if late is None else float(fitted.point.shared[late])
        low, high = (0.0, 0.0) if late is None else _latency_in(fitted)[0].bounds[0]
        self._latency_bounds = low - now, high - now

    def of(self, columns: Sequence[FloatArray]) -> FloatArray:
        """Return the signature of a response, one array of shape (rows,) per manoeuvre, in the channels'
        units."""
        parts = [self.within(i, column[:, None])[:, 0] for i, column in enumerate(columns)]
        return self._freed_of_shared(np.concatenate(parts))

    def within(self, i: int, columns: FloatArray) -> FloatArray:
        """Return weighted responses of manoeuvre ``i``, shape (rows, k), without the effect of its nuisance
        parameters."""
        weighted = self.problem.innovations(i, columns) * self._weights[i][:, None]
        return self._freed_of_own(i, weighted)

    def smallest(self, signature: FloatArray, power: float) -> float:
        """Return the size at which a signature has ``power`` even if latency absorbs a part; else infinite.

        The size is the smallest s with min |s·x − λ·l|² = power over the latencies λ within their bounds.
        """
        x, latency = signature, self._latency
        own, ll = float(x @ x), float(latency @ latency)
        share = float(latency @ x) / ll if ll > 0.0 else 0.0
        remaining = own - share**2 * ll
        free = np.sqrt(power / remaining) if remaining > 1e-12 * own and own > 0.0 else np.inf
        low, high = self._latency_bounds
        bound = high if share > 0.0 else low
        if own <= 1e-18 or free * abs(share) <= abs(bound):
            return float(free) if own > 1e-18 else float("inf")
        along = bound * share * ll
        return float((along + np.sqrt(along**2 - own * (bound**2 * ll - power))) / own)

    def _freed_of_own(self, i: int, weighted: FloatArray) -> FloatArray:
        Q = self._own[i]
        padded = np.vstack([weighted, np.zeros((len(Q) - len(weighted), weighted.shape[1]))])
        return np.asarray(padded - Q @ (Q.T @ padded))

    def _freed_of_shared(self, stacked: FloatArray) -> FloatArray:
        return np.asarray(stacked - self._shared @ (self._shared.T @ stacked))


def _latency_at(fitted: EffectFit) -> int | None:
    """Return the index of the latency among the shared parameters; None for a model without latency."""
    latency = _latency_in(fitted)
    return fitted.point.place(fitted.point.effects.index(latency[0])).start if latency else None


def _latency_in(fitted: EffectFit) -> list[Variant]:
    """Return a list with the latency of the model; empty for a model without latency."""
    return [effect for effect in fitted.point.effects if effect.effect == "latency"]
