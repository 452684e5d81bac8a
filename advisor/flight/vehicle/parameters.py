"""Parameters stated by vehicles and ground stations, each decoded as its autopilot encodes it.

A filter without a stated parameter is unknown. The delay of an unknown filter is part of the estimated delays
of command and angle of attack.

Below its cut-off f a second-order Butterworth low-pass delays every motion by √2/(2πf): 11 ms at 20 Hz. A
notch of width b at f adds b/(2πf²). The short period is far below both filter frequencies.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from math import isfinite, pi, sqrt

import numpy as np

from advisor.flight.signals.messages import Columns
from advisor.flight.vehicle import ardupilot_wiring, px4_wiring
from advisor.flight.vehicle.surfaces import Wiring

_INTEGERS = frozenset(range(1, 7))
"""Values of MAV_PARAM_TYPE that are integers of up to 32 bits."""
_FILTERS = ("INS_GYRO_FILTER", "INS_ACCEL_FILTER", "INS_HNTCH_", "IMU_GYRO_CUTOFF", "IMU_ACCEL_CUTOFF")
"""Beginnings of the names of the filters' parameters."""
_PREFIXES = (*ardupilot_wiring.PREFIXES, *px4_wiring.PREFIXES, *_FILTERS)

AIRSPEED_SENSOR = ("ARSPD_TYPE", "ARSPD_USE")
"""ArduPilot's parameters of its air speed sensor: type and use, where 0 means none."""
LOG_PROFILE = "SDLOG_PROFILE"
"""PX4's parameter of the topics that its log holds."""

Sender = tuple[int, int]
"""System id and component id of a sender."""
Stated = tuple[float, float]
"""A parameter value in both encodings: integers converted to floating point, and integers copied byte by
byte."""


def tells_of_outputs(name: str) -> bool:
    """Return whether a parameter describes servo outputs, filters, air speed, or a log's topics."""
    return name.startswith(_PREFIXES) or name in AIRSPEED_SENSOR or name == LOG_PROFILE


def names_in(columns: Columns) -> list[str]:
    """Return the names of the parameters in PARAM_VALUE messages."""
    return [raw.rstrip(b"\0").decode("ascii", "replace") for raw in columns.fields["param_id"].tolist()]


def read_by(autopilot: str, stated: Stated) -> float:
    """Return the value in this autopilot's encoding."""
    return stated[autopilot == "px4"]


class Parameters:
    """Parameters of the servo outputs and of the inertial sensors' filters.

    PARAM_VALUE carries every value in a floating-point field. ArduPilot converts integers to floating point;
    PX4 copies their bytes ("C cast" and "bytewise" in MAVLink).

    Parameters
    ----------
    wanted
        Function that returns whether the parameter of a name is kept.
    """

    def __init__(self, wanted: Callable[[str], bool] = tells_of_outputs) -> None:
        self._wanted = wanted
        self._known: dict[Sender, dict[str, Stated]] = {}
        self._wired: dict[tuple[object, ...], Wiring] = {}

    def news(self, columns: Columns) -> Iterator[tuple[str, Stated | None, Stated]]:
        """Yield name, earlier value and new value of each parameter that changes."""
        cast = np.asarray(columns.fields["param_value"])
        kinds = np.broadcast_to(columns.fields.get("param_type", np.zeros(len(cast))), cast.shape)
        bytewise = cast.astype(np.float32).view(np.int32)
        for name, kind, value, whole in zip(names_in(columns), kinds, cast, bytewise, strict=True):
            stated = float(value), float(whole) if int(kind) in _INTEGERS else float(value)
            before = self._known.get((columns.system, columns.component), {}).get(name)
            if self._wanted(name) and before != stated:
                yield name, before, stated

    def keep(self, sender: Sender, name: str, stated: Stated | None) -> None:
        """Store a value as the sender's present one; None removes it."""
        values = self._known.setdefault(sender, {})
        self._wired.clear()
        if stated is None:
            values.pop(name, None)
        else:
            values[name] = stated

    def stated(self, senders: Sequence[Sender], autopilot: str) -> dict[str, float]:
        """Return the known parameters of the given senders, by name. The last sender overrides earlier
        ones."""
        return {
            name: value
            for sender in senders
            for name, values in self._known.get(sender, {}).items()
            if isfinite(value := read_by(autopilot, values))
        }

    def wiring(self, senders: Sequence[Sender], autopilot: str) -> Wiring:
        """Return the roles and scales of the outputs from these senders' parameters. The last sender
        overrides earlier ones.
        """
        asked = (*senders, autopilot)
        if asked not in self._wired:
            find = px4_wiring.px4_wiring if autopilot == "px4" else ardupilot_wiring.ardupilot_wiring
            self._wired[asked] = find(self.stated(senders, autopilot))
        return self._wired[asked]


_RATES = ("p", "q", "r")
_FORCES = ("a_x", "a_y", "a_z")
_UNFILTERED_ON_PX4 = "HIGHRES_IMU"
"""Message of PX4 from the sensors' integrals, without a filter."""


def filter_delay_s(channel: str, source: str, autopilot: str, stated: Mapping[str, float]) -> float:
    """Return the known delay of a channel due to the autopilot's filters, s; 0 if unknown."""
    if channel not in _RATES + _FORCES:
        return 0.0
    if autopilot == "px4":
        if source.startswith(_UNFILTERED_ON_PX4):
            return 0.0
        cutoff = stated.get("IMU_GYRO_CUTOFF" if channel in _RATES else "IMU_ACCEL_CUTOFF", 0.0)
        return _low_pass_s(cutoff)
    if autopilot != "ardupilot":
        return 0.0
    if channel in _FORCES:
        return _low_pass_s(stated.get("INS_ACCEL_FILTER", 0.0))
    return _low_pass_s(stated.get("INS_GYRO_FILTER", 0.0)) + _notch_s(stated)


def _low_pass_s(cutoff_hz: float) -> float:
    """Return the delay of a second-order Butterworth filter, s; a cut-off of 0 means no filter."""
    return sqrt(2.0) / (2.0 * pi * cutoff_hz) if cutoff_hz > 0.0 else 0.0


def _notch_s(stated: Mapping[str, float]) -> float:
    """Return the delay of ArduPilot's first harmonic notch, s."""
    centre, width = stated.get("INS_HNTCH_FREQ", 0.0), stated.get("INS_HNTCH_BW", 0.0)
    if not stated.get("INS_HNTCH_ENABLE", 0.0) or centre <= 0.0:
        return 0.0
    return width / (2.0 * pi * centre**2)
