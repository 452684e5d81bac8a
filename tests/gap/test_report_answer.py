"""The answer of a diagnosis as an engineer reads it: which numbers, how large, what limits it, what next."""

from dataclasses import replace
from pathlib import Path

import pytest

from advisor.gap.alternative import Contribution
from advisor.gap.decision import Decision
from advisor.gap.result import Cause, ComparedDerivative, Shrink, Value
from advisor.gap.verdict.text import limits_of
from advisor.report.facts.gap import changed, changes
from advisor.report.facts.reasons import in_percent, weighed
from advisor.report.gap_causes import decision_in_words
from advisor.report.gap_document import gap_document, next_steps
from advisor.report.gap_fidelity import peaks
from advisor.report.page.blocks import Listing
from advisor.report.page.gap import answer, shown_causes, write_gap_picture
from tests.gap.test_report_screen import DELAY, EVIDENCE, UNLIKELY, diagnosis, printed

STIFFER = ComparedDerivative("M_alpha", -44.6, Value(-34.3, 0.36))
SAME = ComparedDerivative("Z_alpha", -8.0, Value(-8.1, 0.2))
DERIVATIVES = (STIFFER, SAME)
LOGS = ["flight.tlog"]


def test_a_derivative_that_differs_stands_with_both_values_the_interval_and_the_change():
    assert changed(STIFFER) == "M_α −44.60 → −34.30 ± 0.71 1/s² (−23 %)"
    assert changed(replace(STIFFER, given=-30.0)).endswith("(+14 %)")


def test_a_derivative_of_another_sign_has_no_per_cent():
    assert changed(replace(STIFFER, given=44.6)) == "M_α 44.60 → −34.30 ± 0.71 1/s²"


def test_derivatives_that_agree_share_a_line():
    assert changes(DERIVATIVES)[1:] == ["Z_α agrees"]
    assert not SAME.differs
    assert STIFFER.differs


def test_wrong_numbers_are_named_in_the_box():
    lines = printed(diagnosis(verdict="parameters", derivatives=DERIVATIVES), 80)
    box = lines[: next(k for k, line in enumerate(lines) if line.startswith("╰"))]
    assert "WRONG NUMBERS" in box[0]
    assert any("M_α −44.60 → −34.30 ± 0.71 1/s² (−23 %)" in line for line in box)


def test_the_peak_error_comes_in_an_engineers_units():
    said = peaks(diagnosis().traces)
    assert said.startswith("peak error of α 5.7 → 0 deg, of q 5.7 → 0 deg/s, of a_z 0.1 → 0 m/s²")


def test_the_limits_of_an_answer_are_sentences_of_every_face():
    no_simulator = "No model to compare with: the answer is about the flight alone."
    found = diagnosis()
    assert list(limits_of(found)) == gap_document(found)["limits"] == [no_simulator]
    assert any(line.startswith(f"│ ! {no_simulator[:40]}") for line in printed(found, 80))
    assert Listing((no_simulator,)) in answer(gap_document(found))


def test_the_air_and_refused_manoeuvres_limit_an_answer():
    in_gusts = Shrink((1, 2), 10.0, 0.1, 99.0, (98.0, 100.0), beyond_air_percent=60.0)
    said = list(limits_of(diagnosis(derivatives=DERIVATIVES, shrink=in_gusts)))
    assert said[0].endswith("Without the air's part the gap falls by 60 %.")
    (one,) = limits_of(diagnosis(derivatives=DERIVATIVES, gap=replace(diagnosis().gap, by_air=2.0)))
    assert one.endswith("So the gap after the correction looks smaller than it is.")
    (one,) = limits_of(diagnosis(derivatives=DERIVATIVES, although_refused=(2,)))
    assert one == "Manoeuvre 2 is used, although advisor analyze refuses it."
    (more,) = limits_of(diagnosis(derivatives=DERIVATIVES, although_refused=(2, 3)))
    assert more == "Manoeuvres 2, 3 are used, although advisor analyze refuses them."


def test_a_gap_that_has_grown_is_marked():
    gap = replace(diagnosis().gap, by_maneuver=((1, 2.0, 0.1), (2, 0.5, 0.7)))
    lines = printed(diagnosis(gap=gap), 80)
    assert any("0.5 → 0.7 ▲" in line for line in lines)
    assert any(line.strip() == "▲ the gap is larger than before in manoeuvre 2" for line in lines)


def test_a_gap_that_prints_alike_has_not_grown():
    gap = replace(diagnosis().gap, by_maneuver=((1, 2.0, 0.1), (2, 0.5, 0.5000001)))
    assert not any("▲" in line for line in printed(diagnosis(gap=gap), 80))


def test_the_steps_say_what_to_put_how_to_prove_it_and_what_excludes_the_rival():
    put, prove, rival = next_steps(diagnosis(effects={"transport_delay": {}}), LOGS, "mine.yaml")
    better = "mine-with-transport-delay.yaml"
    assert "transport delay 30 ± 12 ms" in put.text
    assert put.command == f"advisor gap flight.tlog --aircraft mine.yaml --out {better}"
    assert prove.command == "advisor gap flight.tlog --aircraft mine.yaml --prove"
    assert rival.text == "To exclude actuator lag: log the measured surface position."


