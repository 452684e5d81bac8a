"""Start of the lateral search: a linear regression of the integrated equations.

The kinematics give the sideslip without its level and drift,

    β̇ = a_y/V + (g/V)·cos θ·sin φ + sin α·p - cos α·r,

from the specific force a_y, or without a_y from the weak guess a_y/V = Y_β·β. The integrated equations of the
rates are linear in the derivatives. This is the integral form of the equation-error method (Klein & Morelli,
*Aircraft System Identification*, Ch. 5). A long record is cut into parts, as in multiple shooting.
"""

from dataclasses import replace

import numpy as np

from advisor.aircraft.standard_gravity import GRAVITY_M_S2
from advisor.flight.signals.motion import integrated
from advisor.model.axes.lateral import LATERAL
from advisor.oem.axes.lateral.problem import LateralProblem, LateralRecord
from advisor.oem.prior import guessed_y_beta
from advisor.oem.regression import Equations, regressed
from advisor.oem.rows import Signal
from advisor.process.arrays import FloatArray

PART_S = 5.0
"""Numerical: length of the parts of a record that have trims of their own in the regression, s. Over 20 s the
drift of a sideslip that is integrated from a noisy force hides a small sideslip."""


def lateral_start(problem: LateralProblem) -> tuple[FloatArray, FloatArray]:
    """Return shared (15,) and local (m, 9) parameters for the start of a search.

    The values are always finite; a record without information has a least-norm solution.
    """
    names = LATERAL.names
    shared, local = np.zeros(len(names.shared)), np.zeros((len(problem.records), len(names.local)))
    has_force = ["a_y" in record.outputs for record in problem.records]
    whole = _equations(problem).values()
    for (columns, parts), records in zip(_equations(_in_parts(problem)).items(), whole, strict=True):
        if parts:
            letter = columns[0][0]
            shared[[names.shared.index(name) for name in columns]] = regressed(parts)[0]
            own = [coefficients[0] for coefficients in regressed(records)[1]]
            local[has_force if letter == "Y" else slice(None), names.local.index(f"{letter}_0")] = own
    shared[[names.shared.index(name) for name in ("Y_p", "Y_r")]] = 0.0
    if not any(has_force):
        shared[names.shared.index("Y_beta")] = guessed_y_beta(problem)
    begun = [_Motion(record, problem).signals for record in problem.records]
    for state in LATERAL.states:
        local[:, names.local.index(f"{state}_initial")] = [signals[state][0] for signals in begun]
    return shared, local


def _in_parts(problem: LateralProblem) -> LateralProblem:
    """Return the problem with each record cut into parts of about ``PART_S``, by its roll rate."""
    parts = []
    for record in problem.records:
        rate = record.outputs["p"]
        cuts = np.array_split(np.array(rate), max(1, round(float(np.ptp(rate.t)) / PART_S)), axis=1)
        parts += [replace(record, outputs={**record.outputs, "p": Signal(*cut)}) for cut in cuts]
    return replace(problem, records=tuple(parts))


def _equations(problem: LateralProblem) -> dict[tuple[str, ...], list[Equations]]:
    """Return the regression equations of all records, by the names of the equation's derivatives."""
    prepared = [_Motion(record, problem) for record in problem.records]
    by_letter = {"Y": [m.force() for m in prepared if m.has_force]}
    for letter, output in (("L", "p"), ("N", "r")):
        by_letter[letter] = [Equations(m.integrals(letter), m.signals[output], m.own()) for m in prepared]
    names = LATERAL.names.shared
    return {tuple(n for n in names if n.startswith(f"{y}_")): parts for y, parts in by_letter.items()}


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
                np.zeros(len(t)) if still else problem.servo(name).signal(record.command(name)).at(t)
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
        return np.column_stack([integrated(self.t, column) for column in self.columns(letter)])

    def columns(self, letter: str) -> list[FloatArray]:
        """Return the factors (n,) of the derivatives of one force or moment."""
        terms = [term for term in LATERAL.shared if term.name.startswith(f"{letter}_")]
        return [self.ratio**term.power * self.signals[term.factor] for term in terms]

    def own(self) -> FloatArray:
        """Return the manoeuvre's own columns: trim constant, initial rate, drift of β."""
        since = self.t - self.t[0]
        return np.column_stack([integrated(self.t, self.ratio**2), np.ones(len(since)), since**2])

    def force(self) -> Equations:
        """Return the regression equations of Y: five columns, the force per mass and speed, and the
        manoeuvre's own columns."""
        since = self.t - self.t[0]
        columns = np.column_stack(self.columns("Y"))
        return Equations(columns, self.force_rate, np.column_stack([self.ratio, since, since**2]))


def _leaking(t: FloatArray, rate: FloatArray, y_beta: float) -> FloatArray:
    """Return the solution of β̇ = Y_β·β + rate from rest."""
    beta = np.zeros(len(t))
    for i, step in enumerate(np.diff(t)):
        beta[i + 1] = beta[i] + step * (y_beta * beta[i] + 0.5 * (rate[i] + rate[i + 1]))
    return beta
