"""Result of an examination: facts, limits, and the verdict."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Literal

from advisor.doctor.expectation import Assumed, ExpectedErrors
from advisor.doctor.survey import Arrival, Clocks
from advisor.flight.signals.instrument_finding import InstrumentFinding
from advisor.flight.vehicle.vehicle import Vehicle
from advisor.words.problems import Problem

DoctorVerdict = Literal["ready", "usable with limits", "not usable"]


@dataclass(frozen=True, slots=True)
class Limit:
    """A defect that keeps the telemetry from being ready."""

    code: str
    """Short and stable identifier: ``rate``, ``alpha_derived``, ``calibration``, ..."""
    text: str
    """Sentence on the defect, with its number."""
    fix: str
    """Remedy."""
    stops: bool = False
    """Whether the defect prevents any identification."""
    std_ratio: Mapping[str, float] = field(default_factory=dict)
    """Cost of the defect alone: parameter name to its expected error, divided by the error without the
    defect."""


_OF_THE_FILE = frozenset({"servo_limits", "calibration", "resolution", "servo_unknown"})
"""Codes of the limits that parameters or the aircraft file can mend. All others are limits of the data."""


def in_order(limits: Sequence[Limit]) -> tuple[Limit, ...]:
    """Return limits in the order in which they are said: what stops, then the data, then the numbers of
    parameters and aircraft file. Within these they keep their order."""
    return tuple(sorted(limits, key=lambda limit: (not limit.stops, limit.code in _OF_THE_FILE)))


@dataclass(frozen=True, slots=True)
class ElevatorFound:
    """Elevator as found in the telemetry."""

    outputs: tuple[int, ...]
    resolution_deg: float
    """Deflection of the smallest step that an output can express: 1 us of one output."""
    calibrated: bool
    """Whether the file has a calibration. Without a calibration, the parameters' limits and an assumed full
    travel give the scale."""
    doubts: tuple[Problem, ...] = ()
    """Problems of limits that are assumed in the scale."""


@dataclass(frozen=True, slots=True)
class AlphaFound:
    """Source of the angle of attack."""

    source: str
    provenance: str
    renewed_hz: float
    """Rate at which the value changes, Hz."""


@dataclass(frozen=True, slots=True)
class Examination:
    """Findings of the examination."""

    vehicle: Vehicle | None
    messages: tuple[Arrival, ...]
    clocks: Clocks | None
    elevator: ElevatorFound | None
    alpha: AlphaFound | None
    limits: tuple[Limit, ...]
    """Defects, those that prevent any identification first."""
    expectation: ExpectedErrors | None
    """Expected errors. None when a needed channel is missing."""
    assumed: Assumed
    """Model and noise behind the expected errors and the demands on rates."""
    instruments: tuple[InstrumentFinding, ...] = ()
    """Contradictions of the instruments. Each contradiction of an instrument is also listed in ``limits``."""
    airspeed_m_s: tuple[float, float] | None = None
    """Lowest and highest air speed in flight, m/s. None: no air speed arrives, or nothing flies."""
    notes: tuple[str, ...] = ()
    """Choices made in reading the log, and pauses of the autopilot's own log, as sentences."""

    @property
    def verdict(self) -> DoctorVerdict:
        """Ready, usable with limits, or not usable."""
        if any(limit.stops for limit in self.limits):
            return "not usable"
        return "usable with limits" if self.limits else "ready"
