"""A table that a simulator wrote, as CSV and as MAT, with the names and units of its own."""

import csv
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.io import savemat

from advisor.aircraft.aircraft import Aircraft, TableColumns
from advisor.aircraft_file.read import parse_aircraft
from advisor.analysis.gap import named_simulator, table_maneuvers
from advisor.process.arrays import FloatArray
from advisor.simulators.protocol import Condition, Inputs
from advisor.words.problems import ConfigurationError, UnusableInputError
from tests.simulators.nonlinear import Nonlinear

DEG, KNOT, FOOT = np.degrees(1.0), 0.514444, 0.3048
SCALE = {"a_z": -9.80665, "airspeed": KNOT, "height": FOOT, "elevator": -1.0}
PLAIN = TableColumns(
    "Time", "Elev", "Q", "Alpha", "Theta", a_z="Nz", airspeed="KTAS", height="Alt", units="deg", scale=SCALE
)  # fmt: skip
KINDS = [("x.csv", ","), ("x.csv", "|"), ("x.tsv", "\t"), ("x.mat", "")]
AIRCRAFT = Aircraft(columns=PLAIN)


def table(maneuvers: int = 3) -> dict[str, FloatArray]:
    """Return a simulator's table in its own units, with the elevator's sign reversed."""
    t = 0.02 * np.arange(round(20.0 * maneuvers / 0.02))
    elevator = np.zeros(len(t))
    for k in range(maneuvers):
        sign, start = 1.0 - 2.0 * (k % 2), 8.0 + 20.0 * k
        for begin, end, level in ((0.0, 1.05, 1), (1.05, 1.75, -1), (1.75, 2.1, 1), (2.1, 2.45, -1)):
            elevator[(t >= start + begin) & (t < start + end)] = sign * level * np.radians(2.5)
    flown = Nonlinear().replay(Condition(25.0, 900.0), Inputs(t, elevator))
    series = {name: np.interp(t, flown.t, getattr(flown, name)) for name in
              ("alpha", "q", "theta", "a_z", "airspeed_m_s", "height_m")}  # fmt: skip
    return {
        "Time": t + 12.5, "Elev": -DEG * elevator, "Q": DEG * series["q"], "Alpha": DEG * series["alpha"],
        "Theta": DEG * series["theta"], "Nz": series["a_z"] / -9.80665,
        "KTAS": series["airspeed_m_s"] / KNOT, "Alt": series["height_m"] / FOOT,
    }  # fmt: skip


def written(path: Path, separator: str = ",") -> Path:
    columns = table()
    if path.suffix == ".mat":
        savemat(path, {"Time": columns.pop("Time"), **columns})
        return path
    with path.open("w", newline="") as file:
        rows = csv.writer(file, delimiter=separator)
        rows.writerow(columns)
        rows.writerows(zip(*columns.values(), strict=True))
    return path


@pytest.mark.parametrize(("name", "separator"), KINDS)
def test_every_kind_of_table_gives_the_same_manoeuvres_in_si_units(tmp_path, name, separator):
    maneuvers = table_maneuvers(written(tmp_path / name, separator), AIRCRAFT)
    assert len(maneuvers) == 3
    channels, told = maneuvers[0].channels, table()
    t = channels["q"].t
    assert channels["q"].y == pytest.approx(np.interp(t, told["Time"] - 12.5, told["Q"] / DEG), abs=1e-5)
    assert channels["alpha"].y == pytest.approx(
        np.interp(channels["alpha"].t, told["Time"] - 12.5, told["Alpha"] / DEG), abs=1e-5
    )
    assert np.max(channels["elevator"].y) == pytest.approx(np.radians(2.5), abs=1e-4)
    assert channels["a_z"].y[0] == pytest.approx(-9.79, abs=0.02)
    assert channels["airspeed"].y[0] == pytest.approx(25.0, abs=0.01)
    assert channels["altitude"].y[0] == pytest.approx(900.0, abs=0.5)


def test_an_indicated_air_speed_is_made_true_by_the_height(tmp_path):
    indicated = replace(PLAIN, airspeed=None, indicated_airspeed="KTAS",
                        scale={**PLAIN.scale, "indicated_airspeed": KNOT})  # fmt: skip
    read = table_maneuvers(written(tmp_path / "x.csv"), Aircraft(columns=indicated))
    assert read[0].channels["airspeed"].y[0] == pytest.approx(25.0 * 1.0446, rel=2e-3)


@pytest.mark.study
def test_a_table_is_a_simulators_log(tmp_path):
    file = written(tmp_path / "x.csv")
    simulator = named_simulator(replace(AIRCRAFT, simulator=f"log:{file}"))
    assert simulator.derivatives["M_alpha"] == pytest.approx(-25.0, rel=0.15)


def test_a_column_that_the_table_lacks_is_told_with_those_it_has(tmp_path):
    file = written(tmp_path / "x.csv")
    with pytest.raises(ConfigurationError, match=r"columns.q: x.csv has no column 'pitch_rate'; it has Time"):
        table_maneuvers(file, Aircraft(columns=replace(PLAIN, q="pitch_rate")))


def test_a_table_of_unknown_names_is_one_sentence_with_the_section_to_write(tmp_path):
    file = tmp_path / "x.csv"
    file.write_text("foo,bar,baz\n0,1,2\n1,1,2\n")
    with pytest.raises(
        UnusableInputError, match=r"it has foo, bar, baz. .*columns: {time: …, elevator: …, q: …}"
    ):
        table_maneuvers(file, Aircraft())


def test_what_is_no_table_is_one_sentence(tmp_path):
    broken = tmp_path / "x.mat"
    broken.write_bytes(b"MATLAB 5.0 no")
    with pytest.raises(UnusableInputError, match=r"x.mat is no table of numbers, or damaged\."):
        table_maneuvers(broken, AIRCRAFT)
    constant = tmp_path / "y.csv"
    constant.write_text("Time,Elev,Q,Alpha,Theta,Nz,KTAS,Alt\n" + "0,0,0,0,0,1,50,0\n" * 3)
    with pytest.raises(UnusableInputError, match="does not rise from row to row"):
        table_maneuvers(constant, AIRCRAFT)


def test_the_section_columns_of_the_aircraft_file_is_read_and_checked():
    section = {"time": "t", "elevator": "de", "q": "q"}
    assert parse_aircraft({"columns": section}).columns == TableColumns("t", "de", "q")
    with pytest.raises(ConfigurationError, match=r"columns.scale.nz: unknown key"):
        parse_aircraft({"columns": {**section, "scale": {"nz": 1.0}}})
    assert parse_aircraft({"columns": {"units": "deg"}}).columns == TableColumns(units="deg")


def test_a_table_in_degrees_that_is_declared_in_rad_is_refused(tmp_path):
    path = tmp_path / "x.csv"
    path.write_text("time,elevator,q\n0.0,-4.0,0.0\n0.1,2.0,1.0\n0.2,2.0,1.0\n")
    declared = replace(Aircraft(), columns=TableColumns("time", "elevator", "q"))
    with pytest.raises(UnusableInputError, match=r"elevator reaches 4; .*units: deg"):
        table_maneuvers(path, declared)
