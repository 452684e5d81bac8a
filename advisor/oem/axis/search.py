"""Output-error estimation of an axis: derivatives, errors and identifiability.

A white-noise model makes
coloured residuals look too accurate relative to a prior. A first fit gives the colour of the noise. The
second and third fit weight the priors by the noise colour of the fit before. A search that continues an
earlier one has its noise colour, and needs one fit.
"""

from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from typing import NamedTuple

import numpy as np

from advisor.flight.maneuvers.excitation import external_share
from advisor.model.axis import Axis
from advisor.oem.axis.motion import AxisMotion
from advisor.oem.axis.parameter import FIRST_LAG_S, Parameter, begun
from advisor.oem.axis.problem import AxisProblem
from advisor.oem.axis.start import starting_point
from advisor.oem.descent import Fit, descended
from advisor.oem.driven_motion.estimate import driven
from advisor.oem.driven_motion.setting import Noise
from advisor.oem.estimate import NoEstimate
from advisor.oem.evaluation import share_of
from advisor.oem.identifiability import LARGEST_ERROR
from advisor.oem.prior import Priors
from advisor.oem.profile import Posterior, profiled
from advisor.oem.solution import RUNS_AWAY, Solution, evaluate, refused
from advisor.process.arrays import FloatArray
from advisor.words.quantities import NORMAL_95

FIRST_LOOK = 8
"""Iterations of the first fit, whose residuals give the first colour of the noise. With servos and clocks
fixed, a longer search may leave physical values. In a rudder doublet L_p of -10 1/s became -220 1/s."""
SAME = 0.01
"""Numerical: second moment between two optima, as a share of the bound, at which both are one hill.
The search for the second one ends at a promised decrease of this size."""
WITHOUT_FORCE = (
    "neither a lateral acceleration nor a sideslip was recorded, so only the modes are known; record a_y"
)


class Searched(NamedTuple):
    """Solution of a search."""

    solution: Solution
    still: Solution
    """Solution whose errors contain the instruments' noise alone."""
    noise: Noise | None
    """Noise of instruments and unknown forces; None without unknown forces."""
    merged: bool
    """Whether the search from the other hill ends at this solution."""


class Near(NamedTuple):
    """The search of earlier records of one aircraft."""

    searched: Searched
    places: Sequence[int | None]
    """Index of each record of a problem among the earlier records; None for a new record."""


def solve(problem: AxisProblem, nuisances: Sequence[Parameter] = ()) -> Solution | NoEstimate:
    """Estimate the derivatives of a problem; ``nuisances`` are estimated with them."""
    searched = search(problem, nuisances)
    return searched if isinstance(searched, NoEstimate) else searched.solution


def search(
    problem: AxisProblem, nuisances: Sequence[Parameter], near: Near | None = None
) -> Searched | NoEstimate:
    """Estimate the derivatives of a problem.

    Parameters
    ----------
    nuisances : servos and clocks that are estimated with the derivatives.
    near : search of earlier records of one aircraft, which this search continues.
    """
    problem, motion, n = begun(problem, nuisances), AxisMotion(problem.axis), len(problem.axis.shared)
    start = _holding(problem, starting_point(problem))
    prior = priors_of(problem, start[0])
    resumed = None if near is None else _resumed(problem, nuisances, start[1], near)
    # One hill of earlier records stays one with further records.
    merged = resumed is not None and near is not None and near.searched.merged
    if resumed is None:
        fit = descended(motion, problem, (), prior, start, FIRST_LOOK)
        if not isinstance(fit, NoEstimate) and _has_diverged(fit):
            # A regression without a side force may begin with an aircraft that rolls away.
            fit = descended(motion, problem, (), prior, fit.place)
            start = start if isinstance(fit, NoEstimate) else fit.place
        if isinstance(fit, NoEstimate) or _has_diverged(fit):
            return RUNS_AWAY
        solution = _evaluated(fit, prior, final=False)
    else:
        problem, start, solution = resumed
    for final in (True,) if resumed else (False, True):
        if isinstance(solution, NoEstimate):
            return solution
        share = share_of(solution.covariance_cr[:n, :n], solution.scattered[:n, :n])
        prior = replace(prior, share=share)
        weighed = [replace(x, prior=replace(x.prior, share=share)) for x in nuisances]
        fit = descended(motion, problem, weighed, prior, start)
        if isinstance(fit, NoEstimate):
            return fit
        if (why := refused(fit.optimum)) is not None:
            return why
        problem, start = fit.problem, fit.place
        best, modes = _of_both_hills(fit, weighed, prior) if final and not merged else (fit, None)
        solution = _evaluated(best, prior, final)
    if isinstance(solution, NoEstimate):
        return solution
    merged = merged if modes is None else bool(np.all(np.diag(modes - SAME * solution.covariance_cr) <= 0.0))
    for lag in (x for x in weighed if x.entry == "lag_s"):
        with_modes = replace(solution, modes=modes)
        modes = profiled(with_modes, lag, Posterior(weighed, share), partial(_refitted, prior)).modes
    solution = _with_modes(solution, prior, modes)
    noise = None if near is None else near.searched.noise
    forces = driven(solution, motion, nuisances, lambda *_: replace(prior, share=1.0), near=noise)
    answer = solution if forces is None else _with_modes(_above_bound(forces.solution), prior, modes)
    return Searched(answer, solution, forces and forces.noise, merged)


