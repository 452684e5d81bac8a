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

from advisor.oem.driven_motion.errors import solution_at
from advisor.oem.driven_motion.likeliest_noise import first_noise, noise_of
from advisor.oem.driven_motion.linear import DrivenMotion
from advisor.oem.driven_motion.noise import LEAST_GUST_RAD, Noise
from advisor.oem.driven_motion.normal_equations import System
from advisor.oem.driven_motion.setting import Model, Setting
from advisor.oem.driven_motion.step import Step
from advisor.oem.driven_motion.without_alpha import moving_air
from advisor.oem.extra import Parameter
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
FAR = 1.0
"""Numerical: step, in standard deviations, above which the residual changes too much for its noise to be
estimated."""


class Driven(NamedTuple):
    """An estimate with unknown forces."""

    solution: Solution
    """Values and errors; the fit and the noise of the outputs are those at the new values."""
    noise: Noise
    gain: float
    """Log likelihood gain of the driven motion over coloured instruments, nats."""

    @property
    def gust_rad(self) -> float | None:
        """Standard deviation of the gust's angle, rad; None below ``LEAST_GUST_RAD``, or without clear
        gain."""
        return self.noise.gust if self.noise.gust > LEAST_GUST_RAD and self.gain > CLEARLY else None


def driven(
    start: Solution,
    motion: DrivenMotion,
    parameters: Sequence[Parameter],
    priors: Callable[[Any, FloatArray], Priors],
    near: Noise | None = None,
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
    near
        Noise of earlier records of the aircraft, from which the noise search starts.
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
    noise = near or first_noise(here)
    step = Step.of(model, here, noise)
    gain = 0.5 * (still - step.cost + step.promise)
    if not gain > CLEARLY:
        return None
    return _descended(model, start, here, noise, step, gain, searched=near is None)


def driven_without_alpha(
    start: Solution,
    motion: DrivenMotion,
    parameters: Sequence[Parameter],
    priors: Callable[[Any, FloatArray], Priors],
) -> Driven | None:
    """Return the estimate of a motion without an angle of attack, with gusts and coloured instruments.

    Only the specific force shows gusts then. None if the residuals are too large for gusts, or if the search
    diverges. The arguments are those of ``driven``.
    """
    model = Model(motion, parameters, priors)
    here = model.at(start.problem, start.optimum.shared, start.optimum.local)
    air = None if here is None else moving_air(here)
    if here is None or air is None or not air.is_air:
        return None
    step = Step.of(model, here, air.noise)
    return _descended(model, start, here, air.noise, step, air.gain, searched=None)


def _descended(
    model: Model, start: Solution, here: Setting, noise: Noise, step: Step, gain: float, searched: bool | None
) -> Driven | None:
    """Return the estimate from a setting and its step; None if the search diverges.

    ``searched`` states whether the noise is that of the setting; None keeps the noise.
    """
    for _ in range(ROUNDS):
        if searched is False and step.pending < FAR:
            noise, searched = noise_of(here, noise), True
            step = Step.of(model, here, noise)
        better = None if step.pending < SETTLED else step.taken(model, here, noise)
        if better is None:
            break
        here, searched = better, searched and step.pending < FAR
        step = Step.of(model, here, noise)
    if not step.pending < UNSETTLED:
        return None
    solution = solution_at(model, start, here, noise)
    return None if solution is None else Driven(solution, noise, gain)


def _cost_in_white_noise(start: Solution) -> float:
    """Return -2 log likelihood of the residual in white noise of the likeliest size, up to a constant."""
    channel = start.assembly.channel
    counts, squares = np.bincount(channel), np.bincount(channel, start.residual**2)
    return float(np.sum(counts * (1.0 + np.log(np.maximum(squares, 1e-300) / np.maximum(counts, 1)))))
