"""Starting values of effects in addition to a fit, with all other parameters refitted linearly.

A surface with another servo is a disturbance of its control, whose linear response is known. A late reading
is the fitted output at an earlier time.
"""

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np

from advisor.gap.axis.effects import AxisEffect
from advisor.gap.axis.fit import Fit, Point, outputs
from advisor.gap.axis.models import Case, base_of
from advisor.gap.axis.setting import Flown, Setting, column_of_change, deflection, moved_to
from advisor.gap.fitting.prior import ERROR_IF_WRONG
from advisor.oem.axis.disturbance import STEP_S, answered
from advisor.oem.axis.problem import COMMAND
from advisor.process.arrays import FloatArray


def changes_by(fit: Fit, flown: Flown, of: str, settings: Sequence[Setting]) -> FloatArray:
    """Return the change (settings, N) of the outputs by other servo parameters or by late stamps."""
    if of in flown.axis.inputs:
        parts = [_by_surface(fit, flown, m, of, settings) for m in range(len(flown))]
        return np.vstack(parts).T
    return np.array([_read_later(fit, of, setting) for setting in settings]).reshape(-1, len(fit.fitted))


def _by_surface(fit: Fit, flown: Flown, m: int, control: str, settings: Sequence[Setting]) -> FloatArray:
    """Return the change (n, settings) of one manoeuvre's outputs by other deflections of a control."""
    stamps = fit.assembly.t[fit.assembly.owner == m]
    t = np.arange(np.min(stamps), np.max(stamps) + STEP_S, STEP_S)
    moves = np.zeros((len(t), len(settings)))
    if control in flown.problem.records[m].inputs:
        now = fit.point.setting
        late = t - now[COMMAND][m]
        moves += np.column_stack([deflection(flown, m, control, setting).at(late) for setting in settings])
        moves -= deflection(flown, m, control, now).at(late)[:, None]
    return answered(fit.linear(flown), m, control, t, moves)


def _read_later(fit: Fit, of: str, setting: Setting) -> FloatArray:
    """Return the change (N,) of the outputs when one output is read late."""
    late, now = (numbers.get((of, "delay_s"), np.zeros(1))[0] for numbers in (setting, fit.point.setting))
    change = np.zeros(len(fit.fitted))
    for rows in (named[of] for named in fit.assembly.rows):
        t, y = fit.assembly.t[rows], fit.fitted[rows]
        change[rows] = np.interp(t - late + now, t, y) - y
    return change


SECANT = (0.25, 2.0)
"""Numerical: range of a secant estimate of an effect's size, relative to the simulated size."""


class Start(NamedTuple):
    """Starting value of an effect's fit."""

    effect: AxisEffect
    cost: float
    """-2 log posterior density over the temperature at the start, after a linear refit of all other
    parameters."""
    point: Point
    way: FloatArray
    """Shape (N + p,): weighted change by the effect of the outputs, and of p parameters relative to their
    priors, without what other parameters absorb."""

    @property
    def name(self) -> str:
        """Name of the effect to which the start belongs."""
        return self.effect.name

    @property
    def price(self) -> float:
        """Cost of the start plus twice the number of parameters (Akaike's criterion)."""
        return self.cost + 2.0 * len(self.effect.places)


