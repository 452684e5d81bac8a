"""The step of the search for instruments stays within their ranges."""

from types import SimpleNamespace

import numpy as np
import pytest

from advisor.oem import instrument_fit
from advisor.oem.covariance import Influence
from advisor.oem.extra import Extra
from advisor.oem.instruments import SERVO_LAG, VANE_ARM
from advisor.oem.problem import OutputErrorProblem

INFORMATION = np.array([[2.0, 1.0], [1.0, 2.0]])
PULL = 1e-3


def stepped(monkeypatch, pull):
    """Return the step from a lag and an arm of 0 with this free step, in thousandths, and its promise."""
    rows = np.zeros((1, 10))
    rows[0, 8:] = PULL * np.array(pull)
    found = Influence(
        rows=rows, condition=1.0, unresolved=(), shared_inverse=np.zeros((9, 9)),
        extra_covariance=np.linalg.inv(INFORMATION), prior_rows=np.zeros((2, 10)),
    )  # fmt: skip
    monkeypatch.setattr(instrument_fit, "influence", lambda *_: found)
    monkeypatch.setattr(
        instrument_fit, "extra_of", lambda *_: Extra.at(np.zeros((1, 2)), np.zeros(2), [None] * 2)
    )
    optimum = SimpleNamespace(shared=None, local=None, sensitivities=None, noise=None, fitted=np.zeros(1))
    fit = SimpleNamespace(
        problem=OutputErrorProblem(()), assembly=SimpleNamespace(z=np.ones(1)), optimum=optimum
    )
    return instrument_fit._step(fit, [SERVO_LAG, VANE_ARM])


def test_a_step_within_the_ranges_is_that_of_gauss_and_newton(monkeypatch):
    step, promised = stepped(monkeypatch, (1.0, -1.0))
    assert step == pytest.approx([PULL, -PULL])
    assert promised == pytest.approx(2.0 * PULL**2)


def test_a_lag_that_would_fall_below_zero_stays_and_the_arm_follows(monkeypatch):
    step, promised = stepped(monkeypatch, (-1.0, 1.0))
    assert step == pytest.approx([0.0, 0.5 * PULL])
    assert promised == pytest.approx(0.5 * PULL**2)
