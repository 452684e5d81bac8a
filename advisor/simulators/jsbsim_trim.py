"""Steady, straight flight of a JSBSim aircraft, by Newton's method on the model's accelerations.

JSBSim's own trim advances engines by half a second, with which a constant-speed propeller fails. Here engines
run in their own time while the aircraft is held still. Angle of attack, elevator, bank, aileron and rudder
balance all accelerations except the axial one. Thrust that no throttle gives, as for a glider, is balanced by
a force along the path.
"""

from dataclasses import dataclass

import numpy as np

from advisor.process.arrays import FloatArray
from advisor.simulators.jsbsim_flight import FOOT_M, JsbsimFlight, SteadyState
from advisor.simulators.protocol import Condition
from advisor.words.problems import UnusableInputError

_UNKNOWNS = ("alpha", "elevator", "phi", "aileron", "rudder")
_LONGITUDINAL = (1, 3)
"""Indices of ẇ and q̇ among the accelerations after u̇."""
_DIFFERENCE = 1e-4
_LONGEST_STEP = 0.1
"""Longest Newton step of an angle (rad) or of a command."""
_NEWTON_STEPS = 40
_STEADY = 1e-6
"""Acceleration below which flight counts as steady, m/s² and rad/s²."""
_THROTTLES = 12
_NEARBY = 0.05
"""Numerical: first change of the throttle, 0 to 1. The trim of a neighbouring condition lies within this
change."""
_BALANCED_M_S2 = 1e-3
"""Largest axial acceleration, m/s², that the force along the path balances instead of the throttle."""
_ENGINE_SECONDS = 30
_ENGINES_STEADY = 1e-4
"""Change of the axial acceleration in one second, m/s², below which engines count as steady."""


@dataclass(frozen=True, slots=True)
class _Tried:
    """Steady flight at one throttle, with its remaining axial acceleration, m/s²."""

    state: SteadyState
    excess: float


def trim(
    flight: JsbsimFlight,
    condition: Condition,
    steady_state: SteadyState | None = None,
    near: SteadyState | None = None,
) -> SteadyState:
    """Trim the aircraft in steady flight, held still, and return its state.

    Parameters
    ----------
    steady_state
        Earlier trim of the condition, whose throttle is kept while the engines settle again.
    near
        Trim of a neighbouring condition, at which the search starts.

    Raises
    ------
    UnusableInputError
        No angle of attack and elevator balance the aircraft at the condition.
    """
    flight.begin(condition)
    tried = [_steady(flight, condition, steady_state or near or SteadyState())]
    while steady_state is None and flight.engines and (setting := _next_throttle(tried)) is not None:
        tried.append(_steady(flight, condition, tried[-1].state._replace(throttle=setting)))
    best = tried[-1]
    state = best.state._replace(axial=-best.excess / FOOT_M * flight.mass_slug)
    flight.put(state, condition.flight_path_rad)
    # A turboprop loses its power while a state is put.
    _settle_engines(flight)
    return state


def _next_throttle(tried: list[_Tried]) -> float | None:
    """Return the next throttle between deceleration and acceleration; None if the last throttle is good
    enough.
    """
    last = tried[-1]
    if abs(last.excess) < _BALANCED_M_S2 or len(tried) >= _THROTTLES:
        return None
    slow = [(trial.state.throttle, trial.excess) for trial in tried if trial.excess < 0.0]
    fast = [(trial.state.throttle, trial.excess) for trial in tried if trial.excess >= 0.0]
    if not slow or not fast:
        end, now = 1.0 if slow else 0.0, last.state.throttle
        if now == end:
            return None
        beside = now + _NEARBY if slow else now - _NEARBY
        return min(max(beside, 0.0), 1.0) if len(tried) == 1 else end
    (low, lacking), (high, exceeding) = max(slow), min(fast)
    # Bisection helps a secant that creeps along one side.
    share = lacking / (lacking - exceeding) if len(tried) % 3 else 0.5
    return low + share * (high - low)


def _steady(flight: JsbsimFlight, condition: Condition, guess: SteadyState) -> _Tried:
    """Return the steady flight at the guess's throttle, with its axial acceleration."""
    state = guess._replace(axial=0.0)
    flight.put(state, condition.flight_path_rad)
    _settle_engines(flight)
    state = _newton(flight, condition, state)
    # The engines now have another angle of attack.
    _settle_engines(flight)
    state = _newton(flight, condition, state)
    return _Tried(state, float(flight.accelerations()[0]))


def _settle_engines(flight: JsbsimFlight) -> None:
    before = np.inf
    for _ in range(_ENGINE_SECONDS if flight.engines else 0):
        flight.run_engines()
        now = float(flight.accelerations()[0])
        if abs(now - before) < _ENGINES_STEADY:
            return
        before = now


def _newton(flight: JsbsimFlight, condition: Condition, state: SteadyState) -> SteadyState:
    """Return the state with axial acceleration alone; least squares for an axis without control."""
    gamma = condition.flight_path_rad

    def accelerations(at: SteadyState) -> FloatArray:
        flight.put(at, gamma)
        return flight.accelerations()[1:]

    for _ in range(_NEWTON_STEPS):
        now = accelerations(state)
        if not np.all(np.isfinite(now)):
            break
        slopes = np.column_stack(
            [
                (accelerations(_moved(state, name, h)) - accelerations(_moved(state, name, -h))) / (2.0 * h)
                for name, h in ((name, _DIFFERENCE) for name in _UNKNOWNS)
            ]
        )
        change, *_ = np.linalg.lstsq(slopes, -now, rcond=1e-9)
        if np.max(np.abs(now[list(_LONGITUDINAL)])) < _STEADY and np.max(np.abs(change)) < _STEADY:
            if slopes[1, 0] < 0.0:
                flight.put(state, gamma)
                return state
            # Beyond the stall, lift falls with the angle of attack.
            break
        change *= min(1.0, _LONGEST_STEP / np.max(np.abs(change)))
        for name, by in zip(_UNKNOWNS, change, strict=True):
            state = _moved(state, name, float(by))
    raise UnusableInputError(
        "simulator_trim",
        f"JSBSim {flight.name} finds no steady flight at {condition.airspeed_m_s:.4g} m/s"
        f" and {condition.height_m:.4g} m.",
        "Check the air speed, the height and the mass of the flight against the model's own range.",
    )


def _moved(state: SteadyState, name: str, by: float) -> SteadyState:
    return state._replace(**{name: getattr(state, name) + by})
