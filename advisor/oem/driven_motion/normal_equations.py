"""Normal equations of whitened rows, and the steps that they give."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from advisor.oem.arrow import inverse_of
from advisor.oem.driven_motion.setting import Setting
from advisor.oem.prior import Priors
from advisor.process.arrays import FloatArray


class System(NamedTuple):
    """Normal equations of the whitened rows, without each manoeuvre's own parameters."""

    information: FloatArray
    gradient: FloatArray
    own: Sequence[tuple[FloatArray, FloatArray, FloatArray, FloatArray]]
    """Basis and triangle of each manoeuvre's own columns, its common columns and its residual."""
    misfit: float
    """Sum of squares after a step of all parameters, up to a constant."""

    @classmethod
    def of(cls, setting: Setting, white: FloatArray, prior: Priors, further: int = 0) -> "System":
        """Return the normal equations of the whitened ``columns`` at a setting.

        The columns of so many ``further`` parameters follow, each with a prior of mean 0 and deviation 1.
        """
        laid, extra = setting.assembly, setting.extra
        common, own = laid.common, laid.own
        stated = (prior.std**-2)[common]
        information = np.diag(np.concatenate([stated, extra.weight**2, np.ones(further)]))
        towards = stated * (prior.mean - setting.shared)[common]
        gradient = np.concatenate([towards, extra.weight * extra.pull, np.zeros(further)])
        parts, misfit = [], 0.0
        for rows in laid.blocks:
            residual, columns = white[rows, 0], white[rows, 1 + len(own) :]
            basis, triangle = np.linalg.qr(white[rows, 1 : 1 + len(own)])
            kept = columns - basis @ (basis.T @ columns)
            information += kept.T @ kept
            gradient += kept.T @ residual
            misfit += float(np.sum(residual**2) - np.sum((basis.T @ residual) ** 2))
            parts.append((basis, triangle, columns, residual))
        return cls(
            information, gradient, parts, misfit - float(gradient @ inverse_of(information)[0] @ gradient)
        )

    def step(self, held: dict[int, float]) -> FloatArray:
        """Return the step of the common parameters, with those in ``held`` moved by given amounts."""
        step = np.zeros(len(self.gradient))
        step[list(held)] = list(held.values())
        free = np.array([i for i in range(len(step)) if i not in held], np.int64)
        inverse, _ = inverse_of(self.information[np.ix_(free, free)])
        step[free] = inverse @ (self.gradient - self.information @ step)[free]
        return step