def test_wrong_numbers_are_put_as_numbers_and_name_the_file_though_a_propeller_belongs_to_the_fit():
    found = diagnosis(
        verdict="parameters", derivatives=DERIVATIVES, causes=(), effects={"thrust_moment": {"M_thrust": 0.1}}
    )
    put, *_ = next_steps(found, LOGS, "mine.yaml")
    assert put.text.startswith("Put into the simulator: M_α −44.60 → −34.30 ± 0.71 1/s² (−23 %).")
    assert put.command.endswith("--out mine-with-fitted-model.yaml")


@pytest.mark.parametrize(
    ("derivatives", "first"),
    [
        (DERIVATIVES, "Put into the simulator: M_α −44.60 → −34.30 ± 0.71 1/s² (−23 %)."),
        ((), "To exclude gust: fly more manoeuvres: turbulence recurs in each, a single gust does not."),
    ],
)
def test_moving_air_is_never_put_into_the_simulator(derivatives, first):
    air = Cause(
        "turbulence", "air", 0.95, {"sigma_w_m_s": Value(0.5, 0.1)}, ("gust",),
        "fly more manoeuvres: turbulence recurs in each, a single gust does not", 0.1, True,
    )  # fmt: skip
    step, *_ = next_steps(diagnosis(causes=(air,), derivatives=derivatives), LOGS, "mine.yaml")
    assert step.text.startswith(first)


def test_without_a_gap_there_is_nothing_to_put():
    steps = next_steps(diagnosis(verdict="none", causes=()), LOGS, None)
    assert steps == []


def test_the_document_lists_the_derivatives_that_differ():
    (one,) = gap_document(diagnosis(derivatives=DERIVATIVES))["parameters_changed"]
    assert (one["derivative"], one["simulator"], one["found"]) == ("M_alpha", -44.6, -34.3)
    low, high = one["ci95"]
    assert low == pytest.approx(-35.0, abs=0.01)
    assert high == pytest.approx(-33.6, abs=0.01)


def test_the_document_has_the_traces_sample_by_sample():
    found = diagnosis()
    document = gap_document(found)
    assert [trace["channel"] for trace in document["traces"]] == ["alpha", "q", "a_z", "theta"]
    assert document["traces"][0]["measured"] == pytest.approx(found.traces[0].measured.tolist(), rel=1e-6)


@pytest.mark.parametrize(("name", "head"), [("gap.svg", b"<?xml"), ("gap.png", b"\x89PNG")])
def test_the_picture_is_written_in_the_format_of_its_ending(tmp_path: Path, name: str, head: bytes):
    gap = replace(diagnosis().gap, by_maneuver=((2, 5.0, 0.2),))
    write_gap_picture(gap_document(diagnosis(gap=gap)), tmp_path / name)
    assert (tmp_path / name).read_bytes().startswith(head)


def test_an_effect_of_no_probability_has_no_row_on_the_page():
    assert [c["effect"] for c in shown_causes(gap_document(diagnosis(causes=(DELAY, UNLIKELY))))] == [
        "transport_delay"
    ]


@pytest.mark.parametrize(
    ("decision", "said"),
    [
        (
            Decision("turbulence", "likelihood", 41.24, 30.0, "nats"),
            "turbulence: passed, it raises the log likelihood of the flight by 41.2 nats (at least 30)",
        ),
        (
            Decision("force_equation", "decided", 0.3, 0.6, "probability"),
            "something without a name in the lift: rejected, its probability is 0.3 (at least 0.6)",
        ),
        (
            Decision("none", "against its rival", 1.25, 0.0, "nats"),
            "nothing to correct: passed, its log odds against the next answer are 1.25 nats (at least 0)",
        ),
    ],
)
def test_a_decision_is_a_sentence_with_its_number_and_its_limit(decision: Decision, said: str):
    assert decision_in_words(decision) == said


@pytest.mark.parametrize(
    ("probability", "said"), [(0.999, ">99 %"), (0.934, "93 %"), (0.006, "1 %"), (0.004, "<1 %")]
)
def test_a_probability_is_never_shown_as_0_or_100_percent(probability: float, said: str):
    assert in_percent(probability) == said


def test_the_reasons_of_the_document_end_with_their_sum_in_odds():
    nothing = Contribution("misfit", -0.002, "misfit")
    reasons = (Contribution("fit_gain", 2.0, "gain"), nothing, Contribution("rest", -0.5, "rest"))
    found = gap_document(
        diagnosis(why=reasons, answer=EVIDENCE[0].alternative, rival="actuator_lag", evidence=EVIDENCE)
    )
    assert found["why_heading"].startswith("why transport delay, and not actuator lag")
    assert weighed((one["nats"], one["text"]) for one in found["why"]) == [
        ("+2.0", "gain"),
        ("−0.5", "rest"),
        ("+1.5", "together: 4.5 to 1 for the answer"),
    ]
    assert found["how_sure"].startswith("Probability: transport delay 82 % (by this flight alone 82 %),")
