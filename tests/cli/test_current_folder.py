"""A command that is started in a folder with other people's files runs none of them."""

import ast
import asyncio
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from importlib.metadata import packages_distributions
from pathlib import Path

import aiohttp
import pytest

from tests.flights import TWO, recorded
from tests.mavlink.link.air import records_of
from tests.mavlink.link.builders import free_port, wait_until
from tests.mavlink.link.live import fly

ROOT = Path(__file__).parents[2]
LOG = ROOT / "logs" / "bundled-demo.tlog"
SHORT = ROOT / "logs" / "arduplane-default-rates.tlog"
STARTERS = ROOT / "advisor" / "process" / "children.py"


@pytest.fixture(scope="session")
def names() -> set[str]:
    """Every module that Python, the advisor or its libraries import by name."""
    return (set(sys.stdlib_module_names) | set(packages_distributions())) - {"__main__"}


@pytest.fixture
def folder(names: set[str], tmp_path: Path) -> Path:
    """A folder with a file for each of these modules, which notes that it was run."""
    place, note = tmp_path / "logs of others", tmp_path / "note.py"
    place.mkdir()
    ran = str(place / "RAN")
    note.write_text(f"open({ran!r}, 'a').write(__name__ + chr(10))\nraise ImportError(__name__)\n")
    for name in names:
        os.link(note, place / f"{name}.py")
    (place / ".numba_config.yaml").write_text(f"cache_dir: {place / 'machine-code'}\n")
    return place


class Command:
    """The ``advisor`` command as installed: a script in a folder of programs, not ``python -m``."""

    def __init__(self, folder: Path, *words: object) -> None:
        programs = folder.parent / "programs"
        programs.mkdir()
        script = programs / "advisor"
        script.write_text("from advisor.start import main\nif __name__ == '__main__':\n    main()\n")
        self._folder = folder
        self.out, self.err = folder.parent / "out.txt", folder.parent / "err.txt"
        own = {"HEADLESS": "1", "PYTHONPATH": str(ROOT), "XDG_DATA_HOME": str(folder.parent / "data")}
        environment = {**os.environ, **own}
        environment.pop("PYTHONSAFEPATH", None)
        with self.out.open("wb") as out, self.err.open("wb") as err:
            self.process = subprocess.Popen(
                [sys.executable, str(script), *map(str, words)],
                stdin=subprocess.DEVNULL,
                stdout=out,
                stderr=err,
                cwd=folder,
                env=environment,
                preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),
            )

    def until(self, condition: Callable[[], bool]) -> None:
        """Wait while the command works."""
        wait_until(lambda: condition() or self.process.poll() is not None, 60.0)

    def end(self) -> int:
        """Interrupt the command if it still works, and return its exit code."""
        if self.process.poll() is None:
            self.process.send_signal(signal.SIGINT)
        return self.process.wait(30.0)

    @property
    def ran(self) -> list[str]:
        """Modules of the folder that were run."""
        note = self._folder / "RAN"
        return note.read_text().split() if note.exists() else []


@pytest.fixture
def started(folder: Path) -> Iterator[Callable[..., Command]]:
    """Starts a command in the folder, and ends it after the test."""
    commands: list[Command] = []

    def start(*words: object) -> Command:
        commands.append(Command(folder, *words))
        return commands[-1]

    yield start
    for command in commands:
        if command.process.poll() is None:
            command.process.kill()
        command.process.wait()


def test_live_runs_no_file_of_the_current_folder(started: Callable[..., Command]) -> None:
    port = free_port()
    command = started("live", "--master", f"udpin:127.0.0.1:{port}", "--record", "flight.tlog")
    command.until(lambda: "recording to" in command.err.read_text())
    fly(records_of(LOG)[:600], port, 1.0, lambda now_s: None)
    command.until(lambda: "following" in command.out.read_text())
    assert command.end() == 130, command.err.read_text()
    assert command.ran == []
    assert "started again" not in command.err.read_text()


@pytest.mark.study
def test_demo_runs_no_file_of_the_current_folder(started: Callable[..., Command]) -> None:
    command = started("demo", "--speed", "2")
    command.until(lambda: "following" in command.out.read_text())
    assert command.end() == 130, command.err.read_text()
    assert command.ran == []


def test_batch_runs_no_file_of_the_current_folder(started: Callable[..., Command], tmp_path: Path) -> None:
    (tmp_path / "short.tlog").write_bytes(SHORT.read_bytes()[:40_000])
    command = started("batch", tmp_path / "short.tlog", "-o", tmp_path / "results", "--workers", "1")
    assert command.process.wait(60.0) in (0, 3), command.err.read_text()
    assert command.ran == []
    assert (tmp_path / "results").exists()


def test_a_simulator_that_the_user_names_replaces_no_module_of_python(started):
    log = recorded("linear", 1.0, maneuvers=TWO[:1])
    command = started("gap", log, "--simulator", "python:nowhere_at_all:make")
    assert command.process.wait(60.0) == 2
    assert "No module named 'nowhere_at_all'" in command.err.read_text()
    assert command.ran == []


@pytest.mark.study
def test_a_page_of_serve_runs_no_file_of_the_current_folder(started: Callable[..., Command]) -> None:
    command = started("serve", "replay", LOG, "--port", "0")
    command.until(lambda: "the screens are at" in command.err.read_text())
    url = next(line for line in command.err.read_text().splitlines() if "screens are at" in line).split()[4]

    async def first_bytes() -> bytes:
        async with (
            aiohttp.ClientSession() as session,
            session.ws_connect(f"{url}/ws?width=80&height=24", origin=url) as page,
        ):
            painted = b""
            give_up_s = time.monotonic() + 40.0
            while b"\x1b[" not in painted and time.monotonic() < give_up_s:
                message = await page.receive(40.0)
                painted += message.data if isinstance(message.data, bytes) else b""
            return painted

    assert b"\x1b[" in asyncio.run(first_bytes())
    command.end()
    assert command.ran == []


def test_the_settings_of_numba_in_the_current_folder_do_not_say_whence_machine_code_is_loaded(folder):
    code = "import advisor.process.compiled, numba; print(repr(numba.config.CACHE_DIR)); import yaml"
    done = subprocess.run(
        [sys.executable, "-P", "-W", "ignore", "-c", code],
        cwd=folder,
        env={**os.environ, "PYTHONPATH": str(ROOT), "NUMBA_CACHE_DIR": ""},
        capture_output=True,
        text=True,
        check=True,
    )
    assert done.stdout.strip() == "''"


def test_every_child_is_started_by_the_one_module_that_keeps_the_current_folder_out() -> None:
    elsewhere = []
    for path in [*(ROOT / "advisor").rglob("*.py"), *(ROOT / "sim").rglob("*.py")]:
        text = path.read_text(encoding="utf-8")
        named_at_all = "executable" in text or "multiprocessing" in text
        for node in ast.walk(ast.parse(text)) if named_at_all else ():
            named = isinstance(node, ast.Attribute) and ast.unparse(node)
            if named in ("sys.executable", "multiprocessing.get_context", "multiprocessing.Process"):
                elsewhere.append(f"{path}:{node.lineno}")
    assert [place for place in elsewhere if not place.startswith(str(STARTERS))] == []
