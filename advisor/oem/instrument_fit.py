"""Estimation of instrument parameters together with the derivatives.

Gauss-Newton steps move all instruments of a problem, with everything else refitted. Three kinds of parameter
differ by what is known before the flight:

- *The delays of the command and of the angle of attack* are nuisances of every log. A prior holds each, and
  every interval contains both. A late angle of attack and a vane's arm look nearly alike, and are off by
  Z_α² times the delay in Z_α. So both are in the fit.
- *An open parameter*, such as a servo's lag, has the prior of instruments that nobody has measured. On a
  well damped aircraft a lag is correlated with M_q and M_δe over a long range, and every interval contains
  that.
- *A stated parameter* is estimated next to the statement. Where both agree, the statement is a prior with a
  width. Where they exclude each other, the data decide alone, and the contradiction is told.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from advisor.aircraft.reference import PARAMETERS
from advisor.flight.signals.messages import FloatArray
from advisor.oem.arrow import solved_within
from advisor.oem.covariance import influence
from advisor.oem.estimate import InstrumentEstimate
from advisor.oem.extra import Prior, penalty
from advisor.oem.gauss_newton import CONVERGED, Optimum
from advisor.oem.instruments import Instrument, extra_of, moved_by
from advisor.oem.problem import Assembly, OutputErrorProblem
from advisor.oem.solution import Solution, evaluate, search
from advisor.oem.weighing import Weighing

N = len(PARAMETERS)
ROUNDS = 12
SETTLED = 1e-2
"""Change of -2 log likelihood, promised or found in a round, below which the search for instrument parameters
is done."""
CLOSE_ENOUGH = 1e-7
"""Promised change of log J per sample at which an intermediate search ends."""
ROUGHLY = 1e-4
"""Promised change of log J per sample at which a search ends whose end is only a start of the next one. The
starts of a lag differ by hundreds of times as much."""
LEAST_SHARE = 0.01
"""Least share by which white noise weighs a prior; data without noise have no colour."""
CONTRADICTS = 3.0
"""Distance of a stated value from the value that the data tell, in standard deviations of both, beyond which
they exclude each other."""


class Identified(NamedTuple):
    """An instrument parameter of a fit."""

    instrument: Instrument
    found: InstrumentEstimate

    @property
    def reported(self) -> InstrumentEstimate | None:
        """The parameter for the rest of the program; None for a moment of the aircraft."""
        return None if self.instrument.name == "steady_moment_rad" else self.found


@dataclass(frozen=True, slots=True)
class InstrumentFit:
    """A solution with its instrument parameters."""

    solution: Solution
    """Solution whose ``extra`` columns are the derivatives by ``identified``, in that order."""
    identified: tuple[Identified, ...] = ()

    def misfit(self, weighing: Weighing) -> float:
        """Return -2 log of the posterior up to a constant, under one noise model."""
        found = self.solution
        prior = penalty(found.problem, [x.instrument for x in self.identified])
        return weighing.misfit(found.residual, found.sensitivities) + prior


class _Fit(NamedTuple):
    """The optimum at one setting of the instruments."""

    problem: OutputErrorProblem
    assembly: Assembly
    optimum: Optimum

    def cost(self, names: Sequence[Instrument]) -> float:
        """Return -2 log of the posterior up to a constant."""
        return self.optimum.log_likelihood_cost + penalty(self.problem, names)


def fit_instruments(plain: Solution, unknown: Sequence[Instrument]) -> InstrumentFit:
    """Estimate the instrument parameters; ``plain`` is the solution without any.

    Parameters
    ----------
    unknown
        Parameters with a prior, open ones, and stated ones.
    """
    if not unknown:
        return InstrumentFit(plain)
    fit, solution = _Fit(plain.problem, plain.assembly, plain.optimum), plain
    for look in (_looked_about, _stayed):
        names = tuple(weighed(x, share_of(solution)) for x in unknown)
        fit = _descend(look(fit, names), names)
        found = _solution(fit, names)
        if found is None:
            return InstrumentFit(plain)
        solution = found
    return _with_statements(names, fit, solution, plain)


def share_of(plain: Solution) -> float:
    """Return the errors by white noise over those by the residuals' colour, the median of the parameters."""
    ratio = np.sqrt(np.diag(plain.covariance_cr)[:N] / np.diag(plain.covariance)[:N])
    return float(np.clip(np.nanmedian(ratio), LEAST_SHARE, 1.0))


def weighed(x: Instrument, share: float) -> Instrument:
    """Return the instrument with the share by which white noise weighs its prior."""
    return x if x.prior is None else replace(x, prior=replace(x.prior, share=share))


