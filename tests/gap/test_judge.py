"""The judge turns evidence into probabilities, and its reasons add up to the odds it states."""

import json
import math
from dataclasses import replace

import numpy as np
import pytest

from advisor.gap.alternative import Alternative
from advisor.gap.document import gap_document
from advisor.gap.effects import EFFECTS
from advisor.gap.evidence.course import drift_and_step
from advisor.gap.evidence.measured import FullFit, Measured, QuickFit, Residual
from advisor.gap.evidence.quantities import QUANTITIES
from advisor.gap.evidence.rows import UNKNOWN_IN, Row, rows_of
from advisor.gap.judge.logit import Logit
from advisor.gap.judge.posterior import posterior
from advisor.gap.judge.prior import FIELD, FieldPrior, field_prior
from advisor.gap.judge.weights import LOGIT
from advisor.gap.judge.why import MOST_LINES
from advisor.gap.verdict.as_judged import answered, as_judged, doubtful
from advisor.gap.verdict.limits import limits_of
from advisor.words.problems import ConfigurationError
from benchmarks.judge.fit import slots
from tests.gap.test_report_screen import diagnosis
from tests.schemas import breaches

CHANNELS = ("alpha", "q", "a_z", "theta")
EVEN = FieldPrior(0.25, 0.25, 0.25, 0.25)
LAG, DELAY = (Alternative("effect", name, "input") for name in ("actuator_lag", "transport_delay"))
NONE = Alternative("none", "none")
SIMPLE = Logit(
    {"effect": {"fit_gain": 1.0, "heldout_sigmas": 0.5, "size": 0.2}, "none": {"of_peak": -2.0}},
    {"none": 0.5},
    EVEN,
)


def residual(power=1.0, probes=0.0, of_peak=0.002):
    """Return a residual with equal power in all channels and manoeuvres."""
    return Residual(
        power=np.full(4, power), by_maneuver=np.full((6, 4), power), of_peak=np.full(4, of_peak),
        activity=np.full(4, power), probes={b: (probes, 0.1) for b in UNKNOWN_IN if b != "timing"},
    )  # fmt: skip


def still(**changes):
    """Return what was measured of a flight whose residual is white noise, with the right file."""
    calm = residual()
    measured = Measured(
        channels=CHANNELS, samples=np.full((6, 4), 300.0), base=calm, last=calm, base_gap=0.0,
        base_held=np.full((6, 4), 1.0), named_gain=0.0, fitted={}, added={}, has_file=True,
        screened={e: QuickFit(-3.0, 0.0, 0.1) for e, t in EFFECTS.items() if t.block != "air"},
        file_distance=3.0,
    )  # fmt: skip
    return replace(measured, **changes)


def delayed():
    """Return what was measured of a flight with a plain transport delay."""
    loud = residual(power=8.0, probes=500.0, of_peak=0.2)
    fit = FullFit(
        gain=2000.0, support=6.0, change=100.0, sigmas=60.0, size=12.0, at_bound=False, removed=7.0, gap=0.01,
        power=np.ones(4), by_maneuver=np.ones((6, 4)),
    )  # fmt: skip
    weak = replace(fit, gain=900.0, power=np.full(4, 4.0), by_maneuver=np.full((6, 4), 4.0), gap=3.0)
    screened = still().screened | {
        "transport_delay": QuickFit(2000.0, 0.0, 12.0), "actuator_lag": QuickFit(900.0, 0.0, 8.0),
    }  # fmt: skip
    return still(
        base=loud, base_gap=7.0, base_held=np.full((6, 4), 8.0), screened=screened, named_gain=2000.0,
        fitted={"transport_delay": fit, "actuator_lag": weak}, added={"transport_delay": fit},
    )  # fmt: skip


def test_every_alternative_has_a_row_and_every_row_the_same_columns():
    rows = posterior(rows_of(delayed()), FIELD).evidence
    labels = {one.alternative.label for one in rows}
    assert labels == {"none", "parameters", *EFFECTS, *(f"unknown@{block}" for block in UNKNOWN_IN)}
    names = [quantity.name for quantity in QUANTITIES]
    assert all([column.name for column in one.columns] == names for one in rows)
    assert all(column.sentence.endswith(".") for column in rows[0].columns)


def test_no_column_names_an_effect():
    assert not {quantity.name for quantity in QUANTITIES} & set(EFFECTS)


def test_no_row_has_a_value_without_a_column():
    names = {quantity.name for quantity in QUANTITIES}
    assert all(set(row.values) <= names for row in rows_of(delayed()))


def test_the_weight_that_an_accelerometer_reads_speaks_of_the_accelerometer_alone():
    rows = posterior(rows_of(still(weight={"accelerometer": 2.0})), FIELD).evidence
    told = {one.alternative.label: one.value("weight") for one in rows if one.value("weight")}
    assert told == {"unknown@accelerometer": 2.0}


def test_probabilities_of_all_alternatives_sum_to_one():
    told = posterior(rows_of(delayed()), FIELD).probabilities
    total = told.none + told.parameters + sum(told.unknown.values()) + sum(told.effects.values())
    assert total == pytest.approx(1.0)


