"""Causes without a name in the contract: instruments and clocks; each says what happens aboard."""

import numpy as np
from numpy.random import Generator
from scipy.ndimage import gaussian_filter1d
from scipy.signal import lfilter

from .fleet import Floats
from .flight import STEP_S
from .instruments import DEG, filtered, ringing, shifted
from .setup import Applied, Effect, Setup, both_gyros, moments, named_parameters, only, sign

# Angle-of-attack sensor.


def _flutter(setup: Setup, size: float, rng: Generator) -> Applied:
    """The vane flutters now and then."""
    own = float(rng.uniform(1.5, 3.5)) * setup.plan.own_rad_s
    time = setup.plan.time
    swell = np.clip(np.sin(0.3 * own * time / 6.28 + float(rng.uniform(0.0, 6.28))), 0.0, 1.0)
    series = size * swell * np.sin(own * time)
    return setup.seen(only("alpha", lambda t, x, c: x + series)), named_parameters(
        peak_rad=size, own_rad_s=own
    )


def _stop(setup: Setup, size: float, rng: Generator) -> Applied:
    """The vane meets its stop."""
    middle, upper = setup.plan.trims[0].alpha, bool(rng.random() < 0.5)
    at = middle + (1.0 if upper else -1.0) * 0.03 / size
    bound = np.minimum if upper else np.maximum
    return setup.seen(only("alpha", lambda t, x, c: bound(x, at))), named_parameters(stop_rad=at)


def _encoder(setup: Setup, size: float, rng: Generator) -> Applied:
    """The encoder has lost its low bits."""
    return setup.seen(only("alpha", lambda t, x, c: size * np.round(x / size))), named_parameters(
        step_rad=size
    )


def _ice_on_vane(setup: Setup, size: float, rng: Generator) -> Applied:
    """Ice grows on the vane and falls off."""
    period = float(rng.uniform(5.0, 12.0))
    series = size * (((setup.plan.time + float(rng.uniform(0.0, period))) / period) % 1.0 - 0.5)
    return setup.seen(only("alpha", lambda t, x, c: x + series)), named_parameters(
        bias_rad=size, period_s=period
    )


# Pitch-rate sensor.


def _dead_gyro(setup: Setup, size: float, rng: Generator) -> Applied:
    """Small rates read zero."""
    return setup.seen(
        *both_gyros(lambda x: np.sign(x) * np.maximum(np.abs(x) - size, 0.0))
    ), named_parameters(zone_rad_s=size)


def _notched_gyro(setup: Setup, size: float, rng: Generator) -> Applied:
    """A notch filter set to the wrong frequency."""
    own, wide = float(rng.uniform(0.8, 1.5)) * setup.plan.own_rad_s, 0.7
    s = 2.0 / STEP_S
    rule = np.array([[s * s, -2 * s * s, s * s], [s, 0.0, -s], [1.0, 2.0, 1.0]])
    bottom = np.array([1.0, wide * own, own**2]) @ rule
    top = np.array([1.0, (1.0 - size) * wide * own, own**2]) @ rule
    return setup.seen(*both_gyros(lambda x: lfilter(top, bottom, x))), named_parameters(
        depth=size, own_rad_s=own
    )


def _wandering_gyro(setup: Setup, size: float, rng: Generator) -> Applied:
    """The gyro's zero wanders while it warms up."""
    period = float(rng.uniform(6.0, 15.0)) / setup.plan.own_rad_s
    series = gaussian_filter1d(rng.normal(size=setup.plan.steps), 0.2 * period / STEP_S)
    series *= size / float(np.std(series))
    return setup.seen(*both_gyros(lambda x: x + series)), named_parameters(rms_rad_s=size, period_s=period)


# Accelerometer.


def _soft_mount(setup: Setup, size: float, rng: Generator) -> Applied:
    """The unit sways on soft foam."""
    own = float(rng.uniform(1.8, 3.5)) * setup.plan.own_rad_s

    def soft(t: Floats, x: Floats, c: dict[str, Floats]) -> Floats:
        return x + size * (x[0] + ringing(x, own, 0.1) - x)

    return setup.seen(only("a_z", soft)), named_parameters(share=size, own_rad_s=own)


def _coarse(setup: Setup, size: float, rng: Generator) -> Applied:
    """The accelerometer has lost its low bits."""
    return setup.seen(only("a_z", lambda t, x, c: size * np.round(x / size))), named_parameters(
        step_m_s2=size
    )


def _one_sided(setup: Setup, size: float, rng: Generator) -> Applied:
    """Another gain above 1 g than below."""
    part = sign(rng) * size

    def gained(t: Floats, x: Floats, c: dict[str, Floats]) -> Floats:
        return x + part * np.minimum(x + 9.80665, 0.0)

    return setup.seen(only("a_z", gained)), named_parameters(part=part)


# Attitude sensor.


