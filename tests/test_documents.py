"""What commands print with --json is what the schema files say, and the schema files keep the contract."""

import json

import pytest
from jsonschema import Draft202012Validator

from tests.conftest import Advisor
from tests.flights import SHIPPED
from tests.rows import row
from tests.schemas import SCHEMAS, breaches, schema

KEPT = {
    "analyze": {
        "": "schema usable problems log maneuvers flight_test model estimate_from activity",
        "log": "file duration_s vehicle channels",
        "maneuvers": "number start_boot_s end_boot_s input verdict reasons cost fit estimates rules",
        "flight_test": "rule decision criterion_percent limit_percent stopped_at by_rule next",
        "model": "Z_0 Z_alpha Z_q Z_delta_e M_0 M_alpha M_q M_delta_e reference_airspeed_m_s",
        "activity": "start_boot_s end_boot_s reason text",
    },
    "gap": {
        "": "schema usable problems verdict gap where causes shrink waterfall cannot_see "
        "improved_model decisions probabilities evidence why",
        "gap": "before floor by_channel by_maneuver by_phase by_band_hz",
        "where": "block share ranking",
        "causes": "effect probability parameters cannot_be_told_from tell_apart_by gap_after",
        "shrink": "holdout before after percent ci95_percent in_simulator",
        "cannot_see": "effect because would_need",
        "probabilities": "none parameters unknown effects",
        "evidence": "alternative probability columns",
        "why": "name nats text",
    },
    "doctor": {
        "": "schema usable verdict vehicle messages elevator alpha limits expected_std",
        "vehicle": "system component autopilot firmware",
        "messages": "name rate_hz jitter_ms largest_gap_s renewed_hz",
        "elevator": "output resolution_deg calibrated",
        "limits": "code text fix",
    },
    "study": {"": "schema campaigns rows", "rows": "rule noise_percent needed error_percent paper"},
}
"""Document and section to the keys that the contract promises."""


def _keys(name: str, section: str) -> set[str]:
    whole = schema(name)
    part = whole["properties"][section] if section else whole
    part = part.get("items", part)
    if "$ref" in part:
        part = whole["$defs"][part["$ref"].rsplit("/", 1)[1]]
    return set(part["properties"])


@pytest.mark.parametrize("name", [path.stem for path in sorted(SCHEMAS.glob("*.json"))])
def test_a_schema_file_is_a_schema(name: str) -> None:
    Draft202012Validator.check_schema(schema(name))


@pytest.mark.parametrize(("name", "section"), [(n, s) for n, sections in KEPT.items() for s in sections])
def test_a_schema_has_every_key_of_the_contract(name: str, section: str) -> None:
    assert set(KEPT[name][section].split()) - _keys(name, section) == set()


POOR = SHIPPED / "arduplane-default-rates.tlog"


@row("the analysis of a log that cannot serve is what its schema says", ["analyze", POOR])
@row("the doctor's document is what its schema says", ["doctor", POOR])
@row("the document of a script is what its schema says", ["script", "ardupilot", "-o", "x.lua"])
@row(
    "the document without a script is what its schema says",
    ["script", "ardupilot", "none.tlog", "-o", "x.lua"],
)
def test_a_printed_document(arguments, advisor: Advisor, tmp_path, monkeypatch) -> None:
    monkeypatch.chdir(tmp_path)
    assert breaches(arguments[0], json.loads(advisor(*arguments, "--json").stdout)) == []


def test_a_key_that_no_schema_knows_is_found() -> None:
    assert breaches("study", {"schema": "advisor.study/1", "campaigns": 1, "rows": [], "more": 1}) != []
