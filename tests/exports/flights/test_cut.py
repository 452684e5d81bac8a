"""The log of one manoeuvre: packets of the whole log, byte by byte, in which the manoeuvre is found."""

import gzip
import json
from pathlib import Path

import pytest

import advisor as library
from tests.conftest import Advisor
from tests.exports.flights.conftest import Exported
from tests.flights import SHIPPED, TWO, recorded

pytestmark = pytest.mark.usefixtures("recorded_analyses")
BASE_BIN = Path(__file__).parents[2] / "cases" / "base.bin"


def records(data: bytes) -> list[bytes]:
    """Time stamp and frame of every packet of a MAVLink 2 log without signatures."""
    found, at = [], 0
    while at < len(data):
        size = 8 + 12 + data[at + 9]
        found.append(data[at : at + size])
        at += size
    return found


def test_analyze_finds_the_manoeuvre_in_the_cut_log_with_the_estimate_of_the_whole_log(
    advisor: Advisor, tmp_path: Path
) -> None:
    log = recorded("uav", 1.0, maneuvers=TWO)
    aircraft = tmp_path / "aircraft.yaml"
    aircraft.write_text("elevator: {lag_s: 0.02}\n")
    cut = tmp_path / "m2.tlog"
    run = advisor("export", log, "--cut", "2", "-o", cut, "--aircraft", aircraft)
    assert run.returncode == 0, run.stderr
    whole = json.loads(advisor("analyze", log, "--aircraft", aircraft, "--json").stdout)
    alone = json.loads(advisor("analyze", cut, "--aircraft", aircraft, "--json").stdout)
    (found,) = alone["maneuvers"]
    told = whole["maneuvers"][1]
    assert found["start_boot_s"] == told["start_boot_s"]
    assert found["end_boot_s"] == told["end_boot_s"]
    # The whole log tells more of servo and command than the cut one.
    for name, one in told["estimates"].items():
        assert abs(found["estimates"][name]["value"] - one["value"]) < 1.96 * one["std"] + 1e-9


def test_the_packets_of_a_cut_log_are_those_of_the_whole_log_in_their_order_packed_or_not(
    advisor: Advisor, tmp_path: Path
) -> None:
    flight = recorded("linear", 1.0, maneuvers=TWO)
    packed, cut, unpacked = tmp_path / "flight.tlog.gz", tmp_path / "m2.tlog", tmp_path / "unpacked.tlog"
    packed.write_bytes(gzip.compress(flight.read_bytes()))
    for log, out in ((flight, cut), (packed, unpacked)):
        assert advisor("export", log, "--cut", "2", "-o", out).returncode == 0
    assert unpacked.read_bytes() == cut.read_bytes()
    whole, taken = iter(records(flight.read_bytes())), records(cut.read_bytes())
    assert all(any(record == other for other in whole) for record in taken)
    assert len(cut.read_bytes()) < 0.7 * flight.stat().st_size


@pytest.mark.parametrize(
    ("log", "number"),
    [
        pytest.param("bundled-demo.tlog", 1, marks=pytest.mark.study),
        pytest.param("arduplane-calm.tlog", 7, marks=pytest.mark.study),
    ],
)
def test_the_first_and_the_last_manoeuvre_of_a_shipped_log_are_cut(
    log: str, number: int, advisor: Advisor, tmp_path: Path
) -> None:
    assert_cut_alone(SHIPPED / log, number, advisor, tmp_path)


def test_the_first_manoeuvre_of_a_log_is_cut(advisor: Advisor, tmp_path: Path) -> None:
    assert_cut_alone(recorded("linear", 1.0, maneuvers=TWO), 1, advisor, tmp_path)


def assert_cut_alone(log: Path, number: int, advisor: Advisor, folder: Path) -> None:
    """One manoeuvre of the log is cut, and found alone in the cut log."""
    cut = folder / "cut.tlog"
    assert advisor("export", log, "--cut", number, "-o", cut).returncode == 0
    assert len(library.find(library.read(cut))) == 1


def test_a_manoeuvre_after_a_reboot_is_cut_from_its_own_power_on(advisor: Advisor, tmp_path: Path) -> None:
    first, second = (recorded("linear", 1.0, seed, TWO[:1]).read_bytes() for seed in (11, 12))
    (tmp_path / "two.tlog").write_bytes(first + second)
    cut = tmp_path / "m2.tlog"
    assert advisor("export", tmp_path / "two.tlog", "--cut", "2", "-o", cut).returncode == 0
    assert set(records(cut.read_bytes())[-100:]) <= set(records(second))


def test_a_dataflash_log_is_not_cut_and_the_sentence_says_so(advisor: Advisor, tmp_path: Path) -> None:
    run = advisor("export", BASE_BIN, "--cut", "1", "-o", tmp_path / "m1.tlog")
    assert run.returncode == 2
    assert "only tlogs are cut" in run.stderr
    assert not (tmp_path / "m1.tlog").exists()


def test_a_manoeuvre_that_is_not_there_is_refused_with_how_many_are(
    exported: Exported, advisor: Advisor, tmp_path: Path
) -> None:
    run = advisor("export", exported.log, "--cut", "9", "-o", tmp_path / "m9.tlog")
    assert run.returncode == 2
    assert "no manoeuvre 9; give a number from 1 to 4" in run.stderr
