"""Detection of a change of the aircraft or of an instrument between manoeuvres.

Noise moves every estimate within its interval. A bad manoeuvre moves one estimate only. A change moves all
later estimates equally. For every possible moment, the manoeuvres before and after are pooled and compared by
a likelihood-ratio test. The test uses the derivatives only, because Z_0 and M_0 change with the trim.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.special import chdtri

from advisor.aircraft.aircraft import CampaignPlan
from advisor.aircraft.reference import SIDE_PARAMETERS, SPEED_EXPONENTS
from advisor.decision.history import CandidateManeuver
from advisor.decision.information import USUAL, outliers
from advisor.decision.pooling import (
    Pooled,
    Posterior,
    Shared,
    derivatives_of,
    disagreement,
    information_of,
    pooled,
    pooled_on_both_sides,
    posteriors_at_one_speed,
)
from advisor.process.arrays import FloatArray
from advisor.words.quantities import symbol

FALSE_ALARM = 1e-5
"""Probability of a false alarm in one comparison. A campaign makes a few dozen comparisons, which are not
independent."""
CONSISTENCY = 1e-3
"""Probability below which the manoeuvres on one side of a change contradict each other."""
LEAST_SIGMA = 3.0
"""Least difference of a derivative, in standard deviations, that is reported as a change."""
LEAST_SHARE = 0.08
"""Least difference of a derivative, as a share of its value, that is reported as a change. Repeated estimates
of one aircraft always differ by a few per cent."""
UNEVEN = 0.03
"""Largest relative deviation of a derivative from a cause's common factor, for which the cause explains
it."""


@dataclass(frozen=True, slots=True)
class Moved:
    """One derivative before and after a change of the aircraft."""

    parameter: str
    percent: float
    sigma: float
    """Difference of the derivative divided by its standard deviation."""


@dataclass(frozen=True, slots=True)
class Change:
    """A change between two manoeuvres, with its moment, its derivatives and its likely cause."""

    after: int
    """Number of the last manoeuvre before the change, counting from 1 in the order flown."""
    confirmed: bool
    """Whether at least two manoeuvres show the change. A single manoeuvre may be a bad one instead."""
    moved: tuple[Moved, ...]
    """Derivatives that changed, the most significant first."""
    looks_like: str
    """Simplest cause that explains all changed derivatives, in words; empty without one."""
    sentence: str


def find_change(history: Sequence[CandidateManeuver], plan: CampaignPlan = USUAL) -> Change | None:
    """Return the most significant change between a campaign's manoeuvres; None if noise explains all
    differences.

    At least two manoeuvres must lie before the change. With only one manoeuvre on a side, that manoeuvre may
    be an outlier.
    """
    flown = [(i, e) for i, m in enumerate(history, start=1) if (e := m.usable)]
    posteriors = posteriors_at_one_speed([e for _, e in flown])
    excluded = [k for k in outliers(posteriors, plan) if k < len(posteriors) - 1]
    numbers = [i for k, (i, _) in enumerate(flown) if k not in excluded]
    posteriors = [posterior for k, posterior in enumerate(posteriors) if k not in excluded]
    if len(posteriors) < 3:
        return None
    splits = pooled_on_both_sides(posteriors)[1:]
    apart = [_compare(before, after) for before, after in splits]
    k = int(np.argmax(apart))
    if apart[k] <= 1.0:
        return None
    first, second = splits[k]
    k += 2
    widening = _widening(first, second)
    names = derivatives_of(posteriors[0].names)
    moved = _moved(first.shared, second.shared, widening, names)
    if not moved or _back_to_normal(first, posteriors[k:]):
        return None
    looks_like = _simplest_cause(first, second, names)
    return _told(numbers[k - 1], numbers[k], len(posteriors) > k + 1, moved, looks_like)


def _compare(before: Pooled, after: Pooled) -> float:
    """Return the statistical distance between both sides, over its limit. Noise explains values up to 1."""
    distance, dof = disagreement(before.shared, after.shared)
    if dof == 0:
        return 0.0
    return distance / _widening(before, after) / float(chdtri(dof, FALSE_ALARM))


def _widening(before: Pooled, after: Pooled) -> float:
    """Return the ratio of the scatter within both sides to the stated variances, at least 1."""
    dof = before.dof + after.dof
    return max(1.0, (before.inconsistency + after.inconsistency) / dof) if dof > 0 else 1.0


def _back_to_normal(before: Pooled, after: Sequence[Posterior]) -> bool:
    """Return whether the newest manoeuvre agrees with the manoeuvres before the change. If so, the manoeuvres
    between were bad.
    """
    if len(after) < 2:
        return False
    with_old, dof = disagreement(before.shared, after[-1].shared)
    with_new, _ = disagreement(pooled(after[:-1]).shared, after[-1].shared)
    return with_old < with_new or pooled(after).inconsistency > with_old + float(chdtri(dof, CONSISTENCY))


def _kinematics(names: Sequence[str]) -> FloatArray:
    """Return the kinematic term of each derivative's equation: 1 for the pitch rate in α̇, else 0."""
    return np.array([1.0 if name == "Z_q" else 0.0 for name in names])


