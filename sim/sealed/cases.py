"""Writing of sealed cases: logs and aircraft files under neutral names, and the sealed key."""

import os
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import yaml

from .seal import seal

LOG, AIRCRAFT = "flight.tlog", "aircraft.yaml"
MADE_AT = 1_790_000_000
"""Time stamp of every file, s since 1970, which hides the order of creation."""


@dataclass(frozen=True)
class SealedCase:
    """A case from a generator, before it is sealed."""

    name: str
    """Neutral name: a number in a shuffled order, or random digits."""
    truth: Mapping[str, Any]
    """Truth of the case, with the keys that ``judge`` reads."""
    log: bytes
    """Telemetry log."""
    aircraft: Mapping[str, Any]
    """Aircraft file with the crew's knowledge."""


def key_beside(folder: Path) -> Path:
    """Return the path of the key of a folder of cases, next to the folder."""
    return folder.with_name(folder.name + ".key.json")


def write_set(folder: Path, cases: Iterable[SealedCase]) -> str:
    """Write each case, seal the key of all cases, and return the seal's hash."""
    folder.mkdir(parents=True, exist_ok=True)
    key = {}
    for case in cases:
        key[case.name] = dict(case.truth)
        write_case(case, folder / case.name)
    return seal({name: key[name] for name in sorted(key)}, key_beside(folder), folder)


def write_case(case: SealedCase, folder: Path) -> None:
    """Write one case's log and aircraft file."""
    folder.mkdir(exist_ok=True)
    (folder / LOG).write_bytes(case.log)
    (folder / AIRCRAFT).write_text(yaml.safe_dump(dict(case.aircraft), sort_keys=False), encoding="utf-8")
    for path in (folder / LOG, folder / AIRCRAFT, folder):
        os.utime(path, (MADE_AT, MADE_AT))
