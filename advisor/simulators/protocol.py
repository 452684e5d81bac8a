"""Protocol of a simulator that can be compared with a flight.

A simulator trims at a flight condition, and then replays recorded inputs. Effects of command and instruments
are applied outside a simulator, so every simulator supports them. Effects on force and pitching moment
require a simulator that accepts increments. Other packages add simulators with the entry point
``inflight_advisor.simulators``, a kind and a factory.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Protocol

from advisor.aircraft.aircraft import Aircraft
from advisor.process.arrays import FloatArray

CONTROLS = ("aileron", "rudder", "throttle")
"""Inputs other than the elevator: ``aileron`` and ``rudder`` in rad (positive left), ``throttle`` from 0 to
1."""
CONDITIONS = ("mass", "wind")
"""Parts of the flight condition that a simulator may ignore."""


Progress = Callable[[str, float], None]
"""Function that is told a step of the work, and the share of the work that is done."""


@dataclass(frozen=True, slots=True)
class Condition:
    """Steady, straight flight condition at the start of a manoeuvre."""

    airspeed_m_s: float
    """True air speed, m/s."""
    height_m: float = 0.0
    """Height in the standard atmosphere with the flight's air density, m."""
    flight_path_rad: float = 0.0
    mass_kg: float | None = None
    """Mass of the aircraft, kg; None for the simulator's own mass."""
    wind_m_s: tuple[float, float] = (0.0, 0.0)
    """Horizontal velocity of the air along the aircraft's heading and to the right of the heading, m/s.
    Autopilots estimate no vertical wind."""


@dataclass(frozen=True, slots=True)
class Inputs:
    """Recorded inputs of one manoeuvre, as deviations from their values before the first step."""

    t: FloatArray
    """Shape (n,): middle times of even steps, s since the start of the record."""
    elevator: FloatArray
    """Shape (n,): mean surface deflection over each step, rad, positive trailing edge down. The aircraft
    file's effects between command and surface are included."""
    others: Mapping[str, FloatArray] = field(default_factory=dict)
    """Logged inputs of ``CONTROLS`` by name, each of shape (n,). A simulator uses the inputs that it
    supports."""


@dataclass(frozen=True, slots=True)
class State:
    """State of a simulator in one step, for increments."""

    t: float
    alpha: float
    """Angle of attack, rad, and its rate, rad/s."""
    alpha_dot: float
    q: float
    elevator: float
    """Deviation of the elevator from trim, rad."""
    airspeed_m_s: float
    """True air speed, m/s."""
    height_m: float
    """Height in the standard atmosphere, m."""
    throttle: float
    """Deviation of the throttle from trim, 0 to 1."""


class Increments(Protocol):
    """Force and moment that are added to a simulator in every step. The object must be picklable.

    A simulator calls the object at increasing times. An effect with a memory restarts when the time
    decreases.
    """

    def __call__(self, state: State) -> tuple[float, float]:
        """Return increments of α̇ by a force normal to the path, rad/s, and of q̇, rad/s²."""


@dataclass(frozen=True, slots=True)
class Replay:
    """Motion of a simulator with recorded inputs, without instruments."""

    t: FloatArray
    """Shape (m,): times, s since the start of the record."""
    alpha: FloatArray
    q: FloatArray
    theta: FloatArray
    a_z: FloatArray
    """Specific force along body z at the centre of gravity, m/s², about -9.81 in level flight."""
    airspeed_m_s: FloatArray
    """True air speed, m/s."""
    height_m: FloatArray
    """Height in the standard atmosphere, m."""
    a_x: FloatArray | None = None
    """Specific force along body x, m/s²; None if computed from the motion."""
    bank: FloatArray | None = None
    """Bank angle, rad; None for flight in the vertical plane."""
    r: FloatArray | None = None
    """Yaw rate, rad/s; None for a coordinated turn."""
    p: FloatArray | None = None
    """Roll rate, rad/s, positive right wing down."""
    a_y: FloatArray | None = None
    """Specific force along body y at the centre of gravity, m/s²."""
    beta: FloatArray | None = None
    """Sideslip, rad, positive for wind from the right."""
    trim: Mapping[str, float] = field(default_factory=dict)
    """Controls of the trimmed flight: ``elevator`` in rad, and known ones of ``CONTROLS``."""


class Simulator(Protocol):
    """Interface of one aircraft in one simulator.

    Raises
    ------
    advisor.words.problems.UnusableInputError
        The model does not load or trim, or exceeds its time limit. Each method may raise this error.
    """

    @property
    def description(self) -> str:
        """Description for people, such as ``JSBSim c172p``."""

    @property
    def takes_increments(self) -> bool:
        """Whether the simulator accepts effects on force and pitching moment."""

    @property
    def takes(self) -> frozenset[str]:
        """Inputs of ``CONTROLS`` and parts of ``CONDITIONS`` that the simulator supports."""

    @property
    def speed_limit_s(self) -> float:
        """Largest wall time of one replay, s."""

    def replay(self, condition: Condition, inputs: Inputs, increments: Increments | None = None) -> Replay:
        """Trim at the condition, and fly the inputs as deviations from the trimmed controls."""

    def linearise(self, condition: Condition) -> Mapping[str, float] | None:
        """Return Z_alpha, Z_q, Z_delta_e, M_alpha, M_q and M_delta_e at the condition.

        None if the derivatives are identified from replays.
        """

    def close(self) -> None:
        """End all processes of the simulator."""


Factory = Callable[[str, Aircraft], Simulator]
"""Function that makes a simulator from the part after the specification's colon, and from the aircraft file.

The function raises ``advisor.words.problems.ConfigurationError`` if that part cannot be loaded.
"""
