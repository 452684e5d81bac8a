"""Kinds of gap outside the catalogue that lie in instruments: verdict `unknown`, in the block given."""

from dataclasses import replace
from typing import Any

import numpy as np

from .effects import Effect, Experiment, Outcome, sign
from .motion import GRAVITY
from .sensors import Accelerometer, Attitude, Clock, Vane

Generator = np.random.Generator


def _peak_rate(case: Experiment) -> float:
    """Roughly the pitch rate [rad/s] of a manoeuvre."""
    return abs(case.linear.M_delta_e) * case.plan.typical_elevator / case.omega


def _with_vane(case: Experiment, **changes: float) -> Experiment:
    vane: Vane = replace(case.instruments.vane, **changes)
    return replace(case, instruments=replace(case.instruments, vane=vane))


def _with_gyro(case: Experiment, **changes: Any) -> Experiment:
    gyro = replace(case.instruments.gyro, **changes)
    return replace(case, instruments=replace(case.instruments, gyro=gyro))


def _with_accelerometer(case: Experiment, **changes: float) -> Experiment:
    sensor: Accelerometer = replace(case.instruments.accelerometer, **changes)
    return replace(case, instruments=replace(case.instruments, accelerometer=sensor))


def _with_attitude(case: Experiment, attitude: Attitude) -> Experiment:
    return replace(case, instruments=replace(case.instruments, attitude=attitude))


def vane_sticking(case: Experiment, size: float, rng: Generator) -> Outcome:
    threshold = float(np.radians(0.7)) * size
    return _with_vane(case, stiction=threshold), {"threshold_rad": threshold}


def vane_spikes(case: Experiment, size: float, rng: Generator) -> Outcome:
    peak = float(np.radians(2.0)) * size
    return _with_vane(case, spikes_per_second=1.5, spike_size=peak), {"peak_rad": peak}


def vane_hysteresis(case: Experiment, size: float, rng: Generator) -> Outcome:
    half = float(np.radians(0.4)) * size
    return _with_vane(case, half_play=half), {"half_width_rad": half}


def vane_upwash(case: Experiment, size: float, rng: Generator) -> Outcome:
    curvature = sign(rng) * 6.0 * size
    return _with_vane(case, upwash_curvature=curvature), {"curvature_per_rad": curvature}


def gyro_saturation(case: Experiment, size: float, rng: Generator) -> Outcome:
    limit = _peak_rate(case) * max(0.5 - 0.12 * size, 0.1)
    return _with_gyro(case, saturation=limit), {"limit_rad_s": limit}


def gyro_g_sensitivity(case: Experiment, size: float, rng: Generator) -> Outcome:
    value = sign(rng) * float(np.radians(1.0)) * size
    return _with_gyro(case, g_sensitivity=value), {"rad_s_per_g": value}


def gyro_asymmetry(case: Experiment, size: float, rng: Generator) -> Outcome:
    # The scale of a gyro that is not the same nose up and nose down.
    value = sign(rng) * min(0.15 * size, 0.5)
    return _with_gyro(case, asymmetry=value), {"scale_difference": value}


def gyro_aliasing(case: Experiment, size: float, rng: Generator) -> Outcome:
    peak, frequency = float(np.radians(0.5)) * size, case.omega / 6.28 * float(rng.uniform(0.5, 3.0))
    return _with_gyro(case, alias=peak, alias_frequency=frequency), {"peak_rad_s": peak}


def accelerometer_saturation(case: Experiment, size: float, rng: Generator) -> Outcome:
    peak_alpha = _peak_rate(case) / case.omega
    peak = abs(case.linear.Z_alpha) * case.aircraft.airspeed_m_s * peak_alpha
    limit = peak * max(0.4 - 0.1 * size, 0.05)
    return _with_accelerometer(case, saturation=limit), {"limit_m_s2": limit}


def accelerometer_scale(case: Experiment, size: float, rng: Generator) -> Outcome:
    scale = sign(rng) * min(0.15 * size, 0.6)
    return _with_accelerometer(case, scale=scale), {"scale": scale}


