"""Step of all parameters along whitened residuals."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from advisor.oem.arrow import inverse_of
from advisor.oem.driven_motion.noise import Noise
from advisor.oem.driven_motion.normal_equations import System
from advisor.oem.driven_motion.setting import Model, Setting
from advisor.oem.extra import moved_by
from advisor.process.arrays import FloatArray

_SCALES = (1.0, 0.5, 0.25, 0.1, 0.03)
"""Numerical: tried shares of a step."""
_KEPT = 0.5
"""Numerical: share of the promised decrease of -2 log likelihood at which no shorter step is tried."""


class Step(NamedTuple):
    """A step of all parameters."""

    common: FloatArray
    """Steps of the derivatives, then of servos and clocks."""
    own: Sequence[FloatArray]
    """Step of each manoeuvre's own parameters."""
    pending: float
    """Largest step of a common parameter, in standard deviations."""
    promise: float
    """Decrease of -2 log likelihood that the normal equations promise."""
    cost: float
    """-2 log likelihood of the residual at the setting, up to a constant."""

    @classmethod
    def of(cls, model: Model, here: Setting, noise: Noise) -> "Step":
        """Return the step from a setting.

        A parameter that would leave its range stops at the range's end, and the others are solved again.
        """
        parameters = model.parameters
        white, volume = here.whitened(here.columns, noise)
        system = System.of(here, white, model.prior(here))
        if not np.all(np.isfinite(system.information)):
            return cls(np.empty(0), (), np.inf, 0.0, np.inf)
        derivatives = len(here.assembly.common)
        held: dict[int, float] = {}
        step = system.step(held)
        for _ in parameters:
            wanted = step[derivatives:]
            moved = moved_by(wanted, here.problem, parameters)
            allowed = np.array([x.read(moved) - x.read(here.problem) for x in parameters])
            ends = np.flatnonzero(~np.isclose(allowed, wanted, rtol=1e-6, atol=1e-12))
            if not len(ends):
                break
            held |= {derivatives + int(j): float(allowed[j]) for j in ends}
            step = system.step(held)
        std = np.sqrt(np.maximum(np.diag(inverse_of(system.information)[0]), 1e-300))
        own = [
            np.asarray(np.linalg.lstsq(triangle, basis.T @ (residual - columns @ step), rcond=1e-10)[0])
            for basis, triangle, columns, residual in system.own
        ]
        squares = float(np.sum(white[:, 0] ** 2))
        pending = float(np.max(np.abs(step) / std))
        return cls(step, own, pending, squares - system.misfit, volume + squares)

    def taken(self, model: Model, here: Setting, noise: Noise) -> Setting | None:
        """Return the likeliest setting along the step; None if the likelihood decreases along all of it.

        A full step ignores that the filter changes with the parameters, and overshoots in curved valleys.
        """
        if not self.own:
            return None
        prior = model.prior(here)
        common, own = here.assembly.common, here.assembly.own

        def penalty(setting: Setting) -> float:
            apart = (setting.shared - prior.mean)[common] / prior.std[common]
            return setting.penalty + float(apart @ apart)

        begun = lowest = self.cost + penalty(here)
        best = None
        for scale in _SCALES:
            shared, local = here.shared.copy(), here.local.copy()
            shared[common] += scale * self.common[: len(common)]
            local[:, own - len(here.assembly.names.shared)] += scale * np.array(self.own)
            problem = moved_by(scale * self.common[len(common) :], here.problem, model.parameters)
            trial = model.at(problem, shared, local)
            reached = np.inf if trial is None else trial.cost(noise) + penalty(trial)
            if reached < lowest:
                best, lowest = trial, reached
            elif best is not None:
                break
            if begun - lowest > _KEPT * scale * (2.0 - scale) * self.promise:
                break
        return best
