"""Links that run on this computer, for an advisor that continues after another one ended."""

import contextlib
import json
import os
import signal
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from threading import Thread
from typing import Literal

import platformdirs

from advisor.mavlink.link.keeping import Door
from advisor.process.atomic_file import write_atomically

ANSWERS_WITHIN_S = 5.0
"""Time within which a link's process must answer a caller, s. No task of the process takes a second."""


@dataclass(frozen=True, slots=True)
class RunningLink:
    """A process that keeps a link."""

    pid: int
    master: str
    recording: Path | None
    door: Door
    alone: bool
    """Whether the process is unguarded, because its advisor ended abruptly."""


def note(link: RunningLink) -> None:
    """Write a file about a running link and its state, readable by the user only."""
    path = _path(link.pid)
    path.parent.mkdir(mode=0o700, parents=True, exist_ok=True)
    content = {
        "master": link.master,
        "recording": str(link.recording) if link.recording else None,
        "address": link.door.address,
        "key": link.door.key.hex(),
        "alone": link.alone,
    }
    write_atomically(path, json.dumps(content))


def forget(pid: int) -> None:
    """Remove the file about a link that has ended."""
    with contextlib.suppress(OSError):
        _path(pid).unlink(missing_ok=True)


def running_alone() -> Iterator[RunningLink]:
    """Yield links that run without their advisor. Files about ended processes are removed.

    An unguarded process that hangs is ended, because it would keep its connection.
    """
    for path in sorted(_folder().glob("*.json")):
        with contextlib.suppress(OSError, ValueError, KeyError, TypeError):
            link = _read(path)
            state = _state(link.door)
            if state == "hangs" and link.alone:
                os.kill(link.pid, signal.SIGKILL)
            if state == "gone" or (state == "hangs" and link.alone):
                forget(link.pid)
            elif link.alone:
                yield link


def _state(door: Door) -> Literal["answers", "hangs", "gone"]:
    """Return whether the process at an address answers within ``ANSWERS_WITHIN_S``."""
    states: list[Literal["answers", "gone"]] = []

    def knock() -> None:
        try:
            door.open().close()
            states.append("answers")
        except (OSError, EOFError):
            states.append("gone")

    knocking = Thread(target=knock, daemon=True)
    knocking.start()
    knocking.join(ANSWERS_WITHIN_S)
    return states[0] if states else "hangs"


def _read(path: Path) -> RunningLink:
    content = json.loads(path.read_text(encoding="utf-8"))
    recording = Path(content["recording"]) if content["recording"] else None
    door = Door(content["address"], bytes.fromhex(content["key"]))
    return RunningLink(int(path.stem), content["master"], recording, door, bool(content["alone"]))


def _folder() -> Path:
    return Path(platformdirs.user_data_dir("inflight-advisor")) / "links"


def _path(pid: int) -> Path:
    return _folder() / f"{pid}.json"
