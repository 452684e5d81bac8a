"""Draw what a case is recorded with: noise, rates of the streams, wiring of the servo."""

import numpy as np

from benchmarks.sealed.tlog import IMU_MESSAGES, Wiring

from .planning import STEP
from .telemetry import Noise, Recorder

FILTERED_SHARE = 0.10


def draw_noise(rng: np.random.Generator, coloured: bool) -> Noise:
    """Noise of good instruments, or of fair ones with a memory."""
    worse = float(rng.uniform(1.0, 1.8)) if coloured else 1.0
    return Noise(
        alpha=worse * float(np.radians(rng.uniform(0.08, 0.16))),
        q=worse * float(np.radians(rng.uniform(0.06, 0.16))),
        theta=worse * float(np.radians(rng.uniform(0.04, 0.10))),
        a_x=worse * float(rng.uniform(0.03, 0.08)),
        a_z=worse * float(rng.uniform(0.04, 0.10)),
        airspeed=worse * float(rng.uniform(0.10, 0.25)),
        climb=worse * float(rng.uniform(0.08, 0.20)),
        height=worse * float(rng.uniform(0.05, 0.20)),
        colour=float(rng.uniform(0.3, 0.7)) if coloured else 0.0,
        memory=float(rng.uniform(0.05, 0.3)),
    )


def draw_recorder(
    rng: np.random.Generator, omega: float, period: int, jitter: float, digital: bool
) -> Recorder:
    """Rates of the streams, at least 50 Hz for fast aircraft. Some records are filtered and stored slowly."""
    choices = [25.0, 50.0, 100.0, 200.0] if omega < 6.0 else [50.0, 100.0, 200.0]
    weights = np.array([0.15, 0.5, 0.3, 0.05][-len(choices) :])
    rates = {
        name: float(rng.choice(choices, p=weights / weights.sum())) for name in ("alpha", "attitude", "imu")
    }
    rates["servo"] = 1.0 / (period * STEP) if digital else float(rng.choice([50.0, 100.0]))
    rates["hud"], rates["position"] = float(rng.uniform(5.0, 10.0)), float(rng.choice([5.0, 10.0]))
    low_pass = None
    if rng.random() < FILTERED_SHARE:
        low_pass = omega / (2.0 * np.pi) * float(rng.uniform(2.0, 5.0))
        stored = float(rng.choice([25.0, 50.0]))
        rates.update(dict.fromkeys(("alpha", "attitude", "imu", "servo"), stored))
    in_step = digital and low_pass is None
    return Recorder(rates=rates, jitter=jitter, low_pass=low_pass, servo_in_step=in_step)


def draw_wiring(rng: np.random.Generator) -> Wiring:
    """Elevator output, sense and calibration of the servo, message of the IMU, time since boot."""
    # One slope throughout, so that a microsecond is the same deflection everywhere.
    travel, centre = round(float(rng.uniform(20.0, 28.0)), 1), round(float(rng.uniform(-1.5, 1.5)), 1)
    reverse = bool(rng.random() < 0.4)
    deflections = [round(centre - travel, 1), centre, round(centre + travel, 1)]
    widths = [1100.0, 1500.0, 1900.0]
    points = tuple(zip(widths, deflections[::-1] if reverse else deflections, strict=True))
    return Wiring(
        elevator_output=int(rng.integers(1, 6)),
        reversed=reverse,
        calibration=points,
        imu=str(rng.choice(IMU_MESSAGES)),
        boot_s=round(float(rng.uniform(30.0, 300.0)), 3),
    )
