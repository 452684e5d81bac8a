"""Errors of the gap's derivatives: coloured residuals, and the scatter between manoeuvres."""

from types import SimpleNamespace

import numpy as np
import pytest

from advisor.gap.fitting import uncertainty


@pytest.mark.parametrize(("pulls", "widened"), [([3.0, -3.0, 0.0], 1.0), ([30.0, -30.0, 0.0], 5.0)])
def test_an_error_is_at_least_as_large_as_the_scatter_of_the_manoeuvres_requires(monkeypatch, pulls, widened):
    """Information of 100 states an error of .1, which three pulls of 0 and ±30 widen to .52."""
    parts = iter([(np.array([[0.0, pull], [pull, 0.0]]), None) for pull in pulls])
    monkeypatch.setattr(uncertainty, "own_eliminated", lambda *_: next(parts))
    problem = SimpleNamespace(prior_of=lambda _: (np.zeros(1), np.zeros(1)))
    fitted = SimpleNamespace(
        point=None, information=np.array([[100.0]]), noise=np.ones(1), linear=(None,) * 3
    )
    found = uncertainty.covariance_of(problem, fitted, 1.0)
    assert np.sqrt(found[0, 0]) == pytest.approx(0.1 * widened, rel=0.05)