def _moved(before: Shared, after: Shared, widening: float, names: Sequence[str]) -> tuple[Moved, ...]:
    apart = []
    for k, (name, value) in enumerate(zip(names, before.theta + _kinematics(names), strict=True)):
        difference = after.theta[k] - before.theta[k]
        std = np.sqrt(widening * (before.covariance[k, k] + after.covariance[k, k]))
        size = abs(value)
        if 0.0 < LEAST_SIGMA * std < abs(difference) and 0.0 < LEAST_SHARE * size < abs(difference):
            percent = 100.0 * difference / size * np.sign(value)
            apart.append(Moved(name, float(percent), float(difference / std)))
    return tuple(sorted(apart, key=lambda m: -abs(m.sigma)))


# Each cause multiplies coefficients by powers of one factor, and 1 + Z_q in the place of Z_q. Shifts of the
# aircraft come first, then controls and air. An instrument reads (1 + k) times the truth (substitute the
# reading in the equations of motion).
_CAUSES = (
    ("a shift of the centre of gravity", {"M_alpha": 1}),
    ("a loss or gain of lift, as from ice on the wing", {"Z_alpha": 1}),
    (
        "weaker lift, stiffness and control together, as from ice on wing and tail",
        {"Z_alpha": 1, "Z_delta_e": 1, "M_alpha": 1, "M_delta_e": 1},
    ),
    ("another mass", {"Z_alpha": 1, "Z_delta_e": 1, "M_alpha": 1, "M_q": 1, "M_delta_e": 1}),
    ("a loss of the elevator's moment", {"M_delta_e": 1}),
    ("the elevator's effectiveness or its calibration", {"Z_delta_e": 1, "M_delta_e": 1}),
    ("the scale of the angle of attack", {"Z_q": 1, "Z_delta_e": 1, "M_alpha": -1}),
    ("the scale of the pitch rate", {"Z_q": -1, "M_alpha": 1, "M_delta_e": 1}),
    ("another stability in yaw, as from a shift of the centre of gravity", {"N_beta": 1}),
    ("a smaller or larger fin", {"Y_beta": 1, "N_beta": 1, "N_r": 1}),
    (
        "another moment of inertia in roll, as from tanks in the wing",
        {name: 1 for name in SIDE_PARAMETERS if name.startswith("L")},
    ),
    ("the aileron's effectiveness or its calibration", {f"{y}_delta_a": 1 for y in "YLN"}),
    ("the rudder's effectiveness or its calibration", {f"{y}_delta_r": 1 for y in "YLN"}),
    ("another air speed than recorded", SPEED_EXPONENTS),
)
"""Powers of a cause's factor for each derivative, by the cause's name, for either axis."""


def _simplest_cause(before: Pooled, after: Pooled, names: Sequence[str]) -> str:
    """Return the simplest cause that explains all differences of the derivatives; empty without one."""
    determined = int(np.sum(np.isfinite(before.shared.theta + after.shared.theta)))
    added = _kinematics(names)
    misfits = {
        cause: _misfit(before.shared, after.shared, np.array([float(powers.get(n, 0)) for n in names]), added)
        for cause, powers in _CAUSES
        if any(name in powers for name in names)
    }
    best = min(misfits, key=lambda cause: misfits[cause])
    limit = _widening(before, after) * float(chdtri(max(determined - 1, 1), CONSISTENCY))
    return best if misfits[best] < limit else ""


def _misfit(before: Shared, after: Shared, powers: FloatArray, added: FloatArray) -> float:
    """Return the remaining χ² after ``before`` is multiplied by the best factor to these powers."""
    determined = np.isfinite(before.theta + after.theta)
    start, target = (np.where(determined, side.theta + added, 0.0) for side in (before, after))
    uneven = np.diag((UNEVEN * target) ** 2)
    exponent = 0.0
    for _ in range(20):
        factors = np.exp(exponent * powers)
        information = information_of(
            after.covariance + before.covariance * np.outer(factors, factors) + uneven
        )
        slope, residual = powers * start * factors, target - start * factors
        curvature = float(slope @ information @ slope)
        if not curvature > 0.0:
            return float("inf")
        exponent = float(np.clip(exponent + slope @ information @ residual / curvature, -1.5, 1.5))
    residual = target - start * np.exp(exponent * powers)
    return float(residual @ information @ residual)


def _told(last: int, first: int, confirmed: bool, moved: tuple[Moved, ...], looks_like: str) -> Change:
    what = ", ".join(f"{symbol(m.parameter)} {m.percent:+.0f} % ({abs(m.sigma):.0f} sigma)" for m in moved)
    cause = f"; it looks like {looks_like}" if looks_like else ""
    if confirmed:
        sentence = (
            f"Something changed after manoeuvre {last}: {what}{cause}. "
            f"Exclude the manoeuvres up to {last} to go on with the aircraft as it is now."
        )
    else:
        sentence = (
            f"Manoeuvre {first} does not fit the earlier ones: {what}{cause}. "
            "It was a poor manoeuvre, or something changed; one more will tell."
        )
    return Change(last, confirmed, moved, looks_like, sentence)
