"""The main job, end to end: a log goes in, verdicts, parameters and a decision come out."""

import json
from functools import cache
from pathlib import Path
from typing import Any

import pytest
from click.testing import CliRunner

from advisor.aircraft.reference import PARAMETERS
from advisor.cli.group import advisor
from tests.flights import FOUR, SHIPPED, TWO, calm_two, recorded, truth
from tests.recorded import use_recorded

# The same few flights, analysed once for all that is said of them.
pytestmark = pytest.mark.xdist_group("first flight")

PAPER_ORDER = ["3-2-1-1", "reverse 3-2-1-1", "reverse 3-2-1-1", "3-2-1-1", "reverse 3-2-1-1"]
PAPER_ORDER += ["3-2-1-1", "reverse 3-2-1-1"]


def analyze(log: Path, *options: str) -> str:
    """What ``advisor analyze`` prints; one flight is analysed once for all faces."""
    with pytest.MonkeyPatch.context() as patch:
        use_recorded(patch)
        words = ["analyze", str(log), *options]
        result = CliRunner().invoke(advisor, words, standalone_mode=False, env={"COLUMNS": "100"})
    assert result.exception is None
    return result.stdout


@cache
def analyzed(log: Path, *options: str) -> dict[str, Any]:
    document: dict[str, Any] = json.loads(analyze(log, "--json", *options))
    return document


@pytest.fixture(scope="module")
def uav(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """What is known of the aircraft that ArduPilot flew."""
    aircraft = tmp_path_factory.mktemp("flown") / "uav.yaml"
    aircraft.write_text(
        "elevator: {output: 2, calibration: [[1000, 25.0], [1500, 0.0], [2000, -25.0]], lag_s: 0.14}\n"
    )
    return aircraft


def test_without_noise_every_parameter_of_the_linear_aircraft_comes_back_within_a_thousandth() -> None:
    document = analyzed(recorded("linear", 0.0, maneuvers=TWO))
    for name, true in truth("linear").items():
        assert document["model"][name]["value"] == pytest.approx(true, rel=1e-3)


def test_the_seven_manoeuvres_of_the_paper_are_found_told_apart_and_judged() -> None:
    document = analyzed(recorded("linear", 1.0), "--rule", "continuous")
    assert [m["input"] for m in document["maneuvers"]] == PAPER_ORDER
    assert [m["number"] for m in document["maneuvers"]] == [1, 2, 3, 4, 5, 6, 7]
    assert all(m["verdict"] in ("accepted", "rejected") for m in document["maneuvers"])


def test_at_one_percent_noise_continuous_improvement_decides_each_manoeuvre_by_its_cost() -> None:
    document = analyzed(recorded("linear", 1.0), "--rule", "continuous")
    assert document["flight_test"]["rule"] == "continuous"
    for maneuver in document["maneuvers"]:
        limit = maneuver["rules"]["continuous"]["limit"]
        assert (maneuver["verdict"] == "accepted") == (limit is None or maneuver["cost"] < limit)


def test_at_one_percent_noise_the_stop_comes_with_its_criterion_below_the_limit() -> None:
    flight_test = analyzed(recorded("linear", 1.0), "--rule", "continuous")["flight_test"]
    assert flight_test["decision"] == "stop"
    assert flight_test["criterion_percent"] < flight_test["limit_percent"] == 25.0
    history = flight_test["by_rule"]["continuous"]["history_percent"]
    assert history[flight_test["stopped_at"] - 1] < 25.0
    assert all(value is None or value >= 25.0 for value in history[: flight_test["stopped_at"] - 1])


@pytest.mark.parametrize("parameter", ["M_alpha", "M_q", "M_delta_e", "Z_alpha"])
def test_the_nonlinear_aircraft_gives_its_own_linearisation_within_5_percent(parameter: str) -> None:
    model = analyzed(recorded("uav", 1.0, maneuvers=FOUR))["model"]
    assert model[parameter]["value"] == pytest.approx(truth("uav")[parameter], rel=0.05)


def test_a_flight_that_nobody_here_simulated_gives_judged_manoeuvres_and_a_model(uav: Path) -> None:
    document = analyzed(calm_two(), "--aircraft", str(uav))
    flown = [82.28, 113.34]
    assert [m["start_boot_s"] for m in document["maneuvers"]] == pytest.approx(flown, abs=1.0)
    assert document["log"]["channels"]["alpha"]["provenance"] == "derived"
    assert set(PARAMETERS) <= set(document["model"])
    assert document["model"]["M_delta_e"]["value"] < 0.0 > document["model"]["M_alpha"]["value"]


@pytest.mark.study
def test_on_a_real_autopilot_the_default_rule_says_stop_within_seven_manoeuvres(uav: Path) -> None:
    flight_test = analyzed(SHIPPED / "arduplane-calm.tlog", "--aircraft", str(uav))["flight_test"]
    assert flight_test["rule"] == "information"
    assert flight_test["decision"] == "stop"
    assert flight_test["stopped_at"] <= 7
    information = flight_test["by_rule"]["information"]
    assert set(information["prediction_percent"]) == {"alpha", "q", "a_z"}
    assert max(information["prediction_percent"].values()) < 5.0
    assert max(information["parameter_percent"].values()) < 100.0
    # The paper's rules do not fall: Z_0, Z_q and Z_delta_e are near zero on this aircraft.
    assert flight_test["by_rule"]["continuous"]["stopped_at"] is None


def test_the_document_has_every_key_of_the_contract() -> None:
    document = analyzed(recorded("linear", 1.0), "--rule", "continuous")
    assert document["schema"] == "advisor.analyze/1"
    assert document["usable"] is True
    assert document["problems"] == []
    assert set(document["log"]) >= {"file", "duration_s", "vehicle", "channels"}
    assert set(document["log"]["vehicle"]) >= {"system", "component", "autopilot"}
    assert document["log"]["duration_s"] == pytest.approx(140.0, abs=15.0)
    for channel in document["log"]["channels"].values():
        assert set(channel) >= {"source", "provenance", "rate_hz", "largest_gap_s"}
    for maneuver in document["maneuvers"]:
        keys = "number start_boot_s end_boot_s input verdict reasons cost fit estimates rules"
        assert set(maneuver) >= set(keys.split())
        assert set(maneuver["estimates"]) == set(PARAMETERS)
        assert set(maneuver["fit"]["alpha"]) >= {"rms", "tic", "r2"}
        assert set(maneuver["rules"]) >= {"continuous", "separate"}
    assert set(document["flight_test"]["by_rule"]) == {"continuous", "separate", "information"}
    assert set(document["flight_test"]["next"]["remaining_maneuvers"]) == {"median", "p90"}
    assert set(document["model"]) >= {*PARAMETERS, "reference_airspeed_m_s"}
    for name in PARAMETERS:
        low, high = document["model"][name]["ci95"]
        assert low < document["model"][name]["value"] < high
    assert document["estimate_from"] == [
        m["number"] for m in document["maneuvers"] if m["verdict"] == "accepted"
    ]


def test_people_get_the_same_verdicts_as_text() -> None:
    printed = analyze(recorded("linear", 1.0), "--rule", "continuous")
    document = analyzed(recorded("linear", 1.0), "--rule", "continuous")
    accepted = sum(maneuver["verdict"] == "accepted" for maneuver in document["maneuvers"])
    assert (printed.count("ACCEPTED:"), printed.count("REPEAT:")) == (accepted, 7 - accepted)
    assert "TEST COMPLETE" in printed
    assert "M_δe" in printed
