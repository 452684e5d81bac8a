"""A manoeuvre in buffet or stall is left out: beyond the others' angle of attack, and another aircraft."""

from dataclasses import replace

from advisor.aircraft.aircraft import CampaignPlan
from advisor.decision.history import CandidateManeuver
from advisor.decision.judge import judge_campaign
from tests.decision.campaigns import at_alpha, estimate, with_change
from tests.rows import row

PLAN = CampaignPlan()
STALLED = estimate(with_change("M_q", 0.65))


def codes(*estimates):
    verdicts = judge_campaign([CandidateManeuver(one) for one in estimates], PLAN)
    return [reason.code for verdict in verdicts for reason in verdict.reasons]


def normal(n, low_deg=2.0, high_deg=6.0):
    return [at_alpha(estimate(), low_deg + 0.1 * k, high_deg + 0.1 * k) for k in range(n)]


def test_the_sentence_names_both_angles_of_attack_and_the_next_step():
    history = [CandidateManeuver(one) for one in (*normal(2, 2.0, 6.0), at_alpha(STALLED, 8.0, 12.0))]
    sentence = judge_campaign(history, PLAN)[-1].sentence
    assert "flown about 10.0 deg of alpha (the others: 2.0 to 6.1)" in sentence
    assert sentence.endswith("fly it at their angle of attack")


BEYOND = at_alpha(STALLED, 8.0, 12.0)
SCATTERED = [at_alpha(estimate(with_change("M_q", by)), 2.0, 6.0) for by in (0.7, 1.0, 1.3)]
BLIND = [replace(one, fits=({"q": one.fits[0]["q"]},)) for one in (estimate(), estimate(), STALLED)]


@row("another aircraft beyond two others is left out", [*normal(2), BEYOND], ["alpha_range"])
@row("another aircraft beyond three others is left out", [*normal(3), BEYOND], ["alpha_range"])
@row("another aircraft beyond six others is left out", [*normal(6), BEYOND], ["alpha_range"])
@row("the order flown does not matter", [BEYOND, *normal(2)], ["alpha_range"])
@row("two stalls hide neither", [*normal(3), BEYOND, at_alpha(STALLED, 5.0, 15.0)], ["alpha_range"] * 2)
@row("a linear aircraft beyond the others counts", [*normal(3), at_alpha(estimate(), 8.0, 12.0)], [])
@row("a contradiction within their range is odd", [*normal(4), at_alpha(STALLED, 3.0, 7.0)], ["odd"])
@row("a larger test about the same angle counts", [*normal(2), at_alpha(STALLED, -2.0, 11.0)], [])
@row("of two manoeuvres nobody knows which is beyond", [*normal(1), BEYOND], [])
@row("others that scatter as much leave nothing out", [*SCATTERED, BEYOND], [])
@row("without a measured angle of attack nothing is beyond", BLIND, [])
def test_a_manoeuvre_beyond_the_others_angle_of_attack(history, reasons):
    assert codes(*history) == reasons
