"""A simulator with curves, a speed and a servo of its own, and recordings of an aircraft like it."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from advisor.flight.maneuvers.maneuver import Maneuver, Span
from advisor.flight.signals.record import Channel
from advisor.process.arrays import FloatArray
from advisor.simulators.protocol import Condition, Increments, Inputs, Replay, State

G = 9.80665
STEP_S = 0.01
TRIM_RAD = 0.05
NOISE = {
    "alpha": 0.0015,
    "q": 0.003,
    "theta": 0.001,
    "a_z": 0.08,
    "a_x": 0.08,
    "airspeed": 0.1,
    "height": 0.3,
    "altitude": 0.3,
}


@dataclass(frozen=True)
class Nonlinear:
    """Lift and moment bend with the angle of attack; the speed follows the path."""

    lag_s: float = 0.0
    delay_s: float = 0.0
    rate_rad_s: float = np.inf
    half_play_rad: float = 0.0
    takes_increments: bool = True
    takes: frozenset[str] = frozenset()
    description: str = "the test's simulator"
    speed_limit_s: float = 20.0

    def replay(self, condition: Condition, inputs: Inputs, increments: Increments | None = None) -> Replay:
        """Fly by the midpoint rule."""
        trim_speed, steep = condition.airspeed_m_s, condition.flight_path_rad
        t = np.arange(0.0, inputs.t[-1] + 1.5 * STEP_S, STEP_S)
        surface = _lagging(np.interp(t - self.delay_s, inputs.t, inputs.elevator), self.lag_s)
        surface = _limited(surface, self.rate_rad_s * STEP_S, self.half_play_rad)

        def rates(x: FloatArray, at: float, elevator: float) -> tuple[FloatArray, float]:
            alpha, q, theta, speed, height = x.tolist()
            v, bent = speed / 25.0, alpha - TRIM_RAD
            lift = -G * np.cos(steep) * 25.0 / trim_speed**2 - 3.0 * bent + 8.0 * bent * abs(bent)
            normal = v * (lift - 0.1 * elevator)
            alpha_dot = q + G / speed * np.cos(theta - alpha) + normal
            moment = v * v * (-25.0 * bent + 40.0 * bent**2 - 30.0 * elevator)
            q_dot = moment + v * (-3.0 * q - 0.5 * alpha_dot)
            if increments is not None:
                force, turn = increments(State(at, alpha, alpha_dot, q, elevator, speed, height, 0.0))
                normal, alpha_dot, q_dot = normal + force, alpha_dot + force, q_dot + turn
            along = G * (np.sin(steep) - np.sin(theta - alpha)) - 0.05 * (speed - trim_speed)
            climb = speed * np.sin(theta - alpha)
            return np.array([alpha_dot, q_dot, q, along, climb]), speed * normal

        x = np.array([TRIM_RAD, 0.0, TRIM_RAD + steep, trim_speed, condition.height_m])
        rows = []
        for i, at in enumerate(t):
            k, pull = rates(x, at, surface[i])
            drive = k[3] + G * np.sin(x[2] - x[0])
            c, s = np.cos(x[0]), np.sin(x[0])
            rows.append([*x, pull * c + drive * s, drive * c - pull * s])
            half = 0.5 * (surface[i] + surface[min(i + 1, len(t) - 1)])
            x = x + STEP_S * rates(x + 0.5 * STEP_S * k, at + 0.5 * STEP_S, half)[0]
        alpha, q, theta, speed, height, a_z, a_x = np.array(rows).T
        return Replay(t, alpha, q, theta, a_z, speed, height, a_x)

    def linearise(self, condition: Condition) -> None:
        """Hand nothing out."""

    def close(self) -> None:
        """Do nothing: no process runs."""


def make() -> Nonlinear:
    """Make the simulator, as ``python:module:factory`` calls it."""
    return Nonlinear()


def make_slow() -> Nonlinear:
    """Make the simulator with a servo that lags by a tenth of a second."""
    return Nonlinear(lag_s=0.1)


def _lagging(y: FloatArray, lag_s: float) -> FloatArray:
    out, keep = y.copy(), np.exp(-STEP_S / lag_s) if lag_s > 0.0 else 0.0
    for i in range(1, len(y)):
        out[i] = keep * out[i - 1] + (1.0 - keep) * 0.5 * (y[i - 1] + y[i]) if keep > 0.0 else y[i]
    return out


def _limited(y: FloatArray, step: float, half_play: float) -> FloatArray:
    """Follow a series by at most ``step`` a sample, and only once its play is used up."""
    out = y.copy()
    for i in range(1, len(y)):
        target = min(max(out[i - 1], y[i] - half_play), y[i] + half_play)
        out[i] = out[i - 1] + min(max(target - out[i - 1], -step), step)
    return out


def flown(
    aircraft: Nonlinear = Nonlinear(),
    maneuvers: int = 5,
    reads: Callable[[str, FloatArray], FloatArray] = lambda _, y: y,
) -> list[Maneuver]:
    """Record an aircraft that flies like the simulator, through instruments that read by ``reads``."""
    return [_recorded(aircraft, number, reads) for number in range(maneuvers)]


def _recorded(aircraft: Nonlinear, number: int, reads: Callable[[str, FloatArray], FloatArray]) -> Maneuver:
    rng = np.random.default_rng(number)
    sign, start, unit, lasts = 1.0 - 2.0 * (number % 2), 1.0, 0.35, 9.0
    amplitude = sign * np.radians(2.0 + 0.5 * (number % 3))
    onsets = start + unit * np.array([0.0, 3.0, 5.0, 6.0, 7.0])
    t = np.arange(0.0, lasts, 0.02)
    command = np.zeros(len(t))
    for begin, end, level in zip(onsets[:-1], onsets[1:], (1.0, -1.0, 1.0, -1.0), strict=True):
        command[(t >= begin) & (t < end)] = level * amplitude
    command = np.convolve(command, np.full(3, 1.0 / 3.0), "same")
    middles = (np.arange(round(lasts / 0.005)) + 0.5) * 0.005
    condition = Condition(25.0 + number % 3, 300.0)
    motion = aircraft.replay(condition, Inputs(middles, np.interp(middles, t, command)))
    stamps, zero = t + 0.003, 100.0 + 30.0 * number
    series = {
        "alpha": motion.alpha, "q": motion.q, "theta": motion.theta, "a_z": motion.a_z,
        "a_x": motion.a_x, "airspeed": motion.airspeed_m_s, "height": motion.height_m,
        "altitude": motion.height_m,
    }  # fmt: skip
    channels = {"elevator": Channel("elevator", zero + t, command, "SERVO", "commanded")}
    for name, y in series.items():
        noise = NOISE[name] * rng.standard_normal(len(t))
        provenance = "vane" if name == "alpha" else "measured"
        read = np.interp(stamps, motion.t, reads(name, np.asarray(y)))
        channels[name] = Channel(name, zero + stamps, read + noise, "test", provenance)
    steps = tuple((zero + onset, 0.0) for onset in onsets[:-1])
    span = Span(zero, zero + start, zero + onsets[-1], zero + lasts, "3-2-1-1", steps, "quiet")
    return Maneuver(number + 1, 0, span, channels)
