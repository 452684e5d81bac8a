"""The page of a batch: one row a flight, failures with their reason, trends with what changed."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from advisor.aircraft.aircraft import Aircraft
from advisor.aircraft.reference import PARAMETERS
from advisor.batch.flight import Analyzed, BatchTask, failed
from advisor.batch.index import Point, index_page, trend_svg
from advisor.batch.tables import change_over_flights, changes_of, lying_apart, not_told_apart
from advisor.oem.estimate import Estimate
from advisor.words.problems import Problem
from tests.report.page_reader import Page
from tests.report.test_browser import BROWSER, WIDTHS, opened

THETA = np.array([-0.009, -0.483, 0.104, 0.676, 0.475, -4.93, -2.01, -7.21])
STD = 0.01 * np.abs(THETA)


def estimate_of(seed: int, elevator: float = 1.0) -> Estimate:
    """A joint estimate with an error of 1 % in each parameter; the elevator's moment is scaled."""
    theta = THETA + STD * np.random.default_rng(seed).standard_normal(8)
    theta[PARAMETERS.index("M_delta_e")] *= elevator
    covariance = np.diag(STD**2)
    return Estimate(theta, covariance, covariance, 1.0, (), 1, {}, (), 1.0, 25.0)


def test_a_loss_of_the_elevators_moment_is_told_since_its_first_flight() -> None:
    flights = [(n, estimate_of(n, 1.0 if n < 17 else 0.85)) for n in range(11, 23)]
    found = change_over_flights(flights)
    assert found is not None
    assert found.since == 17
    assert [moved.parameter for moved in found.change.moved] == ["M_delta_e"]
    assert found.sentence.startswith("Since flight 17 M_δe is 15 % smaller")
    assert "a loss of the elevator's moment" in found.sentence


def test_flights_that_differ_by_their_errors_show_no_change() -> None:
    assert change_over_flights([(n, estimate_of(n)) for n in range(1, 13)]) is None


def test_two_flights_are_too_few_for_a_change() -> None:
    assert change_over_flights([(1, estimate_of(1)), (2, estimate_of(2, 0.5))]) is None


def test_two_flights_whose_intervals_lie_apart_are_told() -> None:
    told = lying_apart([(4, estimate_of(1)), (7, estimate_of(2, 0.5))])
    assert told.startswith("M_δe of flights 4 and 7 lies apart: −7.")
    assert told.count("±") == 2


def test_flights_whose_intervals_overlap_are_not_told_apart() -> None:
    assert lying_apart([(1, estimate_of(1)), (2, estimate_of(2))]) == ""


def test_an_estimate_that_was_kept_is_compared_as_it_was() -> None:
    estimate = replace(estimate_of(3), covariance=np.diag([np.inf, *STD[1:] ** 2]))
    joint = {
        "theta": estimate.theta.tolist(),
        "covariance": [[None if not np.isfinite(v) else v for v in row] for row in estimate.covariance],
        "covariance_cr": estimate.covariance_cr.tolist(),
        "airspeed_m_s": 25.0,
    }
    again = Analyzed("a.tlog", "", "", 0.0, {}, joint).estimate
    assert again is not None
    np.testing.assert_array_equal(again.theta, estimate.theta)
    np.testing.assert_array_equal(np.isfinite(again.covariance), np.isfinite(estimate.covariance))


def flown(number: int, elevator: float = 1.0) -> Analyzed:
    """A flight that counts, begun on the day of its number, with two manoeuvres."""
    found = estimate_of(number, elevator)
    document = {
        "usable": True,
        "problems": [],
        "log": {"vehicle": {"system": 1, "autopilot": "px4"}},
        "maneuvers": [{"verdict": "accepted"}, {"verdict": "rejected"}],
        "flight_test": {"sentence": "CONTINUE: the criterion is 40 %."},
        "lateral": {"maneuvers": []},
    }
    joint = {
        "theta": found.theta.tolist(),
        "covariance": found.covariance.tolist(),
        "covariance_cr": found.covariance_cr.tolist(),
        "airspeed_m_s": 25.0,
    }
    began_s = 1.8e9 + 86400.0 * number
    log = f"/logs/of a/campaign/flight-{number}.bin"
    return Analyzed(log, "a.yaml", "", began_s, document, joint, "Talon")


def unusable(log: str) -> Analyzed:
    task = BatchTask(Path(log), Aircraft(), "", "")
    return failed(task, [Problem("empty", "The log is <b>empty</b>.", "Give another.")])


FLIGHTS = [
    *(flown(n, 1.0 if n < 6 else 0.8) for n in range(1, 11)),
    unusable("<script>1</script>.bin"),
]


@pytest.fixture(scope="module")
def page() -> Page:
    return Page.read(index_page(FLIGHTS))


def test_a_row_is_a_flight_with_its_day_and_what_came_of_it(page: Page) -> None:
    _, first, *_, last = page.tables["flights"]
    assert len(page.tables["flights"]) == 1 + len(FLIGHTS)
    assert first == [
        "1",
        "/logs/of a/campaign/flight-1.bin",
        "2027-01-16 08:00",
        "Talon",
        "1 of 2",
        "Not complete: the criterion is 40 %.",
    ]
    assert last[2] == "not dated"
    assert last[5] == "Cannot be used: The log is <b>empty</b>. Give another."


