"""One log of a batch: its key, its analysis, and the form in which results are kept."""

import hashlib
import json
import socket
from collections.abc import Sequence
from dataclasses import asdict, dataclass, field
from math import nan
from pathlib import Path
from typing import Any

import numpy as np

from advisor import __version__
from advisor.aircraft import Aircraft
from advisor.atomic_file import write_atomically
from advisor.log_series import began_s
from advisor.marks_file import path_beside
from advisor.oem.estimate import Estimate
from advisor.problems import ConfigurationError, Problem, UnusableInputError
from advisor.report.document import analysis_document, number


@dataclass(frozen=True, slots=True)
class Task:
    """A log to be analyzed."""

    log: Path
    aircraft: Aircraft
    aircraft_file: str
    """Name of the aircraft file; empty without one."""
    sha256: str
    """Of the log."""

    @property
    def key(self) -> str:
        """Names the result: the same log, configuration, decisions by hand and advisor give the same."""
        beside = path_beside(self.log)
        by_hand = beside.read_text(encoding="utf-8", errors="replace") if beside.is_file() else ""
        parts = [__version__, self.sha256, json.dumps(asdict(self.aircraft), sort_keys=True), by_hand]
        return hashlib.sha256("\0".join(parts).encode()).hexdigest()


@dataclass(frozen=True, slots=True)
class Analyzed:
    """What came of a log."""

    log: str
    aircraft_file: str
    sha256: str
    began_s: float
    """When the log began, s since 1970; NaN where it has no dates."""
    document: dict[str, Any]
    """As ``advisor analyze --json`` prints."""
    joint: dict[str, Any] = field(default_factory=dict)
    """The joint estimate with its covariances, to be compared over flights; empty without one."""

    @property
    def usable(self) -> bool:
        """Whether the log counts."""
        return bool(self.document["usable"])

    @property
    def reasons(self) -> list[str]:
        """Why the log does not count, in sentences."""
        return [f"{problem['text']} {problem['fix']}".strip() for problem in self.document["problems"]]

    @property
    def estimate(self) -> Estimate | None:
        """The joint estimate, as far as flights are compared by it."""
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


def analyze(task: Task) -> Analyzed:
    """Analyze a log as ``advisor analyze`` does; a log that cannot be used is a result, too."""
    from advisor.campaign.campaign import Campaign
    from advisor.log_series import LogSeries

    series = LogSeries([task.log])
    campaign = Campaign(task.aircraft, by_hand=series.read_by_hand())
    for columns in series.batches():
        campaign.feed(columns)
    if series.unreadable:
        return failed(task, list(series.unreadable.values()))
    campaign.finish()
    state = campaign.state
    left_out = {one.flight: one.problems for one in state.flights if one.problems}
    document = analysis_document(state, [str(task.log)], task.aircraft, left_out)
    joint: dict[str, Any] = {}
    if state.model is not None:
        joint = {name: _finite(getattr(state.model, name)) for name in _KEPT}
        joint["airspeed_m_s"] = number(state.model.airspeed_m_s)
    began = began_s(task.log)
    return Analyzed(str(task.log), task.aircraft_file, task.sha256, began, document, joint)


def analyze_shared(task: Task) -> Analyzed:
    """Analyze a log on another computer, which must see the log under the path of this one.

    Raises
    ------
    ConfigurationError
        The worker sees no such log, or another one there.
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


def failed(task: Task, problems: Sequence[Problem]) -> Analyzed:
    """Return the result of a log that could not be analyzed."""
    document = analysis_document(None, [str(task.log)], task.aircraft, {0: problems})
    return Analyzed(str(task.log), task.aircraft_file, task.sha256, nan, document)


def _finite(values: np.ndarray[Any, Any]) -> list[Any]:
    """Return nested lists of numbers that JSON can hold: None for what is not finite."""
    if values.ndim > 1:
        return [_finite(row) for row in values]
    return [number(value) for value in values.tolist()]


def keep(result: Analyzed, path: Path) -> None:
    """Write a result: the file is old or new and whole.

    Raises
    ------
    OSError
        The file cannot be written.
    """
    kept = {**asdict(result), "began_s": number(result.began_s)}
    write_atomically(path, json.dumps(kept, allow_nan=False))


def kept(path: Path) -> Analyzed | None:
    """Return a result that was kept before; None without a file, or with one that holds no result."""
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
    from advisor.mavlink.unpack import beginning_of

    beginning_of(log)
    try:
        with log.open("rb") as file:
            return hashlib.file_digest(file, "sha256").hexdigest()
    except OSError as error:
        raise UnusableInputError(
            "unreadable", f"{log} cannot be read: {error.strerror}.", "Check its permissions."
        ) from None
