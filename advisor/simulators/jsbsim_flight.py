"""One JSBSim aircraft in SI units, for steady states, commands and readings.

The aircraft is held still while a state is sought (:meth:`Flight.freeze`), and engines and propellers settle.
Lags in the flight control also settle.
"""

from math import cos, sin
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from advisor.process.arrays import FloatArray
from advisor.simulators.jsbsim_model import AXIAL, FORCE, LOAD, LOAD_PLACE, WRITES, WRITTEN, load
from advisor.simulators.protocol import Condition
from advisor.words.problems import UnusableInputError

FOOT_M = 0.3048
POUND_KG = 0.45359237
STEP_S = 0.005

_LATITUDE_DEG = 45.0
"""Latitude at which gravity is standard, deg."""
_CLEARANCE_M = 3000.0
"""Height above the terrain, m, so that gear and ground effect have no influence."""
_ADAMS_BASHFORTH_2, _NONE = 3, 0
_INTEGRATORS = {
    "simulation/integrator/rate/rotational": _ADAMS_BASHFORTH_2,
    "simulation/integrator/rate/translational": _ADAMS_BASHFORTH_2,
    "simulation/integrator/position/rotational": _ADAMS_BASHFORTH_2,
    "simulation/integrator/position/translational": _ADAMS_BASHFORTH_2,
}
_COMMANDS = np.linspace(-1.0, 1.0, 81)
_PROBE = 0.02
"""Deviations of α (rad) and q (rad/s) for a test whether the flight control has feedback."""
_SETTLED_RAD = 1e-7
"""Change of the surface in one step, rad, below which filters before the surface have settled."""
_LONGEST_SETTLING_STEPS = 600
"""Largest number of steps in which such filters must settle: three seconds."""
_SETTLE_STEPS = 3
"""Number of calls until all values are consistent: forces lag the state, and α̇ lags the forces, by one call
each."""


class SteadyState(NamedTuple):
    """Steady state of the aircraft at one condition."""

    alpha: float = 0.0
    elevator: float = 0.0
    """Surface deflection, rad."""
    aileron: float = 0.0
    """Aileron command from -1 to 1."""
    rudder: float = 0.0
    """Rudder command from -1 to 1."""
    phi: float = 0.0
    throttle: float = 0.6
    axial: float = 0.0
    """Force along the path that balances excess thrust, lb."""


