"""A flight written as a table gives the derivatives of its log."""

import csv
from pathlib import Path

import numpy as np
import pytest
from scipy.io import savemat

from advisor.aircraft.aircraft import Aircraft
from advisor.aircraft_file.read import load_aircraft
from advisor.analysis.gap import as_in_tables
from advisor.analysis.whole_flights import read_whole
from tests.flights import TWO, recorded

REAL = Path(__file__).parents[5] / "shared" / "flights"
"""Records of real aircraft, which are not distributed."""
NAMES = {
    "elevator": "de_deg", "aileron": "da_deg", "rudder": "dr_deg", "alpha": "alpha_deg", "q": "q_dps",
    "theta": "theta_deg", "a_x": "ax", "a_z": "az", "airspeed": "V_kt", "altitude": "h_ft",
}  # fmt: skip
IN_NAMES = {"_deg": np.degrees(1.0), "_dps": np.degrees(1.0), "_kt": 1.0 / 0.514444, "_ft": 1.0 / 0.3048}


def columns_of(log: Path, aircraft: Aircraft) -> dict[str, np.ndarray]:
    """Return the channels of a log at the stamps of its pitch rate, in the units of their names."""
    ((_, power_on),) = read_whole([log], aircraft, axis="both").power_ons
    t = power_on.channels["q"].t
    columns = {"time_s": t}
    for name, channel in power_on.channels.items():
        if name in NAMES and len(channel.t):
            factor = next((f for end, f in IN_NAMES.items() if NAMES[name].endswith(end)), 1.0)
            columns[NAMES[name]] = factor * np.interp(t, channel.t, channel.y)
    return columns


def write(path: Path, columns: dict[str, np.ndarray]) -> Path:
    if path.suffix == ".mat":
        savemat(path, columns)
        return path
    with path.open("w", newline="") as file:
        rows = csv.writer(file)
        rows.writerow(columns)
        rows.writerows(zip(*columns.values(), strict=True))
    return path


def errors_apart(log: Path, table: Path, aircraft: Aircraft) -> np.ndarray:
    """Return the differences of the derivatives of a table from those of its log, in standard deviations."""
    by_log = read_whole([log], aircraft, axis="both").state.model
    by_table = read_whole([table], as_in_tables(aircraft, [table]), axis="both").state.model
    shared = [k for k, name in enumerate(by_log.names) if name not in ("Z_0", "M_0")]
    return np.abs((by_table.theta - by_log.theta) / by_log.std)[shared]


@pytest.mark.study
@pytest.mark.parametrize("ending", ["csv", "mat"])
def test_a_table_of_a_simulated_flight_gives_the_derivatives_of_its_log(tmp_path, ending):
    log, aircraft = recorded("linear", 1.0, maneuvers=TWO), Aircraft()
    table = write(tmp_path / f"flight.{ending}", columns_of(log, aircraft))
    assert np.max(errors_apart(log, table, aircraft)) < 0.3


@pytest.mark.study
@pytest.mark.skipif(not REAL.is_dir(), reason="the records of real aircraft are not here")
@pytest.mark.parametrize("ending", ["csv", "mat"])
@pytest.mark.parametrize("record", ["jet-vane", "turboprop"])
def test_a_table_of_a_real_record_gives_the_derivatives_of_its_log(tmp_path, record, ending):
    log, aircraft = REAL / f"{record}.tlog", load_aircraft(REAL / f"{record}.yaml")
    table = write(tmp_path / f"{record}.{ending}", columns_of(log, aircraft))
    assert np.max(errors_apart(log, table, aircraft)) < 0.3
