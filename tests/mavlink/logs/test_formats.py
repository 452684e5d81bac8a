"""A format of logs is one object, found by its module."""

from pathlib import Path

import pytest

from advisor.batch.logs import find_logs
from advisor.mavlink.logs import formats
from advisor.mavlink.logs.formats import FORMATS
from advisor.mavlink.logs.kinds import recognised, refusal

CASES = Path(__file__).parents[2] / "cases"
ULOG = b"ULog\x01\x12\x35"


def test_each_module_of_the_room_is_a_format() -> None:
    modules = {path.stem for path in Path(formats.__path__[0]).glob("*.py")} - {"__init__"}
    assert modules == {"dataflash", "table", "telemetry", "ulog"}
    assert len(FORMATS) == len(modules)


@pytest.mark.parametrize(
    ("log", "ending"), [("t_base.tlog", ".tlog"), ("base.bin", ".bin"), ("u_base.ulg", ".ulg")]
)
def test_the_content_tells_the_format_and_what_stands_in_front(log: str, ending: str) -> None:
    content = (CASES / log).read_bytes()[:200_000]
    for front in (b"", b"a line of text\n"):
        found = recognised(front + content)
        assert found is not None
        assert (found.format.ending, found.starts_at) == (ending, len(front))


def test_the_log_that_begins_first_counts() -> None:
    content = (CASES / "base.bin").read_bytes()[:200_000]
    first, behind = recognised(ULOG + content), recognised(content + ULOG)
    assert first is not None
    assert behind is not None
    assert (first.format.ending, behind.format.ending) == (".ulg", ".bin")


def test_each_format_refuses_its_own_relatives() -> None:
    assert refusal("a.ulge", b"ULogEnc\x01").code == "encrypted"
    assert refusal("a.log", b"FMT, 128, 89, FMT, BBnNZ, Type,Length").code == "text_log"


def test_what_is_no_log_is_told_all_formats() -> None:
    problem = refusal("a.jpg", b"\xff\xd8\xff")
    holds = "no MAVLink messages, DataFlash records, columns of a flight or ULog (3 bytes read)."
    assert problem.text == f"a.jpg holds {holds}"
    given = "an ArduPilot .bin, a table with named columns (.csv, .mat) or a PX4 .ulg."
    assert problem.fix == f"Give a .tlog as a ground station records it, {given}"


def test_a_batch_searches_a_folder_for_every_format(tmp_path: Path) -> None:
    for ending in (".tlog", ".bin", ".ulg", ".txt"):
        (tmp_path / f"flight{ending}").write_bytes(b"")
    found = find_logs([tmp_path], tmp_path / "out")
    assert {path.suffix for path in found} == {".tlog", ".bin", ".ulg"}
