"""An FMU for model exchange, which has equations but no solver: SciPy integrates its states.

The states are integrated between events. An event is a zero crossing of an indicator, or a time that the FMU
has named. The FMU may also request an event after a step (FMI 2.0.4, 3.2; FMI 3.0.2, 3.2).
"""

from ctypes import POINTER, c_double
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp

from advisor.process.arrays import FloatArray

_TOLERANCE = 1e-7
"""Relative and absolute tolerance of a step, in the states' own units: a tenth of a microradian."""
_BEYOND_S = 1e-9
"""Time after an indicator's zero crossing at which the FMU handles the event, s. A shorter interval is one
step of Euler's method."""
_MOST_EVENTS = 100
"""Largest number of events in one communication step. A model that switches more often than every 0.1 ms is
stopped."""


class EndedError(Exception):
    """The FMU has ended its simulation."""


class ModelExchange:
    """States of an initialised FMU for model exchange."""

    def __init__(self, instance: Any, description: Any) -> None:
        self._instance = instance
        self._asks = bool(description.modelExchange.needsCompletedIntegratorStep)
        is_fmi3 = description.fmiVersion.startswith("3.")
        self._derivatives = instance.getContinuousStateDerivatives if is_fmi3 else instance.getDerivatives
        self._update = instance.updateDiscreteStates if is_fmi3 else instance.newDiscreteStates
        self._states = int(description.numberOfContinuousStates)
        self._indicators = int(description.numberOfEventIndicators)
        self._next_event_s = np.inf
        self._settle()

    def advance(self, t: float, width: float) -> None:
        """Integrate the states from ``t`` over ``width`` seconds, through all events.

        Raises
        ------
        EndedError
            The FMU has ended its simulation.
        RuntimeError
            The solver finds no solution, or the FMU switches endlessly.
        """
        end = t + width
        for _ in range(_MOST_EVENTS):
            was = self._signs()
            t = self._integrate(t, min(end, self._next_event_s))
            wants, ends = self._instance.completedIntegratorStep() if self._asks else (False, False)
            if ends:
                raise EndedError
            if wants or t >= self._next_event_s or np.any((self._signs() > 0.0) != (was > 0.0)):
                self._instance.enterEventMode()
                self._settle()
            if t >= end:
                return
        raise RuntimeError(f"it switches more than {_MOST_EVENTS} times in {width:g} s")

    def _settle(self) -> None:
        """Update the discrete states until they are constant, and return to continuous time."""
        changing = True
        while changing:
            changing, ends, _, _, is_timed, next_event_s = self._update()
            if ends:
                raise EndedError
        self._next_event_s = float(next_event_s) if is_timed else np.inf
        self._instance.enterContinuousTimeMode()

    def _integrate(self, t: float, until: float) -> float:
        """Integrate to the next indicator crossing or to ``until``, and return the time reached."""
        x = self._read(self._instance.getContinuousStates, self._states)
        if until - t > _BEYOND_S:
            t, x = self._solved(t, until, x)
        # Just beyond a crossing, or over an interval that is too short for a solver.
        after = min(t + _BEYOND_S, until)
        self._put(after, x + (after - t) * self._rates(t, x))
        return after

    def _solved(self, t: float, until: float, x: FloatArray) -> tuple[float, FloatArray]:
        """Return time and states at the next indicator crossing, or at ``until``."""
        before = self._signs()
        watched = before != 0.0

        def nearest(at: float, x: FloatArray) -> float:
            self._put(at, x)
            return float(np.min((np.sign(before) * self._signs())[watched]))

        nearest.terminal, nearest.direction = True, -1.0  # type: ignore[attr-defined]
        solution = solve_ivp(
            self._rates,
            (t, until),
            x,
            method="LSODA",
            events=nearest if np.any(watched) else None,
            rtol=_TOLERANCE,
            atol=_TOLERANCE,
        )
        if not solution.success:
            raise RuntimeError(str(solution.message))
        return float(solution.t[-1]), solution.y[:, -1]

    def _rates(self, at: float, x: FloatArray) -> FloatArray:
        self._put(at, x)
        return self._read(self._derivatives, self._states)

    def _signs(self) -> FloatArray:
        return self._read(self._instance.getEventIndicators, self._indicators)

    def _put(self, at: float, x: FloatArray) -> None:
        self._instance.setTime(at)
        states = np.ascontiguousarray(x, dtype=np.float64)
        self._instance.setContinuousStates(states.ctypes.data_as(POINTER(c_double)), self._states)

    def _read(self, getter: Any, n: int) -> FloatArray:
        values = np.zeros(n)
        if n:
            getter(values.ctypes.data_as(POINTER(c_double)), n)
        return values
