"""Errors of one test of roll and yaw in side gusts and in still air."""

from dataclasses import replace

import numpy as np
import pytest

from advisor.model.axes.lateral import LATERAL
from advisor.oem.axis import search as axis_search
from advisor.oem.axis.disturbance import Linear, courses_of
from advisor.oem.axis.problem import AxisProblem
from advisor.oem.axis.search import solve
from advisor.oem.driven_motion import estimate
from advisor.oem.rows import Signal
from tests.oem.axis.builders import JET, aileron_doublet, flown, vector

T = np.arange(0.0, 15.0, 0.025)
MEASURED = ("p", "r", "bank", "a_y")
KNOWN = [LATERAL.names.reported.index(name) for name in ("L_beta", "L_p", "L_delta_a", "N_beta", "N_r")]
GUSTS_RAD = 0.0015


@pytest.fixture
def coloured(monkeypatch):
    """Return the solutions before unknown forces are sought."""
    seen, sought = [], axis_search.driven
    monkeypatch.setattr(
        axis_search,
        "driven",
        lambda first, *others, **more: seen.append(first) or sought(first, *others, **more),
    )
    return seen


def problem_of(rng):
    return AxisProblem(LATERAL, (flown(JET, aileron=aileron_doublet(T), measured=MEASURED, rng=rng),))


def in_gusts(rng, still):
    """Return the problem of a test in side gusts with a memory of 1 s."""
    fit = Linear(still.problem, still.assembly, vector(JET), still.sensitivities, still.optimum.noise)
    (course,) = courses_of(fit)
    markov = np.exp(-np.abs(course.knots[:, None] - course.knots))
    change = course.columns @ np.linalg.cholesky(markov) @ rng.standard_normal(len(course.knots))
    (record,) = problem_of(rng).records
    outputs = {
        name: Signal(record.outputs[name].t, record.outputs[name].y + GUSTS_RAD * change[rows])
        for name, rows in still.assembly.rows[0].items()
    }
    return AxisProblem(LATERAL, (replace(record, outputs=outputs),))


def std_of(solution):
    return np.sqrt(np.diag(solution.widened)[KNOWN])


def test_still_air_leaves_the_errors_of_the_instruments(coloured):
    ratio = std_of(solve(problem_of(np.random.default_rng(1)))) / std_of(*coloured)
    assert np.all(np.abs(ratio - 1.0) < 0.2)


def test_errors_of_one_test_contain_its_gusts(coloured):
    rng = np.random.default_rng(2)
    still = solve(problem_of(rng))
    off, wide, narrow = [], [], []
    for _ in range(4):
        found = solve(in_gusts(rng, still))
        off.append(np.abs(found.theta - vector(JET))[KNOWN])
        wide.append(std_of(found))
        narrow.append(np.sqrt(np.diag(coloured[-1].covariance)[KNOWN]))  # of the noise alone
    assert np.mean(np.array(off) / wide < 1.96) > 0.85
    assert np.mean(np.array(off) / narrow < 1.96) < 0.75


def test_a_scale_that_residuals_show_counts_less_than_one_that_the_aileron_absorbs(monkeypatch):
    rng = np.random.default_rng(2)
    problem = in_gusts(rng, solve(problem_of(rng)))
    monkeypatch.setattr(estimate, "SCALE", 0.1)
    widths = std_of(solve(problem))
    monkeypatch.setattr(estimate, "SCALE", 1.0)
    L_beta, L_p, L_delta_a, *_ = std_of(solve(problem)) / widths
    assert max(L_beta, L_p) < 2.0
    assert L_delta_a > 5.0
