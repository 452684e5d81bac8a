"""What a log comes in: text in front, gzip, zip; and files that are no logs, each told in one sentence."""

import gzip
import io
import json
import os
import zipfile
from pathlib import Path

import numpy as np
import pytest

from advisor.batch.flight import find_logs
from advisor.mavlink.logs import formats, unpack
from advisor.mavlink.logs.formats import FORMATS, dataflash
from advisor.mavlink.logs.kinds import recognised, refusal
from advisor.mavlink.logs.logs import open_log
from advisor.words.problems import UnusableInputError
from tests.conftest import Advisor
from tests.mavlink.ardupilot.test_autopilot_logs import dataflash_flight, px4_flight
from tests.mavlink.builders import Sender, random_message, record

TEXT = b"INFO  [blackbox] started\n"


def telemetry() -> bytes:
    sender, rng = Sender(), np.random.default_rng(0)
    return b"".join(record(sender.frame(random_message("ATTITUDE", rng))) for _ in range(50))


LOGS = {
    "flight.tlog": telemetry,
    "flight.bin": lambda: dataflash_flight(2.0),
    "flight.ulg": lambda: px4_flight(2.0),
}


def read(path: Path) -> tuple[list[tuple[str, int]], list[str]]:
    """Names and numbers of the messages of a log, and the sentences of its reader."""
    columns = [c for batch in open_log(path) for c in batch]
    texts = [text for c in columns if c.name == "STATUSTEXT" for text in c.fields["text"].tolist()]
    said = [text.decode() for text in texts if text.startswith(b"Log reader: ")]
    return [
        (c.name, len(c)) for c in columns if b"Log reader" not in str(c.fields.get("text")).encode()
    ], said


