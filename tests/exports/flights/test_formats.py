"""Every format is read back by its own reader, with names, units and the numbers of ``analyze --json``."""

import csv
import json
import math
import shutil
import subprocess

import numpy as np
import pyarrow.parquet as pq
import pytest
from mcap.reader import make_reader
from scipy.io import loadmat

from advisor.aircraft.reference import PARAMETERS
from tests.exports.flights.conftest import Exported


def rows_of(exported: Exported, name: str) -> list[dict[str, str]]:
    with (exported.folder / f"{name}.csv").open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def number(text: str) -> float | None:
    return float(text) if text else None


def test_csv_has_the_manoeuvres_of_the_json_document(exported: Exported) -> None:
    rows = rows_of(exported, "maneuvers")
    assert len(rows) == 4
    for row, told in zip(rows, exported.document["maneuvers"], strict=True):
        assert int(row["maneuver"]) == told["number"]
        assert float(row["start_boot_s"]) == told["start_boot_s"]
        assert float(row["end_boot_s"]) == told["end_boot_s"]
        assert (row["accepted"] == "True") == (told["verdict"] == "accepted")
        assert row["sentence"] == told["sentence"]
        assert row["reasons"] == "; ".join(reason["text"] for reason in told["reasons"])
        assert number(row["cost"]) == told["cost"]
        assert number(row["rms_q"]) == told["fit"]["q"]["rms"]


def test_csv_has_the_estimates_of_the_json_document_with_the_joint_one_as_number_0(exported):
    rows = {(int(row["maneuver"]), row["parameter"]): row for row in rows_of(exported, "estimates")}
    told = {m["number"]: m["estimates"] for m in exported.document["maneuvers"]}
    told[0] = exported.document["model"]
    assert {number for number, _ in rows} == set(told)
    derivatives = [key for key in rows if key[1] in PARAMETERS]
    for maneuver, name in derivatives:
        for key in ("value", "std", "std_cr"):
            assert number(rows[maneuver, name][key]) == told[maneuver][name][key]


def test_csv_has_the_instruments_that_were_estimated_with_the_derivatives(exported: Exported) -> None:
    told = exported.document["model"]["instruments"]
    rows = {row["parameter"]: row for row in rows_of(exported, "estimates") if row["maneuver"] == "0"}
    assert set(rows) - set(PARAMETERS) == set(told)
    for name, one in told.items():
        assert (number(rows[name]["value"]), number(rows[name]["std"])) == (one["value"], one["std"])
        assert name.endswith(rows[name]["unit"])


def test_the_diagonal_of_the_covariance_is_the_square_of_the_standard_deviation(exported: Exported) -> None:
    for row in rows_of(exported, "estimates"):
        if row["std"] and row["parameter"] in PARAMETERS:
            diagonal = float(row[f"covariance_{row['parameter']}"])
            assert diagonal == pytest.approx(float(row["std"]) ** 2, rel=1e-12)


def test_the_sidecar_of_the_csv_names_every_column_of_every_file_with_its_unit(exported: Exported) -> None:
    sidecar = json.loads((exported.folder / "columns.json").read_text(encoding="utf-8"))
    files = {path.relative_to(exported.folder).as_posix() for path in exported.folder.rglob("*.csv")}
    assert set(sidecar["files"]) == files
    for name, described in sidecar["files"].items():
        with (exported.folder / name).open(encoding="utf-8", newline="") as file:
            assert next(csv.reader(file)) == list(described["columns"])
    assert sidecar["files"]["record_1/alpha.csv"]["columns"]["alpha"]["unit"] == "rad"
    assert sidecar["grid"].startswith("uniform")


def test_csv_brings_back_every_sample_bit_for_bit(exported: Exported) -> None:
    _, power_on = exported.flights.power_ons[0]
    for name, channel in power_on.channels.items():
        read = rows_of(exported, f"record_1/{name}")
        assert [float(row["t_boot_s"]) for row in read] == channel.t.tolist()
        assert [float(row[name]) for row in read] == channel.y.tolist()


def test_parquet_brings_back_every_table_with_units_in_the_fields(exported: Exported) -> None:
    tables = {table.name: table for table in exported.data.tables}
    recording = exported.data.recordings[0]
    tables |= {f"record_1/{table.name}": table for table in (recording.grid, *recording.channels)}
    for name, table in tables.items():
        read = pq.read_table(exported.folder / f"{name}.parquet")
        assert read.column_names == [column.name for column in table.columns]
        for column in table.columns:
            np.testing.assert_array_equal(read[column.name].to_numpy(), column.values)
            metadata = read.schema.field(column.name).metadata
            assert metadata[b"unit"].decode() == column.unit
    about = json.loads(read.schema.metadata[b"advisor"])
    assert about["logs"][0]["file"] == str(exported.log)


