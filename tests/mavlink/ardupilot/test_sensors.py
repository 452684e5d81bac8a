"""Which of several like sensors of a log counts, on hand-made records."""

import numpy as np
import pytest

from advisor.mavlink.ardupilot import sensors
from advisor.mavlink.ardupilot.sensors import Said, stated_health
from advisor.mavlink.records.stretches import RecordTable


def flown(records: RecordTable) -> RecordTable:
    """Records of the sensor in use, of a log in one stretch."""
    return sensors.flown(records, stated_health(records), records.fields.get("Pri"))


def said(records: RecordTable, chosen: RecordTable, quantity: str) -> list[Said]:
    """Sentences about the sensors, of a log in one stretch."""
    silences = sensors.silences_in(records, chosen)
    return sensors.said(records, chosen, quantity, stated_health(records), silences)


def table(*rows, names):
    """Records one after the other, each a tuple of values in the order of ``names``."""
    fields = {name: np.array(values) for name, values in zip(names, zip(*rows, strict=True), strict=True)}
    fields["TimeUS"] = 100_000 * np.arange(len(rows))
    fields["row"] = np.arange(len(rows))
    return RecordTable(10 * np.arange(len(rows)), fields)


def airspeeds(*rows):
    return table(*rows, names=("I", "U", "H", "Pri"))


def inertial(*rows):
    return table(*rows, names=("I", "GH", "AH"))


@pytest.mark.parametrize(
    ("spoilt", "why"),
    [((0, 0, 1, 1), "not in use"), ((0, 1, 0, 1), "unhealthy"), ((0, 1, 1, 1), "not primary")],
)
def test_the_air_speed_sensor_that_is_good_and_primary_flew(spoilt, why):
    chosen = flown(airspeeds(spoilt, (1, 1, 1, 1), spoilt, (1, 1, 1, 1)))
    assert chosen.fields["row"].tolist() == [1, 3]


def test_a_primary_sensor_that_is_unhealthy_gives_way_to_a_good_one():
    chosen = flown(airspeeds((0, 1, 0, 0), (1, 1, 1, 0), (0, 1, 0, 0), (1, 1, 1, 0)))
    assert chosen.fields["I"].tolist() == [1, 1]


@pytest.mark.parametrize("dead", [(0, 0, 1), (0, 1, 0)], ids=["gyro", "accelerometer"])
def test_an_inertial_sensor_that_is_dead_gives_way_to_the_next(dead):
    chosen = flown(inertial(dead, (1, 1, 1), (2, 1, 1), dead, (1, 1, 1), (2, 1, 1)))
    assert chosen.fields["I"].tolist() == [1, 1]


def test_a_sensor_that_dies_in_flight_gives_way_from_then_on():
    records = inertial((0, 1, 1), (1, 1, 1), (0, 0, 1), (1, 1, 1), (0, 0, 1), (1, 1, 1))
    chosen = flown(records)
    assert chosen.fields["row"].tolist() == [0, 3, 5]
    assert [one.text for one in said(records, chosen, "Rates")] == [
        "Rates: sensor 0 flew",
        "Rates: sensor 1 flew since 0:00.3",
    ]


def test_nothing_is_said_where_the_first_sensor_flew_throughout():
    records = inertial((0, 1, 1), (1, 1, 1), (0, 1, 1), (1, 1, 1))
    assert said(records, flown(records), "Rates") == []


def test_no_sensor_flew_while_none_is_healthy_and_that_is_said():
    records = inertial(*[(0, 1, 1)] * 10, *[(0, 0, 1)] * 10, *[(0, 1, 1)] * 10)
    chosen = flown(records)
    assert chosen.fields["row"].tolist() == [*range(10), *range(20, 30)]
    assert [one.text for one in said(records, chosen, "Rates")] == [
        "Rates: no sensor was healthy from 0:01.0 to 0:01.9 and none is used there"
    ]


def test_a_model_without_noise_at_rest_is_no_dead_sensor():
    fields = {name: np.zeros(40) for name in ("GyrX", "GyrY", "GyrZ", "AccX", "AccY")}
    fields |= {"AccZ": np.full(40, -9.81), "TimeUS": 50_000 * np.arange(40)}
    assert len(flown(RecordTable(10 * np.arange(40), fields))) == 40
    assert len(flown(RecordTable(10 * np.arange(40), {**fields, "AccZ": np.zeros(40)}))) == 0


def test_an_unused_sensor_flew_where_it_is_the_only_one():
    assert len(flown(airspeeds((0, 0, 1, 0), (0, 0, 1, 0)))) == 2


def test_an_inertial_sensor_that_repeats_itself_gives_way_whatever_its_health_says():
    values = np.random.default_rng(0).normal(size=(40, 6))
    values[21::2] = values[19]  # sensor 1 is stuck from its eleventh record on
    names = ("GyrX", "GyrY", "GyrZ", "AccX", "AccY", "AccZ")
    fields = {name: values[:, k] for k, name in enumerate(names)}
    fields |= {"I": np.arange(40) % 2, "GH": np.arange(40) % 2, "AH": np.ones(40)}
    fields["TimeUS"] = 50_000 * np.arange(40)
    chosen = flown(RecordTable(10 * np.arange(40), fields))
    assert chosen.time_us.tolist() == [50_000 * row for row in range(1, 19, 2)]


def test_records_that_do_not_tell_their_sensor_are_all_of_one():
    records = RecordTable(np.arange(3), {"Airspeed": np.array([20.0, 21.0, 22.0])})
    assert flown(records) is records
    assert said(records, records, "Air speed") == []
