"""An answer that the simulator's own flights contradict: every face then says the one that they leave."""

from dataclasses import replace

import numpy as np
import pytest

from advisor.gap.alternative import Alternative, AlternativeEvidence
from advisor.gap.result import ComparedDerivative, Diagnosis, Value
from advisor.gap.verdict.text import title_of
from advisor.report.gap_document import gap_document
from advisor.report.gap_steps import next_steps
from advisor.simulators.contradicted import contradicted
from tests.gap.test_report_screen import CURVED, DELAY, diagnosis, printed

EVIDENCE = (
    AlternativeEvidence(Alternative("effect", "transport_delay", "input"), (), 0.95),
    AlternativeEvidence(Alternative("effect", "nonlinear_pitching_moment", "moment_equation"), (), 0.02),
    AlternativeEvidence(Alternative("parameters", "parameters"), (), 0.02),
    AlternativeEvidence(Alternative("unknown", "unknown", "force_equation"), (), 0.01),
)


def taken_back(removed: float, **changes: object) -> Diagnosis:
    """Return a diagnosis whose delay, 95 % likely, was taken back; the numbers remove a share of the gap."""
    found = diagnosis(
        evidence=EVIDENCE, answer=EVIDENCE[0].alternative, causes=(replace(DELAY, present=False), CURVED),
        effects={"thrust_moment": {"M_throttle": 0.1}},
        derivatives=(ComparedDerivative("M_q", -4.0, Value(-5.0, 0.1)),),
    )  # fmt: skip
    return contradicted(replace(found, **changes), removed)


def test_where_the_numbers_remove_the_gap_without_the_cause_every_face_says_wrong_numbers():
    found = taken_back(0.9)
    steps = next_steps(found, ["flight.tlog"], "mine.yaml")
    document = gap_document(found, (), None)
    assert found.verdict == document["verdict"] == "parameters"
    assert title_of(found) == "WRONG NUMBERS"
    assert "wrong numbers: the eight fitted derivatives remove" in found.sentence
    assert document["probabilities"]["parameters"] == pytest.approx(0.97)
    assert "transport_delay" not in document["probabilities"]["effects"]
    assert (document["where"]["block"], document["where"]["share"]) == ("moment_equation", 0.9)
    assert "M_q" in steps[0].text
    screen = "\n".join(printed(found, 100, why=True, steps=steps))
    assert "WRONG NUMBERS" in screen
    assert "transport delay" not in screen
    assert "CAUSE FOUND" not in screen


def test_where_nothing_removes_half_of_the_gap_it_is_unknown_and_nothing_is_handed_over():
    found = taken_back(0.4)
    assert (found.verdict, title_of(found)) == ("unknown", "UNKNOWN CAUSE")
    assert "the closest, transport delay, is not enough" in found.sentence
    assert (found.where.block, found.where.share) == ("input", pytest.approx(0.95 / 0.96))
    assert not found.improves
    assert not found.effects
    assert found.shrink is None
    assert not any(step.text.startswith("Put into") for step in next_steps(found, ["a.tlog"], None))


def test_where_a_second_effect_stays_it_is_the_cause():
    stays = (replace(DELAY, present=False), replace(CURVED, present=True))
    found = taken_back(0.9, causes=stays)
    assert (found.verdict, title_of(found)) == ("effect", "CAUSE FOUND")
    assert [cause.effect for cause in found.causes if cause.present] == ["nonlinear_pitching_moment"]


@pytest.mark.parametrize("removed", [0.0, 0.4, 0.9])
def test_the_probabilities_sum_to_one_and_the_reasons_to_the_odds(removed):
    found = taken_back(removed)
    shares = [one.probability for one in found.evidence]
    assert sum(shares) == pytest.approx(1.0)
    assert shares == sorted(shares, reverse=True)
    mine, other = (
        sum(one.probability for one in found.evidence if one.alternative.name == name)
        for name in (found.answer.name, found.rival)
    )
    assert mine > other
    assert sum(part.nats for part in found.why) == pytest.approx(np.log(mine / other))


def test_numbers_that_make_the_gap_worse_are_unknown_too():
    numbers = replace(EVIDENCE[2], probability=0.95)
    delay = replace(EVIDENCE[0], probability=0.02)
    found = taken_back(0.0, evidence=(numbers, delay, *EVIDENCE[3:]), answer=numbers.alternative)
    assert (found.verdict, found.probabilities.parameters) == ("unknown", 0.0)