class Starts:
    """Best starting value of each effect."""

    def __init__(
        self,
        case: Case,
        plain: Fit,
        table: Sequence[AxisEffect],
        tolerance: float = ERROR_IF_WRONG,
        share: float = 1.0,
    ) -> None:
        self._case, self._plain = case, plain
        prior = case.prior_of(tolerance, plain.free)
        # One nat of white noise counts as share² nats, beside priors with their true weight.
        self._weight = share * plain.weight
        # A parameter at its bound stays there, whatever an effect explains.
        low, high = plain.bounds
        self._free = np.flatnonzero((plain.values > low) & (plain.values < high))
        root = prior.precision[self._free] ** 0.5
        off = prior.mean - plain.values
        weighed = plain.columns[:, self._free] * self._weight[:, None]
        # A prior is a measurement of its parameter: an effect may relieve a parameter that strains at it.
        self._columns = np.vstack([weighed, np.diag(root)])
        self._information = self._columns.T @ self._columns
        own = plain.assembly.free[plain.assembly.free >= len(plain.point.theta)]
        self._own = plain.sensitivities[:, own] * self._weight[:, None]
        self._parts = [np.flatnonzero(plain.assembly.owner == m) for m in range(plain.assembly.maneuvers)]
        self._begin, self._moves = self._without(
            np.concatenate([plain.residual * self._weight, root * off[self._free]])
        )
        cost = -2.0 * share**2 * plain.likelihood + float(prior.precision @ off**2)
        self._cost = cost - float(self._begin @ self._begin)
        self.of_each = [self._best(effect) for effect in table]

    def together(self, start: Start, other: Start) -> float:
        """Return the price of a pair of effects, from the outputs' changes at both starts."""
        from scipy.optimize import nnls  # not on the start path

        left = nnls(np.column_stack([start.way, other.way]), self._begin)[1] ** 2
        return self._cost + left + 2.0 * (len(start.effect.places) + len(other.effect.places))

    def _best(self, effect: AxisEffect) -> Start:
        """Return the starting value of an effect with the least residual."""
        plain = self._plain
        if effect.columns is not None:
            return self._linear(effect, effect.columns, np.zeros(len(effect.places)))
        is_natural = any(f.place in effect.places for f in plain.free)
        linear = is_natural or effect.of in self._case.axis.outputs or not effect.starts
        about = effect.begins if linear and effect.sides is None else []
        tangents = [self._tangent(effect, np.array(begin)) for begin in about]
        return min([*tangents, *self._each(effect)], key=lambda start: start.cost)

    def _tangent(self, effect: AxisEffect, begin: FloatArray) -> Start:
        """Return the starting value of an effect from the derivative of the outputs at the sizes ``begin``.

        If one reading is late, the clocks of all other channels may be late too. A common delay of all clocks
        leaves no residual, but the linear model holds for small delays only.
        """
        setting, base = self._plain.point.setting, base_of(self._case, effect) + begin
        natural = {f.place for f in self._plain.free}
        at = np.array(
            [setting[p][0] if p in natural else x for p, x in zip(effect.places, base, strict=True)]
        )
        steps = np.diag(effect.variant.steps)
        columns = np.column_stack([self._slope(effect, at, step) for step in steps])
        return self._linear(effect, columns, begin)

    def _slope(self, effect: AxisEffect, at: FloatArray, step: FloatArray) -> FloatArray:
        """Return the derivative of the outputs (N,) by the parameter of an effect that ``step`` moves."""
        plain, flown = self._plain, self._case.flown
        place = effect.places[int(np.argmax(step != 0.0))]
        if effect.kind in flown.axis.changes:
            by, owner = plain.sensitivities, plain.assembly.owner
            return column_of_change(flown, plain.point.setting, place, plain.point.theta, by, owner)
        setting = moved_to(plain.point.setting, effect.places, at + step)
        moved = outputs(flown, plain.point._replace(setting=setting), plain.begun)
        return np.asarray((moved - plain.fitted) / np.sum(step))

    def _linear(self, effect: AxisEffect, columns: FloatArray, begin: FloatArray) -> Start:
        """Return the best start of an effect whose outputs are linear in its parameters.

        An effect adds to the nuisance parameter at its place, which then returns to its prior.
        """
        point, base = self._plain.point, base_of(self._case, effect)
        places = [f.place for f in self._plain.free]
        split = [self._without(self._weighed(column)) for column in columns.T]
        ways, moves = np.column_stack([way for way, _ in split]), np.column_stack([x for _, x in split])
        now, at = base + begin, np.zeros(len(base))
        free = {int(k): j for j, k in enumerate(self._free)}
        for i, place in enumerate(effect.places):
            if place in places:
                now[i] = point.setting[place][0]
                # Beyond a bound the size counts from the bound.
                at[i] = 0.0 if len(point.theta) + places.index(place) in free else now[i] - base[i]
        prior = np.array(effect.std) ** -2.0
        pull = ways.T @ self._begin - prior * at
        change = np.asarray(np.linalg.solve(ways.T @ ways + np.diag(prior), pull))
        left, size = self._begin - ways @ change, now - base + change
        for i, place in enumerate(effect.places):
            if place in places and (j := free.get(len(point.theta) + places.index(place))) is not None:
                size[i] += self._moves[j] - moves[j] @ change
        low, high = np.array(effect.variant.bounds).T
        size = np.clip(size, np.minimum(low, low + base) - base, high)
        setting = moved_to(point.setting, effect.places, base + size)
        cost = self._cost + float(left @ left + prior @ (at + change) ** 2)
        return Start(effect, cost, point._replace(setting=setting), ways @ change)

    def _weighed(self, change: FloatArray) -> FloatArray:
        """Return a change (N,) of the outputs as weighted rows, with zeros for the priors."""
        return np.concatenate([change * self._weight, np.zeros(len(self._free))])

    def _each(self, effect: AxisEffect) -> Iterator[Start]:
        """Yield every starting value of an effect, each with its cost. The outputs are taken as linear in an
        effect's size up to the starting value."""
        case, point = self._case, self._plain.point
        place, sides = effect.sides or (("", ""), (0.0,))
        base = base_of(case, effect)
        begun = [moved_to(point.setting, effect.places, base + values) for values in effect.starts]
        tried = [moved_to(setting, [place], np.array([side])) for setting in begun for side in sides]
        changes = changes_by(self._plain, case.flown, effect.of, tried).reshape(
            len(begun), len(sides), len(self._weight)
        )
        for values, setting, changed in zip(effect.starts, begun, changes, strict=True):
            ways = [self._without(self._weighed(change))[0] for change in changed]
            shares = [np.clip(way @ self._begin / (way @ way + 1e-12), *SECANT) for way in ways]
            left = [self._begin - share * way for share, way in zip(shares, ways, strict=True)]
            squares = np.array([[float(rest[rows] @ rest[rows]) for rows in self._parts] for rest in left])
            best = np.argmin(squares, axis=0)
            if effect.sides is None:
                setting = moved_to(setting, effect.places[:1], np.array([base[0] + shares[0] * values[0]]))
                chosen = left[0]
            else:
                setting = {**setting, place: np.array(sides)[best]}
                chosen = np.mean([left[k] for k in best], axis=0)
                for k, rows in zip(best, self._parts, strict=True):
                    chosen[rows] = left[k][rows]
            way = self._begin - chosen if effect.sides is not None else ways[0]
            yield Start(effect, self._cost + float(chosen @ chosen), point._replace(setting=setting), way)

    def _without(self, left: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return weighted rows (N + p,) without the part that all other parameters absorb, and the change of
        the p free parameters that absorbs it."""
        left = left.copy()
        for rows in self._parts:
            mine = self._own[rows]
            left[rows] -= mine @ np.linalg.lstsq(mine, left[rows], rcond=None)[0]
        moves = np.linalg.solve(self._information, self._columns.T @ left)
        return np.asarray(left - self._columns @ moves), np.asarray(moves)
