"""Which axes a diagnosis of logs judges, and how often a log is read for this choice."""

from pathlib import Path
from types import SimpleNamespace

import pytest
from click.testing import CliRunner

from advisor.aircraft.aircraft import Aircraft
from advisor.analysis import axis_flown as chosen
from advisor.analysis.marks_file import LogSeries
from advisor.cli import axis_gap as side_gap_command
from advisor.cli.group import advisor
from advisor.words.problems import UnusableInputError


@pytest.mark.parametrize(
    ("found", "refused", "sideways", "axis"),
    [
        (1, 1, True, "lateral"),
        (0, 0, True, "lateral"),
        (2, 1, True, "both"),
        (2, 1, False, "pitch"),
        (1, 1, False, "pitch"),
        (None, 0, True, "lateral"),
        (None, 0, False, "pitch"),
    ],
)
def test_the_axis_is_what_has_accepted_manoeuvres(monkeypatch, found, refused, sideways, axis):
    def read(*_, **__):
        if found is None:
            raise UnusableInputError("no_maneuver", "none", "fly")
        return SimpleNamespace(maneuvers=[0] * found, lateral=sideways)

    def whole(*_, **__):
        if not sideways:
            raise UnusableInputError("no_maneuver", "none", "fly")
        return SimpleNamespace(state=None)

    monkeypatch.setattr(chosen, "maneuvers_of", read)
    monkeypatch.setattr(chosen, "read_whole", whole)
    monkeypatch.setattr(chosen, "accepted_of", lambda _: [0])
    monkeypatch.setattr(
        chosen,
        "without_refused",
        lambda m, _: SimpleNamespace(maneuvers=m, although_refused=tuple(range(refused))),
    )
    assert chosen.axis_flown([Path("a.tlog")], Aircraft())[0] == axis


def test_a_flight_of_the_elevator_alone_is_read_once(monkeypatch):
    readings, fed = [], LogSeries.fed_to
    monkeypatch.setattr(LogSeries, "fed_to", lambda self, *a: readings.append(self.logs) or fed(self, *a))
    log = Path("logs/bundled-demo.tlog")
    assert chosen.axis_flown([log], Aircraft()).axis == "pitch"
    assert readings == [[log]]


def test_a_flight_that_roll_and_yaw_answer_is_read_once(monkeypatch):
    state, compared = SimpleNamespace(), []

    def no_elevator(*_, **__):
        raise UnusableInputError("no_maneuver", "none", "fly")

    def compare(found, *_):
        compared.append(found)
        raise UnusableInputError("no_gap", "nothing to compare", "fly")

    monkeypatch.setattr(chosen, "maneuvers_of", no_elevator)
    monkeypatch.setattr(chosen, "read_whole", lambda *_, **__: SimpleNamespace(state=state))
    monkeypatch.setattr(chosen, "accepted_of", lambda _: [0])
    monkeypatch.setattr(side_gap_command, "read_whole", None)
    monkeypatch.setattr(side_gap_command, "compare_side_flown", compare)
    CliRunner().invoke(advisor, ["gap", "logs/bundled-demo.tlog"])
    assert compared == [state]
