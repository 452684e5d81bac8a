"""JSBSim, a six-degree-of-freedom flight simulator, with the bundled aircraft's controls and instruments."""

import math
import os
from typing import Any

import numpy as np

from .linear import ShortPeriod
from .loading import ScenarioError
from .maneuvers import elevator_input
from .motion import HOME_HEIGHT_M, Controls, Motion
from .servo import Calibration

FOOT_M = 0.3048
FULL_TRIM = 1
"""JSBSim's number for trimming all axes in straight flight."""

LATITUDE_DEG = 45.0
"""Latitude at which gravity is standard, deg."""

PROBE_S, PROBE_UNIT_S, PROBE_RAD = 4.0, 0.4, math.radians(0.4)


class JsbsimAircraft:
    """An engine (see :class:`sim.motion.Engine`) that passes each step to JSBSim.

    Raises
    ------
    ScenarioError
        JSBSim is not installed, does not know the aircraft, or finds no trim.
    """

    def __init__(self, name: str, airspeed_m_s: float, height_m: float, dt: float) -> None:
        self._name, self._airspeed, self._height, self._dt = name, airspeed_m_s, height_m, dt
        self._fdm = _load(name, dt)
        self.calibration = Calibration()
        self.trim = self._trimmed()
        self._gust_up = self._gust_head = 0.0
        self._truth: ShortPeriod | None = None

    def _trimmed(self) -> Controls:
        fdm = self._fdm
        fdm["ic/terrain-elevation-ft"] = HOME_HEIGHT_M / FOOT_M
        fdm["ic/h-agl-ft"] = self._height / FOOT_M
        fdm["ic/vt-fps"] = self._airspeed / FOOT_M
        fdm["ic/gamma-deg"] = 0.0
        fdm["ic/lat-geod-deg"] = LATITUDE_DEG
        fdm["fcs/throttle-cmd-norm"] = 0.6
        fdm["fcs/mixture-cmd-norm"] = 0.9
        fdm.run_ic()
        fdm["propulsion/set-running"] = -1
        try:
            fdm["simulation/do_simple_trim"] = FULL_TRIM
        except Exception as error:
            # JSBSim's trim failure is a bare exception type of its extension module.
            raise ScenarioError(
                [f"aircraft: {self._name} finds no level flight at {self._airspeed:g} m/s"]
            ) from error
        surface = fdm["fcs/elevator-pos-rad"]
        fdm.suspend_integration()
        fdm["fcs/pitch-trim-cmd-norm"] = 0.0
        self._throw = {}
        for sign in (-1.0, 1.0):
            fdm["fcs/elevator-cmd-norm"] = sign
            fdm.run()
            self._throw[sign] = abs(fdm["fcs/elevator-pos-rad"])
        self._command(surface)
        for _ in range(3):
            fdm.run()  # forces trail the surface by a call
        fdm.resume_integration()
        return Controls(surface, fdm["fcs/throttle-cmd-norm"], 0.0)

    def _command(self, elevator: float) -> None:
        # The surface's stops need not lie symmetrically.
        self._fdm["fcs/elevator-cmd-norm"] = elevator / self._throw[-1.0 if elevator < 0 else 1.0]

    @property
    def truth(self) -> ShortPeriod:
        """Short-period parameters from a regression of the engine's own α̇ and q̇ in a small 3-2-1-1 on its
        states.

        Airspeed and attitude are also regressors, so that their changes do not bias the eight parameters.
        """
        if self._truth is None:
            probe = JsbsimAircraft(self._name, self._airspeed, self._height, self._dt)
            self._truth = probe.regress()
        return self._truth

    def regress(self) -> ShortPeriod:
        """Fly the small manoeuvre, and return the short-period parameters. The aircraft is no longer at trim
        afterwards."""
        stick = elevator_input("3211", PROBE_RAD, PROBE_UNIT_S)
        start = self.motion()
        rows = []
        for i in range(round(PROBE_S / self._dt)):
            pulled = self.trim._replace(elevator=self.trim.elevator - stick.pull(i * self._dt))
            rows.append(self.step(pulled, self._dt))
        used = ("alpha", "q", "elevator", "airspeed", "theta", "alpha_dot", "q_dot")
        column = {name: np.array([getattr(row, name) for row in rows]) for name in used}
        regressors = np.column_stack(
            [
                np.ones(len(rows)),
                column["alpha"],
                column["q"],
                column["elevator"],
                column["airspeed"] - start.airspeed,
                column["theta"] - start.theta,
            ]
        )
        lift, *_ = np.linalg.lstsq(regressors, column["alpha_dot"])
        pitch, *_ = np.linalg.lstsq(regressors, column["q_dot"])
        values = [*lift[:4], *pitch[:4]]
        values[2] -= 1.0
        return ShortPeriod(*(float(value) for value in values))

    def motion(self) -> Motion:
        """Return the present motion, with specific forces at the centre of gravity."""
        fdm = self._fdm
        # Without steady wind the body velocities over ground are those through the still air mass.
        u, w = FOOT_M * fdm["velocities/u-fps"], FOOT_M * fdm["velocities/w-fps"]
        u_dot, w_dot = FOOT_M * fdm["accelerations/udot-ft_sec2"], FOOT_M * fdm["accelerations/wdot-ft_sec2"]
        speed = math.hypot(u, w)
        mass = fdm["inertia/mass-slugs"]
        return Motion(
            speed,
            math.atan2(w, u),
            fdm["velocities/q-rad_sec"],
            fdm["attitude/theta-rad"],
            FOOT_M * fdm["position/h-agl-ft"],
            fdm["attitude/phi-rad"],
            fdm["velocities/p-rad_sec"],
            FOOT_M * fdm["velocities/h-dot-fps"],
            (u * u_dot + w * w_dot) / speed,
            (u * w_dot - w * u_dot) / speed**2,
            fdm["accelerations/qdot-rad_sec2"],
            FOOT_M * fdm["forces/fbx-total-lbs"] / mass,
            FOOT_M * fdm["forces/fbz-total-lbs"] / mass,
            fdm["fcs/elevator-pos-rad"],
            fdm["fcs/throttle-cmd-norm"],
            self._gust_up,
            self._gust_head,
        )

    def step(self, controls: Controls, dt: float) -> Motion:
        """Fly for ``dt`` seconds; ``dt`` must be the step given at construction."""
        fdm = self._fdm
        self._command(controls.elevator)
        fdm["fcs/throttle-cmd-norm"] = controls.throttle
        fdm["fcs/aileron-cmd-norm"] = controls.aileron
        self._gust_up, self._gust_head = controls.gust_up, controls.gust_head
        fdm["atmosphere/wind-down-fps"] = -controls.gust_up / FOOT_M
        heading = fdm["attitude/psi-rad"]
        fdm["atmosphere/wind-north-fps"] = -controls.gust_head * math.cos(heading) / FOOT_M
        fdm["atmosphere/wind-east-fps"] = -controls.gust_head * math.sin(heading) / FOOT_M
        fdm.run()
        return self.motion()


def _load(name: str, dt: float) -> Any:
    # JSBSim greets on stdout unless configured not to.
    os.environ["JSBSIM_DEBUG"] = "0"
    try:
        import jsbsim
    except ImportError as error:
        raise ScenarioError(
            ["engine: jsbsim is not installed: pip install 'inflight-advisor[jsbsim]'"]
        ) from error
    root = jsbsim.get_default_root_dir()
    if not os.path.isdir(os.path.join(root, "aircraft", name)):
        raise ScenarioError([f"aircraft: JSBSim has no '{name}'; it has c172p, among others"])
    fdm = jsbsim.FGFDMExec(root)
    fdm.set_debug_level(0)
    # A lag or filter computes its coefficients from the step at the time of loading.
    fdm.set_dt(dt)
    fdm.load_model(name)
    return fdm
