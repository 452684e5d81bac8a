"""Effects of the contract in the instruments and their clocks."""

from dataclasses import replace

import numpy as np

from .effects import Effect, Experiment, Outcome, Parameters, sign
from .sensors import Clock

Generator = np.random.Generator


def alpha_lag(case: Experiment, size: float, rng: Generator) -> Outcome:
    lag = size * 0.22 / case.omega
    if rng.random() < 0.5:
        vane = replace(case.instruments.vane, lag=lag)
        return replace(case, instruments=replace(case.instruments, vane=vane)), {"lag_s": lag, "order": 1.0}
    damping = float(rng.uniform(0.5, 0.9))
    vane = replace(case.instruments.vane, natural_frequency=2.0 * damping / lag, damping=damping)
    return replace(case, instruments=replace(case.instruments, vane=vane)), {"lag_s": lag, "order": 2.0}


def alpha_scale(case: Experiment, size: float, rng: Generator) -> Outcome:
    scale = sign(rng) * min(0.11 * size, 0.4)
    vane = replace(case.instruments.vane, scale=scale)
    return replace(case, instruments=replace(case.instruments, vane=vane)), {"scale": scale}


def alpha_bias(case: Experiment, size: float, rng: Generator) -> Outcome:
    bias = sign(rng) * float(np.clip(np.radians(1.0) * size, np.radians(0.5), np.radians(2.0)))
    vane = replace(case.instruments.vane, bias=bias)
    return replace(case, instruments=replace(case.instruments, vane=vane)), {"bias_rad": bias}


def alpha_vane_offset(case: Experiment, size: float, rng: Generator) -> Outcome:
    arm = 0.7 * size * case.aircraft.arm_scale_m
    vane = replace(case.instruments.vane, arm=arm)
    return replace(case, instruments=replace(case.instruments, vane=vane)), {"arm_m": arm}


def pitch_rate_bias(case: Experiment, size: float, rng: Generator) -> Outcome:
    bias = sign(rng) * float(np.clip(np.radians(1.0) * size, np.radians(0.5), np.radians(2.0)))
    gyro = replace(case.instruments.gyro, bias=bias)
    return replace(case, instruments=replace(case.instruments, gyro=gyro)), {"bias_rad_s": bias}


def pitch_rate_scale(case: Experiment, size: float, rng: Generator) -> Outcome:
    scale = sign(rng) * min(0.09 * size, 0.4)
    gyro = replace(case.instruments.gyro, scale=scale)
    return replace(case, instruments=replace(case.instruments, gyro=gyro)), {"scale": scale}


def structural_mode(case: Experiment, size: float, rng: Generator) -> Outcome:
    frequency = float(np.clip(case.omega / (2.0 * np.pi) * rng.uniform(2.5, 5.0), 2.0, 8.0))
    omega = 2.0 * np.pi * frequency
    damping = float(rng.uniform(0.03, 0.10))
    by_rate, from_elevator = bool(rng.random() < 0.5), float(rng.random() < 0.6)
    peak_rate = abs(case.linear.M_delta_e) * case.plan.typical_elevator / case.omega
    # The drive is the elevator [rad] or the load factor [g]; bending is a share of the pitch rate.
    drive = case.plan.typical_elevator if from_elevator else 0.3
    share = 0.10 * size * peak_rate / drive
    gyro = replace(
        case.instruments.gyro, fuselage_bending=share / omega if by_rate else share, bending_by_rate=by_rate
    )
    changed = case.with_model(mode_frequency=omega, mode_damping=damping, mode_from_elevator=from_elevator)
    parameters: Parameters = {"frequency_rad_s": omega, "damping": damping, "gain": share}
    parameters["drive"] = "elevator" if from_elevator else "acceleration"
    return replace(changed, instruments=replace(case.instruments, gyro=gyro)), parameters


def accelerometer_offset(case: Experiment, size: float, rng: Generator) -> Outcome:
    arm = sign(rng) * 0.35 * size * case.aircraft.arm_scale_m
    sensor = replace(case.instruments.accelerometer, arm=arm)
    return replace(case, instruments=replace(case.instruments, accelerometer=sensor)), {"arm_m": arm}


def _late(case: Experiment, stream: str, size: float, rng: Generator) -> Outcome:
    late = sign(rng) * float(np.clip(size * 0.22 / case.omega, 0.010, 0.150))
    return case.with_clock(stream, Clock(late=late)), {"skew_s": late}


def alpha_skew(case: Experiment, size: float, rng: Generator) -> Outcome:
    return _late(case, "alpha", size, rng)


def pitch_rate_skew(case: Experiment, size: float, rng: Generator) -> Outcome:
    return _late(case, "gyro", size, rng)


def accelerometer_skew(case: Experiment, size: float, rng: Generator) -> Outcome:
    return _late(case, "accelerometer", size, rng)


def attitude_skew(case: Experiment, size: float, rng: Generator) -> Outcome:
    return _late(case, "attitude", size, rng)


NAMED_IN_INSTRUMENTS = (
    Effect("alpha_lag", "alpha_sensor", alpha_lag),
    Effect("alpha_scale", "alpha_sensor", alpha_scale),
    Effect("alpha_bias", "alpha_sensor", alpha_bias, dynamic=False),
    Effect("alpha_vane_offset", "alpha_sensor", alpha_vane_offset),
    Effect("pitch_rate_bias", "pitch_rate_sensor", pitch_rate_bias, dynamic=False),
    Effect("pitch_rate_scale", "pitch_rate_sensor", pitch_rate_scale),
    Effect("structural_mode", "pitch_rate_sensor", structural_mode),
    Effect("accelerometer_offset", "accelerometer", accelerometer_offset),
    Effect("alpha_skew", "timing", alpha_skew),
    Effect("pitch_rate_skew", "timing", pitch_rate_skew),
    Effect("accelerometer_skew", "timing", accelerometer_skew),
    Effect("attitude_skew", "timing", attitude_skew),
)