def accelerometer_aliasing(case: Experiment, size: float, rng: Generator) -> Outcome:
    peak, frequency = 0.04 * GRAVITY * size, case.omega / 6.28 * float(rng.uniform(0.5, 3.0))
    return _with_accelerometer(case, alias=peak, alias_frequency=frequency), {"peak_m_s2": peak}


def accelerometer_leakage(case: Experiment, size: float, rng: Generator) -> Outcome:
    share = sign(rng) * min(0.15 * size, 0.5)
    return _with_accelerometer(case, leakage=share), {"z_into_x": share}


def attitude_leans(case: Experiment, size: float, rng: Generator) -> Outcome:
    share, lag = min(0.35 * size, 0.9), float(rng.uniform(0.5, 2.0)) / case.omega
    return _with_attitude(case, Attitude(lean=share, lean_time=lag)), {"share": share, "lag_s": lag}


def attitude_freezes(case: Experiment, size: float, rng: Generator) -> Outcome:
    duration = float(np.clip(0.8 * size / case.omega, 0.1, 1.5))
    starts = [rng.uniform(m.start, m.start + 7.0 * m.unit) for m in case.plan.maneuvers]
    freezes = tuple((float(start), duration) for start in starts)
    return _with_attitude(case, Attitude(freezes=freezes)), {"duration_s": duration}


def attitude_oscillation(case: Experiment, size: float, rng: Generator) -> Outcome:
    peak, frequency = float(np.radians(0.5)) * size, case.omega / 6.28 * float(rng.uniform(0.4, 1.5))
    return _with_attitude(case, Attitude(oscillation=peak, oscillation_frequency=frequency)), {
        "peak_rad": peak
    }


def clock_wander(case: Experiment, size: float, rng: Generator) -> Outcome:
    stream = str(rng.choice(["alpha", "gyro", "accelerometer", "attitude"]))
    peak = float(np.clip(0.35 * size / case.omega, 0.02, 0.3))
    clock = Clock(wander=peak, wander_period=float(rng.uniform(15.0, 60.0)))
    return case.with_clock(stream, clock), {"peak_s": peak, "stream": stream}


def clock_drift(case: Experiment, size: float, rng: Generator) -> Outcome:
    stream = str(rng.choice(["alpha", "gyro", "accelerometer", "attitude"]))
    total = float(np.clip(0.6 * size / case.omega, 0.04, 0.6))
    clock = Clock(drift=sign(rng) * total / float(case.time[-1]))
    return case.with_clock(stream, clock), {"total_s": total, "stream": stream}


OUTSIDE_IN_INSTRUMENTS = (
    Effect("vane_sticking", "alpha_sensor", vane_sticking),
    Effect("vane_spikes", "alpha_sensor", vane_spikes),
    Effect("vane_hysteresis", "alpha_sensor", vane_hysteresis),
    Effect("vane_upwash", "alpha_sensor", vane_upwash),
    Effect("gyro_saturation", "pitch_rate_sensor", gyro_saturation),
    Effect("gyro_g_sensitivity", "pitch_rate_sensor", gyro_g_sensitivity),
    Effect("gyro_asymmetry", "pitch_rate_sensor", gyro_asymmetry),
    Effect("gyro_aliasing", "pitch_rate_sensor", gyro_aliasing),
    Effect("accelerometer_saturation", "accelerometer", accelerometer_saturation),
    Effect("accelerometer_scale", "accelerometer", accelerometer_scale),
    Effect("accelerometer_aliasing", "accelerometer", accelerometer_aliasing),
    Effect("accelerometer_leakage", "accelerometer", accelerometer_leakage),
    Effect("attitude_leans", "attitude_sensor", attitude_leans),
    Effect("attitude_freezes", "attitude_sensor", attitude_freezes),
    Effect("attitude_oscillation", "attitude_sensor", attitude_oscillation),
    Effect("clock_wander", "timing", clock_wander),
    Effect("clock_drift", "timing", clock_drift),
)
