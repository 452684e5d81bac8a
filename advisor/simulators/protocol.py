"""The protocol of a simulator that can be compared with a flight.

A simulator trims at a flight condition and replays recorded inputs from there. Effects of the command and of
the instruments are applied around a simulator, so every simulator carries them. Effects of the force and of
the pitching moment need a simulator that takes increments. Other packages add simulators with the entry point
``inflight_advisor.simulators``: a name before the colon of a specification, and a factory for the rest.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Protocol

from advisor.aircraft.aircraft import Aircraft
from advisor.flight.signals.messages import FloatArray

CONTROLS = ("aileron", "rudder", "throttle")
"""Inputs next to the elevator: ``aileron`` (positive rolls left) and ``rudder`` (positive yaws left) in rad,
``throttle`` from 0 to 1."""
CONDITIONS = ("mass", "wind")
"""Parts of the flight condition that a simulator may ignore."""


@dataclass(frozen=True, slots=True)
class Condition:
    """Flight condition at the start of a manoeuvre: steady, straight flight."""

    airspeed_m_s: float
    """True air speed, m/s."""
    height_m: float = 0.0
    """Height in the standard atmosphere at which the air has the density flown in, m."""
    flight_path_rad: float = 0.0
    mass_kg: float | None = None
    """Mass of the aircraft; None means the simulator's own."""
    wind_m_s: tuple[float, float] = (0.0, 0.0)
    """Horizontal velocity of the air along the aircraft's heading and to the right of the heading, m/s.
    Autopilots estimate no vertical wind."""


@dataclass(frozen=True, slots=True)
class Inputs:
    """Recorded inputs of one manoeuvre, as departures from their values before the first step."""

    t: FloatArray
    """Shape (n,). Seconds since the start of the record: the middles of even steps."""
    elevator: FloatArray
    """Shape (n,). Surface deflection, rad, positive trailing edge down, mean over each step. The aircraft
    file's effects between command and surface are included."""
    others: Mapping[str, FloatArray] = field(default_factory=dict)
    """Logged inputs of ``CONTROLS``, each of shape (n,). A simulator flies those that it takes."""


@dataclass(frozen=True, slots=True)
class State:
    """State of a simulator in one step, for increments that depend on the motion."""

    t: float
    alpha: float
    """Angle of attack, rad, and its rate, rad/s."""
    alpha_dot: float
    q: float
    elevator: float
    """Departure from trim, rad."""
    airspeed_m_s: float
    """True air speed, m/s."""
    height_m: float
    """Height in the standard atmosphere, m."""
    throttle: float
    """Departure from trim."""


class Increments(Protocol):
    """Force and moment that are added to a simulator in every step. An instance can be pickled.

    A simulator calls an instance with rising times. An effect with a memory restarts when time goes back.
    """

    def __call__(self, state: State) -> tuple[float, float]:
        """Return increments of α̇ by a force across the path, rad/s, and of q̇, rad/s²."""


@dataclass(frozen=True, slots=True)
class Replay:
    """Motion of a simulator that flew recorded inputs, without any instrument."""

    t: FloatArray
    """Shape (m,). Seconds since the start of the record."""
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
    """Specific force along body x, m/s²; None means that the motion determines it."""
    bank: FloatArray | None = None
    """Bank angle, rad; None means that the simulator flies in the vertical plane."""
    r: FloatArray | None = None
    """Yaw rate, rad/s; None means that of a coordinated turn."""
    p: FloatArray | None = None
    """Roll rate, rad/s, positive right wing down."""
    a_y: FloatArray | None = None
    """Specific force along body y at the centre of gravity, m/s²."""
    beta: FloatArray | None = None
    """Sideslip, rad, positive where the wind comes from the right."""
    trim: Mapping[str, float] = field(default_factory=dict)
    """Controls of the trimmed flight: ``elevator`` in rad and those known of ``CONTROLS``."""


class Simulator(Protocol):
    """One aircraft of one simulator.

    Raises
    ------
    advisor.words.problems.UnusableInputError
        The model does not load, does not trim, or takes longer than its time limit. Each method may raise
        this error.
    """

    @property
    def description(self) -> str:
        """Description for people, such as ``JSBSim c172p``."""

    @property
    def takes_increments(self) -> bool:
        """Whether the simulator takes effects of the force and of the pitching moment."""

    @property
    def takes(self) -> frozenset[str]:
        """Inputs of ``CONTROLS`` and parts of ``CONDITIONS`` that the simulator flies."""

    @property
    def speed_limit_s(self) -> float:
        """Most wall time of one replay, s."""

    def replay(self, condition: Condition, inputs: Inputs, increments: Increments | None = None) -> Replay:
        """Trim at the condition, and fly the inputs as departures from the trimmed controls."""

    def linearise(self, condition: Condition) -> Mapping[str, float] | None:
        """Return Z_alpha, Z_q, Z_delta_e, M_alpha, M_q, M_delta_e at the condition.

        None means that derivatives are identified from replays.
        """

    def close(self) -> None:
        """End all processes of the simulator."""


Factory = Callable[[str, Aircraft], Simulator]
"""Function that makes a simulator from a specification's part behind the colon, and from the aircraft file.

It raises ``advisor.words.problems.ConfigurationError`` where that part names nothing that can be loaded.
"""
