"""The links that run on this computer, so that an advisor finds the link of one whose screen is gone."""

import contextlib
import json
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import platformdirs

from advisor.atomic_file import write_atomically
from advisor.mavlink.keeping import Door


@dataclass(frozen=True, slots=True)
class RunningLink:
    """A process that keeps a link."""

    pid: int
    master: str
    recording: Path | None
    door: Door
    alone: bool
    """Nobody looks after the process: its advisor ended without a word."""


def note(link: RunningLink) -> None:
    """Write down a link that runs, or how it runs now; only the user can read it."""
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
    """Strike out a link that has ended."""
    _path(pid).unlink(missing_ok=True)


def running_alone() -> Iterator[RunningLink]:
    """Yield links that run though their advisor is gone; notes of processes that are gone too are struck
    out."""
    for path in sorted(_folder().glob("*.json")):
        with contextlib.suppress(OSError, ValueError, KeyError, TypeError):
            link = _read(path)
            try:
                link.door.open().close()
            except OSError:
                forget(link.pid)
                continue
            if link.alone:
                yield link


def _read(path: Path) -> RunningLink:
    content = json.loads(path.read_text(encoding="utf-8"))
    recording = Path(content["recording"]) if content["recording"] else None
    door = Door(content["address"], bytes.fromhex(content["key"]))
    return RunningLink(int(path.stem), content["master"], recording, door, bool(content["alone"]))


def _folder() -> Path:
    return Path(platformdirs.user_data_dir("inflight-advisor")) / "links"


def _path(pid: int) -> Path:
    return _folder() / f"{pid}.json"
