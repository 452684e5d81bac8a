"""Bundled nonlinear aircraft: an airframe in trim, integrated by its equations of motion."""

import numpy as np
from numpy.typing import NDArray

from .airframe import Airframe, as_record
from .dynamics import DERIVATIVES, derivatives, step
from .linear import ShortPeriod, linearise
from .motion import Controls, Motion
from .servo import Calibration
from .trim import trim_level


class NonlinearAircraft:
    """An engine (see :class:`sim.motion.Engine`) that flies an :class:`~sim.airframe.Airframe`."""

    def __init__(self, airframe: Airframe, airspeed_m_s: float, height_m: float) -> None:
        self.record: NDArray[np.void] = as_record(airframe)
        """Airframe that is flown. Effects may change its fields in flight."""
        level = trim_level(self.record, airspeed_m_s, height_m)
        self.record["alpha_ref"] = level.alpha
        self.record["delta_e_ref"] = level.elevator
        self.level = trim_level(self.record, airspeed_m_s, height_m)
        self.calibration = Calibration()
        self._state = self.level.state()
        self._inputs = self.level.inputs()
        self._before = self._inputs.copy()
        self._rates = np.empty(len(DERIVATIVES))
        derivatives(self._state, self._inputs, self.record, self._rates)

    @property
    def trim(self) -> Controls:
        """Controls of level flight."""
        return Controls(self.level.elevator, self.level.throttle, 0.0)

    @property
    def truth(self) -> ShortPeriod:
        """Short-period parameters about the trim, by finite differences of the equations of motion."""
        return linearise(self.record, self.level)

    def motion(self) -> Motion:
        """Return the present motion."""
        speed, alpha, q, theta, height, phi, p, _ = self._state.tolist()
        rates = self._rates.tolist()
        elevator, throttle, _, gust_up, gust_head, _, _ = self._inputs.tolist()
        return Motion(
            speed,
            alpha,
            q,
            theta,
            height,
            phi,
            p,
            rates[4],
            rates[0],
            rates[1],
            rates[2],
            rates[8],
            rates[9],
            elevator,
            throttle,
            gust_up,
            gust_head,
        )

    def step(self, controls: Controls, dt: float) -> Motion:
        """Fly for ``dt`` seconds and return the resulting motion."""
        self._before, self._inputs = self._inputs, self._before
        self._inputs[:] = controls[:7]
        step(self._state, self._before, self._inputs, self.record, dt, self._rates)
        return self.motion()
