"""The law that an answer without a name lacks, as a curve with the nearest formula."""

import shlex
from dataclasses import replace

import numpy as np
import pytest

from advisor.aircraft.aircraft import Aircraft
from advisor.gap.fitting.measure import by_phase
from advisor.gap.records.prepare import prepare
from advisor.gap.result import MissingLaw, Value
from advisor.gap.search.baseline import fit_baseline
from advisor.gap.verdict.missing_law import Lacking, lacking, law_in
from advisor.report.facts.gap import law_said
from advisor.report.gap_document import gap_document, next_steps
from tests.gap.generator import Setup, fly
from tests.gap.test_report_screen import diagnosis


@pytest.fixture(scope="module")
def law() -> MissingLaw:
    """Return the law of flights whose damping grows with the pitch rate."""
    bent = fly(Setup(seed=8, maneuvers=4, switches={"q_square": -0.06}))
    fit = fit_baseline(prepare(bent, Aircraft()), Aircraft())
    found = law_in("moment_equation", lacking(*fit, "moment_equation"), heat=9.0)
    assert found is not None
    return found


def test_a_damping_that_grows_with_the_rate_is_a_curve_over_the_rate(law):
    assert law.variable == "q"
    assert {law.nearest, law.runner_up} == {"q*abs(q)", "q**3"}, "an odd formula"
    assert law.coefficient.value < 0.0


def test_the_offered_term_is_one_that_the_estimate_takes(law):
    assert law.term == f"M:{law.nearest}"
    d = replace(diagnosis(), verdict="unknown", missing_law=law, causes=(), evidence=())
    commands = [step.command for step in next_steps(d, ["a.tlog"], "mine.yaml")]
    assert f"advisor analyze a.tlog --aircraft mine.yaml --term {shlex.quote(law.term)}" in commands


def test_the_curve_rises_in_its_quantity_and_has_a_band(law):
    at = [x for x, _, _ in law.curve]
    assert at == sorted(at)
    assert all(half > 0.0 for *_, half in law.curve)
    told = gap_document(replace(diagnosis(), verdict="unknown", missing_law=law))["missing_law"]
    assert len(told["curve"]) == len(told["band"]) == len(law.curve)


def test_a_formula_within_its_interval_is_not_offered_as_a_law():
    vague = MissingLaw("M", "q", 0.2, ((0.0, 0.0, 1.0),), Value(1.0, 2.0), "q**2")
    assert law_said(vague).endswith("which explains 20 % of the residual; no simple formula fits it.")


def test_a_law_in_a_sensor_is_no_curve():
    assert law_in("alpha_sensor", iter(()), heat=1.0) is None


def test_the_error_of_the_coefficient_grows_with_the_root_of_the_heat():
    rng = np.random.default_rng(4)
    p, shared = rng.standard_normal(80), rng.standard_normal((80, 1))
    residual = 3.0 * p * np.abs(p) + 0.1 * rng.standard_normal(80)
    seen = Lacking({"p": p}, np.eye(80), np.column_stack([p, shared]), residual)
    cool, hot = (law_in("rolling_moment", [seen], heat) for heat in (1.0, 9.0))
    assert cool.term == "L:p*abs(p)"
    assert cool.coefficient.value == pytest.approx(3.0, rel=0.1)
    assert hot.coefficient.std == pytest.approx(3.0 * cool.coefficient.std)


def test_a_residual_behind_the_steps_is_a_gap_at_the_step_edges_alone():
    problem, _ = fit_baseline(prepare(fly(Setup(seed=8, maneuvers=2)), Aircraft()), Aircraft())
    residuals = []
    for flight in problem.flights.flights:
        stamps = np.concatenate([flight.outputs[c].t for c in problem.channels])
        since = stamps[:, None] - flight.edges[:, 0]
        residuals.append(np.where(np.any((since > 0.02) & (since < 0.15), axis=1), 1.0, 0.0))
    gaps = by_phase(problem, residuals, np.full(len(problem.channels), 0.1))
    assert gaps["step edge"] > 10.0
    assert gaps["plateau"] == gaps["free response"] == 0.0