def zipped(**logs: bytes) -> bytes:
    file = io.BytesIO()
    with zipfile.ZipFile(file, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, content in logs.items():
            archive.writestr(name.replace("_", "."), content)
    return file.getvalue()


@pytest.mark.parametrize("name", LOGS)
def test_text_in_front_of_a_log_is_skipped_and_counted(tmp_path: Path, name: str) -> None:
    sound, path = tmp_path / f"sound-{name}", tmp_path / name
    sound.write_bytes(LOGS[name]())
    path.write_bytes(TEXT + LOGS[name]())
    messages, said = read(path)
    assert messages == read(sound)[0]
    assert said == [f"Log reader: {len(TEXT)} bytes in front of the first record were skipped"]
    assert read(sound)[1] == []


@pytest.mark.parametrize("name", LOGS)
@pytest.mark.parametrize("pack", [gzip.compress, lambda log: zipped(readme_txt=b"A flight.", log_x=log)])
def test_a_packed_log_reads_as_the_log_itself(tmp_path: Path, name: str, pack) -> None:
    sound, path = tmp_path / name, tmp_path / f"{name}.packed"
    sound.write_bytes(LOGS[name]())
    path.write_bytes(pack(LOGS[name]()))
    assert read(path) == read(sound)


def test_a_log_is_known_by_its_content_whatever_its_name(tmp_path: Path) -> None:
    for name, make in LOGS.items():
        for other in LOGS:
            path = tmp_path / other
            path.write_bytes(make())
            assert read(path)[0], (name, other)


def test_of_several_logs_in_a_zip_none_is_chosen_and_all_are_named(tmp_path: Path) -> None:
    path = tmp_path / "flights.zip"
    path.write_bytes(zipped(**{"a_bin": dataflash_flight(1.0), "b\x1b[31m_tlog": telemetry()}))
    problem = refused(path)
    assert problem.code == "several_logs"
    assert "a.bin, b[31m.tlog" in problem.text


def refused(path: Path):
    with pytest.raises(UnusableInputError) as caught:
        list(open_log(path))
    (problem,) = caught.value.problems
    assert path.name in problem.text
    assert problem.fix
    return problem


NO_LOGS = {
    "git_lfs": b"version https://git-lfs.github.com/spec/v1\noid sha256:4d7a\nsize 12345\n",
    "web_page": b"\n<!DOCTYPE html>\n<html><body>flight.bin</body></html>",
    "encrypted": b"ULogEnc\x01" + bytes(200),
    "text_log": b"FMT, 128, 89, FMT, BBnNZ, Type,Length,Name,Format,Columns\n",
    "packed": b"7z\xbc\xaf\x27\x1c" + bytes(100),
    "empty": b"",
    "not_a_tlog": b"time,alpha\n0,1\n" * 100,
}


@pytest.mark.parametrize("code", NO_LOGS)
@pytest.mark.parametrize("name", ["flight.bin", "flight.ulge", "flight.tlog"])
def test_a_file_that_is_no_log_is_told_in_one_sentence(tmp_path: Path, code: str, name: str) -> None:
    path = tmp_path / name
    path.write_bytes(NO_LOGS[code])
    assert refused(path).code == code


@pytest.mark.parametrize(
    "content",
    [
        gzip.compress(dataflash_flight(2.0))[:-100],
        zipped(log_bin=dataflash_flight(2.0))[:-100],
        b"PK\x03\x04" + bytes(100),
        b"\x1f\x8b" + bytes(100),
        zipped(notes_txt=b"no log"),
        gzip.compress(gzip.compress(telemetry())),
    ],
    ids=["gzip cut", "zip cut", "no zip", "no gzip", "zip without a log", "packed twice"],
)
def test_a_damaged_or_empty_archive_is_told_in_one_sentence(tmp_path: Path, content: bytes) -> None:
    path = tmp_path / "flight.zip"
    path.write_bytes(content)
    assert refused(path).code == "packed"


def test_a_corrupt_lzma_stream_is_told_like_any_other_damage(tmp_path: Path) -> None:
    file = io.BytesIO()
    with zipfile.ZipFile(file, "w", zipfile.ZIP_LZMA) as archive:
        archive.writestr("flight.bin", dataflash_flight(2.0))
    content = bytearray(file.getvalue())
    for at in (60, 100, 200):
        content[at] ^= 0xFF
    path = tmp_path / "flight.zip"
    path.write_bytes(content)
    with pytest.raises(UnusableInputError, match=r"flight.zip cannot be unpacked: it is damaged"):
        list(open_log(path))


@pytest.mark.parametrize(
    "error", [ZeroDivisionError("float division by zero"), IndexError("19"), MemoryError()]
)
def test_whatever_breaks_a_reader_is_one_sentence_about_that_log(tmp_path, monkeypatch, error):
    def broken(*arguments: object) -> None:
        raise error

    path = tmp_path / "flight.bin"
    path.write_bytes(dataflash_flight(2.0))
    monkeypatch.setattr(dataflash, "read_dataflash", broken)
    with pytest.raises(UnusableInputError, match=r"^flight.bin ") as caught:
        list(open_log(path))
    assert caught.value.__cause__ is error


def test_a_small_file_that_unpacks_to_a_huge_one_is_refused_early(tmp_path, monkeypatch):
    monkeypatch.setattr(unpack, "_SMALL_BYTES", 500_000)
    path = tmp_path / "flight.bin.gz"
    path.write_bytes(gzip.compress(dataflash_flight(2.0) + bytes(50_000_000)))
    with pytest.raises(UnusableInputError, match=r"flight.bin.gz of 0\.\d MB unpacks to more than \d+ MB\."):
        list(open_log(path))


def test_neither_a_folder_nor_a_pipe_nor_a_device_is_waited_for(tmp_path: Path) -> None:
    pipe = tmp_path / "pipe.tlog"
    os.mkfifo(pipe)
    for path in (tmp_path, pipe, Path("/dev/zero"), Path("/dev/null")):
        assert refused(path).code == "not_a_file"


def test_of_a_packed_file_without_a_log_only_the_beginning_is_unpacked(tmp_path: Path) -> None:
    path = tmp_path / "zeros.gz"
    path.write_bytes(gzip.compress(bytes(20 << 20))[:-1000])
    assert refused(path).code == "not_a_tlog"  # the damage at its end was not reached


def test_a_sparse_file_of_zeros_is_refused_after_its_beginning(tmp_path: Path) -> None:
    path = tmp_path / "huge.bin"
    with path.open("wb") as file:
        file.truncate(100 << 30)
    assert refused(path).code == "not_a_tlog"


def test_the_document_carries_the_notes_of_the_reader(tmp_path: Path, advisor: Advisor) -> None:
    path = tmp_path / "flight.bin"
    path.write_bytes(TEXT + dataflash_flight(2.0))
    document = json.loads(advisor("analyze", path, "--json").stdout)
    assert any("25 bytes in front" in note for note in document["log"]["notes"])


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


DEFINITIONS = b"FMT, 128, 89, FMT, BBnNZ, Type,Length,Name,Format,Columns\nFMT, 129, 35, PARM, QNff, TimeUS\n"


@pytest.mark.parametrize("front", [b"", b"1\n\nArduPlane V4.5.6 (abcdef01)\nFree RAM: 0\nPX4\n"])
def test_a_text_log_is_named_with_the_remedy(front: bytes) -> None:
    log = front + DEFINITIONS
    assert recognised(log) is None
    problem = refusal("flight.log", log)
    assert problem.code == "text_log"
    assert problem.fix == "Give the .bin that it was made from."


def test_a_letter_that_mentions_a_definition_is_no_text_log() -> None:
    assert refusal("letter.log", b"We found FMT, 128, 89, FMT, BBnNZ, Type in it.").code == "not_a_tlog"
