"""Logs with their aircraft files, read once for each axis, and diagnosed by the code of the command."""

import lzma
import tempfile
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Protocol

from advisor.aircraft.aircraft import Aircraft
from advisor.aircraft_file.read import load_aircraft
from advisor.analysis.axis_flown import accepted_of, compare_side_flown
from advisor.analysis.gap import compare_flown, opened_simulator
from advisor.analysis.gap_flights import GapFlights, maneuvers_of, without_refused
from advisor.analysis.whole_flights import read_whole
from advisor.campaign.state import CampaignState
from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.gap.alternative import Weighed
from advisor.words.problems import UnusableInputError

SUFFIXES = (".tlog", ".bin", ".ulg")
PACKED = ".xz"
FOLDERS = (Path("logs"), Path("../shared/flights"), Path("../shared/gate/logs"))
"""Folders that are searched without an argument, where they exist."""


@dataclass(frozen=True)
class Answer:
    """Probabilities of the names of one diagnosis, the blocks of "unknown" together."""

    shares: dict[str, float]
    """Name to probability; empty without an answer."""
    because: str = ""
    """Reason for no answer."""

    @property
    def name(self) -> str:
        """Likeliest name."""
        return max(self.shares, key=lambda name: self.shares[name]) if self.shares else "no answer"

    def of(self, name: str) -> float:
        """Return the probability of a name."""
        return self.shares.get(name, 0.0)


class Flight(Protocol):
    """A flight along one axis."""

    @property
    def maneuvers(self) -> Sequence[Maneuver]:
        """Manoeuvres that the diagnosis uses."""

    def answered(self, maneuvers: Sequence[Maneuver]) -> Answer:
        """Return the answer of ``advisor gap`` to manoeuvres of this flight."""


@dataclass(frozen=True)
class PitchFlight:
    """Manoeuvres of the elevator."""

    flown: GapFlights
    aircraft: Aircraft

    @property
    def maneuvers(self) -> Sequence[Maneuver]:
        """Manoeuvres that the diagnosis uses."""
        return self.flown.maneuvers

    def answered(self, maneuvers: Sequence[Maneuver]) -> Answer:
        """Return the answer of ``advisor gap --axis pitch``."""
        flown = replace(self.flown, maneuvers=list(maneuvers))
        try:
            with opened_simulator(self.aircraft) as simulator:
                compared = compare_flown(flown, self.aircraft, simulator)
        except UnusableInputError as error:
            return Answer({}, str(error))
        told = compared.diagnosis
        return answer_of(told) if told.evidence else Answer({}, told.sentence)


@dataclass(frozen=True)
class SideFlight:
    """Accepted manoeuvres of aileron and rudder."""

    state: CampaignState
    aircraft: Aircraft

    @property
    def maneuvers(self) -> Sequence[Maneuver]:
        """Manoeuvres that the diagnosis uses."""
        return accepted_of(self.state)

    def answered(self, maneuvers: Sequence[Maneuver]) -> Answer:
        """Return the answer of ``advisor gap --axis lateral``."""
        assert self.state.lateral is not None
        fresh = {maneuver.number: maneuver for maneuver in maneuvers}
        judged = tuple(
            replace(j, maneuver=fresh[j.maneuver.number])
            for j in self.state.lateral.maneuvers
            if j.maneuver.number in fresh
        )
        # The joint estimate of the log belongs to the unchanged manoeuvres.
        lateral = replace(self.state.lateral, maneuvers=judged, model=None)
        try:
            compared = compare_side_flown(
                replace(self.state, axes={**self.state.axes, "lateral": lateral}), self.aircraft
            )
        except UnusableInputError as error:
            return Answer({}, str(error))
        found = compared.diagnosis
        return answer_of(found) if found.evidence else Answer({}, "no model fits")


def answer_of(diagnosis: Weighed) -> Answer:
    """Return the probabilities of a diagnosis by the names of its alternatives."""
    shares: dict[str, float] = {}
    for each in diagnosis.evidence:
        name = each.alternative.name
        shares[name] = shares.get(name, 0.0) + each.probability
    return Answer(shares)


def flights_of(log: Path, axes: Sequence[str]) -> Iterator[tuple[str, Flight]]:
    """Yield the flight of a log along each axis with usable manoeuvres.

    Raises
    ------
    ConfigurationError
        The aircraft file of the log is wrong.
    """
    aircraft = load_aircraft(beside(log))
    with unpacked(log) as plain:
        if "pitch" in axes:
            try:
                flown = maneuvers_of([plain], aircraft)
                without_refused(flown.maneuvers, aircraft)
                yield "pitch", PitchFlight(flown, aircraft)
            except UnusableInputError:
                pass
        if "lateral" in axes:
            try:
                state = read_whole([plain], aircraft, no_marks=True, axis="lateral").state
                accepted_of(state)
                yield "lateral", SideFlight(state, aircraft)
            except UnusableInputError:
                pass


def logs_of(paths: Sequence[Path]) -> list[Path]:
    """Return the logs of files and folders that have an aircraft file next to the log."""
    folders = paths or [folder for folder in FOLDERS if folder.is_dir()]
    every = [p for path in folders for p in (sorted(path.iterdir()) if path.is_dir() else [path])]
    return [log for log in every if _is_log(log) and beside(log).is_file()]


def beside(log: Path) -> Path:
    """Return the path of a log's aircraft file."""
    bare = log.with_suffix("") if log.suffix == PACKED else log
    return bare.with_suffix(".yaml")


def _is_log(path: Path) -> bool:
    bare = path.with_suffix("") if path.suffix == PACKED else path
    return bare.suffix.lower() in SUFFIXES


@contextmanager
def unpacked(log: Path) -> Iterator[Path]:
    """Provide a log as a plain file, which lasts as long as the context."""
    if log.suffix != PACKED:
        yield log
        return
    with tempfile.TemporaryDirectory() as folder:
        plain = Path(folder) / log.with_suffix("").name
        plain.write_bytes(lzma.decompress(log.read_bytes()))
        yield plain
