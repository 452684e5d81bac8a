"""Verdicts on manoeuvres: their own faults first, then the chosen rule, every rule shown."""

from dataclasses import replace

import numpy as np
import pytest

from advisor.aircraft.aircraft import CampaignPlan
from advisor.decision.history import CandidateManeuver
from advisor.decision.judge import accepted_estimates, judge_campaign
from advisor.decision.verdict import Reason
from advisor.oem.estimate import Estimate, NoEstimate
from tests.decision.campaigns import SAMPLES, drawn, estimate, flown, with_change, with_residual
from tests.decision.test_advice import manoeuvre

QUIET = Reason("amplitude", "too gentle, pitch rate 3 deg/s; use about 1.5 times the stick", 3.0, 5.0)
PLAN = CampaignPlan(rule="continuous")


def test_a_quiet_record_with_a_tiny_cost_is_refused_and_poisons_no_limit() -> None:
    history = [
        CandidateManeuver(estimate(cost=1e-9)),
        CandidateManeuver(estimate(cost=1e-15), reasons=(QUIET,)),
        CandidateManeuver(estimate(cost=1.5e-9)),
    ]
    verdicts = judge_campaign(history, PLAN)
    assert [v.accepted for v in verdicts] == [True, False, True]
    assert verdicts[1].sentence == "REPEAT: too gentle, pitch rate 3 deg/s; use about 1.5 times the stick"
    assert verdicts[1].reasons == (QUIET,)
    assert not any(result.accepted for result in verdicts[1].rules.values())


BANKED = Reason("bank", "bank reached 60 deg (limit 45); fly it wings level", 60.0, 45.0)
MORE = Reason(
    "information", "the pitch rate is predicted to 45 % only; use about 2 times the stick", 45.0, 25.0
)


def test_a_verdict_has_the_remedy_of_its_first_cause_alone() -> None:
    (verdict,) = judge_campaign([CandidateManeuver(estimate(), reasons=(BANKED, MORE))], PLAN)
    assert verdict.reasons[0] == BANKED
    assert verdict.reasons[1].text == "the pitch rate is predicted to 45 % only"
    assert (verdict.reasons[1].value, verdict.reasons[1].limit) == (45.0, 25.0)


def test_every_verdict_shows_what_every_rule_says() -> None:
    verdict = judge_campaign(flown([1e-9, 1.5e-9]), PLAN)[-1]
    assert verdict.accepted
    assert {name: r.accepted for name, r in verdict.rules.items()} == {
        "continuous": True,
        "separate": False,
        "information": True,
    }
    assert verdict.rules["continuous"].limit == 2e-9
    assert verdict.rules["separate"].limit == 1e-9


def test_the_chosen_rule_decides() -> None:
    history = flown([1e-9, 1.5e-9])
    assert not judge_campaign(history, replace(PLAN, rule="separate"))[-1].accepted
    assert judge_campaign(history, replace(PLAN, rule="information"))[-1].accepted


def test_a_cost_above_the_limit_is_a_reason_with_both_numbers() -> None:
    verdict = judge_campaign(flown([1e-9, 3e-9]), PLAN)[-1]
    (reason,) = verdict.reasons
    assert (reason.code, reason.value, reason.limit) == ("cost", 3e-9, 2e-9)
    assert verdict.sentence.startswith("REPEAT: ")
    assert "cost 1.50 times its limit" in verdict.sentence


def test_a_cost_hardly_above_its_limit_does_not_read_as_the_limit_itself() -> None:
    assert "cost 1.0001 times its limit" in judge_campaign(flown([1e-9, 2.0002e-9]), PLAN)[-1].sentence
    assert "cost 0.9999 of its limit" in judge_campaign(flown([1e-9, 1.9998e-9]), PLAN)[-1].sentence


@pytest.mark.parametrize(("left", "percent"), [(0.0, "100.0"), (0.02, "99.9"), (0.1, "99.0"), (2.1, "18.4")])
def test_an_accepted_manoeuvre_tells_how_well_the_model_explains_it(left: float, percent: str) -> None:
    first, second = flown([1e-9, 1.08e-9])
    assert isinstance(second.estimate, Estimate)
    # Uncorrelated with the motion, so that the variances add: the share explained is 1 / (1 + left²).
    motion, rest = np.tile([1.0, -1.0, 1.0, -1.0], 50), left * np.tile([1.0, 1.0, -1.0, -1.0], 50)
    fits = {
        name: replace(fit, t=np.arange(200.0), measured=motion + rest, fitted=motion)
        for name, fit in second.estimate.fits[0].items()
    }
    seen = replace(second, estimate=replace(second.estimate, fits=(fits,)))
    sentence = judge_campaign([first, seen], PLAN)[-1].sentence
    explains = f"the model explains {percent} % of it"
    assert sentence == f"ACCEPTED: good manoeuvre, {explains}; cost 0.54 of its limit"


def test_nothing_is_said_of_the_share_explained_where_nothing_moved() -> None:
    sentence = judge_campaign(flown([1e-9, 1.08e-9]), PLAN)[-1].sentence
    assert sentence == "ACCEPTED: good manoeuvre, cost 0.54 of its limit"