def _false_horizon(setup: Setup, size: float, rng: Generator) -> Applied:
    """The attitude filter takes the specific force for level."""
    lag = float(rng.uniform(2.0, 5.0)) / setup.plan.own_rad_s

    def pulled(t: Floats, x: Floats, c: dict[str, Floats]) -> Floats:
        # Taken for level: the specific force's own direction.
        apparent = np.arctan2(c["a_x"], -c["a_z"])
        return x + size * filtered(apparent - x, lag)

    return setup.seen(only("theta", pulled)), named_parameters(weight=size, lag_s=lag)


def _resets(setup: Setup, size: float, rng: Generator) -> Applied:
    """The attitude jumps and comes back."""
    series = np.zeros(setup.plan.steps)
    for start in moments(setup, rng, int(rng.integers(3, 6))):
        since = setup.plan.time - start - float(rng.uniform(0.0, 2.0))
        series += np.where(since > 0.0, sign(rng) * size * np.exp(-np.maximum(since, 0.0) / 1.5), 0.0)
    return setup.seen(only("theta", lambda t, x, c: x + series)), named_parameters(jump_rad=size)


def _short_gimbal(setup: Setup, size: float, rng: Generator) -> Applied:
    """The attitude shows too small an angle."""
    middle = setup.plan.trims[0].alpha
    return setup.seen(only("theta", lambda t, x, c: middle + (1.0 - size) * (x - middle))), named_parameters(
        part=-size
    )


# Timing.


def _aged(setup: Setup, rng: Generator, age: Floats) -> Setup:
    groups = [("q", "theta"), ("a_x", "a_z", "imu_q")] + ([("alpha",)] if setup.kit.boom else [])
    group = groups[int(rng.integers(len(groups)))]
    return setup.seen(*(only(name, lambda t, x, c: shifted(t, x, age)) for name in group))


def _sawtooth(setup: Setup, size: float, rng: Generator) -> Applied:
    """A buffer fills and is emptied: values age and are young again."""
    period = float(rng.uniform(3.0, 7.0))
    age = size * ((setup.plan.time / period + float(rng.random())) % 1.0)
    return _aged(setup, rng, age), named_parameters(largest_s=size, period_s=period)


def _stepped(setup: Setup, size: float, rng: Generator) -> Applied:
    """A stream is late in some manoeuvres only."""
    ends = np.array([m.end_s for m in setup.plan.maneuvers])
    after = np.searchsorted(ends, setup.plan.time)
    ages = size * rng.permutation(np.arange(ends.size + 1) % 2)
    return _aged(setup, rng, ages[after].astype(float)), named_parameters(step_s=size)


def _stalls(setup: Setup, size: float, rng: Generator) -> Applied:
    """A stream repeats its last value under new stamps."""
    age, time = np.zeros(setup.plan.steps), setup.plan.time
    at = float(rng.uniform(0.0, 3.0))
    while at < time[-1]:
        inside = (time >= at) & (time < at + size)
        age[inside] = time[inside] - at
        at += size + float(rng.uniform(0.6, 2.5))
    return _aged(setup, rng, age), named_parameters(stall_s=size)


SENSING = {
    "vane_flutter": Effect("alpha_sensor", 0.3 * DEG, 1.0 * DEG, 2.0 * DEG, _flutter, needs_boom=True),
    "vane_stop": Effect("alpha_sensor", 1.0, 2.5, 6.0, _stop, needs_boom=True),
    "coarse_encoder": Effect("alpha_sensor", 0.8 * DEG, 2.0 * DEG, 4.0 * DEG, _encoder, needs_boom=True),
    "vane_ice": Effect("alpha_sensor", 0.6 * DEG, 2.0 * DEG, 4.0 * DEG, _ice_on_vane, needs_boom=True),
    "gyro_dead_zone": Effect("pitch_rate_sensor", 0.4 * DEG, 2.0 * DEG, 4.0 * DEG, _dead_gyro),
    "gyro_notch": Effect("pitch_rate_sensor", 0.15, 0.6, 0.9, _notched_gyro),
    "gyro_wander": Effect("pitch_rate_sensor", 0.3 * DEG, 1.2 * DEG, 3.0 * DEG, _wandering_gyro),
    "soft_mount": Effect("accelerometer", 0.2, 0.7, 0.9, _soft_mount),
    "coarse_accelerometer": Effect("accelerometer", 0.4, 1.5, 4.0, _coarse),
    "one_sided_accelerometer": Effect("accelerometer", 0.06, 0.3, 0.5, _one_sided),
    "false_horizon": Effect("attitude_sensor", 0.15, 0.6, 0.9, _false_horizon),
    "attitude_resets": Effect("attitude_sensor", 0.4 * DEG, 2.0 * DEG, 4.0 * DEG, _resets),
    "short_attitude": Effect("attitude_sensor", 0.06, 0.3, 0.5, _short_gimbal),
    "sawtooth_age": Effect("timing", 0.05, 0.2, 0.4, _sawtooth),
    "stepped_age": Effect("timing", 0.03, 0.15, 0.3, _stepped),
    "stalled_stream": Effect("timing", 0.1, 0.3, 0.6, _stalls),
}
