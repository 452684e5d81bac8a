"""What a simulator must do to be compared with a flight.

A simulator trims at a flight condition and replays recorded inputs from there. Effects of the command and of
the instruments are applied around a simulator, so every simulator carries them. Effects of the force and of
the pitching moment need a simulator that takes increments. Other packages add simulators with the entry point
``inflight_advisor.simulators``: a name before the colon of a specification, and a factory for the rest.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Protocol

from advisor.aircraft import Aircraft
from advisor.flight.messages import FloatArray


@dataclass(frozen=True, slots=True)
class Condition:
    """The flight condition in which a manoeuvre begins: steady, straight flight."""

    airspeed_m_s: float
    """True air speed."""
    height_m: float = 0.0
    """Pressure altitude."""
    flight_path_rad: float = 0.0
    mass_kg: float | None = None
    """None: the simulator's own mass."""


@dataclass(frozen=True, slots=True)
class Inputs:
    """The recorded inputs of one manoeuvre, as departures from where they rested before the first step."""

    t: FloatArray
    """Shape (n,). Seconds since the start of the record: the middles of even steps."""
    elevator: FloatArray
    """Shape (n,), rad, positive trailing edge down, the mean over each step, at the surface: what lies
    between command and surface in the aircraft file is in it already."""
    others: Mapping[str, FloatArray] = field(default_factory=dict)
    """``aileron`` and ``rudder`` in rad, ``throttle`` from 0 to 1: shape (n,), those that were logged."""


@dataclass(frozen=True, slots=True)
class State:
    """Where a simulator stands in one step, for increments that depend on the motion."""

    t: float
    alpha: float
    """Angle of attack, rad, and its rate, rad/s."""
    alpha_dot: float
    q: float
    elevator: float
    """Departure from trim, rad."""
    airspeed_m_s: float
    height_m: float
    throttle: float
    """Departure from trim."""


class Increments(Protocol):
    """Force and moment that are added to a simulator in every step. An instance can be pickled.

    A simulator calls an instance with rising times. An effect with a memory begins anew when time goes back.
    """

    def __call__(self, state: State) -> tuple[float, float]:
        """Return increments of α̇ by a force across the path, rad/s, and of q̇, rad/s²."""


@dataclass(frozen=True, slots=True)
class Replay:
    """The motion that a simulator made of recorded inputs, without any instrument."""

    t: FloatArray
    """Shape (m,). Seconds since the start of the record."""
    alpha: FloatArray
    q: FloatArray
    theta: FloatArray
    a_z: FloatArray
    """Specific force along body z at the centre of gravity, m/s², about -9.81 in level flight."""
    airspeed_m_s: FloatArray
    height_m: FloatArray
    a_x: FloatArray | None = None
    """Specific force along body x, m/s²; None: worked out of the motion."""


class Simulator(Protocol):
    """One aircraft of one simulator.

    Raises
    ------
    advisor.problems.UnusableInputError
        From each method: the model does not load, does not trim, or takes longer than its time limit.
    """

    @property
    def description(self) -> str:
        """What it is, for people: ``JSBSim c172p``."""

    @property
    def takes_increments(self) -> bool:
        """Whether it carries effects of the force and of the pitching moment."""

    @property
    def speed_limit_s(self) -> float:
        """Wall time that one replay may take."""

    def replay(self, condition: Condition, inputs: Inputs, increments: Increments | None = None) -> Replay:
        """Trim at the condition, and fly the inputs as departures from the trimmed controls."""

    def linearise(self, condition: Condition) -> Mapping[str, float] | None:
        """Return Z_alpha, Z_q, Z_delta_e, M_alpha, M_q, M_delta_e at the condition.

        None: they are identified from replays.
        """

    def close(self) -> None:
        """End whatever process the simulator runs in."""


Factory = Callable[[str, Aircraft], Simulator]
"""Makes a simulator of what follows the colon in a specification, and of the aircraft file.

Raises ``advisor.problems.ConfigurationError`` where that names nothing which can be loaded.
"""