def test_mat_brings_back_channels_estimates_and_residuals_with_units(exported: Exported) -> None:
    read = loadmat(exported.folder / "flight.mat", simplify_cells=True)
    _, power_on = exported.flights.power_ons[0]
    for name, channel in power_on.channels.items():
        np.testing.assert_array_equal(read["record_1"][name][name], channel.y)
        np.testing.assert_array_equal(read["record_1"][name]["t_boot_s"], channel.t)
    assert read["record_1"]["q"]["units"]["q"] == "rad/s"
    estimates = exported.data.table("estimates")
    np.testing.assert_array_equal(read["estimates"]["value"], estimates["value"])
    assert read["estimates"]["parameter"].tolist() == estimates["parameter"].tolist()
    np.testing.assert_array_equal(
        read["residuals_q"]["residual"], exported.data.table("residuals_q")["residual"]
    )


def test_octave_reads_the_mat_file(exported: Exported) -> None:
    octave = shutil.which("octave-cli") or shutil.which("octave")
    if octave is None:
        pytest.skip("Octave is not installed")
    script = (
        "load('flight.mat'); e = estimates; k = find(strcmp(e.parameter, 'M_alpha') & e.maneuver == 0);"
        "printf('%.17g %s %s %d', e.value(k), e.unit{k}, record_1.q.units.q, numel(record_1.q.q));"
    )
    command = [octave, "--no-gui", "--norc", "--quiet", "--eval", script]
    run = subprocess.run(
        command, cwd=exported.folder, capture_output=True, text=True, timeout=100, check=False
    )
    assert run.returncode == 0, run.stderr
    value, unit, of_q, samples = run.stdout.split()
    assert float(value) == exported.document["model"]["M_alpha"]["value"]
    assert (unit, of_q) == ("1/s^2", "rad/s")
    assert int(samples) == len(exported.flights.power_ons[0][1].channels["q"])


def test_mcap_has_a_topic_a_channel_with_vehicle_times_and_a_schema_with_the_unit(exported):
    _, power_on = exported.flights.power_ons[0]
    with (exported.folder / "record_1.mcap").open("rb") as file:
        messages = list(make_reader(file).iter_messages())
    by_topic: dict[str, list[tuple[int, dict[str, object]]]] = {}
    for schema, topic, message in messages:
        assert schema is not None
        assert (schema.encoding, topic.message_encoding) == ("jsonschema", "json")
        by_topic.setdefault(topic.topic, []).append((message.log_time, json.loads(message.data)))
    for name, channel in power_on.channels.items():
        read = by_topic[f"/{name}"]
        assert [value[name] for _, value in read] == channel.y.tolist()
        assert [at for at, _ in read] == [round(t * 1e9) for t in channel.t.tolist()]
    schemas = {topic.topic: json.loads(schema.data) for schema, topic, _ in messages if schema}
    assert schemas["/alpha"]["properties"]["alpha"]["unit"] == "rad"
    assert len(by_topic["/maneuvers"]) == 4
    assert len(by_topic["/estimates"]) == len(exported.data.table("estimates"))
    assert len(by_topic["/residuals_q"]) == len(exported.data.table("residuals_q"))


def test_residuals_are_those_of_the_accepted_manoeuvres_and_have_the_rms_of_the_document(exported):
    rows = rows_of(exported, "residuals_q")
    accepted = [m for m in exported.document["maneuvers"] if m["verdict"] == "accepted"]
    assert {int(row["maneuver"]) for row in rows} == {m["number"] for m in accepted}
    for told in accepted:
        mine = [row for row in rows if int(row["maneuver"]) == told["number"]]
        residual = [float(row["residual"]) for row in mine]
        assert math.sqrt(np.mean(np.square(residual))) == pytest.approx(told["fit"]["q"]["rms"], rel=1e-12)
        assert [float(r["measured"]) - float(r["fitted"]) for r in mine] == residual


def test_the_samples_of_a_manoeuvre_stand_in_the_whole_channel(exported: Exported) -> None:
    _, power_on = exported.flights.power_ons[0]
    for judged in exported.flights.state.maneuvers:
        for name, channel in judged.maneuver.channels.items():
            whole = power_on.channels[name].cut(channel.t[0], channel.t[-1])
            np.testing.assert_array_equal(whole.t, channel.t)
            np.testing.assert_array_equal(whole.y, channel.y)


def test_every_parameter_of_the_model_has_a_row_and_a_column_of_covariance(exported: Exported) -> None:
    joint = [row for row in rows_of(exported, "estimates") if row["maneuver"] == "0"]
    rows = joint[: len(PARAMETERS)]
    assert [row["parameter"] for row in rows] == list(PARAMETERS)
    matrix = np.array([[float(row[f"covariance_{name}"] or "nan") for name in PARAMETERS] for row in rows])
    model = exported.flights.state.model
    assert model is not None
    told = np.isfinite(matrix)
    np.testing.assert_array_equal(matrix[told], model.covariance[told])
    assert told.any()