def _with_modes(solution: Solution, prior: Priors, other: FloatArray | None) -> Solution:
    """Return the solution with another mode's second moment, and with the errors by controls that follow.

    Dynamics that the model lacks also move a control that follows the motion. A fit that takes a yaw damper's
    rudder for a cause counts a part of the damper as the aircraft's own damping. Only the control's external
    part and the prior determine the control's derivatives. Errors correlated with theirs grow accordingly.
    """
    covariance, records, axis = solution.scattered, solution.problem.records, solution.problem.axis
    total = np.zeros_like(covariance) if other is None else other.copy()
    for control, (rate, moment) in axis.follows.items():
        pairs = [
            (record.inputs[control], record.outputs[rate]) for record in records if control in record.inputs
        ]
        share = external_share(pairs, solution.theta[axis.names.reported.index(moment)])
        for j in (k for k, term in enumerate(axis.shared) if term.factor == control):
            stated = prior.std[j] ** -2
            if (variance := covariance[j, j]) > 0.0 and (gained := 1.0 / variance - stated) > 0.0:
                more = 1.0 / (share * gained + stated) - variance
                total += more * np.outer(covariance[j], covariance[j]) / variance**2
    return replace(solution, modes=total)


def _of_both_hills(fit: Fit, nuisances: Sequence[Parameter], prior: Priors) -> tuple[Fit, FloatArray | None]:
    """Return the likelier of two fits, with the other one's second moment times its probability.

    An unknown lag of the aileron and the time constant of the roll mode act on the roll rate alike. If both
    are exchanged, the roll rate after an aileron input is unchanged. Only yaw and the rudder distinguish the
    two fits.
    """
    axis = fit.problem.axis
    lag = next((x for x in nuisances if x.entry == "lag_s" and x.place[0] in axis.rivals), None)
    if lag is None or lag.read(fit.problem) <= FIRST_LAG_S:
        return fit, None
    damping = next(k for k, term in enumerate(axis.shared) if term.name == axis.rivals[lag.place[0]])
    roll = -float(fit.optimum.shared[damping])
    if roll <= 0.0:
        return fit, None
    shared = fit.optimum.shared.copy()
    own = [term.state == axis.shared[damping].state for term in axis.shared]
    shared[own] /= roll * lag.read(fit.problem)
    there, start = lag.write(fit.problem, 1.0 / roll), _holding(fit.problem, (shared, fit.optimum.local))
    rival = descended(AxisMotion(axis), there, nuisances, prior, start, settled=SAME)
    if isinstance(rival, NoEstimate) or refused(rival.optimum) is not None:
        return fit, None
    lower, moment = Posterior(nuisances, lag.prior.share).apart(fit, rival)
    return fit if lower >= 0.0 else rival, moment


def _refitted(
    prior: Priors, nuisances: Sequence[Parameter], problem: AxisProblem, near: Fit | Solution
) -> Fit | None:
    """Return the fit near another one; None where the search fails."""
    motion = AxisMotion(problem.axis)
    fit = descended(motion, problem, nuisances, prior, (near.optimum.shared, near.optimum.local))
    return None if isinstance(fit, NoEstimate) or refused(fit.optimum) else fit


def _holding(problem: AxisProblem, place: tuple[FloatArray, FloatArray]) -> tuple[FloatArray, FloatArray]:
    """Return a place with the derivatives that the user holds at their values."""
    shared = place[0].copy()
    for name, value in problem.fixed.items():
        shared[problem.axis.names.shared.index(name)] = value
    return shared, place[1]


