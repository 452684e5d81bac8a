"""One scorer for every generator: each class of answer, and what the figures count."""

from typing import Any

import pytest

from sim.blind.sizes import INSIDE
from sim.sealed.judge import NO_ANSWER, judge
from sim.sealed.score import Rate, score, wilson


def truth(kind: str, effects: dict[str, dict[str, float]] | None = None, **changes: Any) -> dict[str, Any]:
    return {
        "kind": kind, "condition": "clean", "effects": effects or {}, "blocks": [], "gap": 1.0,
        "background": [],
    } | changes  # fmt: skip


def answer(
    verdict: str | None, *causes: str, block: str = "", waterfall: tuple[str, ...] = (), **first: Any
) -> Any:
    told: list[dict[str, Any]] = [{"effect": name, "probability": 0.99} for name in causes]
    if told:
        told[0] |= first
    return {
        "verdict": verdict,
        "causes": told,
        "where": {"block": block},
        "waterfall": [{"effect": name} for name in waterfall],
        "shrink": {"percent": 98.0},
    }


NONE, TURBULENT = truth("none"), truth("none", background=["turbulence"])
ONE = truth("one", {"alpha_lag": {"lag_s": 0.05}}, blocks=["alpha_sensor"])
TWO = truth("two", {"alpha_lag": {}, "icing": {}}, blocks=["alpha_sensor", "force_equation"])
NUMBERS = truth("parameters")
OUTSIDE = truth("outside", {"fuel_slosh": {}}, blocks=["moment_equation"])
LAGGING = truth("simulator", {"actuator_lag": {"lag_s": 0.05}}, blocks=["input"])
UNCHANGED = truth("simulator")
SILENT: dict[str, Any] = {}
UNUSABLE = {"usable": False, "verdict": None}


@pytest.mark.parametrize(
    ("case", "said", "right"),
    [
        (NONE, answer("none"), True),
        (NONE, answer(None), True),  # without a model there is no simulator to be wrong: nothing is claimed
        (NONE, answer("parameters"), False),
        (NONE, answer("unknown", block="air"), False),
        (NONE, answer("effect", "turbulence"), False),
        (NONE, SILENT, False),
        (NONE, UNUSABLE, False),
        (TURBULENT, answer("effect", "turbulence"), True),
        (TURBULENT, answer("effect", "gust"), False),
        (TURBULENT, answer("unknown", block="air"), False),
        (TURBULENT, answer(None), True),
        (ONE, answer("effect", "alpha_lag"), True),
        (ONE, answer("effect", "alpha_skew", "alpha_lag"), False),
        (ONE, answer("unknown", "alpha_lag", block="alpha_sensor"), False),
        (ONE, answer(None, "alpha_lag"), False),
        (ONE, answer("none"), False),
        (ONE, SILENT, False),
        (TWO, answer("effect", "alpha_lag", waterfall=("alpha_lag", "icing")), True),
        (TWO, answer("effect", "icing", waterfall=("alpha_lag",)), True),
        (TWO, answer("effect", "alpha_lag", "icing"), False),  # an alternative is no claim
        (TWO, answer("effect", "alpha_lag"), False),
        (NUMBERS, answer("parameters"), True),
        (NUMBERS, answer("none"), False),
        (NUMBERS, answer(None), False),
        (NUMBERS, SILENT, False),
        (OUTSIDE, answer("unknown", block="moment_equation"), True),
        (OUTSIDE, answer("unknown", block="air"), False),
        (OUTSIDE, answer("effect", "cg_shift", block="moment_equation"), False),
        (OUTSIDE, answer(None, block="moment_equation"), False),
        (LAGGING, answer("effect", "actuator_lag"), True),
        (LAGGING, answer("none"), False),
        (LAGGING, answer("parameters"), False),
        (UNCHANGED, answer("none"), True),
        (UNCHANGED, answer("parameters"), True),
        (UNCHANGED, answer("effect", "icing"), False),
        (UNCHANGED, SILENT, False),
    ],
    ids=lambda part: str(part.get("kind") or part.get("verdict")) if isinstance(part, dict) else str(part),
)
def test_an_answer_is_right_where_it_fits_its_question(case, said, right):
    assert judge(case, said).is_right is right


def test_a_document_that_says_unusable_counts_as_no_answer() -> None:
    assert judge(NONE, UNUSABLE).verdict == judge(NONE, SILENT).verdict == NO_ANSWER


def figures(*pairs: tuple[dict[str, Any], dict[str, Any]]) -> dict[str, Rate]:
    return {rate.name: rate for rate in score([judge(case, said) for case, said in pairs])}


