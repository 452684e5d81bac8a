"""Logs of a batch: each log's aircraft file, key and analysis, and the file with its result."""

import hashlib
import json
import os
import socket
from collections.abc import Sequence
from dataclasses import asdict, dataclass, field
from fnmatch import fnmatch
from math import nan
from pathlib import Path
from typing import Any

import numpy as np

from advisor import __version__
from advisor.aircraft.aircraft import Aircraft
from advisor.analysis.marks_file import began_s, path_beside
from advisor.mavlink.logs.formats import ENDINGS
from advisor.oem.estimate import Estimate
from advisor.process.atomic_file import write_atomically
from advisor.process.yaml_file import read_yaml
from advisor.report.document import analysis_document
from advisor.words.plain import plain
from advisor.words.problems import ConfigurationError, Problem, UnusableInputError

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


@dataclass(frozen=True, slots=True)
class BatchTask:
    """A log for analysis, with its aircraft file."""

    log: Path
    aircraft: Aircraft
    aircraft_file: str
    """Name of the aircraft file; empty without one."""
    sha256: str
    """SHA-256 hash of the log."""
    aircraft_path: Path | None = None
    """Path of the aircraft file; None without a file."""

    @property
    def aircraft_name(self) -> str:
        """Name of the aircraft, from the name of its file; empty without a file."""
        return self.aircraft.name if self.aircraft_file else ""

    @property
    def key(self) -> str:
        """Key under which the log's result is stored. Logs with equal content, configuration, decisions by
        hand and advisor have one key."""
        beside = path_beside(self.log)
        by_hand = beside.read_text(encoding="utf-8", errors="replace") if beside.is_file() else ""
        parts = [__version__, self.sha256, json.dumps(asdict(self.aircraft), sort_keys=True), by_hand]
        return hashlib.sha256("\0".join(parts).encode()).hexdigest()


@dataclass(frozen=True, slots=True)
class Analyzed:
    """Result of the analysis of one log."""

    log: str
    aircraft_file: str
    sha256: str
    began_s: float
    """Start time of the log, s since 1970. NaN for a log without dates."""
    document: dict[str, Any]
    """Document of ``advisor analyze --json``."""
    joint: dict[str, Any] = field(default_factory=dict)
    """Joint estimate with its covariances, for comparison over flights; empty without an estimate."""
    aircraft_name: str = ""
    """Name of the aircraft, from the name of its file; empty without a file."""

    @property
    def usable(self) -> bool:
        """Whether the log's results are used."""
        return bool(self.document["usable"])

    @property
    def reasons(self) -> list[str]:
        """Reasons for which the log's results are not used, as sentences."""
        return [f"{problem['text']} {problem['fix']}".strip() for problem in self.document["problems"]]

    @property
    def maneuvers(self) -> list[dict[str, Any]]:
        """Manoeuvres of the elevator, then those of aileron and rudder, from the document."""
        return [*self.document["maneuvers"], *self.lateral.get("maneuvers", ())]

    @property
    def lateral(self) -> dict[str, Any]:
        """Block ``lateral`` of the document; empty for a log that could not be analyzed."""
        side: dict[str, Any] = self.document["lateral"] if self.document["flight_test"] else {}
        return side

    @property
    def is_named(self) -> bool:
        """Whether an aircraft file identifies the aircraft that flew."""
        return bool(self.aircraft_file)

    @property
    def estimate(self) -> Estimate | None:
        """Joint estimate, with the parts that the comparison of flights needs."""
        if not self.joint:
            return None
        theta, covariance_cr, covariance = (np.array(self.joint[name], dtype=np.float64) for name in _KEPT)
        return Estimate(
            theta,
            covariance_cr,
            covariance,
            cost=nan,
            fits=(),
            iterations=0,
            not_identifiable={},
            correlated=(),
            condition=nan,
            airspeed_m_s=self.joint["airspeed_m_s"],
        )


_KEPT = ("theta", "covariance_cr", "covariance")


def analyze(task: BatchTask) -> Analyzed:
    """Analyze a log like ``advisor analyze``. An unusable log has a result too."""
    from advisor.analysis.gap import as_in_tables
    from advisor.analysis.marks_file import LogSeries
    from advisor.analysis.whole_flights import left_out_of
    from advisor.campaign.campaign import Campaign

    series = LogSeries([task.log], task.aircraft.columns)
    campaign = Campaign(as_in_tables(task.aircraft, [task.log]), by_hand=series.read_by_hand(), lateral=True)
    for columns in series.batches():
        campaign.feed(columns)
    if series.unreadable:
        return failed(task, list(series.unreadable.values()))
    campaign.finish()
    state = campaign.state
    document = analysis_document(state, [str(task.log)], task.aircraft, left_out_of("both", state))
    joint: dict[str, Any] = {}
    if state.model is not None:
        joint = {name: plain(getattr(state.model, name)) for name in _KEPT}
        joint["airspeed_m_s"] = plain(state.model.airspeed_m_s)
    began = began_s(task.log)
    name = task.aircraft_name
    return Analyzed(str(task.log), task.aircraft_file, task.sha256, began, document, joint, name)


def analyze_shared(task: BatchTask) -> Analyzed:
    """Analyze a log on another computer, which must see the log under one path.

    Raises
    ------
    ConfigurationError
        The worker sees no log, or another log, under the path.
    """
    try:
        seen = sha256_of(task.log)
    except UnusableInputError:
        seen = ""
    if seen != task.sha256:
        host = socket.gethostname()
        what = f"the worker on {host} sees {'another log' if seen else 'no log'} there"
        raise ConfigurationError(f"{task.log}: {what}. Share the folder of logs under one path.")
    return analyze(task)


def failed(task: BatchTask, problems: Sequence[Problem]) -> Analyzed:
    """Return the result of a log whose analysis failed."""
    document = analysis_document(None, [str(task.log)], task.aircraft, {0: problems})
    name = task.aircraft_name
    return Analyzed(str(task.log), task.aircraft_file, task.sha256, nan, document, aircraft_name=name)


def keep(result: Analyzed, path: Path) -> None:
    """Write the result of a log into a file. The file is always complete, with the old or the new result.

    Raises
    ------
    OSError
        The file cannot be written.
    """
    kept = {**asdict(result), "began_s": plain(result.began_s)}
    write_atomically(path, json.dumps(kept, allow_nan=False))


def kept(path: Path) -> Analyzed | None:
    """Return a stored result; None without a file, or for a file without a result."""
    try:
        content = json.loads(path.read_text(encoding="utf-8"))
        return Analyzed(**{**content, "began_s": nan if content["began_s"] is None else content["began_s"]})
    except (OSError, ValueError, KeyError, TypeError):
        return None


def sha256_of(log: Path) -> str:
    """Return SHA-256 of a file.

    Raises
    ------
    UnusableInputError
        There is no such file, or it cannot be read.
    """
    from advisor.mavlink.logs.unpack import beginning_of

    beginning_of(log)
    try:
        with log.open("rb") as file:
            return hashlib.file_digest(file, "sha256").hexdigest()
    except OSError as error:
        raise UnusableInputError(
            "unreadable", f"{log} cannot be read: {error.strerror}.", "Check its permissions."
        ) from None
