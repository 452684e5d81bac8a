"""Information of an input before its flight: expected errors and excursions from the short-period model."""

from dataclasses import dataclass

import numpy as np

from advisor.aircraft.reference import PARAMETERS
from advisor.model.outputs import LOCAL, N_LOCAL, N_PARAMETERS, SHARED
from advisor.model.response import respond
from advisor.model.short_period import ShortPeriod
from advisor.oem.covariance import cramer_rao, influence
from advisor.oem.extra import Extra
from advisor.oem.problem import Assembly, OutputErrorProblem, Record, assemble
from advisor.oem.rows import Signal
from advisor.oem.surface import Servo
from advisor.process.arrays import FloatArray

UNMEASURED = 1e3
"""Noise of an unmeasured angle of attack, rad. With this noise α adds no information."""


@dataclass(frozen=True, slots=True)
class Instruments:
    """Sampling and noise of the outputs, and the servo between stick and surface."""

    step_s: tuple[float, float]
    """Time between samples of α and of q, s."""
    noise: tuple[float, float]
    """Standard deviations of the noise of α in rad and of q in rad/s."""
    servo: Servo
    specific_force: tuple[float, float] | None = None
    """Time between samples of a_z in s, and the noise of a_z divided by the air speed in 1/s. None if a_z is
    not used."""


@dataclass(frozen=True, slots=True)
class Expectation:
    """Expected errors and excursion of a manoeuvre."""

    covariance: FloatArray
    """Shape (8, 8): Cramér-Rao bound, in the order of ``PARAMETERS``."""
    alpha_excursion: float
    """Largest deviation of α from its initial value, rad."""
    influence: FloatArray
    """Shape (n, 8): change of the estimate with each sample."""

    @property
    def std(self) -> FloatArray:
        """Shape (8,): expected standard deviations."""
        return np.sqrt(np.diag(self.covariance))


def expect(theta: FloatArray, elevator: Signal, instruments: Instruments) -> Expectation | None:
    """Return the expected errors of the eight parameters from one manoeuvre with this elevator.

    Parameters
    ----------
    theta
        Shape (8,): present estimate of the aircraft.
    elevator
        Elevator command including trim; the record begins in the model's equilibrium.

    Returns
    -------
    Expectation or None
        None if the input cannot separate the parameters, or the model diverges.
    """
    steps = dict(zip(("alpha", "q"), instruments.step_s, strict=True))
    if instruments.specific_force is not None:
        steps["a_z"] = instruments.specific_force[0]
    outputs = {name: unmeasured(float(elevator.t[-1]), step) for name, step in steps.items()}
    problem = OutputErrorProblem(
        (Record(elevator, outputs),), servo=instruments.servo, airspeed_may_be_off=False
    )
    force = instruments.specific_force[1] if instruments.specific_force else 0.0
    return foresee(theta, assemble(problem), np.array([*instruments.noise, force, 0.0]))


def unmeasured(end_s: float, step_s: float) -> Signal:
    """Return stamps and zero values for an output of an input that is not flown yet."""
    t = np.arange(0.0, end_s, step_s)
    return Signal(t, np.zeros_like(t))


def foresee(
    theta: FloatArray,
    assembly: Assembly,
    noise: FloatArray,
    prior: FloatArray | None = None,
    extra: Extra | None = None,
) -> Expectation | None:
    """Return the expected errors of one manoeuvre at the stamps of an assembly.

    Parameters
    ----------
    theta
        Shape (8,): model of the aircraft.
    noise
        Shape (4,): standard deviation of each output's noise.
    prior
        Precision of the parameters before the flight, as in :func:`advisor.oem.covariance.influence`.
    extra
        Additional estimated parameters, such as a servo's lag.

    Returns
    -------
    Expectation or None
        None if the input cannot separate the parameters, or the model diverges.
    """
    sensitivities = np.empty((len(assembly.z), N_PARAMETERS))
    y = response_from_trim(theta, assembly, sensitivities)
    effect = None if y is None else influence(assembly, sensitivities, noise, extra, prior)
    if y is None or effect is None:
        return None
    alpha = y[assembly.rows[0]["alpha"]] if "alpha" in assembly.rows[0] else np.zeros(1)
    excursion = float(np.max(np.abs(alpha - alpha[0])))
    effect = effect.first(len(theta))
    covariance = cramer_rao(assembly, effect.rows, noise) + effect.prior_covariance
    return Expectation(covariance, excursion, effect.rows)


def response_from_trim(
    theta: FloatArray, assembly: Assembly, sensitivities: FloatArray | None = None
) -> FloatArray | None:
    """Return the outputs (n,) of one manoeuvre that begins in equilibrium; None for a diverging model.

    Parameters
    ----------
    sensitivities
        Array (n, N_PARAMETERS) that receives the sensitivities. None if sensitivities are not needed.
    """
    local = local_at_trim(theta, assembly)
    if local is None:
        return None
    y = np.empty(len(assembly.z))
    wanted = np.empty((0, N_PARAMETERS)) if sensitivities is None else sensitivities
    return y if respond(assembly.grid, shared_of(theta), local, y, wanted) else None


def local_at_trim(theta: FloatArray, assembly: Assembly) -> FloatArray | None:
    """Return the local parameters (1, N_LOCAL) of a manoeuvre that begins in equilibrium; else None."""
    model = ShortPeriod(theta)
    try:
        begin = -np.linalg.solve(model.a, model.b * assembly.grid.elevator[0] + model.c)
    except np.linalg.LinAlgError:
        return None
    local = np.zeros((1, N_LOCAL))
    for name, value in zip(("Z_0", "M_0", "alpha_initial", "q_initial"), (*model.c, *begin), strict=True):
        local[0, LOCAL.index(name)] = value
    return local


def shared_of(theta: FloatArray) -> FloatArray:
    """Return the parameters that manoeuvres share, in the order of ``SHARED``, with zero for instruments."""
    return np.array([theta[PARAMETERS.index(s)] if s in PARAMETERS else 0.0 for s in SHARED])
