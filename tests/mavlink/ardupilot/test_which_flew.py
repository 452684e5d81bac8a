"""Which sensor, lane and estimator flew: a log with two of them swapped is read as its twin."""

import numpy as np
import pytest

from advisor.mavlink.ardupilot.ardupilot_messages import KINDS, Known, Translation
from advisor.mavlink.ardupilot.former_records import Clocked
from advisor.mavlink.records.stretches import RecordTable

T_US = 40_000 * np.arange(100)
SOUND = {
    "ARSP": {"Airspeed": 20.0},
    "BARO": {"CRt": 0.5, "Press": 70_000.0},
    "GPS": {"Alt": 500.0, "GWk": 0.0, "GMS": 0.0},
    "IMU": dict.fromkeys(("GyrX", "GyrY", "GyrZ", "AccX", "AccY", "AccZ"), 1.0),
    "GYR": dict.fromkeys(("GyrX", "GyrY", "GyrZ"), 1.0),
    "ACC": dict.fromkeys(("AccX", "AccY", "AccZ"), 1.0),
    "XKF1": {"VD": 1.0},
    "XKF2": {"VWN": 3.0, "VWE": 4.0},
    "NKF1": {"VD": 1.0},
    "NKF2": {"VWN": 3.0, "VWE": 4.0},
}
"""Values of the sound sensor in each record, without their noise."""
PAIRS = [
    ("ARSP", "H"), ("ARSP", "U"), ("ARSP", "Pri"), ("ARSP", "ARSPD_PRIMARY"),
    ("BARO", "H"), ("BARO", "Health"), ("BARO", "BARO_PRIMARY"), ("BARO", "GND_PRIMARY"),
    ("GPS", "Status"), ("GPS", "U"),
    ("IMU", "GH"), ("IMU", "AH"), ("IMU", "INS_USE"), ("GYR", "INS_USE"), ("ACC", "INS_USE"),
    ("XKF1", "PI"), ("XKF2", "PI"), ("NKF1", "PI"), ("NKF2", "PI"),
]  # fmt: skip
"""Record, and the field or parameter that tells which of its instances flew."""
GOOD = {"Status": 3, "INS_USE": 1}
BAD = {"Status": 1}


def records(name, at_us, scale, **fields):
    """Return records of one instance: noisy values about the sound ones, times a scale."""
    noise = np.random.default_rng(5).normal(size=len(at_us))
    values = {field: scale * (value + 0.1 * noise) for field, value in SOUND[name].items()}
    stated = {field: np.full(len(at_us), value) for field, value in fields.items()}
    return {"TimeUS": at_us, **values, **stated}


def parameters(**values):
    """Return the record PARM before all others."""
    n = len(values)
    names = np.array([name.encode() for name in values], dtype="S16")
    return RecordTable(np.zeros(n, np.int64), {
        "TimeUS": np.zeros(n, np.int64), "Name": names, "Value": np.array([*values.values()], float),
    })  # fmt: skip


def log(name, field, sound):
    """Return a log in which one field tells that instance ``sound`` is right; the other reads a third."""
    number = "C" if name[1:3] == "KF" else "I"
    primary = field in ("Pri", "PI") or field.endswith("_PRIMARY")
    parts = []
    for right, late_us, scale in ((True, 10_000, 1.0), (False, 20_000, 0.3)):
        instance = sound if right else 1 - sound
        stated = (
            {} if primary or "_" in field else {field: GOOD.get(field, 1) if right else BAD.get(field, 0)}
        )
        if field == "Pri":
            stated = {"Pri": sound}
        parts.append(records(name, T_US + late_us, scale, **{number: instance}, **stated))
    whole = {key: np.concatenate([part[key] for part in parts]) for key in parts[0]}
    rows = np.argsort(whole["TimeUS"])
    tables = {name: RecordTable(whole["TimeUS"][rows], {key: v[rows] for key, v in whole.items()})}
    if field == "PI":
        selector = KINDS[name].selector[0]
        tables[selector] = RecordTable(T_US, {"TimeUS": T_US, "C": 0 * T_US, "PI": 0 * T_US + sound})
    if field.endswith("_PRIMARY"):
        tables["PARM"] = parameters(**{field: sound})
    if field == "INS_USE":
        tables["PARM"] = parameters(INS_USE=1 - sound, INS_USE2=sound)
    return tables


def read(tables):
    """Return the fields of all messages but texts, by the message's name, as text."""
    columns = Translation(Clocked(tables, 0), Known()).columns()
    return {
        c.name: (c.order.tolist(), {key: repr(np.asarray(v).tolist()) for key, v in c.fields.items()})
        for c in columns
        if c.name not in ("STATUSTEXT", "PARAM_VALUE")
    }


def texts(tables):
    """Return the sentences of the reader."""
    columns = [c for c in Translation(Clocked(tables, 0), Known()).columns() if c.name == "STATUSTEXT"]
    return [text.decode() for c in columns for text in c.fields["text"].tolist()]


@pytest.mark.parametrize(("name", "field"), PAIRS)
def test_a_log_with_two_instances_swapped_is_read_as_its_twin(name, field):
    first, swapped = (log(name, field, sound) for sound in (0, 1))
    alone = log(name, field, 0)
    table = alone[name]
    number = "C" if "C" in table.fields else "I"
    alone[name] = table[table.fields[number] == 0]
    assert read(swapped) == read(first) == read(alone)
    assert len(read(alone)) > 1, "the record becomes a message"


@pytest.mark.parametrize("flies", ["XKF", "NKF"])
def test_the_estimator_of_ahrs_ekf_type_flew(flies):
    other = "NKF" if flies == "XKF" else "XKF"
    tables = {"PARM": parameters(AHRS_EKF_TYPE=3 if flies == "XKF" else 2)}
    for family, scale in ((flies, 1.0), (other, 0.3)):
        for number in "12":
            one = records(family + number, T_US, scale, C=0)
            tables[family + number] = RecordTable(T_US, one)
    alone = {name: table for name, table in tables.items() if not name.startswith(other)}
    assert read(tables) == read(alone)
    assert any("EKF2 flew" in text for text in texts(tables)) == (flies == "NKF")


def test_a_change_of_lane_in_flight_is_said_with_its_time():
    tables = log("XKF1", "PI", 0)
    tables["XKF4"].fields["PI"][50:] = 1
    said = [text for text in texts(tables) if "EKF3" in text]
    assert [text.partition("EKF3: ")[2] for text in said] == ["lane 0 flew", "lane 1 flew since 0:02.0"]


def test_many_changes_are_said_in_few_sentences():
    tables = log("GPS", "U", 0)
    gps = tables["GPS"]
    gps.fields["U"][:] = (gps.fields["TimeUS"] // 200_000 + gps.fields["I"]) % 2
    said = [text for text in texts(tables) if "GPS: receiver" in text]
    assert len(said) == 5
    assert said[-1].endswith("more changes follow")