def test_calmer_air_is_asked_for_only_where_the_air_moved() -> None:
    first, rough = flown([1e-9, 3e-9])
    assert isinstance(rough.estimate, Estimate)
    noise = np.random.default_rng(1).standard_normal(SAMPLES)
    white = replace(rough, estimate=with_residual(rough.estimate, noise))
    coloured = replace(rough, estimate=with_residual(rough.estimate, np.cumsum(noise)))
    said = [
        judge_campaign([first, m], PLAN)[-1].sentence
        for m in (replace(white, air_moved=True), replace(coloured, air_moved=True), coloured, white)
    ]
    assert ["calmer air" in sentence for sentence in said] == [True, True, False, False]
    assert "steps no larger" in said[2]
    assert "check the instruments" in said[3]


def test_a_manoeuvre_that_contradicts_all_the_others_is_refused_by_the_rule_information_alone() -> None:
    rng = np.random.default_rng(2)
    history = [CandidateManeuver(drawn(rng)) for _ in range(5)]
    history[1] = CandidateManeuver(drawn(rng, with_change("M_alpha", 1.5)))
    verdicts = judge_campaign(history, replace(PLAN, rule="information"))
    assert [v.accepted for v in verdicts] == [True, False, True, True, True]
    (reason,) = verdicts[1].reasons
    assert reason.code == "odd"
    assert reason.value > reason.limit
    assert verdicts[1].sentence.startswith("REPEAT: contradicts all the others, ")
    assert judge_campaign(history, PLAN)[1].rules["continuous"].accepted
    assert isinstance(history[1].estimate, Estimate)
    costly = [*history]
    costly[1] = CandidateManeuver(replace(history[1].estimate, cost=1.0))
    assert [r.code for r in judge_campaign(costly, PLAN)[1].reasons] == ["cost"]
    # As long as it was the newest of two nobody could know which of them was odd.
    assert judge_campaign(history[:2], replace(PLAN, rule="information"))[1].accepted


def test_a_movement_before_the_first_test_input_is_no_test_and_one_after_it_is_to_be_repeated() -> None:
    named = manoeuvre()
    unnamed = replace(named, span=replace(named.span, kind="other"))
    trimming = CandidateManeuver(estimate(), reasons=(QUIET,), maneuver=unnamed)
    first = CandidateManeuver(estimate(), maneuver=named)
    words = [one.sentence.partition(":")[0] for one in judge_campaign([trimming, first, trimming], PLAN)]
    assert words == ["NO TEST INPUT", "ACCEPTED", "REPEAT"]


def test_a_manoeuvre_without_an_estimate_is_refused_with_its_reason() -> None:
    (verdict,) = judge_campaign(
        [CandidateManeuver(NoEstimate("no_input", "the elevator did not move"))], PLAN
    )
    assert not verdict.accepted
    assert verdict.reasons[0].code == "no_input"
    assert verdict.sentence == "REPEAT: the elevator did not move"


def test_excluding_a_manoeuvre_by_hand_recomputes_every_later_verdict() -> None:
    history = flown([1e-12, 1e-9, 1.5e-9])
    assert [v.accepted for v in judge_campaign(history, PLAN)] == [True, False, False]
    history[0] = replace(history[0], excluded_because="wrong flap setting")
    verdicts = judge_campaign(history, PLAN)
    assert [v.accepted for v in verdicts] == [False, True, True]
    assert verdicts[0].sentence == "EXCLUDED by hand: wrong flap setting"
    assert verdicts[0].reasons[0].code == "excluded"


def test_including_it_again_restores_the_verdicts() -> None:
    history = flown([1e-12, 1e-9])
    excluded = [replace(history[0], excluded_because="gust"), history[1]]
    assert judge_campaign(excluded, PLAN) != judge_campaign(history, PLAN)
    assert judge_campaign([replace(excluded[0], excluded_because=None), history[1]], PLAN) == judge_campaign(
        history, PLAN
    )


def test_judging_one_by_one_and_all_at_once_agree() -> None:
    history = flown([2e-9, 1e-9, 5e-9, 1.9e-9, 0.5e-9])
    one_by_one = [judge_campaign(history[: i + 1], PLAN)[-1] for i in range(len(history))]
    assert one_by_one == list(judge_campaign(history, PLAN))


def test_cautions_stand_on_the_verdict_once() -> None:
    noted = replace(estimate(), notes=("servo dynamics unknown",))
    flown_once = CandidateManeuver(noted, cautions=("alpha is derived", "servo dynamics unknown"))
    (verdict,) = judge_campaign([flown_once], PLAN)
    assert verdict.accepted
    assert verdict.cautions == ("alpha is derived", "servo dynamics unknown")


def test_only_accepted_manoeuvres_enter_the_model() -> None:
    history = flown([1e-9, 3e-9, 1.1e-9])
    assert [e.cost for e in accepted_estimates(history, "continuous")] == [1e-9, 1.1e-9]
    assert len(accepted_estimates(history, "information")) == 3
