"""Roll and yaw of a JSBSim aircraft, with servos of aileron and rudder."""

from .effects.side import SideKit
from .jsbsim_aircraft import FOOT_M, JsbsimAircraft
from .motion import Controls, Motion
from .servo import Servo

_SURFACES = {"aileron": "fcs/left-aileron-pos-rad", "rudder": "fcs/rudder-pos-rad"}
_CONTROLS = tuple(_SURFACES)


class LateralJsbsim(JsbsimAircraft):
    """A JSBSim aircraft whose aileron and rudder demands pass a kit's stages.

    A positive demand rolls and yaws to the right. The surfaces are recorded positive to the left.
    """

    def __init__(self, name: str, airspeed_m_s: float, height_m: float, dt: float, kit: SideKit) -> None:
        super().__init__(name, airspeed_m_s, height_m, dt)
        self._kit = kit
        self._servos = {name: Servo(tuple(kit.mechanisms[name])) for name in _CONTROLS}
        self._level = {name: self._fdm[f"fcs/{name}-cmd-norm"] for name in _CONTROLS}
        self.full_rad = {name: self._throw_of(name) for name in _CONTROLS}
        """Deflection at full demand, rad: half of the surface's range."""
        turns = {"aileron": "accelerations/pdot-rad_sec2", "rudder": "accelerations/rdot-rad_sec2"}
        self._right = {name: self._sense(name, turns[name]) for name in _CONTROLS}

    def motion(self) -> Motion:
        """Return the present motion with yaw rate and lateral acceleration."""
        fdm = self._fdm
        side = FOOT_M * fdm["forces/fby-total-lbs"] / fdm["inertia/mass-slugs"]
        return super().motion()._replace(r=fdm["velocities/r-rad_sec"], a_y=side)

    def step(self, controls: Controls, dt: float) -> Motion:
        """Fly for ``dt`` seconds; ``dt`` must be the step given at construction."""
        wanted = {"aileron": controls.aileron, "rudder": controls.rudder}
        moved = {}
        for name, demand in wanted.items():
            full = self.full_rad[name]
            surface = self._servos[name].step(-full * demand, dt)
            moved[name] = self._level[name] - self._right[name] * surface / full
        self._fdm["fcs/rudder-cmd-norm"] = moved["rudder"]
        return super().step(controls._replace(aileron=moved["aileron"]), dt)

    def _throw_of(self, name: str) -> float:
        low, high = (self._at(name, command, _SURFACES[name]) for command in (-1.0, 1.0))
        return abs(high - low) / 2.0

    def _sense(self, name: str, turn: str) -> float:
        """Return 1 if a positive command turns to the right, else -1."""
        low, high = (self._at(name, command, turn) for command in (-1.0, 1.0))
        return 1.0 if high > low else -1.0

    def _at(self, name: str, command: float, seen: str) -> float:
        """Return the value of a property under a command, with the flight frozen."""
        fdm = self._fdm
        fdm.suspend_integration()
        fdm[f"fcs/{name}-cmd-norm"] = command
        for _ in range(3):
            fdm.run()
        value = float(fdm[seen])
        fdm[f"fcs/{name}-cmd-norm"] = self._level[name]
        for _ in range(3):
            fdm.run()
        fdm.resume_integration()
        return value
