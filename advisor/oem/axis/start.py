"""Start of the search along an axis: a linear regression of the integrated equations.

The known terms of the rates and the recorded specific force give a state that no vane measures, but neither
its level nor its drift. For the sideslip this is

    β̇ = a_y/V + (g/V)·cos θ·sin φ + sin α·p - cos α·r,

or without a_y the weak guess a_y/V = Y_β·β. The integrated equations of the rates are linear in the
derivatives. This is the integral form of the equation-error method (Klein & Morelli, *Aircraft System
Identification*, Ch. 5). A long record is cut into parts, as in multiple shooting.
"""

from dataclasses import replace

import numpy as np

from advisor.flight.signals.derived_alpha import integrated
from advisor.model.axis import CONSTANT, SINE, TURN, Around
from advisor.oem.axis.problem import AxisProblem, AxisRecord, Surroundings
from advisor.oem.regression import Equations, regressed
from advisor.oem.rows import Signal
from advisor.process.arrays import FloatArray

PART_S = 5.0
"""Numerical: length of the parts of a record that have trims of their own in the regression, s. Over 20 s the
drift of a sideslip that is integrated from a noisy force hides a small sideslip."""


def starting_point(problem: AxisProblem) -> tuple[FloatArray, FloatArray]:
    """Return shared (s,) and local (m, l) parameters for the start of a search.

    The values are always finite; a record without information has a least-norm solution.
    """
    axis, names = problem.axis, problem.axis.names
    shared, local = np.zeros(len(names.shared)), np.zeros((len(problem.records), len(names.local)))
    has_force = [axis.force in record.outputs for record in problem.records]
    whole, in_parts = equations_of(problem), equations_of(_in_parts(problem))
    for letter, state in axis.letters.items():
        if in_parts[letter]:
            own = [k for k, t in enumerate(axis.shared) if t.state == state and t.factor != CONSTANT]
            shared[own] = regressed(in_parts[letter])[0]
            constants = [coefficients[0] for coefficients in regressed(whole[letter])[1]]
            of = has_force if state == axis.hidden else slice(None)
            local[of, names.local.index(f"{letter}_0")] = constants
    shared[[names.shared.index(name) for name in axis.weak]] = 0.0
    if axis.hidden and not any(has_force):
        shared[_damping(problem)] = guessed_damping(problem)
    begun = [_Motion(record, problem).signals for record in problem.records]
    for state in axis.states:
        local[:, names.local.index(f"{state}_initial")] = [signals[state][0] for signals in begun]
    return shared, local


def guessed_damping(problem: AxisProblem) -> float:
    """Return a typical derivative of the hidden state's force by that state, 1/s, such as Y_β."""
    axis = problem.axis
    assert axis.prior is not None
    nothing = np.zeros(len(axis.shared))
    prior = axis.prior(nothing, axis.inputs, False, problem.mean_airspeed_m_s)
    return float(prior.mean[_damping(problem)])


def _damping(problem: AxisProblem) -> int:
    hidden = problem.axis.hidden
    return next(k for k, t in enumerate(problem.axis.shared) if t.state == hidden == t.factor)


def _in_parts(problem: AxisProblem) -> AxisProblem:
    """Return the problem with each record cut into parts of about ``PART_S``, by its first output."""
    parts, clock = [], problem.axis.needed[0]
    for record in problem.records:
        rate = record.outputs[clock]
        cuts = np.array_split(np.array(rate), max(1, round(float(np.ptp(rate.t)) / PART_S)), axis=1)
        parts += [replace(record, outputs={**record.outputs, clock: Signal(*cut)}) for cut in cuts]
    return replace(problem, records=tuple(parts))


def equations_of(problem: AxisProblem) -> dict[str, list[Equations]]:
    """Return the regression equations of all records, by the letter of the equation.

    The specific force is that of the hidden state's equation, which needs no integration.
    """
    axis = problem.axis
    prepared = [_Motion(record, problem) for record in problem.records]
    return {
        letter: [m.force(state) for m in prepared if m.has_force]
        if state == axis.hidden
        else [Equations(m.integrals(state), m.signals[state], m.own()) for m in prepared]
        for letter, state in axis.letters.items()
    }


