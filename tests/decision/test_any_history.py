"""Whatever comes in, a decision comes out: no estimate can make the rules stumble."""

from dataclasses import replace

import numpy as np
import pytest

from advisor.aircraft.aircraft import Aircraft, CampaignPlan, Limits, Rule
from advisor.decision.history import CandidateManeuver
from advisor.decision.judge import judge_campaign
from advisor.decision.stopping import flight_test
from advisor.decision.verdict import Reason
from advisor.oem.estimate import Estimate, NoEstimate
from tests.decision.test_advice import flown


def odd_manoeuvre(rng: np.random.Generator) -> CandidateManeuver:
    """A manoeuvre whose estimate is missing, partly unknown, exact, zero, wild, or merely large."""
    one = flown(float(10.0 ** rng.uniform(-2.0, 2.0)))
    estimate = one.estimate
    assert isinstance(estimate, Estimate)
    unknown = estimate.covariance.copy()
    k = int(rng.integers(8))
    unknown[k, k] = np.inf
    theta = estimate.theta.copy()
    theta[k] = np.nan
    exact = np.zeros((8, 8))
    return [
        CandidateManeuver(NoEstimate("no_input", "the elevator did not move")),
        replace(one, estimate=replace(estimate, theta=np.full(8, np.nan))),
        replace(one, estimate=replace(estimate, theta=theta, covariance=unknown, covariance_cr=unknown)),
        replace(one, estimate=replace(estimate, theta=rng.normal(0.0, 10.0, 8), airspeed_m_s=20.0)),
        replace(one, estimate=replace(estimate, covariance=exact, covariance_cr=exact)),
        replace(one, estimate=replace(estimate, theta=np.zeros(8))),
        replace(one, reasons=(Reason("bank", "bank reached 43 deg; keep wings level", 43.0, 30.0),)),
        replace(one, maneuver=None),
    ][rng.integers(8)]


@pytest.mark.parametrize("rule", ["continuous", "separate", "information"])
def test_every_history_gets_verdicts_a_decision_and_advice(rule: Rule) -> None:
    rng = np.random.default_rng(31)
    plan = CampaignPlan(rule=rule)
    for limit in (None, 5.0) * 4:
        history = [odd_manoeuvre(rng) for _ in range(int(rng.integers(1, 7)))]
        assert len(judge_campaign(history, plan)) == len(history)
        verdict = flight_test(history, plan, Aircraft(limits=Limits(alpha_deg=limit)))
        assert verdict.next is not None
        assert verdict.decision == "continue" or verdict.criterion_percent is not None
        assert verdict.criterion_percent is None or np.isfinite(verdict.criterion_percent)
