"""Estimation of a motion that unknown forces drive, for every axis.

Output error treats every deviation as noise of an instrument. Gusts, propeller and vibration drive the
aircraft itself, and the motion after such a force depends on the force. Here white noise drives the rate of
every state that has a force, and a gust adds its angle to the angle of incidence. The instruments have white
and coloured noise. A Kalman filter about the fitted motion whitens residuals and sensitivities. The estimate
is least squares of the whitened residuals (Maine & Iliff, NASA RP-1168; Jategaonkar, *Flight Vehicle
System Identification*, chapter 5).
"""

from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np

from advisor.oem.arrow import inverse_of
from advisor.oem.driven_motion.errors import solution_at
from advisor.oem.driven_motion.likeliest_noise import FINE, MOST_MANEUVERS, STEPS, likeliest, starts
from advisor.oem.driven_motion.linear import DrivenMotion
from advisor.oem.driven_motion.noise import LEAST_GUST_RAD, Noise
from advisor.oem.driven_motion.normal_equations import System
from advisor.oem.driven_motion.setting import Model, Setting
from advisor.oem.extra import Parameter, moved_by
from advisor.oem.prior import Priors
from advisor.oem.solution import Solution
from advisor.oem.weighing import Weighing
from advisor.process.arrays import FloatArray

ROUNDS = 8
"""Numerical: largest number of noise estimates, each followed by one step of all parameters."""
SETTLED = 0.1
"""Largest pending step of a converged estimate, in standard deviations."""
UNSETTLED = 3.0
"""Pending step, in standard deviations, above which the search counts as diverged."""
CLEARLY = 20.0
"""Log likelihood gain of a driven motion over coloured instruments, nats, above which the motion counts as
driven."""
_SCALES = (1.0, 0.5, 0.25, 0.1, 0.03)


class Driven(NamedTuple):
    """An estimate with unknown forces."""

    solution: Solution
    """Values and errors; the fit and the noise of the outputs are those at the new values."""
    noise: Noise
    gain: float
    """Log likelihood gain of the driven motion over coloured instruments, nats."""

    @property
    def gust_rad(self) -> float | None:
        """Standard deviation of the gust's angle, rad; None below ``LEAST_GUST_RAD``."""
        return self.noise.gust if self.noise.gust > LEAST_GUST_RAD else None


def driven(
    start: Solution,
    motion: DrivenMotion,
    parameters: Sequence[Parameter],
    priors: Callable[[Any, FloatArray], Priors],
) -> Driven | None:
    """Return the estimate with unknown forces; None if the motion is not driven, or if the search diverges.

    Parameters
    ----------
    start
        Output-error solution, from which the search starts.
    parameters
        Servos and clocks that are estimated with the derivatives.
    priors
        Function that returns the priors of the derivatives for a problem and shared parameters.
    """
    weighing = Weighing.by(start.noise.colours, start.assembly)
    coloured = weighing.volume + float(np.sum(weighing.forward(start.residual[:, None]) ** 2))
    if not 0.5 * (_cost_in_white_noise(start) - coloured) > CLEARLY:
        # The motion after a force is coloured: where no residual is, there is no force.
        return None
    model = Model(motion, parameters, priors)
    here = model.at(start.problem, start.optimum.shared, start.optimum.local)
    if here is None:
        return None
    prior = model.prior(here)
    still = weighing.volume + System.of(here, weighing.forward(here.columns), prior).misfit
    noises = [likeliest(here, noise, STEPS[:1]) for noise in starts(here)]
    noise = noises[np.argmin([here.cost(noise, MOST_MANEUVERS) for noise in noises])]
    noise = likeliest(here, noise, STEPS[1:])
    white, volume = here.whitened(here.columns, noise)
    gain = 0.5 * (still - volume - System.of(here, white, prior).misfit)
    if not gain > CLEARLY:
        return None
    pending = np.inf
    for _ in range(ROUNDS):
        better, pending = _stepped(model, here, noise)
        if better is None or pending < SETTLED:
            break
        here = better
        noise = likeliest(here, noise, FINE)
    if not pending < UNSETTLED:
        return None
    solution = solution_at(model, start, here, noise)
    return None if solution is None else Driven(solution, noise, gain)


def _cost_in_white_noise(start: Solution) -> float:
    """Return -2 log likelihood of the residual in white noise of the likeliest size, up to a constant."""
    channel = start.assembly.channel
    counts, squares = np.bincount(channel), np.bincount(channel, start.residual**2)
    return float(np.sum(counts * (1.0 + np.log(np.maximum(squares, 1e-300) / np.maximum(counts, 1)))))


def _stepped(model: Model, here: Setting, noise: Noise) -> tuple[Setting | None, float]:
    """Return the likeliest setting along the step, and the step's length in standard deviations.

    The setting is None if the likelihood decreases along the whole step. A full step ignores that the filter
    changes with the parameters, and overshoots in curved valleys. A parameter that would leave its range
    stops at the range's end, and the others are solved again.
    """
    prior, parameters = model.prior(here), model.parameters
    system = System.of(here, here.whitened(here.columns, noise)[0], prior)
    if not np.all(np.isfinite(system.information)):
        return None, np.inf
    common, own = here.assembly.common, here.assembly.own
    held: dict[int, float] = {}
    step = system.step(held)
    for _ in parameters:
        wanted = step[len(common) :]
        moved = moved_by(wanted, here.problem, parameters)
        allowed = np.array([x.read(moved) - x.read(here.problem) for x in parameters])
        ends = np.flatnonzero(~np.isclose(allowed, wanted, rtol=1e-6, atol=1e-12))
        if not len(ends):
            break
        held |= {len(common) + int(j): float(allowed[j]) for j in ends}
        step = system.step(held)
    std = np.sqrt(np.maximum(np.diag(inverse_of(system.information)[0]), 1e-300))
    pending = float(np.max(np.abs(step) / std))
    owns = [
        np.linalg.lstsq(triangle, basis.T @ (residual - columns @ step), rcond=1e-10)[0]
        for basis, triangle, columns, residual in system.own
    ]

    def cost(setting: Setting) -> float:
        apart = (setting.shared - prior.mean)[common] / prior.std[common]
        return setting.cost(noise) + setting.extra.penalty + float(apart @ apart)

    best, lowest = None, cost(here)
    for scale in _SCALES:
        shared, local = here.shared.copy(), here.local.copy()
        shared[common] += scale * step[: len(common)]
        local[:, own - len(here.assembly.names.shared)] += scale * np.array(owns)
        problem = moved_by(scale * step[len(common) :], here.problem, parameters)
        trial = model.at(problem, shared, local)
        reached = np.inf if trial is None else cost(trial)
        if reached < lowest:
            best, lowest = trial, reached
        elif best is not None:
            break
    return best, pending
