"""The log of a flight: 50 Hz by an ArduPlane, with a vane or with the autopilot's own angle of attack."""

from collections.abc import Iterator

import numpy as np
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from advisor.flight.signals.track import standard_pressure
from benchmarks.sealed.tlog import STANDARD_GRAVITY, Timed, int16, microseconds, milliseconds, packed

from .body import Body
from .flight import Flown
from .motion import HEIGHT_M, STEP_S, Floats

RATE_HZ = 50.0
OUTPUTS = (2, 1, 4)
"""Servo outputs of elevator, aileron and rudder."""
NOISE = {"alpha": 0.003, "beta": 0.003, "rate": 0.003, "angle": 0.002, "force": 0.06, "airspeed": 0.2}
"""Standard deviation of the noise of each kind of channel, SI."""
DERIVED_S, RENEWED_HZ = 0.03, 20.0
"""Lateness and renewal of an autopilot's angle of attack."""
FLY_BY_WIRE = 5
"""Mode of ArduPlane in which the script calls its inputs."""
BOOT_S = 5.0
_PARAMETERS = {
    f"SERVO{n}_{name}": value
    for n, function in ((1, 4.0), (2, 19.0), (3, 70.0), (4, 21.0))
    for name, value in (
        ("FUNCTION", function), ("MIN", 1100.0), ("TRIM", 1500.0), ("MAX", 1900.0), ("REVERSED", 0.0)
    )
} | {"INS_GYRO_FILTER": 0.0, "INS_ACCEL_FILTER": 0.0}  # fmt: skip


def tlog_of(flown: Flown, body: Body, vane: bool, rng: np.random.Generator, mode: int = FLY_BY_WIRE) -> bytes:
    """Return the log, with angles of the air from a vane, or as an autopilot derives them."""
    end_s = float(flown.t[-1])
    times = {
        name: rng.uniform(0.0, 1.0 / RATE_HZ) + np.arange(0.0, end_s - 0.1, 1.0 / RATE_HZ) for name in "aisv"
    }
    timed = [
        (BOOT_S + k, mavlink.MAVLink_heartbeat_message(1, 3, 81, mode, 4, 3)) for k in range(int(end_s) + 1)
    ]
    for k, (name, value) in enumerate(_PARAMETERS.items()):
        message = mavlink.MAVLink_param_value_message(name.encode(), value, 9, len(_PARAMETERS), k)
        timed.append((BOOT_S + 0.01 + 0.005 * k, message))
    timed += [(BOOT_S + t, mavlink.MAVLink_statustext_message(5, text.encode())) for t, text in flown.marks]
    timed += _fast(flown, times, rng)
    timed += _air(flown, times["v"], vane, rng)
    timed += _slow(flown, body, rng)
    return packed(timed)


def _at(flown: Flown, t: Floats, columns: Floats) -> Floats:
    return np.array([np.interp(t, flown.t, column) for column in columns.T]).T


def _noisy(values: Floats, kind: str, rng: np.random.Generator) -> list[list[float]]:
    return np.asarray(values + NOISE[kind] * rng.standard_normal(values.shape)).tolist()  # type: ignore[no-any-return]


def _fast(flown: Flown, times: dict[str, Floats], rng: np.random.Generator) -> Iterator[Timed]:
    """Yield attitude, inertial sensors and servo outputs."""
    rates, angles = (_at(flown, times["a"], flown.state[:, columns]) for columns in ([3, 4, 5], [6, 7]))
    rows = zip(times["a"].tolist(), _noisy(rates, "rate", rng), _noisy(angles, "angle", rng), strict=True)
    for t, rate, (phi, theta) in rows:
        sent = BOOT_S + t
        yield sent, mavlink.MAVLink_attitude_message(milliseconds(sent), phi, theta, 0.0, *rate)
    forces, rates = _at(flown, times["i"], flown.felt), _at(flown, times["i"], flown.state[:, 3:6])
    rows = zip(times["i"].tolist(), _noisy(forces, "force", rng), _noisy(rates, "rate", rng), strict=True)
    for t, force, rate in rows:
        felt = [int16(1e3 / STANDARD_GRAVITY * value) for value in force]
        turned = [int16(1e3 * value) for value in rate]
        yield (
            BOOT_S + t,
            mavlink.MAVLink_raw_imu_message(microseconds(BOOT_S + t), *felt, *turned, 200, 0, 400),
        )
    for t in times["s"].tolist():
        widths = [1500] * 8 + [0] * 8
        for output, us in zip(OUTPUTS, flown.pulses[int(t / STEP_S)], strict=True):
            widths[output - 1] = int(us)
        stamp = microseconds(BOOT_S + t) & 0xFFFFFFFF
        yield BOOT_S + t, mavlink.MAVLink_servo_output_raw_message(stamp, 0, *widths)


def _air(flown: Flown, t: Floats, vane: bool, rng: np.random.Generator) -> Iterator[Timed]:
    """Yield the angles of attack and sideslip."""
    u, v, w = flown.state[:, :3].T
    angles = np.column_stack([np.arctan2(w, u), np.arcsin(v / np.sqrt(u**2 + v**2 + w**2))])
    seen = t if vane else np.maximum(np.floor(t * RENEWED_HZ) / RENEWED_HZ - DERIVED_S, 0.0)
    read = _at(flown, seen, angles)
    if vane:
        noisy = np.asarray(_noisy(read, "alpha", rng))
        for stamp, (alpha, beta) in zip(t.tolist(), noisy.tolist(), strict=True):
            sent = BOOT_S + stamp
            for name, value in ((b"alpha", alpha), (b"beta", beta)):
                yield sent, mavlink.MAVLink_named_value_float_message(milliseconds(sent), name, value)
        return
    for stamp, (alpha, beta) in zip(t.tolist(), np.degrees(read).tolist(), strict=True):
        sent = BOOT_S + stamp
        yield sent, mavlink.MAVLink_aoa_ssa_message(microseconds(sent), alpha, beta)


def _slow(flown: Flown, body: Body, rng: np.random.Generator) -> Iterator[Timed]:
    """Yield air speed, height and static pressure ten times a second."""
    share = np.sqrt(body.density / 1.225)
    ground = body.pitching.elevation_m
    t = np.arange(0.05, flown.t[-1] - 0.1, 0.1)
    state = _at(flown, t, flown.state)
    speed = np.sqrt(np.sum(state[:, :3] ** 2, axis=1))
    read = share * speed + NOISE["airspeed"] * rng.standard_normal(len(t))
    # The density is that of one height at every height.
    pressure = float(standard_pressure(ground + HEIGHT_M)) / 100.0
    for stamp, airspeed, true, height in zip(
        t.tolist(), read.tolist(), speed.tolist(), state[:, 8].tolist(), strict=True
    ):
        sent = BOOT_S + stamp
        yield sent, mavlink.MAVLink_vfr_hud_message(airspeed, true, 0, 40, ground + height, 0.0)
        yield sent, mavlink.MAVLink_scaled_pressure_message(milliseconds(sent), pressure, 0.0, 1500)
        yield sent, mavlink.MAVLink_global_position_int_message(
            milliseconds(sent), 473_000_000, 85_000_000, round(1e3 * (ground + height)), round(1e3 * height),
            int16(100.0 * true), 0, 0, 0,
        )  # fmt: skip
