"""Start of the search: a linear regression of the integrated equations.

Integrated from the first stamp, Eqs. (1)-(2) read

    α(t) = α(0) + Z_0·t + Z_α·∫α + (1 + Z_q)·∫q + Z_δe·∫δe

and equally for q. The integrated equations are linear in the parameters and the initial states, and
integration averages the noise. This is the integral form of the equation-error method (Klein & Morelli, Ch.
5). Each integrated equation is regressed at the stamps of its left side. The derivatives are common to all
manoeuvres; constants and initial states belong to single manoeuvres.
"""

import numpy as np

from advisor.flight.signals.derived_alpha import integrated
from advisor.model.outputs import N_LOCAL, N_SHARED
from advisor.oem.problem import OutputErrorProblem, Record
from advisor.oem.regression import Equations, regressed
from advisor.oem.rows import Signal, finite
from advisor.process.arrays import FloatArray


def start(
    problem: OutputErrorProblem, *, lift_from_alpha_only: bool = False
) -> tuple[FloatArray, FloatArray]:
    """Return shared (7,) and local (m, 7) parameters for the start of a search.

    Parameters
    ----------
    lift_from_alpha_only : regress Eq. (1) with Z_q = Z_δe = 0. These two are small and correlated with
        Z_α. If the model is not exact (a late angle of attack, an unknown servo), a free regression can lead
        to a wrong minimum.

    The values are always finite; a record without information has a least-norm solution.
    """
    if any("alpha" not in record.outputs for record in problem.records):
        return _from_force(problem)
    local = np.zeros((len(problem.records), N_LOCAL))
    shared = np.zeros(N_SHARED)
    for output, first in (("alpha", 0), ("q", 1)):
        moment = output == "q"
        parts = _equations(problem, output)
        if lift_from_alpha_only and not moment:
            parts = [Equations(p.common[:, :1], p.side - p.common[:, 1], p.own) for p in parts]
        theta, own = regressed(parts)
        if moment:
            shared[3:6] = theta
        elif lift_from_alpha_only:
            shared[0] = theta[0]
        else:
            shared[0:3] = theta
            shared[1] -= 1.0
        local[:, [2 + first, first]] = own
    for m, record in enumerate(problem.records):
        if "theta" in record.outputs:
            local[m, 4] = finite(record.outputs["theta"]).y[0]
    return shared, local


def _equations(problem: OutputErrorProblem, output: str) -> list[Equations]:
    """Return the integrated equation of ``alpha`` or ``q`` of each record, for a regression."""
    moment, parts = output == "q", []
    for record in problem.records:
        side = finite(record.outputs["q"] if moment else record.alpha)
        common, constants = _regressors(record, problem, side.t, moment)
        parts.append(Equations(common, side.y, constants))
    return parts


def _from_force(problem: OutputErrorProblem) -> tuple[FloatArray, FloatArray]:
    """Return the start without a measured angle of attack, with Z_q = Z_δe = 0.

    Specific force is aerodynamic: n = a_z/V = Z_0 + Z_α·α. In Eq. (2) n replaces α with the factor M_α/Z_α,
    because an inferred α does not show moving air. The slope of n over the inferred α is Z_α; a parabola in
    time removes the drift of α.
    """
    shared, local = np.zeros(N_SHARED), np.zeros((len(problem.records), N_LOCAL))
    moments, slopes, forces, levels = [], [], [], []
    for record in problem.records:
        q, force = finite(record.outputs["q"]), finite(record.outputs["a_z"])
        surface, ratio = problem.servo.signal(record.command), _ratio(record, problem, q.t)
        begin = float(q.t[0])
        n = force if record.airspeed is None else Signal(force.t, force.y / record.airspeed.at(force.t))
        columns = [
            _integral(Signal(x.t, x.y * ratio.at(x.t) ** power), begin, q.t)
            for x, power in ((n, 1), (q, 1), (surface, 2))
        ]
        constants = np.column_stack([np.ones(len(q.t)), _integral(Signal(ratio.t, ratio.y**2), begin, q.t)])
        moments.append(Equations(np.column_stack(columns), q.y, constants))
        alpha, lift = record.alpha.at(n.t), n.y / ratio.at(n.t)
        drift = np.vander((n.t - n.t.mean()) / max(float(np.ptp(n.t)), 1e-9), 3)
        free = np.linalg.pinv(drift)
        slopes.append(alpha - drift @ (free @ alpha))
        forces.append(lift - drift @ (free @ lift))
        levels.append((float(np.mean(lift)), float(np.mean(alpha)), float(alpha[0])))
    (stiffness, damping, control), own = regressed(moments)
    moved, lifted = np.concatenate(slopes), np.concatenate(forces)
    z_alpha = min(float(moved @ lifted) / max(float(moved @ moved), 1e-300), 0.0)
    shared[[0, 3, 4, 5]] = z_alpha, stiffness * z_alpha, damping, control
    for m, ((initial, constant), (lift_mean, alpha_mean, alpha_first)) in enumerate(
        zip(own, levels, strict=True)
    ):
        z_0 = lift_mean - z_alpha * alpha_mean
        local[m, :4] = z_0, constant + stiffness * z_0, alpha_first, initial
    return shared, local


def _ratio(record: Record, problem: OutputErrorProblem, t: FloatArray) -> Signal:
    """Return the air speed over the reference speed; 1 if the derivatives do not scale with speed."""
    if record.airspeed is None or problem.reference_airspeed_m_s is None:
        return Signal(t, np.ones(len(t)))
    return Signal(record.airspeed.t, record.airspeed.y / problem.reference_airspeed_m_s)


def _regressors(
    record: Record, problem: OutputErrorProblem, t: FloatArray, moment: bool
) -> tuple[FloatArray, FloatArray]:
    """Return the integrals of α, q, δe from the record's first stamp to ``t``, shape (n, 3), and of 1 and s,
    shape (n, 2)."""
    alpha, q = finite(record.alpha), finite(record.outputs["q"])
    surface = problem.servo.signal(record.command)
    begin = min(signal.t[0] for signal in record.outputs.values())
    ratio = _ratio(record, problem, t)
    powers = (2, 1, 2, 2) if moment else (1, 0, 1, 1)
    columns = [
        _integral(Signal(x.t, x.y * ratio.at(x.t) ** power), begin, t)
        for x, power in zip((alpha, q, surface, Signal(t, np.ones(len(t)))), powers, strict=True)
    ]
    return np.column_stack(columns[:3]), np.column_stack([np.ones(len(t)), columns[3]])


def _integral(x: Signal, begin: float, t: FloatArray) -> FloatArray:
    """Return ∫ x from ``begin`` to each of ``t``, the samples joined by lines."""
    total = integrated(x.t, x.y)

    def upto(times: FloatArray) -> FloatArray:
        i = np.clip(np.searchsorted(x.t, times, side="right") - 1, 0, len(x.t) - 1)
        return total[i] + (times - x.t[i]) * (x.y[i] + x.at(times)) / 2.0

    return np.asarray(upto(t) - upto(np.array([begin])))
