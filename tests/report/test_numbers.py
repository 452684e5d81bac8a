"""The numbers of the page are those of the JSON documents, in degrees where people read them."""

import hashlib
from math import degrees

import pytest

from advisor.aircraft.reference import PARAMETERS
from advisor.report.page.render import page
from advisor.report.qualities import coefficients_of, qualities_of, quality_lines
from advisor.words.quantities import clock, with_half
from tests.report.conftest import Reported
from tests.report.page_reader import with_interval

HALF = 1.959963984540054
pytestmark = pytest.mark.xdist_group("report")


def people(name: str, value: float) -> float:
    return degrees(value) if name in ("Z_0", "M_0") else value


def last_digit(cell: str) -> float:
    """Half a unit of the last digit shown, with a hair for rounding."""
    decimals = len(cell.split("±")[0].strip().partition(".")[2])
    return 0.5001 * 10.0**-decimals


def test_the_joint_estimate_is_that_of_analyze(reported: Reported) -> None:
    rows = reported.page.tables["joint"][1:]
    for name, row in zip(PARAMETERS, rows, strict=True):
        entry, (value, half) = reported.analysis["model"][name], with_interval(row[1])
        assert value == pytest.approx(people(name, entry["value"]), abs=last_digit(row[1]))
        assert half == pytest.approx(people(name, HALF * entry["std"]), abs=last_digit(row[1]))


def test_the_model_of_the_aircraft_file_stands_with_the_estimate(reported: Reported) -> None:
    m_alpha = reported.page.tables["joint"][1 + PARAMETERS.index("M_alpha")]
    assert float(m_alpha[3].replace("−", "-")) == -6.0


def test_the_estimates_of_the_manoeuvres_are_those_of_analyze(reported: Reported) -> None:
    accepted = [m for m in reported.analysis["maneuvers"] if m["verdict"] == "accepted"]
    rows = reported.page.tables["by-maneuver"][1:]
    assert len(rows) == len(accepted) > 1
    for maneuver, row in zip(accepted, rows, strict=True):
        assert row[0] == str(maneuver["number"])
        for name, cell in zip(PARAMETERS, row[1:], strict=True):
            value, _ = with_interval(cell)
            expected = people(name, maneuver["estimates"][name]["value"])
            assert value == pytest.approx(expected, abs=last_digit(cell))


def test_every_manoeuvre_has_its_verdict_and_reason(reported: Reported) -> None:
    maneuvers = reported.analysis["maneuvers"]
    rows = reported.page.tables["maneuver-list"][1:]
    assert len(rows) == len(maneuvers) == 3
    for maneuver, row in zip(maneuvers, rows, strict=True):
        assert row[1] == clock(maneuver["start_boot_s"])
        assert maneuver["verdict"] in row[4]
        assert maneuver["sentence"] in row[5]


def test_the_criterion_is_that_of_analyze_for_every_rule(reported: Reported) -> None:
    rows = reported.page.tables["criterion-values"]
    for column, (rule, progress) in enumerate(reported.analysis["flight_test"]["by_rule"].items(), start=1):
        assert rows[0][column].startswith(rule)
        shown = [row[column] for row in rows[1:]]
        expected = ["–" if v is None else f"{v:.1f}" for v in progress["history_percent"]]
        assert shown == expected


def test_the_flying_qualities_are_those_of_analyze(reported: Reported) -> None:
    found = reported.analysis["flying_qualities"]
    names = ("natural_frequency", "damping", "t_theta_2", "n_alpha", "cap", "static_margin", "neutral_point")
    for name, row in zip(names, reported.page.tables["qualities"][1:], strict=True):
        value, half = with_interval(row[1])
        low, high = found[name]["ci95"]
        assert value == pytest.approx(found[name]["value"], abs=last_digit(row[1]))
        assert half == pytest.approx((high - low) / 2.0, abs=last_digit(row[1]))
        assert row[2] == found[name]["unit"]
    assert f"{found['air']['density_kg_m3']:.3f} kg/m³" in reported.page.text


def test_the_gap_is_that_of_gap(reported: Reported) -> None:
    gap, text = reported.gap, reported.page.text
    assert gap["verdict"] == "parameters"
    assert gap["sentence"] in text
    assert f"gap {gap['gap']['before']:.3g} → {gap['gap']['after']:.3g} times" in text
    before = [float(row[1]) for row in reported.page.tables["gap-channels"][1:]]
    assert before == pytest.approx(list(gap["gap"]["by_channel"].values()), rel=6e-3)


def test_the_telemetry_is_that_of_doctor(reported: Reported) -> None:
    rows = {row[0]: row for row in reported.page.tables["messages-0"][1:]}
    assert set(rows) == {message["name"] for message in reported.doctor["messages"]}
    for message in reported.doctor["messages"]:
        assert float(rows[message["name"]][1]) == pytest.approx(message["rate_hz"], abs=0.051)
    assert reported.doctor["verdict"] in reported.page.text


def test_the_inputs_are_named_by_their_hashes(reported: Reported) -> None:
    rows = dict(reported.page.tables["files"][1:])  # type: ignore[arg-type]
    for path in (reported.log, reported.aircraft):
        assert rows[path.name] == hashlib.sha256(path.read_bytes()).hexdigest()


def test_the_markdown_says_the_same(reported: Reported) -> None:
    lines = page(reported.content, "md").splitlines()
    for name in ("joint", "maneuver-list", "criterion-values", "qualities", "files"):
        for row in reported.page.tables[name][1:]:
            assert f"| {' | '.join(row)} |" in lines


def test_the_text_of_analyze_says_the_flying_qualities_and_their_conventions(reported: Reported) -> None:
    reference = reported.content.aircraft.reference
    qualities = qualities_of(reported.content.state, reference)
    assert qualities is not None
    said = "\n".join(quality_lines(qualities, coefficients_of(reported.content.state, reference)))
    found = reported.analysis["flying_qualities"]
    for name in ("natural_frequency", "n_alpha", "neutral_point"):
        assert with_half(found[name]["value"], HALF * found[name]["std"]) in said
    for level in found["levels"].values():
        assert level["text"] in said
    moment = reported.analysis["coefficients"]["C_m_alpha"]
    assert f"C_m_alpha {with_half(moment['value'], HALF * moment['std'])}" in said
    for convention in ("m/s true", "q·c/(2·V)", "written for manned aeroplanes"):
        assert convention in said