def test_a_file_without_numbers_has_no_probability_of_wrong_ones():
    assert posterior(rows_of(still(has_file=False)), FIELD).probabilities.parameters == 0.0


def test_a_calm_flight_of_a_right_file_is_none():
    assert posterior(rows_of(still()), FIELD).probabilities.none > 0.5


def two_found():
    """Return what was measured of a flight where the search found a delay with a smaller lag."""
    both = replace(delayed().fitted["transport_delay"], gain=2100.0, gap=0.005)
    lag = replace(both, gain=100.0, removed=0.5)
    return replace(
        delayed(),
        added={**delayed().added, "actuator_lag": lag},
        sets={("transport_delay", "actuator_lag"): both},
    )


def test_a_set_that_the_search_found_is_a_row_of_its_own():
    rows = {one.alternative.label: one for one in posterior(rows_of(two_found()), FIELD).evidence}
    found = rows["transport_delay + actuator_lag"]
    assert found.value("fit_gain") == 2100.0
    assert found.value("fit_share") == 1.0
    assert found.value("model_gain") == rows["transport_delay"].value("model_gain") + 100.0
    assert found.value("screen_gain") == rows["transport_delay"].value("screen_gain")
    assert found.alternative.block == "input"


def test_a_set_counts_for_its_main_effect_and_all_probabilities_still_sum_to_one():
    told = posterior(rows_of(two_found()), FIELD, SIMPLE)
    effects = told.probabilities.effects
    stated = {one.alternative.label: one.probability for one in told.evidence}
    both = stated["transport_delay"] + stated["transport_delay + actuator_lag"]
    assert effects["transport_delay"] == pytest.approx(both)
    assert effects["actuator_lag"] == pytest.approx(stated["actuator_lag"])
    assert told.probabilities.none + sum(effects.values()) + sum(told.probabilities.unknown.values()) + (
        told.probabilities.parameters
    ) == pytest.approx(1.0)


def test_a_set_with_equal_evidence_makes_its_main_effect_no_likelier():
    rows = [Row(LAG, {"size": 2.0}), Row(NONE, {})]
    with_set = [*rows, Row(replace(LAG, second="transport_delay"), {"size": 2.0})]
    alone, both = (posterior(some, EVEN, SIMPLE).of(LAG) for some in (rows, with_set))
    assert both == pytest.approx(alone)


def test_the_reasons_of_a_set_add_up_to_its_log_odds_against_another_first_cause():
    told = posterior(rows_of(two_found()), FIELD)
    answer = replace(DELAY, second="actuator_lag")
    stated = {one.alternative: one.probability for one in told.evidence}
    rival = told.rival_of(answer)
    assert rival.first != DELAY
    odds = math.log(stated[answer] / stated[rival])
    assert sum(line.nats for line in told.why(answer)) == pytest.approx(odds)


def test_the_answer_of_two_causes_is_their_set_where_the_search_fitted_one():
    found = diagnosis()
    causes = (replace(found.causes[0], present=True), replace(found.causes[0], effect="gust", present=True))
    both = replace(DELAY, second="gust")
    assert answered(replace(found, causes=causes), [DELAY, both]) == both
    assert answered(replace(found, causes=causes), [DELAY]) == DELAY


def test_a_plain_delay_is_likelier_than_everything_else_together():
    assert posterior(rows_of(delayed()), FIELD).probabilities.effects["transport_delay"] > 0.5


def test_the_judge_has_at_most_sixty_weights():
    numbers = {weight for weights in LOGIT.weights.values() for weight in weights.values()}
    assert len(numbers | set(LOGIT.intercepts.values())) <= 60
    assert len(slots()) <= 60


def test_the_field_prior_moves_the_odds_by_just_its_own_ratio():
    rows = rows_of(delayed())
    even, other = (posterior(rows, prior, SIMPLE) for prior in (EVEN, FieldPrior(0.5, 0.2, 0.2, 0.1)))
    odds = [told.of(DELAY) / told.of(NONE) for told in (even, other)]
    assert odds[1] / odds[0] == pytest.approx(0.2 / 0.5)


def test_the_shares_of_the_fitted_flights_are_replaced_by_the_field_prior():
    rows, flown = rows_of(delayed()), FieldPrior(0.1, 0.1, 0.7, 0.1)
    many = posterior(rows, flown, replace(SIMPLE, flown=flown))
    field = posterior(rows, FieldPrior(0.7, 0.1, 0.1, 0.1), replace(SIMPLE, flown=flown))
    odds = [told.of(NONE) / told.of(DELAY) for told in (many, field)]
    assert odds[1] / odds[0] == pytest.approx(49.0)
    assert many.of(NONE) == pytest.approx(posterior(rows, EVEN, SIMPLE).of(NONE))


@pytest.mark.parametrize("logit", [SIMPLE, LOGIT])
def test_the_reasons_add_up_to_the_log_odds_in_at_most_seven_lines(logit):
    told = posterior(rows_of(delayed()), FIELD, logit)
    lines = told.why(DELAY)
    assert len(lines) <= MOST_LINES
    odds = told.of(DELAY) / told.of(told.rival_of(DELAY))
    assert sum(line.nats for line in lines) == pytest.approx(math.log(odds))


