"""Result of a telemetry examination: facts, limits, the verdict, and the next steps."""

import shlex
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Literal

from advisor.doctor.expectation import Assumed, ExpectedErrors
from advisor.doctor.survey import Arrival, Clocks
from advisor.flight.signals.trust import InstrumentFinding
from advisor.flight.vehicle.vehicle import Vehicle
from advisor.process.installed import SAMPLE
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


NEW_FILE = "aircraft.yaml"
"""Name of the aircraft file in the commands, if no aircraft file exists."""
RECORDING = "flight.tlog"
"""Name of a live link's recording in the commands."""
USUAL_LINK = "udpin:0.0.0.0:14550"
"""Default address to which ground stations and simulators send telemetry."""
_SLOW = frozenset({"rate", "renewal", "no_pitch_rate", "no_alpha", "no_airspeed", "no_accelerometer"})
"""Codes of limits for which faster message streams are the remedy."""

_NO_AIRCRAFT = frozenset({"no_vehicle", "multicopter"})
"""Codes of limits of a log without a fixed-wing aircraft."""


@dataclass(frozen=True, slots=True)
class ExaminedInput:
    """The log or connection that was examined, as the user named it."""

    target: str
    """Path of a log, or address of a connection."""
    is_log: bool
    aircraft_file: str | None = None
    target_system: int | None = None
    has_model: bool = False
    """Whether the aircraft file has the simulator's derivatives."""


def next_commands(findings: Examination, examined: ExaminedInput) -> tuple[str, str, str]:
    """Return the next three commands, in their order."""
    return _after_log(findings, examined) if examined.is_log else _after_link(findings, examined)


def _after_log(findings: Examination, examined: ExaminedInput) -> tuple[str, str, str]:
    log, aircraft = shlex.quote(examined.target), shlex.quote(examined.aircraft_file or NEW_FILE)
    chosen = _chosen(findings, examined)
    stopping = {limit.code for limit in findings.limits if limit.stops}
    if examined.aircraft_file is None:
        describe = f"advisor aircraft new --from {log} -o {NEW_FILE}{chosen}"
    else:
        describe = f"advisor aircraft check {aircraft} --log {log}{chosen}"
    if not stopping:
        last = "gap" if examined.has_model else "report"
        output = "" if examined.has_model else " -o flight.html"
        return (
            describe,
            f"advisor replay {log} --aircraft {aircraft}{chosen}",
            f"advisor {last} {log} --aircraft {aircraft}{output}{chosen}",
        )
    if stopping & _NO_AIRCRAFT:
        sample = f"{SAMPLE}.tlog --aircraft {SAMPLE}.yaml"
        return (f"advisor doctor {USUAL_LINK}", "advisor sample", f"advisor doctor {sample}")
    if stopping & _SLOW:
        # This flight is lost for the purpose; the next one need not be.
        if examined.aircraft_file is None:
            return (describe, *_next_flight(aircraft)[:2])
        return _next_flight(aircraft)
    return (
        describe,
        f"advisor doctor {log} --aircraft {aircraft}{chosen}",
        f"advisor analyze {log} --aircraft {aircraft} --all{chosen}",
    )


def _next_flight(aircraft: str) -> tuple[str, str, str]:
    return (
        f"advisor doctor {USUAL_LINK} --request-rates --aircraft {aircraft}",
        f"advisor live --master {USUAL_LINK} --request-rates --record {RECORDING} --aircraft {aircraft}",
        f"advisor analyze {RECORDING} --aircraft {aircraft}",
    )


def _after_link(findings: Examination, examined: ExaminedInput) -> tuple[str, str, str]:
    connection, chosen = shlex.quote(examined.target), _chosen(findings, examined)
    aircraft = f" --aircraft {shlex.quote(examined.aircraft_file)}" if examined.aircraft_file else ""
    codes = {limit.code for limit in findings.limits}
    rates = " --request-rates" if codes & _SLOW or findings.elevator is None else ""
    live = f"advisor live --master {connection}{rates} --record {RECORDING}{aircraft}{chosen}"
    after = f"advisor report {RECORDING}{aircraft} -o flight.html{chosen}"
    if any(limit.stops for limit in findings.limits):
        return (f"advisor doctor {connection}{rates}{aircraft}{chosen}", live, after)
    return (live, f"advisor analyze {RECORDING}{aircraft}{chosen}", after)


def _chosen(findings: Examination, examined: ExaminedInput) -> str:
    """Return the option that names the vehicle, if the user selected a vehicle or several vehicles are
    received.
    """
    system = examined.target_system
    if system is None and findings.vehicle and any(x.code == "several_vehicles" for x in findings.limits):
        system = findings.vehicle.system
    return "" if system is None else f" --target-system {system}"
