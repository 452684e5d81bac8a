"""Estimation of a motion that unknown forces drive, for every axis.

Output error treats every deviation as noise of an instrument. Gusts, propeller and vibration drive the
aircraft itself, and the motion after such a force depends on the force. Here white noise drives the rate of
every state that has a force, and a gust adds its angle to the angle of incidence. The instruments have white
and coloured noise. A Kalman filter about the fitted motion whitens residuals and sensitivities. The estimate
is least squares of the whitened residuals (Maine & Iliff, NASA RP-1168; Jategaonkar, *Flight Vehicle
System Identification*, chapter 5).
"""

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

from advisor.flight.signals.record import robust_std
from advisor.oem.arrow import inverse_of
from advisor.oem.covariance import Weighing
from advisor.oem.driven_motion.likeliest_noise import first_noise, noise_of
from advisor.oem.driven_motion.setting import LEAST_GUST_RAD, DrivenMotion, Model, Noise, Setting
from advisor.oem.evaluation import errors_of
from advisor.oem.extra import Parameter, moved_by
from advisor.oem.prior import Priors
from advisor.oem.rows import Laid
from advisor.oem.solution import Solution, reported
from advisor.oem.turbulence import Rows, Turbulence, find_turbulence
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


SCALE = 0.03 / 3.0**0.5
"""Standard deviation of the scale of an instrument, relative. Data sheets of autopilots' gyros and
accelerometers allow 3 % to either side. Residuals show a part of it, and the derivatives absorb the rest."""


def _scaled(laid: Laid, y: FloatArray) -> FloatArray:
    """Return the change (N, o) of the outputs ``y`` by a standard deviation of each output's scale."""
    columns = np.zeros((len(y), len(laid.names.outputs)))
    for named in laid.rows:
        for name, rows in named.items():
            columns[rows, laid.names.outputs.index(name)] = SCALE * (y[rows] - y[rows].mean())
    return columns


def solution_at(model: Model, start: Solution, setting: Setting, noise: Noise) -> Solution | None:
    """Return the solution at a setting, with Cramér-Rao errors and errors for coloured innovations."""
    laid, fitted = setting.assembly, setting.assembly.z - setting.residual
    unsure = np.column_stack([model.motion.unsure(laid, fitted), _scaled(laid, fitted)])
    white, _ = setting.whitened(
        np.column_stack([setting.residual, setting.sensitivities, setting.extra.columns, unsure]), noise
    )
    size, split = unsure.shape[1], 1 + setting.sensitivities.shape[1]
    left, g, extra, unsure = np.split(white, [1, split, white.shape[1] - size], axis=1)
    prior = model.prior(setting)
    errors = errors_of(
        laid,
        left[:, 0],
        g,
        np.ones(len(laid.names.outputs)),
        setting.extra.whitened(extra),
        np.asarray(prior.std**-2.0),
        prior_share=prior.share,
    )
    if errors is None:
        return None
    # The estimate keeps the scales at 1: their posterior second moment is the error.
    ordered = np.column_stack([left, g[:, laid.own], g[:, laid.common], extra, unsure])
    system = System.of(setting, ordered, prior, size)
    shown = system.step({})[-size:]
    moment = inverse_of(system.information)[0][-size:, -size:] + np.outer(shown, shown)
    pulled = errors["influence"].rows.T @ unsure
    # Dynamics that the model lacks do not stand out in innovations: their error is that of output error.
    systematic, kept = pulled @ moment @ pulled.T, min(len(pulled), len(start.systematic))
    systematic[:kept, :kept] += start.systematic[:kept, :kept]
    errors["systematic"] = systematic
    optimum = start.optimum._replace(
        shared=setting.shared, local=setting.local, fitted=fitted, sensitivities=setting.sensitivities
    )
    return replace(
        start,
        problem=setting.problem,
        assembly=laid,
        optimum=optimum,
        theta=reported(setting.shared, setting.local, laid.names),
        extra=setting.extra,
        parameters=model.parameters,
        modes=None,
        alike=None,
        **errors,
    )


MOST_MANEUVERS = 7
"""Number of the newest manoeuvres for the noise estimate. More manoeuvres would change the noise estimate
little."""


def moving_air(setting: Setting) -> Turbulence:
    """Return the moving air and the noise that fit the residuals of a setting best."""
    rows = [_rows(setting, m) for m in range(len(setting.records))][-MOST_MANEUVERS:]
    outputs = range(len(setting.assembly.names.outputs))
    white = np.array([_white([r.residual[r.channel == c] for r in rows]) for c in outputs])
    return find_turbulence(rows, white, start_variance=0.0)


def _white(parts: list[np.ndarray]) -> float:
    """Return the standard deviation of the white part of an output's residuals, from their differences."""
    steps = np.concatenate([np.diff(part) for part in parts])
    return robust_std(steps) / float(np.sqrt(2.0)) if len(steps) else 1.0


def _rows(setting: Setting, m: int) -> Rows:
    """Return the residuals of a manoeuvre in order of time, without each output's mean."""
    order = setting.records[m].order
    channel, residual = setting.assembly.channel[order], setting.residual[order]
    for c in np.unique(channel):
        residual[channel == c] -= residual[channel == c].mean()
    return Rows(setting.assembly.t[order], channel, residual, setting.records[m].motion)


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
