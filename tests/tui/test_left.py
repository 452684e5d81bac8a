"""What stands on the terminal after the screens are left."""

from pathlib import Path

from advisor.cli.live import _page
from advisor.cli.screen import so_far
from tests.tui import flights


def test_the_verdicts_so_far_stand_on_the_terminal_after_leaving() -> None:
    lines = list(so_far(flights.state(3, bad=(2,))))
    assert [line.split()[0] for line in lines] == ["1", "2", "3", "▶", "warning:", "next:"]
    assert "✗ REPEAT: too gentle" in lines[1]


def test_before_the_first_manoeuvre_there_is_nothing_to_say() -> None:
    assert list(so_far(flights.state(0))) == []


def test_the_command_for_the_page_names_every_recording_and_the_aircraft_file() -> None:
    logs = [Path("a.tlog"), Path("my flight.tlog")]
    said = "The page of the flight: advisor report a.tlog 'my flight.tlog' -o flight.html"
    assert _page(logs, None) == said
    assert _page(logs, Path("uav.yaml")) == f"{said} --aircraft uav.yaml"