def _resumed(
    problem: AxisProblem, nuisances: Sequence[Parameter], local: FloatArray, near: Near
) -> tuple[AxisProblem, tuple[FloatArray, FloatArray], Solution] | None:
    """Return problem and place at the servos, clocks and derivatives of another solution, and that solution.

    ``local`` (m, l) are the local parameters of records that are new to the other solution. None where the
    other solution has other servos or clocks.
    """
    there = near.searched.still
    values = {x.name: x.read(there.problem) for x in there.parameters}
    if values.keys() != {x.name for x in nuisances}:
        return None
    for x in nuisances:
        problem = x.write(problem, values[x.name])
    pairs = zip(near.places, local, strict=True)
    local = np.array([own if k is None else there.optimum.local[k] for k, own in pairs])
    return problem, (there.optimum.shared, local), there


def _has_diverged(fit: Fit) -> bool:
    """Return whether a fit explains the outputs worse than a constant does."""
    z, channel, noise = fit.assembly.z, fit.assembly.channel, fit.optimum.noise
    least = fit.assembly.least
    each = ((z[channel == c], least[c], noise[c]) for c in np.unique(channel))
    gain = sum(len(y) * float(np.log(max(float(np.std(y)), floor) / left)) for y, floor, left in each)
    return not gain >= 0.0


def _evaluated(fit: Fit, prior: Priors, final: bool) -> Solution | NoEstimate:
    """Return the solution at a fit, with errors for instruments of coloured noise."""
    at = fit.problem, fit.assembly, fit.optimum, fit.extra
    solution = evaluate(*at, prior=prior, parameters=fit.nuisances, final=final)
    return solution if isinstance(solution, NoEstimate) else _above_bound(solution)


def _above_bound(solution: Solution) -> Solution:
    """Return the solution with no error below the bound, because instruments have a noise floor."""
    bound, stated = np.diag(solution.covariance_cr), np.diag(solution.covariance)
    ratio = np.divide(bound, stated, out=np.ones_like(stated), where=stated > 0.0)
    factor = np.sqrt(np.maximum(ratio, 1.0))
    return replace(solution, covariance=solution.covariance * np.outer(factor, factor))


def priors_of(problem: AxisProblem, theta: FloatArray) -> Priors:
    """Return the priors of the axis, for derivatives near ``theta`` (s,)."""
    axis = problem.axis
    if axis.prior is None:
        return Priors(np.zeros(len(theta)), np.full(len(theta), np.inf))
    flown = [name for name in axis.inputs if problem.flies(name)]
    return Priors(*axis.prior(theta, flown, problem.tells_force, problem.mean_airspeed_m_s))


def not_identifiable(solution: Solution) -> dict[str, str]:
    """Return the reason why a derivative has no usable value, by the derivative's name."""
    problem, axis = solution.problem, solution.problem.axis
    if axis.hidden and not problem.tells_force:
        return dict.fromkeys(axis.names.reported, WITHOUT_FORCE)
    reasons: dict[str, str] = {}
    missing = [name for name in axis.inputs if not problem.flies(name)]
    there = [name for name in axis.inputs if any(name in r.inputs for r in problem.records)]
    for name in missing:
        moved = f"moved by {np.degrees(problem.motion(name)):.1f} deg only"
        text = (
            f"the {name} {moved if problem.moves(name) else 'did not move'}; fly {axis.inputs_to_fly[name]}"
        )
        text = text if name in there else f"no output of the {name} is known"
        of_it = (term.name for term in axis.shared if term.factor == name)
        reasons |= {derivative: text for derivative in of_it if derivative not in problem.fixed}
    fly = [axis.inputs_to_fly[name] for name in there if name in missing or not {*there} & {*missing}]
    advice = " and ".join(fly)
    reasons |= {
        name: f"the record does not depend on it; fly {advice}"
        for name in solution.influence.unresolved
        if name not in reasons
    }
    # Another manoeuvre does not help against dynamics that the model lacks: they are no want of excitation.
    std = np.sqrt(np.diag(solution.scattered))
    for name, size in axis.natural_size(solution.theta).items():
        error = float(std[axis.names.reported.index(name)])
        if name not in reasons and not error <= _largest_error(axis, name) * size:
            reasons[name] = (
                f"its error ±{NORMAL_95 * error:.2g} is too large for the size of such a"
                f" derivative here ({size:.2g}); fly {advice}"
            )
    return reasons


def _largest_error(axis: Axis, name: str) -> float:
    """Return the largest usable standard deviation of a derivative, as a share of its natural size.

    The data determine a derivative with a prior only if its error is clearly below the prior's.
    """
    return LARGEST_ERROR * axis.weak.get(name, 1.0)
