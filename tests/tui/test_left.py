"""What stands on the terminal after the screens are left."""

from advisor.aircraft.aircraft import Aircraft
from advisor.cli.screen import so_far
from tests.tui import flights


def test_the_verdicts_so_far_stand_on_the_terminal_after_leaving() -> None:
    lines = list(so_far(flights.state(3, bad=(2,)), Aircraft()))
    assert [line.split()[0] for line in lines] == ["1", "2", "3", "▶", "next:"]
    assert "✗ REPEAT: too gentle" in lines[1]


def test_before_the_first_manoeuvre_there_is_nothing_to_say() -> None:
    assert list(so_far(flights.state(0), Aircraft())) == []
