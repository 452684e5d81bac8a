"""Comparison of a flight with a JSBSim aircraft: ``jsbsim:MODEL`` or ``jsbsim:PATH/model.xml``.

JSBSim's own trim advances engines by half a second, with which a constant-speed propeller fails. Here engines
run in their own time while the aircraft is held still. Angle of attack, elevator, bank, aileron and rudder
balance all accelerations except the axial one. Thrust that no throttle gives, as for a glider, is balanced by
a force along the path.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from advisor.aircraft.aircraft import Aircraft
from advisor.process.arrays import FloatArray
from advisor.simulators.isolated import Isolated
from advisor.simulators.jsbsim_flight import FOOT_M, STEP_S, JsbsimFlight, SteadyState
from advisor.simulators.jsbsim_model import FORCE, MOMENT, find_model
from advisor.simulators.protocol import CONDITIONS, CONTROLS, Condition, Increments, Inputs, Replay
from advisor.simulators.stepped import Stepping
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


_THRUST_SHARE = 0.01
"""Largest force along the flight path, over the weight, in a trimmed state."""
_SHOWN = 6
"""Largest number of foreign properties in a sentence."""
_PROBE = 1e-3
"""Steps of central differences: α and elevator in rad, q in rad/s."""


def make_jsbsim(model: str, aircraft: Aircraft) -> Isolated:
    """Return the simulator of ``jsbsim:MODEL``, in a separate process.

    Raises
    ------
    ConfigurationError
        JSBSim is not installed, or the model cannot be found or loaded.
    """
    path = find_model(model)
    return Isolated("advisor.simulators.jsbsim:Jsbsim", path, description=f"JSBSim {path.stem}")


class Jsbsim(Stepping):
    """A JSBSim aircraft that flies recorded inputs (a simulator of the protocol).

    The recorded elevator is a deviation from the trimmed surface. The deviation is commanded at the pilot's
    input, by the inverse of the model's command-to-surface curve. An actuator in the model's flight control
    is kept, with its lag, hysteresis and stops. A flight control with feedback of the motion is bypassed, and
    the surface itself is set. Aileron, rudder and throttle are commanded at the pilot's inputs. Positive
    aileron rolls to the left, and positive rudder yaws to the left.
    """

    takes_increments = True
    takes = frozenset({*CONTROLS, *CONDITIONS})
    _dt = STEP_S
    _reads_at = 1.0

    def __init__(self, path: Path) -> None:
        self.description = f"JSBSim {path.stem}"
        self._path = path
        self._flight = JsbsimFlight(path)
        self._trims: dict[Condition, SteadyState] = {}
        self.notes = _of_foreign(self._flight.foreign)

    def replay(self, condition: Condition, inputs: Inputs, increments: Increments | None = None) -> Replay:
        """Trim at the condition, and fly the inputs as deviations from the trimmed controls."""
        self._moved = inputs.others
        try:
            replay = super().replay(condition, inputs, increments)
            if not all(np.all(np.isfinite(getattr(replay, name))) for name in self._seen(condition)):
                raise UnusableInputError(
                    "simulator_diverges",
                    f"{self.description} grows without limit in a replay of {replay.t[-1]:.3g} s.",
                    "Shorten the manoeuvre, or check the model at the flown condition.",
                )
        except Exception:
            # Engines and filters keep the state of a failed flight, so a new instance is loaded.
            self._flight = JsbsimFlight(self._path)
            raise
        return replay

    def linearise(self, condition: Condition) -> Mapping[str, float] | None:
        """Return central differences of α̇ and q̇ about the trimmed state, at constant speed and flight path.

        A moment due to α̇ becomes part of the derivatives, as in the short-period model.
        """
        start = self._steady(condition)
        by_alpha = self._slopes(condition, start, alpha=_PROBE)
        by_q = self._slopes(condition, start, q=_PROBE)
        by_elevator = self._slopes(condition, start, elevator=_PROBE)
        return {
            "Z_alpha": by_alpha[0],
            "Z_q": by_q[0] - 1.0,
            "Z_delta_e": by_elevator[0],
            "M_alpha": by_alpha[1],
            "M_q": by_q[1],
            "M_delta_e": by_elevator[1],
        }

    def _steady(self, condition: Condition) -> SteadyState:
        near = next(reversed(self._trims.values()), None)
        state = trim(self._flight, condition, self._trims.get(condition), near)
        self._trims[condition] = state
        return state

    def _trimmed(self, condition: Condition) -> dict[str, float]:
        self._rest = rest = self._steady(condition)
        trim = {"alpha": rest.alpha, "elevator": rest.elevator}
        if self._flight.engines and abs(rest.axial) < _THRUST_SHARE * self._flight.fdm["inertia/weight-lbs"]:
            trim["throttle"] = rest.throttle
        return trim

    def _start(self, condition: Condition, trim: Mapping[str, float]) -> None:
        self._throws = {name: self._throw(name) for name in ("aileron", "rudder") if name in self._moved}
        self._hidden = self._rest.throttle - trim.get("throttle", 0.0)
        self._flight.release()

    def _step(self, controls: Mapping[str, float]) -> None:
        flight = self._flight
        flight.elevator(controls["elevator"])
        if "throttle" in controls:
            flight.throttle(self._hidden + controls["throttle"])
        for name, per_rad in self._throws.items():
            command = getattr(self._rest, name) + per_rad * controls[name]
            flight.fdm[f"fcs/{name}-cmd-norm"] = min(max(command, -1.0), 1.0)
        if "force" in controls:
            slugs, speed = flight.fdm["inertia/mass-slugs"], flight.fdm["velocities/vt-fps"]
            flight.fdm[f"{FORCE}/magnitude"] = controls["force"] * slugs * speed
            flight.fdm[MOMENT] = controls["moment"] * flight.fdm["inertia/iyy-slugs_ft2"]
        flight.fdm.run()

    def _end(self) -> None:
        self._flight.freeze()
        self._flight.fdm[f"{FORCE}/magnitude"] = 0.0
        self._flight.fdm[MOMENT] = 0.0

    def _slopes(
        self,
        condition: Condition,
        start: SteadyState,
        alpha: float = 0.0,
        q: float = 0.0,
        elevator: float = 0.0,
    ) -> tuple[float, float]:
        rates = []
        for sign in (1.0, -1.0):
            moved = start._replace(
                alpha=start.alpha + sign * alpha, elevator=start.elevator + sign * elevator
            )
            self._flight.put(moved, condition.flight_path_rad, sign * q)
            rates.append(self._rates())
        width = 2.0 * (alpha + q + elevator)
        return (rates[0][0] - rates[1][0]) / width, (rates[0][1] - rates[1][1]) / width

    def _rates(self, rows: Sequence[Mapping[str, float]] = ()) -> tuple[float, float]:
        """Return the model's own rates of α, rad/s, and of q, rad/s²."""
        fdm = self._flight.fdm
        u, v, w = (fdm[f"velocities/{axis}-aero-fps"] for axis in "uvw")
        # The wind stands still over the ground, and turns in the axes of the body.
        along, right, down = (
            fdm[f"velocities/{axis}-fps"] - air for axis, air in zip("uvw", (u, v, w), strict=True)
        )
        p, q, r = (fdm[f"velocities/{rate}-rad_sec"] for rate in "pqr")
        u_dot = fdm["accelerations/udot-ft_sec2"] + q * down - r * right
        w_dot = fdm["accelerations/wdot-ft_sec2"] + p * right - q * along
        return (u * w_dot - w * u_dot) / (u * u + w * w), fdm["accelerations/qdot-rad_sec2"]

    def _throw(self, name: str) -> float:
        """Return the command per radian of surface, positive if positive surface turns to the left."""
        fdm = self._flight.fdm
        surface, rate = {
            "aileron": ("fcs/left-aileron-pos-rad", "accelerations/pdot-rad_sec2"),
            "rudder": ("fcs/rudder-pos-rad", "accelerations/rdot-rad_sec2"),
        }[name]
        command = f"fcs/{name}-cmd-norm"
        before, seen = fdm[command], {}
        fdm.suspend_integration()
        for sign in (-1.0, 1.0):
            fdm[command] = sign
            fdm.run()
            seen[sign] = (fdm[surface], fdm[rate])
        fdm[command] = before
        fdm.run()
        fdm.resume_integration()
        throw, turn = (abs(seen[1.0][i] - seen[-1.0][i]) / 2.0 for i in (0, 1))
        if throw == 0.0 or turn == 0.0:
            return 0.0
        return math.copysign(1.0 / throw, seen[-1.0][1] - seen[1.0][1])

    def _seen(self, condition: Condition) -> Mapping[str, float]:
        fdm = self._flight.fdm
        acceleration = FOOT_M / fdm["inertia/mass-slugs"]
        return {
            "alpha": fdm["aero/alpha-rad"],
            "q": fdm["velocities/q-rad_sec"],
            "theta": fdm["attitude/theta-rad"],
            "a_z": acceleration * fdm["forces/fbz-total-lbs"],
            "airspeed_m_s": FOOT_M * fdm["velocities/vt-fps"],
            "height_m": FOOT_M * fdm["position/h-sl-ft"],
            "a_x": acceleration * fdm["forces/fbx-total-lbs"],
            "bank": fdm["attitude/phi-rad"],
            "r": fdm["velocities/r-rad_sec"],
            "p": fdm["velocities/p-rad_sec"],
            "a_y": acceleration * fdm["forces/fby-total-lbs"],
            "beta": fdm["aero/beta-rad"],
        }


def _of_foreign(names: tuple[str, ...]) -> tuple[str, ...]:
    """Return a sentence about properties that another program would write; empty without one."""
    if not names:
        return ()
    shown = ", ".join(names[:_SHOWN]) + (", ..." if len(names) > _SHOWN else "")
    return (f"The JSBSim model reads properties that FlightGear writes, and they are 0 here: {shown}.",)
