"""False stops of the default rule, in small numbers."""

import json

import pytest
from click.testing import CliRunner

from benchmarks.studies import stops
from benchmarks.studies.__main__ import main
from benchmarks.studies.stops import Case, Stops, by_case, fly, stop_blocks


def one(case: Case, campaigns: int = 6) -> Stops:
    (found,) = by_case([fly(block) for block in stop_blocks(campaigns, seed=5, cases=[case])])
    return found


@pytest.mark.study
@pytest.mark.parametrize(
    "case",
    [
        Case("white", 5.0),
        Case("white, tight", 5.0, tolerance_percent=1.0),
        Case("coloured", 2.5, tolerance_percent=2.0, correlation_s=0.2),
        Case("lag", 2.5, lag_s=0.14),
    ],
    ids=lambda case: case.name,
)
def test_no_stop_leaves_the_response_wrong_by_more_than_the_tolerance(case: Case) -> None:
    found = one(case)
    assert len(found.error_percent) >= 5
    assert found.false_percent <= 5.0


def test_the_default_rule_needs_no_more_manoeuvres_than_the_papers() -> None:
    found = one(Case("white", 5.0), campaigns=20)
    assert found.median_needed("information") == 2
    assert (found.median_needed("continuous") or 99) > 2
    assert found.never_percent("separate") > found.never_percent("information") == 0.0


def test_an_error_beyond_the_tolerance_counts_as_a_false_stop() -> None:
    found = Stops(Case("any", 1.0, tolerance_percent=2.0), {}, (1.0, 3.0, 1.5, 1.9), ())
    assert found.false_percent == 25.0


def test_a_forecast_is_kept_by_a_campaign_that_stops_no_later() -> None:
    found = Stops(Case("any", 1.0), {}, (), ((1, 1), (2, 1), (1, 2), (3, None)))
    assert found.kept_percent == 50.0


def test_the_study_of_stops_is_told_in_lines_and_as_a_document(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(stops, "CASES", (Case("white noise", 1.0),))
    words = ["stops", "--campaigns", "10", "--workers", "1"]
    assert "white noise" in CliRunner().invoke(main, words).stdout
    document = json.loads(CliRunner().invoke(main, [*words, "--json"]).stdout)
    assert document["schema"] == "advisor.study.stops/1"
    assert document["rows"][0]["needed"]["information"]["median"] == 2
    assert document["rows"][0]["false_percent"] == 0.0
