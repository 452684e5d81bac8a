"""What the advice saves, and how soon a changed aircraft is noticed, in small numbers."""

import json

import pytest
from click.testing import CliRunner

from benchmarks.studies import advised, reports
from benchmarks.studies.__main__ import main

ALONE = ("--workers", "1")
"""In this process."""


@pytest.mark.study
def test_following_the_advice_saves_manoeuvres() -> None:
    pairs = advised.pairs(5, seed=1, cases=[("twin jet", 10.0)])
    savings = advised.savings(pairs, [advised.fly(pair) for pair in pairs])
    assert [s.same_excursion for s in savings] == [True, False]
    assert min(s.percent for s in savings) > 20.0


@pytest.mark.study
def test_what_the_advice_saves_is_told_for_two_aircraft() -> None:
    document = json.loads(CliRunner().invoke(main, ["advice", "--campaigns", "10", "--json", *ALONE]).stdout)
    assert {row["aircraft"] for row in document["rows"]} == {"twin jet", "UAV"}
    assert {row["same_excursion"] for row in document["rows"]} == {True, False}
    assert min(row["fewer_percent"] for row in document["rows"]) > 10.0


@pytest.mark.study
def test_a_changed_aircraft_is_noticed_within_two_manoeuvres() -> None:
    document = json.loads(CliRunner().invoke(main, ["change", "--campaigns", "10", "--json", *ALONE]).stdout)
    lost = [row for row in document["rows"] if row["lost"]]
    assert {(row["lost"], row["noise_percent"]) for row in lost} == {
        (name, noise) for name in ("M_alpha", "Z_alpha") for noise in (1.0, 2.5, 5.0)
    }
    assert all(row["confirmed_percent"] >= 90.0 for row in lost if row["noise_percent"] <= 2.5)
    assert all(row["confirmed_percent"] == 0.0 for row in document["rows"] if row["lost"] is None)


@pytest.mark.parametrize(
    "study", [reports.advice(3, 3), reports.change(30, 3), reports.early_stops(7, 3), reports.coverage(7, 3)]
)
def test_no_two_tasks_of_a_study_have_the_same_seed_and_together_they_are_all_campaigns(study):
    assert len(set(study.tasks)) == len(study.tasks)
    assert max(task.campaigns for task in study.tasks) < sum(task.campaigns for task in study.tasks)
