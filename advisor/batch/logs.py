"""Logs of a batch, and the aircraft file of each."""

import os
from collections.abc import Sequence
from dataclasses import dataclass
from fnmatch import fnmatch
from pathlib import Path

from advisor.mavlink.logs.formats import ENDINGS
from advisor.process.yaml_file import read_yaml
from advisor.words.problems import ConfigurationError, UnusableInputError

PACKED = (".gz", ".zip")


def find_logs(places: Sequence[Path], without: Path) -> list[Path]:
    """Return logs without repetitions, in the given order. Logs of a folder are sorted by name.

    Parameters
    ----------
    places
        Logs and folders. A folder is searched with its subfolders for names with the endings of logs.
    without
        Folder of the results, which is not searched.

    Raises
    ------
    UnusableInputError
        A folder holds no log.
    """
    by_path: dict[Path, Path] = {}
    for place in places:
        logs = _in_folder(place, without.resolve()) if place.is_dir() else [place]
        if not logs:
            raise UnusableInputError(
                "no_logs",
                f"{place} holds no logs ({', '.join(ENDINGS)}, packed or not).",
                "Give a folder with logs in it.",
            )
        for log in logs:
            by_path.setdefault(log.resolve(), log)
    return list(by_path.values())


def _in_folder(folder: Path, without: Path) -> list[Path]:
    logs = []
    for root, folders, files in os.walk(folder):
        folders[:] = sorted(name for name in folders if (Path(root) / name).resolve() != without)
        logs += [Path(root) / name for name in sorted(files) if _is_log(name)]
    return logs


def _is_log(name: str) -> bool:
    lower = name.lower()
    for ending in PACKED:
        lower = lower.removesuffix(ending)
    return lower.endswith(ENDINGS)


@dataclass(frozen=True, slots=True)
class AircraftMap:
    """Patterns of log names with their aircraft files. The first pattern that matches a log is used."""

    entries: tuple[tuple[str, Path], ...]

    def file_of(self, log: Path) -> Path | None:
        """Return the aircraft file of a log; None if no pattern matches the log's path or name."""
        names = (log.as_posix(), log.name)
        return next((file for pattern, file in self.entries if any(fnmatch(n, pattern) for n in names)), None)


def read_map(path: Path) -> AircraftMap:
    """Read a YAML file of ``pattern: aircraft file``. Paths of the aircraft files are relative to the map.

    Raises
    ------
    ConfigurationError
        The file cannot be read, or is no list of patterns and aircraft files.
    """
    content = read_yaml(path)
    if not isinstance(content, dict) or not all(
        isinstance(text, str) for text in (*content, *content.values())
    ):
        raise ConfigurationError(
            f"{path}: give one line a pattern, as in '\"alpha-*.tlog\": alpha.yaml'; "
            "the first pattern that matches counts."
        )
    return AircraftMap(tuple((pattern, path.parent / file) for pattern, file in content.items()))
