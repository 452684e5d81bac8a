"""Quantities of a table as the messages that a vehicle with these motions would have sent."""

from collections.abc import Iterator, Mapping
from dataclasses import replace
from math import degrees

import numpy as np
from numpy.typing import ArrayLike

from advisor.aircraft.aircraft import Aircraft
from advisor.flight.signals.messages import Columns
from advisor.mavlink.records.equivalent import MAV_TYPE_FIXED_WING, message
from advisor.process.arrays import FloatArray

_CENTRE_US, _US_PER_DEG = 1500.0, 10.0
"""Pulse width at zero deflection, and its change per degree, of an arbitrary calibration that is inverted
later."""
_SYSTEM, _ARDUPILOT, _ARMED_MANUAL = 1, 3, 128
_ORDERS = 8
"""Number of messages of one row, which arrive one after another."""
_OUTPUTS = {"elevator": 1, "aileron": 2, "rudder": 3}
"""Servo output that carries each surface of a table."""
SURFACES = tuple(_OUTPUTS)
"""Surfaces of a table by their keys in the section ``columns``."""
_LATEST_BOOT_S = 1e6
"""Latest first time that counts as a time since power-on, s. Later ones are dates."""


def with_outputs(aircraft: Aircraft, surfaces: tuple[str, ...] = ("elevator",)) -> Aircraft:
    """Return the aircraft with the surfaces of a table as outputs, and with the table's angles.

    Stops, lag, delay, and places of the instruments stay as the aircraft file states them. A source of the
    angle of attack or of the sideslip other than ``auto`` stays, too.
    """
    given = {name: getattr(aircraft, name) for name in surfaces}
    controls = {
        name: replace(control, output=_OUTPUTS[name], calibration=_scaled(control.ends_deg or (-90.0, 90.0)))
        for name, control in given.items()
    }
    if "elevator" in controls:
        controls["elevator"] = replace(controls["elevator"], outputs=())
    own = {"auto", "aoa_ssa"}
    alpha, beta = aircraft.alpha, aircraft.beta
    return replace(
        aircraft,
        **controls,
        alpha=replace(alpha, source="named_value:alpha") if alpha.source in own else alpha,
        beta=replace(beta, source="named_value:beta") if beta.source in own else beta,
    )


def _scaled(ends_deg: tuple[float, float]) -> tuple[tuple[float, float], ...]:
    return tuple((_CENTRE_US + _US_PER_DEG * deg, deg) for deg in ends_deg)


def messages_of(given: Mapping[str, FloatArray], as_stamped: bool) -> Iterator[Columns]:
    """Yield the messages of a table's quantities (SI).

    Parameters
    ----------
    as_stamped
        Whether times stay unchanged, unless they are dates. Otherwise the first time becomes 0.
    """
    begins = float(given["time"][0])
    t = given["time"] - (0.0 if as_stamped and 0.0 <= begins <= _LATEST_BOOT_S else begins)
    milliseconds, microseconds = 1e3 * t, 1e6 * t
    rows = np.arange(len(t), dtype=np.int64) * _ORDERS
    nothing = np.full(len(t), np.nan)

    def of(name: str, place: int, values: Mapping[str, ArrayLike], which: slice = slice(None)) -> Columns:
        cut = {key: np.asarray(y)[which] if np.ndim(y) else y for key, y in values.items()}
        return message(name, _SYSTEM, rows[which] + place, t[which], cut, "table")

    def get(name: str) -> FloatArray:
        return given.get(name, nothing)

    every_second = slice(None, None, max(round(1.0 / float(np.median(np.diff(t)))), 1))
    heart = {"type": MAV_TYPE_FIXED_WING, "autopilot": _ARDUPILOT, "base_mode": _ARMED_MANUAL}
    yield of("HEARTBEAT", 0, heart, every_second)
    yield of("ATTITUDE", 1, {
        "time_boot_ms": milliseconds, "pitchspeed": get("q"), "pitch": get("theta"), "roll": get("bank"),
        "rollspeed": get("p"), "yawspeed": get("r"),
    })  # fmt: skip
    for place, angle in ((2, "alpha"), (6, "beta")):
        if angle in given:
            names = np.full(len(t), angle.encode(), dtype="S10")
            values = {"time_boot_ms": milliseconds, "value": given[angle], "name": names}
            yield of("NAMED_VALUE_FLOAT", place, values)
    if given.keys() & {"a_z", "a_y"}:
        force = {"xacc": get("a_x"), "yacc": get("a_y"), "zacc": get("a_z")}
        yield of("HIGHRES_IMU", 3, {"time_usec": microseconds, **force})
    speeds = {"true_airspeed": "airspeed", "airspeed": "indicated_airspeed", "climb": "climb_rate"}
    air = {field: given[name] for field, name in speeds.items() if name in given}
    throttle, height = 100.0 * get("throttle"), get("height")
    yield of("VFR_HUD", 4, {"time_usec": microseconds, **air, "throttle": throttle, "alt": height})
    pulses = {
        f"servo{output}_raw": _CENTRE_US + _US_PER_DEG * degrees(1.0) * given[name]
        for name, output in _OUTPUTS.items()
        if name in given
    }
    yield of("SERVO_OUTPUT_RAW", 5, {"time_usec": microseconds, **pulses})
