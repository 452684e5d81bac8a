"""Three ways to measure: a boom, an autopilot that makes its own angle of attack, and one that sends none."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.random import Generator
from scipy.signal import lfilter

from .fleet import Aircraft, Floats
from .flight import STEP_S, Channels

DEG = float(np.pi / 180.0)

Sensing = Callable[[Floats, Channels], Channels]
"""Change of the measured channels: time [s] and channels in, channels out."""


@dataclass(frozen=True)
class Instruments:
    """What is on board, how often each sends, and how much noise each adds."""

    boom: bool
    sends_alpha: bool
    imu_message: str
    rates_hz: dict[str, float]
    noise: dict[str, float]
    """Standard deviation by channel, SI; of a channel's noise ``colour`` of the variance is slow."""
    colour: dict[str, float]
    colour_s: float
    stamp_error_s: float
    uneven: float
    """Share of a period by which sampling is uneven."""
    vane_arm_m: float | None
    """Ahead of the centre of gravity, as the file states; None without a vane."""
    imu_arm_m: float
    stated_imu_arm_m: float | None
    gyro_bias: float
    """Of the raw gyro [rad/s]; the attitude filter has taken it out of its own rate."""
    alpha_age_s: float
    alpha_filter_s: float
    alpha_renewed_hz: float


def draw_instruments(aircraft: Aircraft, rng: Generator) -> Instruments:
    """Draw the equipment of one aircraft: half of all have a boom, a quarter no angle of attack at all."""
    boom = bool(rng.random() < 0.5)
    sends_alpha = boom or bool(rng.random() < 0.5)
    fine = 1.0 if boom else 1.6
    noise = {
        "alpha": float(rng.uniform(0.05, 0.18)) * DEG * (1.0 if boom else 0.6),
        "q": float(rng.uniform(0.05, 0.2)) * DEG * fine,
        "theta": float(rng.uniform(0.03, 0.09)) * DEG * fine,
        "a_x": float(rng.uniform(0.02, 0.08)) * fine,
        "a_z": float(rng.uniform(0.03, 0.1)) * fine,
        "imu_q": float(rng.uniform(0.1, 0.3)) * DEG * fine,
        "airspeed": float(rng.uniform(0.1, 0.3)) * fine,
        "climb": float(rng.uniform(0.04, 0.1)) * fine,
        "height": 0.15,
    }
    rates = {"alpha": 50.0, "attitude": 50.0, "imu": 50.0, "servo": 50.0, "hud": 10.0, "position": 5.0}
    if not boom:
        rates["attitude"] = 25.0
        rates["alpha"] = float(rng.choice([10.0, 20.0, 25.0]))
        rates["imu"] = float(rng.choice([25.0, 50.0]))
        rates["servo"] = float(rng.choice([20.0, 25.0, 50.0]))
    imu_arm = float(rng.uniform(-0.15, 0.4)) * aircraft.chord_m if rng.random() < 0.5 else 0.0
    return Instruments(
        boom=boom,
        sends_alpha=sends_alpha,
        imu_message="HIGHRES_IMU"
        if boom and rng.random() < 0.5
        else str(rng.choice(["RAW_IMU", "SCALED_IMU2"])),
        rates_hz=rates,
        noise=noise,
        colour={"a_x": float(rng.uniform(0.1, 0.5)), "a_z": float(rng.uniform(0.1, 0.5)), "alpha": 0.2},
        colour_s=float(rng.uniform(0.05, 0.25)),
        stamp_error_s=0.0 if rng.random() < 0.7 else float(rng.uniform(0.001, 0.003)),
        uneven=float(rng.uniform(0.01, 0.12)),
        vane_arm_m=float(rng.uniform(0.4, 1.1)) * aircraft.tail_arm_m if boom else None,
        imu_arm_m=imu_arm,
        stated_imu_arm_m=imu_arm,
        gyro_bias=float(rng.normal(0.0, 0.4)) * DEG,
        alpha_age_s=float(rng.uniform(0.02, 0.04)),
        alpha_filter_s=float(rng.uniform(0.01, 0.03)),
        alpha_renewed_hz=float(rng.choice([10.0, 20.0])),
    )


def shifted(time: Floats, series: Floats, late_s: float | Floats) -> Floats:
    """The series as it was some time ago."""
    return np.interp(time - late_s, time, series)


def filtered(series: Floats, lag_s: float) -> Floats:
    """First-order lag of the series, from its first value on."""
    keep = float(np.exp(-STEP_S / lag_s))
    # The bilinear rule has no delay of its own.
    half = 0.5 * (1.0 - keep)
    return np.asarray(lfilter([half, half], [1.0, -keep], series - series[0]) + series[0])


def measured(true: Channels, kit: Instruments, sensing: tuple[Sensing, ...]) -> Channels:
    """What the instruments show without noise, at every 5 ms."""
    time = STEP_S * np.arange(true["q"].size)
    shown = dict(true)
    shown["a_z"] = true["a_z"] - kit.imu_arm_m * true["q_dot"]
    shown["a_x"] = true["a_x"] - kit.imu_arm_m * true["q"] ** 2
    shown["imu_q"] = true["q"].copy()
    if kit.vane_arm_m is not None:
        shown["alpha"] = true["alpha"] - kit.vane_arm_m * true["q"] / true["airspeed"]
    for change in sensing:
        shown = change(time, shown)
    if not kit.boom:
        # Attitude less flight path, which no vertical gust moves.
        path = np.arcsin(np.clip(true["climb"] / true["airspeed"], -1.0, 1.0))
        shown["alpha"] = shifted(time, filtered(true["theta"] - path, kit.alpha_filter_s), kit.alpha_age_s)
    return shown


def slow_noise(count: int, step_s: float, lag_s: float, rng: Generator) -> Floats:
    """Noise of unit variance that forgets within ``lag_s``."""
    keep = float(np.exp(-step_s / lag_s))
    white = rng.normal(size=count)
    white[0] /= np.sqrt(1.0 - keep**2)
    return np.asarray(lfilter([np.sqrt(1.0 - keep**2)], [1.0, -keep], white))


def ringing(driving: Floats, own: float, damping: float) -> Floats:
    """Mass on a spring after a driven base: its deflection, Newmark's rule (average acceleration)."""
    x = v = a = 0.0
    out, pull = np.empty(driving.size), own**2 * (driving - driving[0])
    bottom = 1.0 + damping * own * STEP_S + 0.25 * own**2 * STEP_S**2
    for k, value in enumerate(pull.tolist()):
        if k > 0:
            x_0, v_0 = x + STEP_S * v + 0.25 * STEP_S**2 * a, v + 0.5 * STEP_S * a
            a = (value - 2.0 * damping * own * v_0 - own**2 * x_0) / bottom
            x, v = x_0 + 0.25 * STEP_S**2 * a, v_0 + 0.5 * STEP_S * a
        out[k] = x
    return out
