"""Nothing that moves the elevator disappears without a word: activities in events, JSON and text."""

import json
from dataclasses import replace

import pytest

from advisor.flight.maneuvers.maneuver import Activity
from tests.flights import SHIPPED, TWO, recorded

pytestmark = pytest.mark.usefixtures("recorded_analyses")
CRUISE = Activity(
    10.0,
    12.0,
    "autopilot",
    "the elevator moved in CRUISE without the sharp steps of a test; not a test input",
    stay_s=5.0,
)
SMALL = Activity(40.0, 41.0, "small", "a correction", stay_s=5.0)


def test_what_an_autopilot_does_in_one_stay_in_a_mode_is_one_activity():
    later = replace(CRUISE, start_s=100.0, end_s=110.0)
    assert later.joined(CRUISE) == replace(CRUISE, end_s=110.0)


@pytest.mark.parametrize("change", [{"stay_s": 60.0}, {"boot": 1}, {"reason": "small"}])
def test_another_stay_boot_or_reason_is_another_activity(change):
    assert replace(CRUISE, start_s=100.0, end_s=110.0, **change).joined(CRUISE) is None


def test_corrections_far_apart_or_of_another_size_are_told_one_by_one():
    assert replace(SMALL, start_s=50.0, end_s=51.0).joined(SMALL) == replace(SMALL, end_s=51.0)
    assert replace(SMALL, start_s=90.0, end_s=91.0).joined(SMALL) is None
    assert replace(SMALL, start_s=50.0, text="another").joined(SMALL) is None


def test_the_document_lists_activities_with_time_reason_and_text(advisor):
    document = json.loads(advisor("analyze", recorded("uav", 1.0, maneuvers=TWO), "--json").stdout)
    between = [(m["end_boot_s"], m["start_boot_s"]) for m in document["maneuvers"]]
    assert document["activity"]
    for activity in document["activity"]:
        assert {"start_boot_s", "end_boot_s", "reason", "text"} <= set(activity)
        assert activity["start_boot_s"] < activity["end_boot_s"]
        assert all(
            activity["start_boot_s"] >= end or activity["end_boot_s"] <= start for end, start in between
        )
    assert {a["reason"] for a in document["activity"]} == {"autopilot"}
    assert (
        document["activity"][0]["text"]
        == "the elevator moved in CRUISE without the sharp steps of a test; not a test input"
    )


def test_all_lists_each_activity_in_a_line_of_its_own_among_the_manoeuvres(advisor):
    plain = advisor("analyze", recorded("uav", 1.0, maneuvers=TWO)).stdout
    everything = advisor("analyze", recorded("uav", 1.0, maneuvers=TWO), "--all").stdout
    assert "not a test input" not in plain
    lines = everything.splitlines()
    first, second = (next(i for i, line in enumerate(lines) if line.startswith(f" {n}  ")) for n in (1, 2))
    (told,) = lines[first + 1 : second]
    assert "the elevator moved in CRUISE without the sharp steps of a test; not a test input" in told


def test_all_lists_activities_even_where_no_manoeuvre_was_found(advisor):
    told = advisor("analyze", SHIPPED / "arduplane-default-rates.tlog", "--all")
    assert told.returncode == 3
    assert "the elevator moved in CRUISE without the sharp steps of a test; not a test input" in told.stdout
