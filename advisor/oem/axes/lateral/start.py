"""Start of the lateral search: a linear regression of the integrated equations.

The kinematics give the sideslip without its level and drift,

    β̇ = a_y/V + (g/V)·cos θ·sin φ + sin α·p - cos α·r,

from the specific force a_y, or without a_y from the weak guess a_y/V = Y_β·β. The integrated equations of the
rates are linear in the derivatives. This is the integral form of the equation-error method (Klein & Morelli,
*Aircraft System Identification*, Ch. 5).
"""

import numpy as np

from advisor.aircraft.standard_gravity import GRAVITY_M_S2
from advisor.flight.signals.motion import integrated
from advisor.model.axes.lateral import LATERAL
from advisor.oem.axes.lateral.problem import LateralProblem, LateralRecord
from advisor.oem.prior import guessed_y_beta
from advisor.oem.regression import Equations, regressed
from advisor.process.arrays import FloatArray


def lateral_start(problem: LateralProblem) -> tuple[FloatArray, FloatArray]:
    """Return shared (15,) and local (m, 9) parameters for the start of a search.

    The values are always finite; a record without information has a least-norm solution.
    """
    prepared = [_Motion(record, problem) for record in problem.records]
    names = LATERAL.names
    shared = np.zeros(len(names.shared))
    local = np.zeros((len(prepared), len(names.local)))
    for letter in "LN":
        output = {"L": "p", "N": "r"}[letter]
        columns = [k for k, name in enumerate(names.shared) if name.startswith(f"{letter}_")]
        found, own = regressed([Equations(m.integrals(letter), m.signals[output], m.own()) for m in prepared])
        shared[columns] = found
        local[:, names.local.index(f"{letter}_0")] = [coefficients[0] for coefficients in own]
    columns = [k for k, name in enumerate(names.shared) if name.startswith("Y_")]
    forces = [m.force() for m in prepared if m.has_force]
    if forces:
        found, own = regressed(forces)
        kept = np.array([name not in ("Y_p", "Y_r") for name in np.array(names.shared)[columns]])
        shared[columns] = np.where(kept, found, 0.0)
        local[[m.has_force for m in prepared], names.local.index("Y_0")] = [
            coefficients[0] for coefficients in own
        ]
    else:
        shared[columns[0]] = guessed_y_beta(problem)
    for i, motion in enumerate(prepared):
        for state in LATERAL.states:
            local[i, names.local.index(f"{state}_initial")] = motion.signals[state][0]
    return shared, local


def lateral_equations(problem: LateralProblem) -> dict[tuple[str, ...], list[Equations]]:
    """Return the regression equations of all records, by the names of the equation's derivatives."""
    prepared = [_Motion(record, problem) for record in problem.records]
    found = {"Y": [m.force() for m in prepared if m.has_force]}
    for letter, output in (("L", "p"), ("N", "r")):
        found[letter] = [Equations(m.integrals(letter), m.signals[output], m.own()) for m in prepared]
    names = LATERAL.names.shared
    return {tuple(n for n in names if n.startswith(f"{y}_")): parts for y, parts in found.items()}


class _Motion:
    """Signals of one lateral record at the stamps of the roll rate."""

    def __init__(self, record: LateralRecord, problem: LateralProblem) -> None:
        t = record.outputs["p"].t
        self.t = t
        self.speed = record.airspeed.at(t)
        reference = problem.reference_airspeed_m_s
        self.ratio = np.ones(len(t)) if reference is None else self.speed / reference
        self.signals = {name: record.outputs[name].at(t) for name in ("p", "r", "bank")}
        for name in LATERAL.inputs:
            still = name not in record.inputs
            self.signals[name] = (
                np.zeros(len(t)) if still else problem.servo(name).signal(record.inputs[name]).at(t)
            )
        self.has_force = "a_y" in record.outputs
        alpha, theta = record.alpha.at(t), record.theta.at(t)
        turn = GRAVITY_M_S2 / self.speed * np.cos(theta) * np.sin(self.signals["bank"])
        turn += np.sin(alpha) * self.signals["p"] - np.cos(alpha) * self.signals["r"]
        self.force_rate = record.outputs["a_y"].at(t) / self.speed if self.has_force else np.zeros(len(t))
        if "beta" in record.outputs:
            arm = problem.beta_arm_m / self.speed
            self.signals["beta"] = record.outputs["beta"].at(t) - arm * self.signals["r"]
        elif self.has_force:
            self.signals["beta"] = integrated(t, turn + self.force_rate)
        else:
            self.signals["beta"] = _leaking(t, turn, guessed_y_beta(problem))

    def integrals(self, letter: str) -> FloatArray:
        """Return the integrals (n, 5) whose coefficients are the derivatives of one moment."""
        return np.column_stack(
            [
                integrated(self.t, self.ratio**term.power * self.signals[term.factor])
                for term in LATERAL.shared
                if term.name.startswith(f"{letter}_")
            ]
        )

    def own(self) -> FloatArray:
        """Return the manoeuvre's own columns: trim constant, initial rate, drift of β."""
        since = self.t - self.t[0]
        return np.column_stack([integrated(self.t, self.ratio**2), np.ones(len(since)), since**2])

    def force(self) -> Equations:
        """Return the regression equations of Y: five columns, the force per mass and speed, and the
        manoeuvre's own columns."""
        columns = np.column_stack(
            [
                self.ratio**term.power * self.signals[term.factor]
                for term in LATERAL.shared
                if term.name.startswith("Y_")
            ]
        )
        since = self.t - self.t[0]
        return Equations(columns, self.force_rate, np.column_stack([self.ratio, since, since**2]))


def _leaking(t: FloatArray, rate: FloatArray, y_beta: float) -> FloatArray:
    """Return the solution of β̇ = Y_β·β + rate from rest."""
    beta = np.zeros(len(t))
    for i, step in enumerate(np.diff(t)):
        beta[i + 1] = beta[i] + step * (y_beta * beta[i] + 0.5 * (rate[i] + rate[i + 1]))
    return beta