class _Motion:
    """Signals of one record at the stamps of its first output."""

    def __init__(self, record: AxisRecord, problem: AxisProblem) -> None:
        axis = problem.axis
        t = record.outputs[axis.needed[0]].t
        self.axis, self.t = axis, t
        self.speed = record.airspeed.at(t)
        reference = problem.reference_airspeed_m_s
        self.ratio = np.ones(len(t)) if reference is None else self.speed / reference
        self.signals = {name: record.outputs[name].at(t) for name in axis.needed}
        for name in axis.inputs:
            still = name not in record.inputs
            self.signals[name] = (
                np.zeros(len(t)) if still else problem.servo(name).signal(record.command(name)).at(t)
            )
        self.has_force = axis.force in record.outputs
        if not axis.hidden:
            return
        around = Surroundings(problem, record, t)
        turn = self._turn(around)
        self.force_rate = (
            record.outputs[axis.force].at(t) / self.speed if self.has_force else np.zeros(len(t))
        )
        if axis.hidden in record.outputs:
            by_turning = (
                axis.factors[r.factor](around) * self.signals[r.state]
                for r in axis.seen
                if r.output == axis.hidden != r.state and r.number is None
            )
            self.signals[axis.hidden] = record.outputs[axis.hidden].at(t) - sum(by_turning)
        elif self.has_force:
            self.signals[axis.hidden] = integrated(t, turn + self.force_rate)
        else:
            self.signals[axis.hidden] = _leaking(t, turn, guessed_damping(problem))

    def _turn(self, around: Around) -> FloatArray:
        """Return the known part of the hidden state's rate, shape (n,)."""
        axis, signals = self.axis, {**self.signals, CONSTANT: np.ones(len(self.t))}
        if axis.bank:
            signals[SINE] = np.sin(signals[axis.bank])
            signals[TURN] = np.cos(signals[axis.bank]) * signals[axis.yaw]
        terms = [k for k in axis.turning if k.state == axis.hidden and k.number is None]
        factors = [1.0 if k.factor == CONSTANT else axis.factors[k.factor](around) for k in terms]
        return np.asarray(sum(f * signals[k.column] for f, k in zip(factors, terms, strict=True)))

    def integrals(self, state: str) -> FloatArray:
        """Return the integrals (n, k) whose coefficients are the derivatives of one moment."""
        return np.column_stack([integrated(self.t, column) for column in self.columns(state)])

    def columns(self, state: str) -> list[FloatArray]:
        """Return the factors (n,) of the derivatives of one force or moment."""
        terms = [t for t in self.axis.shared if t.state == state and t.factor != CONSTANT]
        return [self.ratio**term.power * self.signals[term.factor] for term in terms]

    def own(self) -> FloatArray:
        """Return the manoeuvre's own columns: trim constant, initial rate, drift of the hidden state."""
        since = self.t - self.t[0]
        return np.column_stack([integrated(self.t, self.ratio**2), np.ones(len(since)), since**2])

    def force(self, state: str) -> Equations:
        """Return the regression equations of the force: its columns, the force per mass and speed, and the
        manoeuvre's own columns."""
        since = self.t - self.t[0]
        columns = np.column_stack(self.columns(state))
        return Equations(columns, self.force_rate, np.column_stack([self.ratio, since, since**2]))


def _leaking(t: FloatArray, rate: FloatArray, damping: float) -> FloatArray:
    """Return the solution of ẋ = damping·x + rate from rest."""
    x = np.zeros(len(t))
    for i, step in enumerate(np.diff(t)):
        x[i + 1] = x[i] + step * (damping * x[i] + 0.5 * (rate[i] + rate[i + 1]))
    return x
