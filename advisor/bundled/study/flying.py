"""Exact flight of the linear aircraft: inputs, responses, and the reference of "noise of 1 %"."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

import numpy as np
from scipy.linalg import expm

from advisor.flight.maneuvers.maneuver import Maneuver, Span
from advisor.flight.signals.record import Channel
from advisor.process.arrays import FloatArray
from advisor.process.installed import SIMULATOR

if TYPE_CHECKING or SIMULATOR == "sim":
    from sim.airframe import UAV
    from sim.hangar import AIRFRAMES
    from sim.linear import RESEARCH_JET, ShortPeriod
    from sim.maneuvers import STEPS
    from sim.nonlinear_aircraft import NonlinearAircraft
else:
    from inflight_sim.airframe import UAV
    from inflight_sim.hangar import AIRFRAMES
    from inflight_sim.linear import RESEARCH_JET, ShortPeriod
    from inflight_sim.maneuvers import STEPS
    from inflight_sim.nonlinear_aircraft import NonlinearAircraft

__all__ = ["AIRFRAMES", "RESEARCH_JET", "STEPS", "UAV", "NonlinearAircraft", "ShortPeriod"]


Steps = tuple[tuple[float, float], ...]
NoiseReading = Literal["std", "peak", "rms", "sample"]

NOISE_READINGS: Mapping[NoiseReading, str] = {
    "std": "of the standard deviation of the response over the manoeuvre",
    "peak": "of the largest deviation of the response from trim",
    "rms": "of the root mean square of the response, trim included",
    "sample": "of each sample's own deviation from trim",
}
"""Description of each reference of the noise's percentage, by its name. The first reference is the
default."""


@dataclass(frozen=True, slots=True)
class Scene:
    """An aircraft, with the sampling rate and the input of its manoeuvres."""

    aircraft: ShortPeriod = RESEARCH_JET
    unit_s: float = 0.7
    """One unit of time of the 3-2-1-1: about a quarter of the short period, the textbook's choice."""
    amplitude_rad: float = float(np.radians(2.0))
    lead_s: float = 1.0
    duration_s: float = 10.0
    rate_hz: float = 50.0

    @property
    def theta(self) -> FloatArray:
        """Shape (8,), the true parameters in the order of ``PARAMETERS``."""
        return np.array(list(self.aircraft.as_dict().values()))


@dataclass(frozen=True, slots=True)
class NoiselessManeuver:
    """One simulated manoeuvre without noise."""

    t: FloatArray
    elevator: FloatArray
    """(n,) elevator deflection in rad, linear between samples."""
    response: FloatArray
    """(n, 2) response of α in rad and q in rad/s."""
    trim: FloatArray
    """(2,) state before the input."""


def fly(scene: Scene, steps: Steps) -> NoiselessManeuver:
    """Fly an input of ``steps`` (duration in units, share of the amplitude; positive pulls) from trim."""
    _, trimmed = scene.aircraft.trim()
    t = np.arange(round(scene.duration_s * scene.rate_hz) + 1) / scene.rate_hz
    elevator = np.full(len(t), trimmed)
    onset = scene.lead_s
    for units, share in steps:
        on = (t > onset - 1e-9) & (t < onset + units * scene.unit_s - 1e-9)
        elevator[on] -= share * scene.amplitude_rad  # trailing edge up raises the nose
        onset += units * scene.unit_s
    return follow(scene, t, elevator)


def follow(scene: Scene, t: FloatArray, elevator: FloatArray) -> NoiselessManeuver:
    """Return the response from trim to an elevator sampled at ``t``."""
    alpha, _ = scene.aircraft.trim()
    trim = np.array([alpha, 0.0])
    return NoiselessManeuver(t, elevator, respond(scene.aircraft, elevator, trim, 1.0 / scene.rate_hz), trim)


def fly_named(scene: Scene, name: str) -> NoiselessManeuver:
    """Fly one of the bundled aircraft's inputs: ``3211``, ``rev``, ..."""
    return fly(scene, STEPS[name])


def as_maneuver(flight: NoiselessManeuver) -> Maneuver:
    """Return the flight as a manoeuvre from a message stream: command, begin and end."""
    moving = np.flatnonzero(np.abs(flight.elevator - flight.elevator[0]) > 1e-9)
    start, end = flight.t[moving[0]], flight.t[min(moving[-1] + 1, len(flight.t) - 1)]
    span = Span(
        record_from_s=0.0,
        start_s=float(start),
        last_step_s=float(end),
        end_s=float(flight.t[-1]),
        kind="other",
        steps=(),
        closed_by="quiet",
    )
    return Maneuver(1, 0, span, {"elevator": Channel("elevator", flight.t, flight.elevator)})


def respond(aircraft: ShortPeriod, elevator: FloatArray, state: FloatArray, step_s: float) -> FloatArray:
    """Return the exact solution of Eqs. (1)-(2) for an elevator that is linear between its samples.

    The matrix exponential of the system augmented by the input and its slope (Van Loan, 1978).

    Returns
    -------
    FloatArray
        Shape (n, 2): α and q at the samples.
    """
    p = aircraft
    augmented = np.zeros((5, 5))
    augmented[0] = [p.Z_alpha, 1.0 + p.Z_q, p.Z_delta_e, p.Z_0, 0.0]
    augmented[1] = [p.M_alpha, p.M_q, p.M_delta_e, p.M_0, 0.0]
    augmented[2, 4] = 1.0
    step = expm(augmented * step_s)[:2]
    states = np.empty((len(elevator), 2))
    states[0] = state
    for k in range(len(elevator) - 1):
        slope = (elevator[k + 1] - elevator[k]) / step_s
        states[k + 1] = step @ [*states[k], elevator[k], 1.0, slope]
    return states


def noise_scale(flight: NoiselessManeuver, reading: NoiseReading) -> FloatArray:
    """Return the standard deviation of a noise of 100 %, for every sample, broadcastable to (n, 2)."""
    deviation = flight.response - flight.trim
    match reading:
        case "std":
            return np.asarray(flight.response.std(axis=0))
        case "peak":
            return np.asarray(np.abs(deviation).max(axis=0))
        case "rms":
            return np.asarray(np.sqrt((flight.response**2).mean(axis=0)))
        case "sample":
            return np.abs(deviation)
