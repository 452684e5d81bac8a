"""Result of a telemetry examination: facts, limits, and the verdict."""

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
    """A defect for which the telemetry is not ready."""

    code: str
    """Short and stable identifier: ``rate``, ``alpha_derived``, ``calibration``, ..."""
    text: str
    """Sentence on the defect, with the measured value."""
    fix: str
    """Remedy."""
    stops: bool = False
    """Whether the defect prevents any identification."""
    std_ratio: Mapping[str, float] = field(default_factory=dict)
    """Cost of this defect, by parameter name: the expected error divided by the error without the defect."""


_OF_THE_FILE = frozenset({"servo_limits", "calibration", "resolution", "servo_unknown"})
"""Codes of the limits that parameters or the aircraft file can remedy. All other codes are limits of the
data."""


def in_order(limits: Sequence[Limit]) -> tuple[Limit, ...]:
    """Return the limits in the order of a report. Limits that prevent identification come first, then limits
    of the data, then of parameters and aircraft file.
    """
    return tuple(sorted(limits, key=lambda limit: (not limit.stops, limit.code in _OF_THE_FILE)))


@dataclass(frozen=True, slots=True)
class ElevatorFound:
    """Elevator of the vehicle, as found in the telemetry."""

    outputs: tuple[int, ...]
    resolution_deg: float
    """Deflection of the smallest step that an output can express: 1 us of one output."""
    calibrated: bool
    """Whether the file has a calibration. Without a calibration, the parameters' limits and an assumed full
    travel give the scale."""
    doubts: tuple[Problem, ...] = ()
    """Problems with the servo limits that the scale assumes."""


@dataclass(frozen=True, slots=True)
class AlphaFound:
    """Source of the angle of attack in the telemetry."""

    source: str
    provenance: str
    renewed_hz: float
    """Rate at which the value changes, Hz."""


@dataclass(frozen=True, slots=True)
class Examination:
    """Findings of the telemetry examination."""

    vehicle: Vehicle | None
    messages: tuple[Arrival, ...]
    clocks: Clocks | None
    elevator: ElevatorFound | None
    alpha: AlphaFound | None
    limits: tuple[Limit, ...]
    """Defects of the telemetry, beginning with those that prevent any identification."""
    expectation: ExpectedErrors | None
    """Expected errors of the derivatives. None when a needed channel is missing."""
    assumed: Assumed
    """Model and noise from which the expected errors and the required rates follow."""
    instruments: tuple[InstrumentFinding, ...] = ()
    """Contradictions of the instruments. Each contradiction of an instrument is also listed in ``limits``."""
    airspeed_m_s: tuple[float, float] | None = None
    """Lowest and highest air speed in flight, m/s. None: no air speed arrives, or the vehicle does not
    fly."""
    notes: tuple[str, ...] = ()
    """Choices made in reading the log, and pauses of the autopilot's own log, as sentences."""

    @property
    def verdict(self) -> DoctorVerdict:
        """Verdict on the telemetry: ready, usable with limits, or not usable."""
        if any(limit.stops for limit in self.limits):
            return "not usable"
        return "usable with limits" if self.limits else "ready"