def _with_statements(
    names: tuple[Instrument, ...], best: _Fit, solution: Solution, plain: Solution
) -> InstrumentFit:
    """Return the fit in which every stated value that the data do not exclude is a prior."""
    alone = identified_at(solution, names)
    white = np.sqrt(np.diag(solution.covariance_cr)[N:])
    if all(x.instrument.stated is None or x.found.contradicts for x in alone):
        return InstrumentFit(solution, alone)
    kept, reset = [], best
    for one, white_std in zip(alone, white, strict=True):
        x, found = one
        share = min(1.0, float(white_std) / found.std)
        if x.prior is not None:
            kept.append(one._replace(instrument=weighed(x, share)))
        elif x.stated is None or found.contradicts:
            kept.append(one)
        elif x.known_to * abs(x.stated) > 0.0:
            # A statement is trusted no better than the data confirm it.
            width = max(x.known_to * abs(x.stated), abs(found.told - x.stated))
            kept.append(one._replace(instrument=replace(x, prior=Prior(x.stated, width, share))))
        else:
            reset = _at(x.write(reset.problem, x.stated), reset) or reset
    names = tuple(one.instrument for one in kept)
    final = _solution(_descend(reset, names), names)
    return InstrumentFit(plain) if final is None else InstrumentFit(final, refreshed(kept, final))


def refreshed(identified: Sequence[Identified], solution: Solution) -> tuple[Identified, ...]:
    """Return the instruments with the values and errors of another solution. Findings about stated values
    stay."""
    now = identified_at(solution, [x.instrument for x in identified])
    return tuple(
        there
        if x.instrument.stated is None
        else x._replace(found=replace(x.found, value=there.found.value, std=there.found.std))
        for x, there in zip(identified, now, strict=True)
    )


def _looked_about(begin: _Fit, names: Sequence[Instrument]) -> _Fit:
    """Return the best of the starts of each instrument, one instrument after the other.

    The posterior of a lag may have a second, lower peak at a third of the lag. A measured surface, whose
    stated lag is zero, has none."""
    best = begin
    for x in names:
        near, here = best, best.problem
        for start in x.starts if x.stated != 0.0 else ():
            near = _at(x.write(here, start), near, ROUGHLY) or near
            best = min(best, near, key=lambda fit: fit.cost(names))
    return best


def _stayed(fit: _Fit, _: Sequence[Instrument]) -> _Fit:
    return fit


def _descend(best: _Fit, names: Sequence[Instrument]) -> _Fit:
    """Minimise the cost over the instruments by Gauss-Newton, with everything else refitted at each step.

    The start is not kept: of hundreds of manoeuvres it is tens of megabytes.
    """
    for _ in range(ROUNDS if names else 0):
        step, promised = _step(best, names)
        if promised < SETTLED:
            break
        found = None
        for _ in range(5):
            found = _at(moved_by(step, best.problem, names), best)
            if found is not None and found.cost(names) < best.cost(names):
                break
            step, found = step / 4.0, None
        if found is None:
            break
        gain, best = best.cost(names) - found.cost(names), found
        if gain < SETTLED:
            break
    return best


def _step(fit: _Fit, names: Sequence[Instrument]) -> tuple[FloatArray, float]:
    """Return the Gauss-Newton step of the instruments with everything else free, shape (k,).

    Instruments that the step would move out of their ranges go to the end of them, and the others follow. The
    second value is the change of -2 log of the posterior that the quadratic model promises.
    """
    optimum = fit.optimum
    extra = extra_of(fit.problem, fit.assembly, optimum.shared, optimum.local, names)
    effect = influence(fit.assembly, optimum.sensitivities, optimum.noise, extra)
    if effect is None:
        return np.zeros(len(names)), 0.0
    step = effect.step(fit.assembly.z - optimum.fitted, extra)[N:]
    information = np.asarray(np.linalg.pinv(effect.extra_covariance, hermitian=True), np.float64)
    slope, now = information @ step, np.array([x.read(fit.problem) for x in names])
    least, most = np.array([(x.lowest, x.highest) for x in names]).T - now
    allowed = solved_within(information, slope, least, most)
    return allowed, float(allowed @ (2.0 * slope - information @ allowed))


def _at(problem: OutputErrorProblem, near: _Fit, flat: float = CLOSE_ENOUGH) -> _Fit | None:
    begin = (near.optimum.shared, near.optimum.local)
    assembly, optimum = search(problem, begin=begin, flat=flat)
    return _Fit(problem, assembly, optimum) if optimum.status == CONVERGED else None


def identified_at(solution: Solution, names: Sequence[Instrument]) -> tuple[Identified, ...]:
    """Return values and errors of instruments in a solution whose first extra columns are theirs."""
    std = np.sqrt(np.diag(solution.widened)[N : N + len(names)])
    return tuple(_identified(x, solution.problem, float(s)) for x, s in zip(names, std, strict=True))


def _identified(x: Instrument, problem: OutputErrorProblem, std: float) -> Identified:
    value, off = x.read(problem), False
    if x.prior is not None:
        # Sound instruments all lie within the prior; a servo's lag with a prior was told by other manoeuvres.
        odd = abs(value - x.prior.mean) > CONTRADICTS * float(np.hypot(std, x.prior.std))
        off = odd and x.name == "command_delay_s"
    elif x.stated is not None:
        apart = abs(value - x.stated)
        excluded = apart > CONTRADICTS * float(np.hypot(std, x.known_to * x.stated))
        off = excluded and not x.at_end(problem, std)
    return Identified(x, InstrumentEstimate(x.name, value, std, x.stated, value, std, off))


def _solution(fit: _Fit, names: Sequence[Instrument]) -> Solution | None:
    extra = extra_of(fit.problem, fit.assembly, fit.optimum.shared, fit.optimum.local, names)
    found = evaluate(*fit, extra)
    return found if isinstance(found, Solution) else None
