"""Information of an input before its flight: expected errors and excursions of the short-period model."""

from dataclasses import dataclass

import numpy as np

from advisor.aircraft.aircraft import PARAMETERS
from advisor.flight.signals.messages import FloatArray
from advisor.model.response import LOCAL, N_LOCAL, N_PARAMETERS, SHARED, respond
from advisor.model.short_period import ShortPeriod
from advisor.oem.covariance import cramer_rao, influence
from advisor.oem.problem import OutputErrorProblem, Record, Signal, assemble
from advisor.oem.surface import Servo

UNMEASURED = 1e3
"""Noise of an angle of attack that is not measured, rad. The number is so large that α adds no
information."""


@dataclass(frozen=True, slots=True)
class Instruments:
    """Measurement of the outputs, and the servo between stick and surface."""

    step_s: tuple[float, float]
    """Time between samples of α and of q, s."""
    noise: tuple[float, float]
    """Standard deviation of α in rad and of q in rad/s."""
    servo: Servo
    specific_force: tuple[float, float] | None = None
    """Time between samples of a_z in s, and the noise of a_z divided by the air speed in 1/s. None: a_z is
    not used."""


@dataclass(frozen=True, slots=True)
class Expectation:
    """Expected errors and excursion of a manoeuvre."""

    covariance: FloatArray
    """(8, 8) Cramér-Rao bound, in the order of ``PARAMETERS``."""
    alpha_excursion: float
    """Largest deviation of α from its initial value, rad."""

    @property
    def std(self) -> FloatArray:
        """(8,) expected standard deviations."""
        return np.sqrt(np.diag(self.covariance))


def expect(theta: FloatArray, elevator: Signal, instruments: Instruments) -> Expectation | None:
    """Return the expected errors of the eight parameters from one manoeuvre with this elevator.

    Parameters
    ----------
    theta
        (8,) present estimate of the aircraft.
    elevator
        The command, trim included; the record begins in the model's equilibrium at its first value.

    Returns
    -------
    Expectation or None
        None when the input cannot separate the parameters, or the model diverges.
    """
    end = elevator.t[-1]
    outputs = {
        name: Signal(t := np.arange(0.0, end, step), np.zeros_like(t))
        for name, step in zip(("alpha", "q"), instruments.step_s, strict=True)
    }
    if instruments.specific_force is not None:
        t = np.arange(0.0, end, instruments.specific_force[0])
        outputs["a_z"] = Signal(t, np.zeros_like(t))
    assembly = assemble(
        OutputErrorProblem((Record(elevator, outputs),), servo=instruments.servo, airspeed_may_be_off=False)
    )
    shared = np.array([theta[PARAMETERS.index(s)] if s in PARAMETERS else 0.0 for s in SHARED])
    model = ShortPeriod(theta)
    try:
        begin = -np.linalg.solve(model.a, model.b * elevator.y[0] + model.c)
    except np.linalg.LinAlgError:
        return None
    local = np.zeros((1, N_LOCAL))
    for name, value in zip(("Z_0", "M_0", "alpha_initial", "q_initial"), (*model.c, *begin), strict=True):
        local[0, LOCAL.index(name)] = value
    y, g = np.empty(len(assembly.z)), np.empty((len(assembly.z), N_PARAMETERS))
    if not respond(assembly.grid, shared, local, y, g):
        return None
    force = instruments.specific_force[1] if instruments.specific_force else 0.0
    noise = np.array([*instruments.noise, force, 0.0])
    effect = influence(assembly, g, noise)
    if effect is None:
        return None
    covariance = cramer_rao(assembly, effect.rows, noise)
    alpha = y[assembly.rows[0]["alpha"]]
    return Expectation(covariance, float(np.max(np.abs(alpha - begin[0]))))