@pytest.mark.parametrize("logit", [SIMPLE, LOGIT])
def test_without_the_evidence_of_the_first_line_the_log_odds_change_by_just_that_line(logit):
    told = posterior(rows_of(delayed()), FIELD, logit)
    first = next(line for line in told.why(LAG) if line.name not in ("prior", "rest"))
    rival = told.rival_of(LAG)
    rows = [Row(r.alternative, {k: v for k, v in r.values.items() if k != first.name}) for r in told.rows]
    without = posterior(rows, FIELD, logit)
    before, after = (math.log(t.of(LAG) / t.of(rival)) for t in (told, without))
    assert before - after == pytest.approx(first.nats)


def test_two_alternatives_that_share_the_probability_are_both_told():
    said = doubtful([(LAG, 0.6), (DELAY, 0.35)], (LAG, 0.6))
    assert said == "The evidence does not decide between actuator lag (60 %) and transport delay (35 %)."
    assert doubtful([(LAG, 0.95)], (LAG, 0.95)) == ""


def test_the_doubt_stands_among_the_limits_next_to_the_answer_and_in_json():
    rows = [Row(a, {"size": s}) for a, s in ((DELAY, 3.0), (LAG, 2.7), (NONE, 0.0))]
    told = posterior(rows, EVEN, Logit({"effect": {"size": 1.0}}, {"none": -9.0}, EVEN))
    found = as_judged(diagnosis(), told)
    said = "The evidence does not decide between transport delay (52 %) and actuator lag (48 %)."
    assert next(limits_of(found)) == said
    assert gap_document(found)["limits"][0] == said
    assert said not in found.notes


def test_an_answer_that_the_evidence_contradicts_says_so():
    said = doubtful([(NONE, 0.95)], (LAG, 0.02))
    assert said == "By the evidence no gap (95 %) is likelier than this answer (2 %)."


def test_a_credible_answer_has_the_fewest_alternatives_with_nine_tenths():
    rows = [Row(a, {"size": s}) for a, s in ((LAG, 3.0), (DELAY, 2.0), (NONE, 0.0))]
    told = posterior(rows, EVEN, Logit({"effect": {"size": 1.0}}, {"none": -9.0}, EVEN))
    assert [a for a, _ in told.credible] == [LAG, DELAY]
    assert sum(p for _, p in told.credible) >= 0.9


def test_a_diagnosis_states_the_probabilities_of_the_evidence():
    found = as_judged(diagnosis(), posterior(rows_of(delayed()), FIELD))
    assert found.probabilities is not None
    assert all(cause.probability == found.probabilities.effects[cause.effect] for cause in found.causes)
    assert answered(found, [DELAY]) == DELAY
    document = json.loads(json.dumps(gap_document(found), allow_nan=False))
    assert breaches("gap", document) == []
    assert sum(line["nats"] for line in document["why"]) == pytest.approx(
        math.log(
            document["probabilities"]["effects"]["transport_delay"]
            / probability_of(document["rival"], document)
        )
    )


def probability_of(label, document):
    """Return the probability of an alternative of a document by its label."""
    return next(one["probability"] for one in document["evidence"] if one["alternative"] == label)


def test_a_prior_is_read_as_people_write_it_and_a_wrong_one_is_refused():
    assert field_prior("none=4,parameters=2,effect=3,unknown=1") == FIELD
    for wrong in (
        "none=1",
        "none=1,parameters=1,effect=1,other=1",
        "none=a",
        "",
        "none=0,parameters=1,effect=1,unknown=1",
    ):
        with pytest.raises(ConfigurationError, match="--prior"):
            field_prior(wrong)


def test_a_trim_that_drifts_shows_as_a_drift_and_one_that_steps_as_a_step():
    rng = np.random.default_rng(0)
    t, noise = np.arange(9.0), 0.01 * rng.standard_normal(9)
    drift, step = (
        drift_and_step({"M_trim": course + noise}, t)["moment_equation"]
        for course in (0.1 * t, 1.0 * (t > 4))
    )
    calm = drift_and_step({"M_trim": noise}, t)["moment_equation"]
    assert drift[0] > drift[1] > calm[1]
    assert step[1] > step[0]
    assert max(calm) < 3.0


def test_few_manoeuvres_have_no_course():
    assert drift_and_step({"M_trim": np.arange(4.0)}, np.arange(4.0)) == {}


def test_at_the_shares_of_its_own_flights_the_judge_is_not_corrected():
    shares = FieldPrior(none=0.1, parameters=0.2, effect=0.6, unknown=0.1)
    uneven = replace(SIMPLE, flown=shares)
    assert uneven.offset("effect", shares) == pytest.approx(0.0)
    assert uneven.offset("none", shares) == pytest.approx(0.5)
    assert uneven.offset("none", FIELD) == pytest.approx(0.5 + math.log(4.0))
