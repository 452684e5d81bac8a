"""Tables with named columns as logs: names, units, messages, and files that are no tables."""

import numpy as np
import pytest
from scipy.io import savemat

from advisor.aircraft.aircraft import Aircraft, Elevator, TableColumns
from advisor.analysis.gap import as_in_tables
from advisor.mavlink.logs.formats.table import quantities_of, recognised_columns
from advisor.mavlink.logs.kinds import recognised, refusal
from advisor.mavlink.logs.logs import open_log
from advisor.words.problems import ConfigurationError, UnusableInputError
from tests.flights import SHIPPED

DEG = np.degrees(1.0)
T = np.arange(5.0)
PLAIN = {"time": T, "elevator": np.full(5, 0.1), "q": np.full(5, 0.2)}


def quantities(columns: TableColumns | None = None, **more):
    return quantities_of({**PLAIN, **more}, columns or TableColumns(), "x.csv")


@pytest.mark.parametrize(
    ("column", "quantity", "si"),
    [
        ("alpha_deg", "alpha", 1.0 / DEG), ("AoA [deg]", "alpha", 1.0 / DEG), ("alpha_rad", "alpha", 1.0),
        ("p (deg/s)", "p", 1.0 / DEG), ("r_dps", "r", 1.0 / DEG), ("KTAS", "airspeed", 0.514444),
        ("V_m_s", "airspeed", 1.0), ("ias_kt", "indicated_airspeed", 0.514444), ("alt_ft", "height", 0.3048),
        ("nz", "a_z", -9.80665), ("a_x_g", "a_x", 9.80665), ("da", "aileron", 1.0),
        ("throttle_pct", "throttle", 0.01),
        ("Climb", "climb_rate", 1.0),
    ],
)  # fmt: skip
def test_a_usual_name_says_quantity_and_unit(column, quantity, si):
    told = quantities(**{column: np.full(5, 0.5)})
    assert told[quantity] == pytest.approx(np.full(5, 0.5 * si))


def test_a_column_of_another_meaning_is_left_alone():
    assert recognised_columns(["pitch_gain", "time_of_day", "elevation", "quality"]) == {}


def test_a_name_of_the_aircraft_file_counts_before_a_usual_name():
    columns = TableColumns(alpha="vane", scale={"alpha": -1.0})
    told = quantities(columns, alpha=np.zeros(5), vane=np.full(5, 0.3))
    assert told["alpha"] == pytest.approx(np.full(5, -0.3))


def test_the_unit_in_a_name_counts_before_the_unit_of_the_file():
    told = quantities(TableColumns(units="deg"), alpha_rad=np.full(5, 0.3))
    assert told["alpha"][0] == pytest.approx(0.3)
    assert told["q"][0] == pytest.approx(0.2 / DEG)


def test_the_flight_among_the_structures_of_a_mat_file_is_found():
    table = {"a.t": T, "a.x": T, "b.time": T, "b.de": PLAIN["elevator"], "b.q": PLAIN["q"]}
    assert quantities_of(table, TableColumns(), "x.mat")["q"] == pytest.approx(PLAIN["q"])


def test_a_missing_column_is_named_with_those_there_are():
    with pytest.raises(UnusableInputError, match=r"no column that is q .* it has time, elevator"):
        quantities_of({"time": T, "elevator": T}, TableColumns(), "x.csv")


def table(folder, name="flight.csv"):
    """Write a short table of a flight in degrees, from 12.5 s on."""
    t = 12.5 + 0.02 * np.arange(200)
    columns = {"time_s": t, "elevator_deg": np.sin(t), "rudder_deg": np.cos(t), "q_dps": 3.0 * np.cos(t)}
    path = folder / name
    if path.suffix == ".mat":
        savemat(path, columns)
    else:
        np.savetxt(
            path, np.column_stack(list(columns.values())), "%.9f", ",", header=",".join(columns), comments=""
        )
    return path


@pytest.mark.parametrize("name", ["flight.csv", "flight.mat", "flight.dat"])
def test_a_table_is_a_log_with_its_own_times(tmp_path, name):
    columns = {c.name: c for batch in open_log(table(tmp_path, name)) for c in batch}
    attitude = columns["ATTITUDE"].fields
    assert attitude["time_boot_ms"][0] == pytest.approx(12_500.0)
    assert attitude["pitchspeed"][0] == pytest.approx(3.0 * np.cos(12.5) / DEG)
    assert columns["SERVO_OUTPUT_RAW"].fields["servo1_raw"][0] == pytest.approx(1500.0 + 10.0 * np.sin(12.5))


def test_the_surfaces_of_a_table_replace_the_outputs_of_the_aircraft_file(tmp_path):
    told = as_in_tables(Aircraft(elevator=Elevator(output=7, lag_s=0.1)), [table(tmp_path)])
    assert (told.elevator.output, told.elevator.lag_s, told.rudder.output) == (1, 0.1, 3)
    assert told.aileron.output == "auto"
    assert told.alpha.source == "named_value:alpha"


def test_the_stops_of_the_aircraft_file_hold_in_a_table(tmp_path):
    stated = Elevator(calibration=((1000.0, 7.0), (2000.0, -7.0)))
    told = as_in_tables(Aircraft(elevator=stated), [table(tmp_path)])
    assert told.elevator.ends_deg == (-7.0, 7.0)
    assert dict(told.elevator.calibration) == {1430.0: -7.0, 1570.0: 7.0}


def test_an_aircraft_of_other_logs_stays_as_it_is():
    aircraft = Aircraft(elevator=Elevator(output=7))
    assert as_in_tables(aircraft, [SHIPPED / "bundled-demo.tlog"]) is aircraft


def test_a_table_and_a_log_of_servo_outputs_are_not_one_campaign(tmp_path):
    with pytest.raises(ConfigurationError, match="analyze them in two commands"):
        as_in_tables(Aircraft(), [table(tmp_path), SHIPPED / "bundled-demo.tlog"])


@pytest.mark.parametrize(
    "head", [b"", b"just words\n", b"1.0,2.0,3.0\n", b"a,b\n1,2\n", b"\x00\x01,b,c\n", b"a,b,c"]
)
def test_what_is_no_table_is_not_taken_for_one(head):
    assert recognised(head) is None


@pytest.mark.parametrize(
    ("beginning", "sentence", "fix"),
    [
        (b"H Product:Blackbox", "is a Blackbox log of Betaflight or INAV", "blackbox_decode"),
        (b'{"a": [1]}', "is JSON", "CSV with a header line"),
        (b"#ROSBAG V2.0\n", "is a bag of ROS 1", "rostopic echo"),
        (b"SQLite format 3\0", "is an SQLite database, such as a bag of ROS 2", "CSV with a header line"),
        (b"\x89MCAP0\r\n", "is an MCAP recording", "CSV with a header line"),
        (b"MATLAB 7.3 MAT-file, Platform", "is HDF5, such as a MAT file of version 7.3", "'-v7'"),
        (b"PAR1", "is a Parquet table", "read_parquet"),
        (b"<?xml version='1.0'?><gpx>", "is XML", "CSV"),
    ],
)  # fmt: skip
def test_a_file_of_another_program_is_named_with_its_conversion(beginning, sentence, fix):
    problem = refusal("x.log", beginning)
    assert sentence in problem.text
    assert fix in problem.fix
