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
from advisor.gap.axis.setting import Flown, Setting, deflection, moved_to
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
    """-2 log likelihood over the temperature at the start, after a linear refit of all other parameters."""
    point: Point
    way: FloatArray
    """Shape (N,): weighted change of the outputs by the effect, without what other parameters absorb."""
    saved: float = 0.0
    """Part of the cost's decrease that comes from the prior of a replaced nuisance parameter."""

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
        self._columns = plain.columns * self._weight[:, None]
        self._information = self._columns.T @ self._columns + np.diag(prior.precision)
        own = plain.assembly.free[plain.assembly.free >= len(plain.point.theta)]
        self._own = plain.sensitivities[:, own] * self._weight[:, None]
        self._parts = [plain.assembly.owner == m for m in range(plain.assembly.maneuvers)]
        self._begin = self._without(plain.residual * self._weight)
        self._cost = -2.0 * share**2 * plain.likelihood - float(self._begin @ self._begin)
        self.of_each = [self._best(effect) for effect in table]

    def together(self, start: Start, other: Start) -> float:
        """Return the price of a pair of effects, from the outputs' changes at both starts."""
        from scipy.optimize import nnls  # not on the start path

        left = nnls(np.column_stack([start.way, other.way]), self._begin)[1] ** 2
        count = len(start.effect.places) + len(other.effect.places)
        return self._cost + left - start.saved - other.saved + 2.0 * count

    def _best(self, effect: AxisEffect) -> Start:
        """Return the starting value of an effect with the least residual.

        An effect that replaces a nuisance parameter starts at that parameter's value and saves the prior's
        cost.
        """
        if effect.columns is not None:
            return self._linear(effect, effect.columns)
        plain = self._plain
        saved = sum(
            ((value - f.prior.mean) / f.prior.std) ** 2
            for f, value in zip(plain.free, plain.values[len(plain.point.theta) :], strict=True)
            if f.place in effect.places
        )
        if not saved:
            linear = effect.of in self._case.axis.outputs or not effect.starts
            tangent = [self._tangent(effect)] if linear else []
            return min([*tangent, *self._each(effect)], key=lambda start: start.cost)
        cost = self._cost + float(self._begin @ self._begin) - saved
        return Start(effect, cost, plain.point, np.zeros(len(self._begin)), saved)

    def _tangent(self, effect: AxisEffect) -> Start:
        """Return the starting value of an effect from the derivative of the outputs.

        If one reading is late, the clocks of all other channels may be late too. A common delay of all clocks
        leaves no residual, but the linear model holds for small delays only.
        """
        point, step = self._plain.point, np.array(effect.variant.steps)
        setting = moved_to(point.setting, effect.places, base_of(self._case, effect) + step)
        moved = outputs(self._case.flown, point._replace(setting=setting), self._plain.begun)
        return self._linear(effect, (moved - self._plain.fitted)[:, None] / step)

    def _linear(self, effect: AxisEffect, columns: FloatArray) -> Start:
        """Return the best start of an effect whose outputs are linear in its parameters."""
        ways = np.column_stack([self._without(column * self._weight) for column in columns.T])
        prior = np.array(effect.std) ** -2.0
        values = np.asarray(np.linalg.solve(ways.T @ ways + np.diag(prior), ways.T @ self._begin))
        way = ways @ values
        left = self._begin - way
        point, cost = self._plain.point, self._cost + float(left @ left + prior @ values**2)
        setting = moved_to(point.setting, effect.places, base_of(self._case, effect) + values)
        return Start(effect, cost, point._replace(setting=setting), way)

    def _each(self, effect: AxisEffect) -> Iterator[Start]:
        """Yield every starting value of an effect, each with its cost. The outputs are taken as linear in an
        effect's size up to the starting value."""
        case, point = self._case, self._plain.point
        place, sides = effect.sides or (("", ""), (0.0,))
        base = base_of(case, effect)
        begun = [moved_to(point.setting, effect.places, base + values) for values in effect.starts]
        tried = [moved_to(setting, [place], np.array([side])) for setting in begun for side in sides]
        changes = changes_by(self._plain, case.flown, effect.of, tried).reshape(
            len(begun), len(sides), len(self._begin)
        )
        for values, setting, changed in zip(effect.starts, begun, changes, strict=True):
            ways = [self._without(change * self._weight) for change in changed]
            shares = [np.clip(way @ self._begin / (way @ way + 1e-12), *SECANT) for way in ways]
            left = [self._begin - share * way for share, way in zip(shares, ways, strict=True)]
            squares = np.array([[float(rest[rows] @ rest[rows]) for rows in self._parts] for rest in left])
            best = np.argmin(squares, axis=0)
            if effect.sides is None:
                setting = moved_to(setting, effect.places[:1], np.array([base[0] + shares[0] * values[0]]))
            else:
                setting = {**setting, place: np.array(sides)[best]}
            way = np.sum([ways[k] * rows for k, rows in zip(best, self._parts, strict=True)], axis=0)
            cost = self._cost + float(np.sum(np.min(squares, axis=0)))
            yield Start(effect, cost, point._replace(setting=setting), way)

    def _without(self, left: FloatArray) -> FloatArray:
        """Return weighted rows (N,) without the part that all other parameters absorb."""
        left = left.copy()
        for rows in self._parts:
            mine = self._own[rows]
            left[rows] -= mine @ np.linalg.lstsq(mine, left[rows], rcond=None)[0]
        return np.asarray(left - self._columns @ np.linalg.solve(self._information, self._columns.T @ left))
