"""The paper's campaign, many times, in small numbers."""

import json
from dataclasses import replace

import numpy as np
import pytest

from advisor.aircraft.aircraft import CampaignPlan
from advisor.aircraft.reference import PARAMETERS
from advisor.bundled.study import run
from advisor.bundled.study.campaigns import (
    ORDER,
    RULES,
    CampaignBlock,
    Scene,
    estimate_copies,
    fly_campaigns,
    fly_named,
    noise_scale,
    outcome,
)
from advisor.bundled.study.figure import curve, in_terminal
from advisor.bundled.study.table import as_document, row
from advisor.decision.history import CandidateManeuver
from advisor.decision.pooling import pool, posteriors_at_one_speed
from advisor.decision.stopping import progress
from advisor.oem.estimate import Estimate
from advisor.oem.problem import OutputErrorProblem, Record
from advisor.oem.rows import Signal
from advisor.oem.solution import Solution, solve
from advisor.process.tasks.processes import results_in_order, run_here

SCENE = Scene()
PLAN = CampaignPlan()
CAMPAIGNS = 40


@pytest.fixture(scope="module")
def flown() -> list[list[Estimate]]:
    """Forty campaigns at 1 % noise."""
    return fly_campaigns(CampaignBlock(SCENE, 1.0, CAMPAIGNS, (1, 1000)))


def test_every_campaign_has_the_papers_seven_manoeuvres(flown: list[list[Estimate]]) -> None:
    assert len(flown) == CAMPAIGNS
    assert {len(campaign) for campaign in flown} == {len(ORDER)}


def test_estimates_scatter_as_their_bounds_say(flown: list[list[Estimate]]) -> None:
    first = [campaign[0] for campaign in flown]
    normalised = np.array([(e.theta - SCENE.theta) / e.std for e in first])
    np.testing.assert_allclose(np.sqrt(np.mean(normalised**2, axis=0)), 1.0, atol=0.35)


def test_at_one_per_cent_continuous_improvement_stops_after_three_as_in_the_paper(flown):
    assert {outcome(campaign, "continuous", PLAN).needed for campaign in flown} == {3}


def test_the_study_stops_when_the_flight_test_would(flown: list[list[Estimate]]) -> None:
    for rule in RULES:
        for campaign in flown[:5]:
            in_flight = progress([CandidateManeuver(estimate) for estimate in campaign], rule, PLAN)
            assert outcome(campaign, rule, PLAN).needed == in_flight.stopped_at


def test_the_document_has_the_contracts_keys(flown: list[list[Estimate]]) -> None:
    rows = [row(rule, 1.0, [outcome(c, rule, PLAN) for c in flown], SCENE.theta) for rule in RULES]
    document = json.loads(json.dumps(as_document(rows, CAMPAIGNS), allow_nan=False))
    assert document["schema"] == "advisor.study/1"
    assert document["campaigns"] == CAMPAIGNS
    first = document["rows"][0]
    assert (first["rule"], first["noise_percent"]) == ("continuous", 1.0)
    assert set(first["needed"]) == {"median", "p90", "never_percent"}
    assert set(first["error_percent"]) == set(PARAMETERS)
    assert {"median", "p90"} <= set(first["error_percent"]["Z_0"])
    assert first["paper"]["needed"] == 3
    assert set(first["paper"]["percentile_of_paper"]) == set(PARAMETERS)
    assert "paper" not in document["rows"][2]


def test_a_campaign_that_never_stops_counts_as_infinitely_long(flown: list[list[Estimate]]) -> None:
    impossible = CampaignPlan(limit_percent=1e-6)
    never = row("continuous", 1.0, [outcome(c, "continuous", impossible) for c in flown], SCENE.theta)
    assert never.never_percent == 100.0
    assert never.needed_quantile(0.5) is None
    assert never.needed_percentile_of_paper() == 0.0


def test_figure_five_is_drawn_in_the_terminal_with_its_limit(flown: list[list[Estimate]]) -> None:
    drawn = curve("continuous", 1.0, [outcome(c, "continuous", PLAN) for c in flown])
    assert drawn.quantiles[:2] == (None, None)
    text = "\n".join(in_terminal([drawn], "continuous"))
    assert "25 |---" in text
    assert "manoeuvres flown" in text


def test_pooled_estimates_equal_the_joint_output_error_estimate() -> None:
    rng = np.random.default_rng(2)
    records, singles = [], []
    for name in ORDER[:3]:
        flight = fly_named(SCENE, name)
        z = flight.response + 0.01 * noise_scale(flight, "std") * rng.standard_normal(flight.response.shape)
        outputs = {"alpha": Signal(flight.t, z[:, 0]), "q": Signal(flight.t, z[:, 1])}
        records.append(Record(Signal(flight.t, flight.elevator), outputs))
        single = solve(OutputErrorProblem((records[-1],)))
        assert isinstance(single, Solution)
        singles.append(single)
    joint = solve(OutputErrorProblem(tuple(records)))
    assert isinstance(joint, Solution)
    template = estimate_copies(fly_named(SCENE, "3211"), np.array([1e-4, 1e-4]), 1, rng)[0]
    estimates = [_with(template, s) for s in singles]
    pooled = pool(posteriors_at_one_speed(estimates))
    # Within a tenth of its own error of the joint fit, and equally sure.
    joint_std = np.sqrt(np.diag(joint.covariance_cr))
    assert np.all(np.abs(pooled.theta - joint.theta) < 0.1 * joint_std)
    np.testing.assert_allclose(pooled.std, joint_std, rtol=0.05)


def _with(template: Estimate, solution: Solution) -> Estimate:
    return replace(
        template,
        theta=solution.theta,
        covariance=solution.covariance_cr[:8, :8],
        covariance_cr=solution.covariance_cr[:8, :8],
    )


def test_the_whole_study_reports_where_the_paper_lies() -> None:
    study = run.table_1(10, seed=3)
    told: list[int] = []
    report = study.report(results_in_order(run_here, study.work, study.tasks, told.append))
    text = "\n".join(report.lines)
    assert "continuous, 2.5 %: it needed 7" in text
    assert told == list(range(len(study.tasks)))
    document = json.loads(json.dumps(report.document, allow_nan=False))
    assert len(document["rows"]) == 9
    assert len(document["figure_5"]) == 6
    assert document["noise_reading"] == "std"


def test_no_two_tasks_of_a_study_have_the_same_seed_and_together_they_are_all_campaigns() -> None:
    tasks = run.table_1(70, 3).tasks
    assert len(set(tasks)) == len(tasks)
    assert max(task.campaigns for task in tasks) < sum(task.campaigns for task in tasks)
