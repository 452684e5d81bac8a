"""Steps of the search: at the ends of the parameters' ranges, and in a bent valley."""

from types import SimpleNamespace

import numpy as np
import pytest

from advisor.oem import descent
from advisor.oem.descent import Fit, _Setting, _Step, descended
from advisor.oem.gauss_newton import CONVERGED, EXHAUSTED, Optimum


class Parameter:
    """One of three parameters, each between -1 and 1."""

    prior = None

    def __init__(self, place):
        self.place = place

    def read(self, problem):
        return problem[self.place]

    def moved(self, problem, change):
        value = float(np.clip(problem[self.place] + change, -1.0, 1.0))
        return {**problem, self.place: value}


def test_a_parameter_at_its_end_stays_there_while_a_second_one_reaches_its_own(monkeypatch):
    """The second parameter leaves its range only beside the first one, held."""
    asked = []

    def solved(damping, held):
        asked.append(dict(held))
        free = np.array([5.0, 0.5 if not held else -4.0, 0.2])
        return _Step(np.array([held.get(k, x) for k, x in enumerate(free)]), np.zeros((1, 0)), 1.0)

    monkeypatch.setattr(descent, "_System", SimpleNamespace(of=lambda *_: SimpleNamespace(solved=solved)))
    fit = SimpleNamespace(optimum=SimpleNamespace(shared=np.empty(0)), problem=dict.fromkeys(range(3), 0.0))
    step = _Setting(None, [Parameter(k) for k in range(3)], None).step(fit, 0.0)
    assert asked == [{}, {0: 1.0}, {0: 1.0, 1: -1.0}]
    assert step.shared == pytest.approx([1.0, -1.0, 0.2])


BENT = 30.0
"""True curvature of a valley over the one that small residuals would give."""


class Valley:
    """A valley along one parameter, in which undamped steps go far beyond the bottom."""

    def __init__(self, *_):
        pass

    def at(self, problem, laid, x, local):
        empty = np.empty(0)
        cost = float(BENT * x[0] ** 2)
        return Fit(None, None, Optimum(EXHAUSTED, x, local, empty, cost, 0, empty, empty), (), None)

    def step(self, fit, damping):
        x = float(fit.optimum.shared[0])
        move = -BENT * x / (1.0 + 1e5 * damping)
        return _Step(np.array([move]), np.empty(0), -2.0 * BENT * x * move - move**2)

    def moved(self, fit, step):
        return self.at(None, None, fit.optimum.shared + step.shared, fit.optimum.local)


def test_a_valley_that_large_residuals_bend_takes_few_trials(monkeypatch):
    """Dampings by powers of ten alternate between steps that are far too long and too short."""
    monkeypatch.setattr(descent, "_Setting", Valley)
    motion = SimpleNamespace(laid=lambda _: None)
    fit = descended(motion, None, (), None, (np.array([100.0]), np.empty(0)))
    assert fit.optimum.status == CONVERGED
    assert fit.optimum.iterations < 30
    assert abs(fit.optimum.shared[0]) < 0.01