def test_a_null_verdict_where_nothing_is_counts_as_no_alarm() -> None:
    told = figures((NONE, answer(None)), (NONE, answer("none")), (NONE, answer("unknown")))
    assert (told["false alarms without an effect"].hits, told["false alarms without an effect"].count) == (
        1,
        3,
    )


def test_perfect_answers_score_full_marks_and_shuffled_labels_fall() -> None:
    size = {"lag_s": {"value": 0.051, "std": 0.001}}
    told = figures(
        *(
            (
                truth("one", {name: {"lag_s": 0.05}}, blocks=["input"]),
                answer("effect", name, probability=1.0, parameters=size, block="input"),
            )
            for name in sorted(INSIDE)
        )
    )
    assert told["right cause first, one effect"].value == 100.0
    assert told["right cause first, clean"].value == 100.0
    assert told["named effects: right block"].value == 100.0
    assert told["size within its stated 95 % interval"].value == 100.0
    assert told["expected calibration error of probabilities"].value == 0.0
    assert told["held-out shrink, right cause, clean (median %)"].value == 98.0
    assert told["label shuffle: right by chance (20 shuffles)"].value < 10.0


def test_a_size_beside_its_interval_is_counted_and_one_without_deviation_is_not() -> None:
    beside = {"lag_s": {"value": 0.055, "std": 0.001}, "other": {"value": 1.0, "std": 1.0}}
    told = figures(
        (ONE, answer("effect", "alpha_lag", parameters=beside)),
        (ONE, answer("effect", "alpha_lag", parameters={"lag_s": {"value": 0.05, "std": None}})),
    )
    inside = told["size within its stated 95 % interval"]
    assert (inside.hits, inside.count) == (0, 1)


def test_wrong_answers_are_counted_where_they_belong() -> None:
    told = figures(
        (NONE, answer("effect", "alpha_lag")),
        (NONE, answer("none")),
        (OUTSIDE, answer("unknown", block="moment_equation")),
        (TWO, answer("effect", "alpha_lag", waterfall=("alpha_lag", "icing"))),
        (ONE | {"condition": "hard"}, answer("effect", "alpha_skew", probability=0.6)),
        (NUMBERS, SILENT),
    )
    assert told["false alarms without an effect"].value == 50.0
    assert told["outside the catalogue: unknown"].value == 100.0
    assert told["outside the catalogue: right block"].value == 100.0
    assert told["two effects: both named"].value == 100.0
    assert told["right cause first, hard, moderate or stronger"].value == 0.0
    assert told["a named cause is right (hard)"].value == 0.0
    assert (told["usable"].hits, told["usable"].count) == (5, 6)


def test_each_condition_has_a_share_of_its_own_and_small_hard_effects_count_apart() -> None:
    right, wrong = answer("effect", "alpha_lag"), answer("none")
    told = figures(
        (ONE, right),
        (ONE | {"condition": "filtered"}, wrong),
        (ONE | {"condition": "hard", "gap": 0.1}, wrong),
        (ONE | {"condition": "hard", "gap": 0.3}, right),
        (ONE | {"condition": "hard", "gap": None}, right),
    )
    assert told["right cause first, filtered"].value == 0.0
    assert (told["right cause first, hard"].hits, told["right cause first, hard"].count) == (2, 3)
    assert (told["right cause first, one effect"].hits, told["right cause first, one effect"].count) == (3, 5)
    moderate = told["right cause first, hard, moderate or stronger"]
    assert (moderate.hits, moderate.count) == (2, 2)


def test_the_air_that_a_flight_was_made_in_is_a_cause_that_is_there_but_not_the_one_that_was_drawn() -> None:
    case = truth("one", {"alpha_scale": {"scale": 0.03}}, condition="hard", background=["turbulence"])
    told = figures(*((case, answer("effect", name)) for name in ("alpha_scale", "turbulence", "alpha_skew")))
    assert told["a named cause is right (hard)"].value == pytest.approx(100.0 / 3.0)
    assert told["  the same, or the air it was flown in"].value == pytest.approx(200.0 / 3.0)


def test_what_is_true_of_a_log_by_its_making_stays_an_alarm_and_has_a_row_of_its_own() -> None:
    case = NONE | {"also_true": ["alpha_skew", "alpha_lag"]}
    told = figures((case, answer("effect", "alpha_skew")), (case, answer("none")))
    assert told["true of the log and not asked for, named first"].value == 50.0
    assert told["false alarms without an effect"].value == 50.0


@pytest.mark.parametrize(
    ("hits", "trials", "low", "high"), [(8, 10, 0.490, 0.943), (0, 20, 0.0, 0.161), (20, 20, 0.839, 1.0)]
)
def test_an_interval_is_wilsons(hits: int, trials: int, low: float, high: float) -> None:
    assert wilson(hits, trials) == pytest.approx((low, high), abs=1e-3)
