"""The course of trims, offsets and derivatives over a flight: a drift or a step between manoeuvres.

Every manoeuvre has its own trims and offsets, which absorb a slow change. The change shows between the
manoeuvres.
"""

from collections.abc import Mapping, Sequence

import numpy as np

from advisor.flight.signals.messages import FloatArray
from advisor.gap.fitting.fit import EffectFit
from advisor.gap.fitting.problem import EffectProblem
from advisor.gap.fitting.step import own_eliminated
from advisor.gap.simulator.layout import DERIVATIVES, NUISANCES

LEAST_MANEUVERS = 5
"""Record: least number of manoeuvres for a course: a step has two levels and a place, a drift two
parameters."""
_BLOCKS = {
    "Z_trim": "force_equation", "M_trim": "moment_equation", "a_z": "accelerometer",
    "theta": "attitude_sensor", "Z_alpha": "force_equation", "M_alpha": "moment_equation",
    "M_q": "moment_equation", "M_delta_e": "input",
}  # fmt: skip
"""Block that each trim term, offset and derivative speaks of."""


def courses_of(problem: EffectProblem, fitted: EffectFit) -> dict[str, FloatArray]:
    """Return trims, offsets and single estimates by manoeuvre, each of shape (manoeuvres,), SI.

    The estimate of a derivative is the step that the manoeuvre alone would make from the joint estimate.
    """
    offsets = [channel for channel in ("a_z", "theta") if channel in problem.channels]
    names = [*NUISANCES, *offsets, *DERIVATIVES]
    rows = []
    for block, own in zip(fitted.linear, fitted.point.own, strict=True):
        inner, follow = own_eliminated(block, 1.0 / fitted.noise)
        still = follow[: len(NUISANCES) + len(offsets), -1]
        n = len(DERIVATIVES)
        alone = inner[:n, -1] / np.maximum(np.diag(inner)[:n], 1e-300)
        rows.append([*(own + still[: len(own)]), *still[len(own) :], *alone])
    return dict(zip(names, np.array(rows).T, strict=True))


def drift_and_step(
    courses: Mapping[str, FloatArray], times_s: Sequence[float]
) -> dict[str, tuple[float, float]]:
    """Return by block the gain in log likelihood of a drift and of a step, nats; the largest of its courses.

    The scatter of a course is unknown. The gain is therefore n/2 ln of the ratio of the sums of squares, less
    the price of the parameters (Schwarz).
    """
    t = np.asarray(times_s, float)
    found: dict[str, tuple[float, float]] = {}
    if len(t) < LEAST_MANEUVERS:
        return found
    for name, block in _BLOCKS.items():
        if name in courses:
            drift, step = _drift(t, courses[name]), _step(t, courses[name])
            before = found.get(block, (0.0, 0.0))
            found[block] = (max(drift, before[0]), max(step, before[1]))
    return found


def _drift(t: FloatArray, course: FloatArray) -> float:
    line = np.vander((t - t[0]) / max(t[-1] - t[0], 1e-9), 2)
    return _gain(course, course - line @ np.linalg.lstsq(line, course, rcond=None)[0], 1)


def _step(t: FloatArray, course: FloatArray) -> float:
    """Return the gain of the best step that has at least two manoeuvres on either side."""
    ordered = course[np.argsort(t)]
    parts = [np.split(ordered, [k]) for k in range(2, len(t) - 1)]
    left = [np.concatenate([part - np.mean(part) for part in pair]) for pair in parts]
    return max(_gain(course, rest, 2) for rest in left)


def _gain(course: FloatArray, rest: FloatArray, parameters: int) -> float:
    n = len(course)
    before = float(np.sum((course - np.mean(course)) ** 2))
    if before <= 0.0:
        return 0.0
    ratio = max(float(rest @ rest) / before, 1e-6)
    return max(-0.5 * n * float(np.log(ratio)) - 0.5 * parameters * float(np.log(n)), 0.0)
