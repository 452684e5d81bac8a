"""Output never fails for the encoding of a terminal, and stays readable."""

import io
import json
import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from advisor.cli import group as cli
from advisor.words.problems import plain
from tests.cli.processes import finished, flight

Said = Callable[..., tuple[int, str, str]]
"""Called with an encoding and the words of the command line: exit code, output, errors."""
pytestmark = pytest.mark.usefixtures("recorded_analyses")
COMMANDS: dict[str, list[str]] = {
    "analyze": ["analyze"],
    "doctor": ["doctor"],
    "replay": ["replay", "--speed", "max"],
}


@pytest.fixture
def said(monkeypatch: pytest.MonkeyPatch) -> "Said":
    """Call the command in this process, both of its outputs in one encoding."""

    def call(encoding: str, *arguments: object) -> tuple[int, str, str]:
        out, err = (io.TextIOWrapper(io.BytesIO(), encoding=encoding) for _ in range(2))
        monkeypatch.setattr("sys.argv", ["advisor", *map(str, arguments)])
        monkeypatch.setattr("sys.stdout", out)
        monkeypatch.setattr("sys.stderr", err)
        monkeypatch.setenv("HEADLESS", "1")
        with pytest.raises(SystemExit) as ended:
            cli.main()
        assert isinstance(ended.value.code, int)
        told, complained = (stream.buffer.getvalue().decode(encoding) for stream in (out, err))  # type: ignore[attr-defined]
        return ended.value.code, told, complained

    return call


@pytest.mark.parametrize("encoding", ["ascii", "cp1252"])
@pytest.mark.parametrize("command", COMMANDS)
def test_a_command_prints_in_any_encoding(command: str, encoding: str, said: Said) -> None:
    code, out, err = said(encoding, *COMMANDS[command], flight())
    assert code == 0, err
    assert out
    assert err == ""


def test_the_posix_locale_is_no_obstacle(tmp_path: Path) -> None:
    aircraft = tmp_path / "aircraft.yaml"
    aircraft.write_text("M_α: -7.2\n", encoding="utf-8")
    locale = {"LC_ALL": "C", "PYTHONUTF8": "0", "PYTHONCOERCECLOCALE": "0"}
    code, _, err = finished("analyze", "none.tlog", "--aircraft", aircraft, **locale)
    assert code == 2
    assert b"M_alpha: unknown key" in err


def test_what_an_encoding_lacks_is_spelled_and_columns_stay_straight(said: Said) -> None:
    _, out, _ = said("ascii", "analyze", flight())
    lines = out.splitlines()
    table = [line for line in lines if line.startswith(("parameter", "Z_", "M_"))]
    assert {line.split()[0] for line in table[1:]} >= {"Z_alpha", "M_alpha", "M_delta_e"}
    assert "+- 95 %" in table[0]
    assert len({len(line) for line in table}) == 1


def test_what_an_encoding_has_is_printed_as_it_is(said: Said) -> None:
    _, out, _ = said("utf-8", "analyze", flight())
    assert "M_α" in out


def test_json_is_the_same_in_every_encoding(said: Said) -> None:
    _, wide, _ = said("utf-8", "analyze", flight(), "--json")
    _, narrow, _ = said("ascii", "analyze", flight(), "--json")
    assert json.loads(narrow) == json.loads(wide)


@pytest.mark.parametrize("command", [[], ["gap"], ["live"], ["study"]])
def test_help_needs_no_unicode(command: list[str], said: Said) -> None:
    code, out, _ = said("ascii", *command, "--help")
    assert code == 0
    assert "Example:" in out


def test_the_word_help_is_the_option(said: Said) -> None:
    for words in ((), ("locate",)):
        assert said("utf-8", "help", *words) == said("utf-8", *words, "--help")


def test_a_file_named_in_another_script_is_named_in_a_sentence(tmp_path: Path, said: Said) -> None:
    code, _, err = said("ascii", "analyze", tmp_path / "полёт-β.tlog")
    assert code == 3
    assert "beta.tlog" in err


@pytest.mark.parametrize(
    ("written", "spelled"),
    [
        ("M_δe −7.2 ± 0.1", "M_delta_e -7.2 +- 0.1"),
        ("▶ CONTINUE", "> CONTINUE"),
        ("α → θ", "alpha -> theta"),
        ("┌─┬│╰", "+-+|+"),
        ("▁▁▔▔▁", "__--_"),
        ("███··", "###--"),
        ("Müller", "Muller"),
        ("\udcff飞", "??"),
    ],
)
def test_characters_are_spelled_as_engineers_type_them(written: str, spelled: str) -> None:
    assert plain(written) == spelled


@pytest.mark.parametrize("name", ["locate", pytest.param("analyze", marks=pytest.mark.study)])
def test_a_reader_that_goes_away_ends_the_command_silently(name: str) -> None:
    command = [sys.executable, "-m", "advisor", name, *([str(flight())] if name == "analyze" else [])]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE) as process:
        assert process.stdout is not None
        assert process.stderr is not None
        process.stdout.close()
        assert process.stderr.read() == b""
        assert process.wait(timeout=60) == 0


def test_a_full_disk_behind_the_output_is_one_sentence() -> None:
    with Path("/dev/full").open("wb") as full:
        command = [sys.executable, "-m", "advisor", "locate"]
        run = subprocess.run(command, stdout=full, stderr=subprocess.PIPE, timeout=60, check=False)
    assert run.returncode == 2
    assert run.stderr.count(b"\n") == 1
    assert b"No space left" in run.stderr


@pytest.mark.parametrize(("dots", "spelled"), [("⠀", " "), ("⠉", "'"), ("⣀", "."), ("⣿", ":"), ("⡇", ":")])
def test_a_curve_in_braille_is_spelled_by_the_half_of_the_cell_that_it_fills(dots: str, spelled: str) -> None:
    assert plain(dots) == spelled


@pytest.mark.parametrize(
    ("stated", "asked", "posix"), [("C", None, True), ("C", "1", False), ("de", None, False)]
)
def test_a_user_who_states_the_posix_locale_gets_ascii_though_python_writes_utf8(stated, asked, posix):
    words = "import sys; from advisor.words import problems as a; print(a._posix())"
    environment = {key: value for key, value in os.environ.items() if key not in ("LC_ALL", "PYTHONUTF8")}
    environment |= {"LC_ALL": stated} | ({"PYTHONUTF8": asked} if asked else {})
    told = subprocess.run(
        [sys.executable, "-c", words], env=environment, capture_output=True, text=True, check=True
    )
    assert told.stdout.strip() == str(posix)
