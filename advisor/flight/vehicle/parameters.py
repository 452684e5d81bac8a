"""Parameters stated by vehicles and ground stations, each decoded as its autopilot encodes it."""

from collections.abc import Iterator, Sequence
from math import isfinite

import numpy as np

from advisor.flight.signals.messages import Columns
from advisor.flight.vehicle import ardupilot_wiring, imu_filters, px4_wiring
from advisor.flight.vehicle.wiring import Wiring

_INTEGERS = frozenset(range(1, 7))
"""Values of MAV_PARAM_TYPE that are integers of up to 32 bits."""
_PREFIXES = (*ardupilot_wiring.PREFIXES, *px4_wiring.PREFIXES, *imu_filters.PREFIXES)

AIRSPEED_SENSOR = ("ARSPD_TYPE", "ARSPD_USE")
"""ArduPilot's parameters of its air speed sensor: its kind, and its use. 0 means none."""
LOG_PROFILE = "SDLOG_PROFILE"
"""PX4's parameter of the topics that its log holds."""

Sender = tuple[int, int]
"""System id and component id of a sender."""
Stated = tuple[float, float]
"""A value in both readings: integers converted to floating point, and integers put there byte by byte."""


def tells_of_outputs(name: str) -> bool:
    """Return whether a parameter describes servo outputs, filters, an air speed sensor, or a log's
    topics."""
    return name.startswith(_PREFIXES) or name in AIRSPEED_SENSOR or name == LOG_PROFILE


def names_in(columns: Columns) -> list[str]:
    """Return the names of the parameters in PARAM_VALUE messages."""
    return [raw.rstrip(b"\0").decode("ascii", "replace") for raw in columns.fields["param_id"].tolist()]


def read_by(autopilot: str, stated: Stated) -> float:
    """Return the value by this autopilot's encoding."""
    return stated[autopilot == "px4"]


class Parameters:
    """Keeps the parameters that describe the servo outputs and the filters of the inertial sensors.

    PARAM_VALUE carries every value in a field of floating point. ArduPilot converts integers to floating
    point; PX4 puts their bytes there (MAVLink's parameter protocol, "C cast" and "bytewise").
    """

    def __init__(self) -> None:
        self._known: dict[Sender, dict[str, Stated]] = {}

    def news(self, columns: Columns) -> Iterator[tuple[str, Stated | None, Stated]]:
        """Yield name, earlier value and new value of each parameter that changes the known values."""
        cast = np.asarray(columns.fields["param_value"])
        kinds = np.broadcast_to(columns.fields.get("param_type", np.zeros(len(cast))), cast.shape)
        bytewise = cast.astype(np.float32).view(np.int32)
        for name, kind, value, whole in zip(names_in(columns), kinds, cast, bytewise, strict=True):
            stated = float(value), float(whole) if int(kind) in _INTEGERS else float(value)
            before = self._known.get((columns.system, columns.component), {}).get(name)
            if tells_of_outputs(name) and before != stated:
                yield name, before, stated

    def keep(self, sender: Sender, name: str, stated: Stated | None) -> None:
        """Keep a value as the sender's present one; None: as if none had been heard."""
        known = self._known.setdefault(sender, {})
        if stated is None:
            known.pop(name, None)
        else:
            known[name] = stated

    def stated(self, senders: Sequence[Sender], autopilot: str) -> dict[str, float]:
        """Return the known values of these senders by name. The last sender overrides."""
        return {
            name: value
            for sender in senders
            for name, values in self._known.get(sender, {}).items()
            if isfinite(value := read_by(autopilot, values))
        }

    def wiring(self, senders: Sequence[Sender], autopilot: str) -> Wiring:
        """Return the roles and scales of the outputs by these senders' parameters. The last sender overrides.

        Parameters
        ----------
        senders
            Systems and components that state the vehicle's parameters.
        autopilot
            Name of the autopilot in the vehicle's identity.
        """
        stated = self.stated(senders, autopilot)
        find = px4_wiring.px4_wiring if autopilot == "px4" else ardupilot_wiring.ardupilot_wiring
        return find(stated)