def test_names_of_logs_and_reasons_are_text_only_and_nothing_is_asked_for(page: Page) -> None:
    assert page.tables["flights"][-1][1] == "<script>1</script>.bin"
    assert not page.tags & {"script", "link", "img", "iframe", "b"}
    assert not [a for a in page.attributes if a[1] in ("src", "href") or a[1].startswith("on")]
    assert "url(" not in index_page(FLIGHTS)


def test_each_derivative_has_a_picture_with_every_flight(page: Page) -> None:
    pictures = [value for tag, name, value in page.attributes if (tag, name) == ("svg", "aria-label")]
    assert pictures[0] == "Z_α, 1/s over flights"
    assert len(pictures) == 6
    assert page.attributes.count(("g", "class", "flight")) == 6 * 10


def test_the_sentence_of_the_change_test_stands_with_a_mark_in_its_picture_only(page: Page) -> None:
    assert "Since flight 6 M_δe is 21 % smaller" in page.text
    assert [name for _, name, _ in page.attributes].count("stroke-dasharray") == 1


@pytest.mark.parametrize(
    ("flights", "sentence"),
    [
        (2, "Flights with a joint estimate: 2; a change needs at least three flights."),
        (4, "The change test over 4 flights finds no change, and all intervals overlap;"),
        (8, "lies apart: "),
    ],
)
def test_without_a_change_the_page_says_so(flights: int, sentence: str) -> None:
    assert sentence in index_page([flown(n) for n in range(1, flights + 1)])


def test_each_aircraft_has_trends_of_its_own() -> None:
    two = [flown(1), replace(flown(2), aircraft_file="b.yaml")]
    text = index_page(two)
    assert "<h2>Talon (a.yaml px4 system 1)</h2>" in text
    assert "<h2>Talon (b.yaml px4 system 1)</h2>" in text
    assert text.count("<svg") == 12


def test_a_flight_that_did_not_show_a_derivative_is_left_out_of_its_picture() -> None:
    points = [Point(1, -4.9, 0.2), Point(2, 3.0, float("inf")), Point(3, -5.1, 0.2)]
    picture = trend_svg("M_alpha", "1/s^2", points, None)
    assert picture.count('class="flight"') == 2
    assert "flight 1: −4.90 ± 0.20 1/s^2" in picture
    assert "no flight determines this derivative" in trend_svg("M_alpha", "1/s^2", points[1:2], None)


@pytest.mark.parametrize("value", [0.0, 1e-9, -4.93, 1234.5])
def test_one_flight_without_spread_has_a_picture(value: float) -> None:
    assert 'class="flight"' in trend_svg("Z_q", "1", [Point(4, value, 0.0)], None)


@pytest.mark.skipif(BROWSER is None, reason="Debian's chromium is not installed")
def test_the_page_overflows_nowhere_on_a_screen_and_on_a_phone(tmp_path: Path) -> None:
    seen = opened(index_page(FLIGHTS), tmp_path)
    assert [one["width"] for one in seen] == list(WIDTHS)
    for one in seen:
        assert (one["loaded"], one["wide"], one["cut"]) == ([], [], [])
        assert one["figures"] == 6
        assert one["least_height"] > 60.0


def test_the_table_of_flights_comes_before_the_courses() -> None:
    text = index_page(FLIGHTS)
    assert 0 < text.index('id="flights"') < text.index('class="gallery"')


def test_a_flight_with_a_report_links_to_its_page() -> None:
    log = Path(FLIGHTS[1].log)
    page = Page.read(index_page(FLIGHTS, {log: "reports/a b.html"}))
    assert [value for _, name, value in page.attributes if name == "href"] == ["reports/a%20b.html"]
    assert page.tables["flights"][2][1] == str(log)


def test_logs_are_named_below_the_folder_that_they_share() -> None:
    other = replace(flown(2), log="/logs/of a/campaign/2026/flight-2.bin")
    rows = Page.read(index_page([flown(1), other])).tables["flights"][1:]
    assert [row[1] for row in rows] == ["flight-1.bin", "2026/flight-2.bin"]


def test_an_aircraft_is_called_by_its_name_alone_where_no_other_shares_it() -> None:
    assert "<h2>Talon</h2>" in index_page([flown(1)])


def test_lateral_tests_count_and_a_flight_that_is_over_gets_no_order() -> None:
    lateral = {
        "maneuvers": [{"verdict": "accepted"}] * 3,
        "flight_test": {"sentence": "CONTINUE: the error of L_p is 140 % of its tolerance."},
    }
    one = flown(1)
    row = Page.read(index_page([replace(one, document={**one.document, "lateral": lateral})])).tables[
        "flights"
    ][1]
    assert row[4] == "1 of 2; roll and yaw 3 of 3"
    assert row[5].endswith("Roll and yaw: Not complete: the error of L_p is 140 % of its tolerance.")


def test_without_an_aircraft_file_flights_that_disagree_are_not_told_apart() -> None:
    nameless = [replace(flown(n, 1.0 if n < 6 else 0.8), aircraft_file="") for n in range(1, 11)]
    text = Page.read(index_page(nameless)).text
    assert "Not distinguished: px4 system 1 may be one aircraft that has changed, or several." in text
    assert "lies apart" in text
    assert "Since flight" not in text
    assert changes_of(nameless) == {}


def test_without_an_aircraft_file_flights_that_agree_count_as_those_of_one_aircraft() -> None:
    assert not_told_apart([replace(flown(n), aircraft_file="") for n in (1, 2)]) == {}


def test_an_aircraft_file_says_that_its_flights_are_of_one_aircraft() -> None:
    assert not_told_apart([flown(n, 1.0 if n < 6 else 0.8) for n in range(1, 11)]) == {}
