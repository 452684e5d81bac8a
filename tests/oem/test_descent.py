"""Steps of the search at the ends of the parameters' ranges."""

from types import SimpleNamespace

import numpy as np
import pytest

from advisor.oem import descent
from advisor.oem.descent import _Setting, _Step


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
