"""The scorer of blind flights: alarms, log scores, and the flights with the telemetry of the world."""

from typing import Any

import numpy as np
import pytest

from benchmarks.gap_draws import DRAWS, STRATA, drawn
from benchmarks.gap_score import LEAST_SHARE, in_markdown, is_alarm, is_right, log_score, table


def flight(kind: str, first: str, shares: dict[str, float], **truth: Any) -> dict[str, Any]:
    """Return an answered flight; names other than none, parameters and unknown are effects."""
    effects = {n: p for n, p in shares.items() if n not in ("none", "parameters", "unknown")}
    told = {
        "none": shares.get("none", 0.0), "parameters": shares.get("parameters", 0.0),
        "unknown": {"input": shares.get("unknown", 0.0)}, "effects": effects,
    }  # fmt: skip
    return {
        "case": f"{truth.pop('generator', 'own')}/1/case",
        "truth": {"kind": kind, "effects": truth.pop("effects", {}), "background": [], **truth},
        "answer": {"first": {"name": first, "sizes": {}}, "probabilities": told, "gap": {"before": 2.0}},
        "seconds": 1.0,
    }


def test_an_alarm_is_an_effect_or_an_unknown_where_nothing_is_withheld() -> None:
    assert is_alarm(flight("none", "actuator_lag", {"actuator_lag": 0.9}))
    assert is_alarm(flight("none", "unknown", {"unknown": 0.9}))
    assert not is_alarm(flight("none", "parameters", {"parameters": 0.9}))
    assert not is_alarm(flight("none", "turbulence", {"turbulence": 0.9}, background=["turbulence"]))
    assert not is_alarm(flight("none", "alpha_skew", {"alpha_skew": 0.9}, also_true=["alpha_skew"]))
    assert not is_right(flight("outside", "alpha_skew", {"alpha_skew": 0.9}, also_true=["alpha_skew"]))


@pytest.mark.parametrize(
    ("kind", "effects", "share"),
    [("none", {}, 0.5), ("parameters", {}, 0.2), ("outside", {}, 0.1), ("one", {"alpha_lag": {}}, 0.15)],
)
def test_the_log_score_is_that_of_the_probability_of_the_truth(kind, effects, share):
    shares = {"none": 0.5, "parameters": 0.2, "unknown": 0.1, "alpha_lag": 0.15, "gust": 0.05}
    assert log_score(flight(kind, "none", shares, effects=effects)) == pytest.approx(np.log(share))


def test_a_truth_that_the_answer_excludes_costs_no_more_than_one_in_a_thousand() -> None:
    assert log_score(flight("none", "unknown", {"unknown": 1.0})) == pytest.approx(np.log(LEAST_SHARE))


def test_a_lag_of_either_control_is_right_where_all_servos_are_slow() -> None:
    effects = {"aileron_actuator_lag": {}, "rudder_actuator_lag": {}}
    assert is_right(flight("one", "rudder_actuator_lag", {"rudder_actuator_lag": 1.0}, effects=effects))


def test_flights_in_the_world_are_counted_apart() -> None:
    rows = list(
        table(
            [
                flight("none", "none", {"none": 0.9, "unknown": 0.1}),
                flight("none", "unknown", {"none": 0.1, "unknown": 0.9}, world={}),
            ]
        )
    )
    assert rows[0].split()[:8] == ["in", "the", "world:", "first", "answer", "right,", "own", "0"]
    assert next(r for r in rows if r.startswith("first answer right, own")).split()[4:7] == ["1", "of", "1"]


def test_the_page_has_a_row_for_each_figure_and_its_source() -> None:
    flights = [flight("none", "none", {"none": 1.0}), flight("none", "gust", {"gust": 1.0}, world={})]
    page = in_markdown(list(table(flights)), seed=7, count=2).splitlines()
    assert "| first answer right, own | 1 of 1 [ 21, 100] % |" in page
    assert "| in the world: false alarms, own | 1 of 1 [ 21, 100] % |" in page
    assert page[-1].startswith("2 flights, seed 7, 20")


@pytest.mark.study
def test_a_stratum_of_the_world_has_only_flights_with_its_numbers() -> None:
    names = [(name, case) for name, case in drawn(1, 41, ("own",), only_world=True)]
    assert len(names) == sum(stratum.in_world for stratum in STRATA)
    assert all("world" in case.truth for _, case in names)
    assert all("natural" in case.truth["background"] for _, case in names)


def test_every_generator_draws_flights_with_natural_numbers_in_all_of_them() -> None:
    assert set(DRAWS) - {"arduplane"} == {"own", "second", "third", "by hand"}