class JsbsimFlight:
    """A loaded JSBSim model, with its elevator commanded in radians of surface.

    The elevator uses the model's path from command to surface, with its actuator, if that path is one curve.
    If the flight control has feedback, the surface itself is set, without actuator and flight control.
    Filters in the path settle only after some steps of frozen flight. A steady state is sought with the
    surface set, and the filters settle before the flight begins.

    Raises
    ------
    UnusableInputError
        The model does not load; :meth:`begin` also raises it if the command moves no
        ``fcs/elevator-pos-rad``.
    """

    def __init__(self, path: Path) -> None:
        self.fdm: Any
        self.fdm, self.foreign = load(path, STEP_S)
        self.name = path.stem
        self.engines = int(self.fdm.get_propulsion().get_num_engines())
        self._curve: tuple[FloatArray, FloatArray] | None = None
        self._curves: dict[Condition, tuple[FloatArray, FloatArray] | None] = {}
        self._airspeed_fps = 0.0
        self._wind_fps = (0.0, 0.0)
        self._settling = 0
        self._resting = 0.0
        self.fdm["propulsion/fuel_freeze"] = 1.0
        self.fdm["gear/gear-cmd-norm"] = 0.0
        self._started = False

    def begin(self, condition: Condition) -> None:
        """Set speed, height, mass and wind, start the engines, and hold the flight still."""
        fdm = self.fdm
        along, right = condition.wind_m_s
        self._airspeed_fps, self._wind_fps = condition.airspeed_m_s / FOOT_M, (along / FOOT_M, right / FOOT_M)
        fdm["ic/lat-geod-deg"] = _LATITUDE_DEG
        fdm["ic/terrain-elevation-ft"] = (condition.height_m - _CLEARANCE_M) / FOOT_M
        fdm["ic/h-sl-ft"] = condition.height_m / FOOT_M
        fdm["ic/vt-fps"] = self._airspeed_fps
        self.freeze()
        fdm.run_ic()
        if not self._started:
            fdm["propulsion/set-running"] = -1
            self._started = True
        self._weigh(condition.mass_kg)
        if condition not in self._curves:
            self._curves[condition] = self._elevator_curve(condition)
        self._curve = self._curves[condition]
        self.fdm[WRITES] = float(self._writes)

    def freeze(self) -> None:
        """Hold position and velocity fixed until `release`, while engines, filters and forces settle."""
        self.fdm.set_trim_status(True)
        for integrator in _INTEGRATORS:
            self.fdm[integrator] = _NONE

    def release(self) -> None:
        """Release the aircraft to fly from its present state."""
        if self._writes and self._curve is not None:
            self._command(self._resting)
            for _ in range(self._settling):
                self.fdm.run()
            self.fdm[WRITES] = 0.0
        for integrator, method in _INTEGRATORS.items():
            self.fdm[integrator] = method
        self.fdm.set_trim_status(False)
        self.fdm["simulation/sim-time-sec"] = 0.0

    def elevator(self, surface: float) -> None:
        """Move the elevator to ``surface``, rad."""
        if self.fdm[WRITES]:
            self.fdm[WRITTEN] = self._resting = surface
        else:
            self._command(surface)

    @property
    def _writes(self) -> bool:
        """Whether the surface itself is set in a steady state."""
        return self._curve is None or self._settling > 0

    def _command(self, surface: float) -> None:
        """Set the command for which the surface settles at ``surface``, rad."""
        assert self._curve is not None
        surfaces, commands = self._curve
        self.fdm["fcs/elevator-cmd-norm"] = float(np.interp(surface, surfaces, commands))

    def throttle(self, setting: float) -> None:
        """Set all engines to ``setting``, 0 to 1."""
        for i in range(self.engines):
            self.fdm[f"fcs/throttle-cmd-norm[{i}]"] = min(max(setting, 0.0), 1.0)

    def put(self, state: SteadyState, gamma: float, q: float = 0.0) -> None:
        """Set a state of the aircraft on a path of angle ``gamma``, with pitch rate ``q``."""
        fdm = self.fdm
        fdm["ic/vt-fps"] = self._airspeed_fps
        fdm["ic/alpha-rad"] = state.alpha
        fdm["ic/beta-rad"] = 0.0
        fdm["ic/phi-rad"] = state.phi
        fdm["ic/theta-rad"] = state.alpha + gamma
        fdm["ic/psi-true-rad"] = 0.0
        fdm["ic/q-rad_sec"] = q
        fdm["fcs/aileron-cmd-norm"] = state.aileron
        fdm["fcs/rudder-cmd-norm"] = state.rudder
        fdm[f"{AXIAL}/magnitude"] = state.axial
        self.elevator(state.elevator)
        self.throttle(state.throttle)
        self._blow(state.phi, state.alpha + gamma)
        fdm.suspend_integration()
        for _ in range(_SETTLE_STEPS):
            fdm.run()
        fdm.resume_integration()

    def _blow(self, phi: float, theta: float) -> None:
        """Begin the flight in wind. JSBSim's own initial wind would change the air speed twice."""
        fdm, (along, right) = self.fdm, self._wind_fps
        down = along * sin(theta)
        of_the_body = {
            "u": along * cos(theta),
            "v": right * cos(phi) + down * sin(phi),
            "w": down * cos(phi) - right * sin(phi),
        }
        through_air = {axis: fdm[f"ic/{axis}-fps"] for axis in of_the_body}
        for axis, by in of_the_body.items() if any(self._wind_fps) else ():
            fdm[f"ic/{axis}-fps"] = through_air[axis] + by
        fdm.run_ic()
        fdm["atmosphere/wind-north-fps"], fdm["atmosphere/wind-east-fps"] = along, right

    def run_engines(self) -> None:
        """Run engines and propellers for one second of frozen flight."""
        for _ in range(round(1.0 / STEP_S)):
            self.fdm.run()

    def accelerations(self) -> FloatArray:
        """Return u̇, v̇, ẇ in m/s² and ṗ, q̇, ṙ in rad/s², shape (6,)."""
        fdm = self.fdm
        linear = [FOOT_M * fdm[f"accelerations/{axis}dot-ft_sec2"] for axis in "uvw"]
        return np.array(linear + [fdm[f"accelerations/{axis}dot-rad_sec2"] for axis in "pqr"])

    @property
    def mass_slug(self) -> float:
        return float(self.fdm["inertia/mass-slugs"])

    def _weigh(self, mass_kg: float | None) -> None:
        fdm = self.fdm
        fdm[LOAD] = 0.0
        fdm.run_ic()
        for axis in "xyz":
            place = fdm[f"inertia/cg-{axis}-in"]
            fdm[LOAD_PLACE.format(axis.upper())] = place
            fdm[f"{FORCE}/location-{axis}-in"] = place
            fdm[f"{AXIAL}/location-{axis}-in"] = place
        if mass_kg is not None:
            fdm[LOAD] = mass_kg / POUND_KG - fdm["inertia/weight-lbs"]
            fdm.run_ic()

    def _elevator_curve(self, condition: Condition) -> tuple[FloatArray, FloatArray] | None:
        """Return ascending surface angles and their commands; None if the surface itself is set."""
        fdm = self.fdm
        fdm[WRITES] = 0.0
        fdm["fcs/pitch-trim-cmd-norm"] = 0.0
        surfaces = np.array([self._surface_at(condition, command) for command in _COMMANDS])
        still = self._surface_at(condition, 0.0)
        fed_back = max(
            abs(self._surface_at(condition, 0.0, alpha=_PROBE) - still),
            abs(self._surface_at(condition, 0.0, q=_PROBE) - still),
        )
        turns = np.diff(surfaces)
        if not np.any(turns):
            raise UnusableInputError(
                "simulator_elevator",
                f"No elevator command moves the surface fcs/elevator-pos-rad of JSBSim {self.name}.",
                "Let the model's flight control and its aerodynamics use fcs/elevator-pos-rad.",
            )
        if fed_back > 10.0 * _SETTLED_RAD or turns.min() < 0.0 < turns.max():
            return None
        ascending, first = np.unique(surfaces, return_index=True)
        return ascending, _COMMANDS[first]

    def _surface_at(self, condition: Condition, command: float, alpha: float = 0.0, q: float = 0.0) -> float:
        fdm = self.fdm
        fdm["ic/alpha-rad"] = alpha
        fdm["ic/theta-rad"] = alpha + condition.flight_path_rad
        fdm["ic/q-rad_sec"] = q
        fdm["fcs/elevator-cmd-norm"] = command
        fdm.run_ic()
        now = float(fdm["fcs/elevator-pos-rad"])
        for step in range(_LONGEST_SETTLING_STEPS):
            fdm.run()
            before, now = now, float(fdm["fcs/elevator-pos-rad"])
            if abs(now - before) < _SETTLED_RAD:
                self._settling = max(self._settling, step)
                break
        return now
