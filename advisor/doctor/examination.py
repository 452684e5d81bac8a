"""What an examination finds: facts, limits, and the verdict."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal

from advisor.doctor.expectation import Belief, Expectation
from advisor.doctor.survey import Arrival, Clocks
from advisor.flight.vehicle import Vehicle

Verdict = Literal["ready", "usable with limits", "not usable"]


@dataclass(frozen=True, slots=True)
class Limit:
    """Something that keeps the telemetry from being ready."""

    code: str
    """Short and stable: ``rate``, ``alpha_derived``, ``calibration``, ..."""
    text: str
    """What is so, with its number."""
    fix: str
    """What to change."""
    stops: bool = False
    """Nothing can be identified before it is mended."""
    std_ratio: Mapping[str, float] = field(default_factory=dict)
    """What it costs by itself: parameter name to its expected error over the one without this limit."""


@dataclass(frozen=True, slots=True)
class ElevatorFound:
    """The elevator as the telemetry shows it."""

    outputs: tuple[int, ...]
    resolution_deg: float
    """Deflection of the smallest step that an output can express: 1 us of one output."""
    calibrated: bool
    """False: scaled by the limits in the parameters and assumed full strokes."""


@dataclass(frozen=True, slots=True)
class AlphaFound:
    """Where the angle of attack would come from."""

    source: str
    provenance: str
    renewed_hz: float
    """How often it really changes."""


@dataclass(frozen=True, slots=True)
class Examination:
    """The doctor's findings."""

    vehicle: Vehicle | None
    messages: tuple[Arrival, ...]
    clocks: Clocks | None
    elevator: ElevatorFound | None
    alpha: AlphaFound | None
    limits: tuple[Limit, ...]
    """Those that stop everything first."""
    expectation: Expectation | None
    """None when a needed channel is missing altogether."""
    belief: Belief
    """What the expected errors and the demands on rates rest on."""
    notes: tuple[str, ...] = ()
    """What was chosen in reading the log, and where the autopilot wrote none, in sentences."""

    @property
    def verdict(self) -> Verdict:
        """Ready, usable with limits, or not usable."""
        if any(limit.stops for limit in self.limits):
            return "not usable"
        return "usable with limits" if self.limits else "ready"
