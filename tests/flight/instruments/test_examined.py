"""The instruments of a record that grows are examined at times, with corrections for every sample."""

import numpy as np
import pytest

from advisor.flight.instruments.examination import examine
from advisor.flight.instruments.examined import ExaminedRecords
from advisor.flight.instruments.measured import Evidence
from tests.flight.instruments.flights import Channels, T, flight, late, times

FAULTS = {
    "unit": times(1000.0 / 9.80665, "a_z", "a_x"),
    "clock": late(0.2, "theta"),
    "sound": times(1.0, "q"),
}


def so_far(channels: Channels, end_s: float) -> Channels:
    return {name: channel.cut(-np.inf, end_s) for name, channel in channels.items()}


@pytest.mark.parametrize("fault", FAULTS)
def test_the_corrections_of_the_first_part_are_those_of_the_whole_record(fault: str) -> None:
    channels = FAULTS[fault](flight())
    whole = examine(channels)
    growing = ExaminedRecords(examine).so_far(channels, 0.0, float(T[-1]))
    for name, channel in whole.channels.items():
        assert growing.channels[name].t == pytest.approx(channel.t, abs=0.02)
        assert growing.channels[name].y == pytest.approx(channel.y, rel=1e-9)


def test_a_record_is_examined_again_when_its_length_has_doubled() -> None:
    examined = []

    def counted(channels: Channels, earlier: Evidence) -> object:
        examined.append(len(channels["q"]))
        return examine(channels, earlier)

    records = ExaminedRecords(counted)
    for end_s in T[10::10]:
        found = records.so_far(so_far(flight(), float(end_s)), 0.0, float(end_s))
        assert len(found.channels["q"]) == np.sum(end_s >= T)
    assert examined == [np.sum(s >= T) for s in (0.125, 0.25, 0.5, 1.0, 2.0, 4.0)]


def test_another_record_is_examined_by_itself() -> None:
    records = ExaminedRecords(examine)
    records.so_far(late(0.2, "theta")(flight()), 0.0, float(T[-1]))
    assert records.so_far(flight(), 0.5, float(T[-1])).findings == ()
