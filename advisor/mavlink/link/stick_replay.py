"""Recorded sticks of a flight, sent to a simulated vehicle as an override of its receiver.

RC_CHANNELS_OVERRIDE (MAVLink common.xml, 70) replaces the receiver's pulses; 0 releases a channel. An
autopilot accepts an override only from the system id of its ground station. A vehicle must have a parameter
of simulations before anything is sent.
"""

from typing import Any

import numpy as np
from pymavlink.dialects.v20 import ardupilotmega as dialect

from advisor.mavlink.link.outgoing import Ids, Talker
from advisor.mavlink.wire.framing import Frame
from advisor.process.arrays import FloatArray, IntArray

CHANNELS = 4
"""Number of overridden channels: roll, pitch, throttle and yaw in the usual order."""
SIMULATED = ("SIM_SPEEDUP", "SIM_BAT_DRAIN")
"""Parameters that only the simulations of ArduPilot and PX4 have. An autopilot on board lacks these
parameters."""
_STATIONS = ("SYSID_MYGCS", "MAV_GCS_SYSID")
"""Parameters with the id of the ground station whose override ArduPilot accepts."""
_ASK_EVERY_S, _ASK_FOR_S, _SEND_EVERY_S = 0.5, 5.0, 0.02
_RELEASES = 10
"""Number of releasing messages at the end, because messages may be lost."""
_USUAL_STATION = 255


class StickReplay(Talker):
    """Replay of recorded sticks in their own time, after a test whether the vehicle is simulated.

    Parameters
    ----------
    t
        Shape (n,): seconds since the first pulse.
    pulses
        Shape (n, 4): pulse widths of channels 1 to 4, µs.
    """

    def __init__(self, t: FloatArray, pulses: IntArray) -> None:
        self._t, self._pulses = t, pulses
        self._simulated_s: float | None = None
        self._station: int | None = None
        self._asked_s = self._sent_s = float("-inf")
        self._first_asked_s: float | None = None
        self._began_s: float | None = None
        self._released = 0
        self.refused = False
        """Whether the vehicle lacked the parameters of a simulation."""

    @property
    def done(self) -> bool:
        """Whether all pulses were sent and the channels released, or the vehicle was refused."""
        return self.refused or self._released >= _RELEASES

    def source(self, own: Ids, vehicle: Ids) -> Ids:
        """Return the id of the vehicle's own ground station, whose override the vehicle accepts."""
        return self._station or _USUAL_STATION, own[1]

    def hear(self, frame: Frame, now_s: float) -> None:
        """Take the answers to the questions."""
        if frame.message_id != dialect.MAVLINK_MSG_ID_PARAM_VALUE:
            return
        payload = frame.payload.ljust(25, b"\0")
        name = payload[8:24].partition(b"\0")[0].decode("ascii", "replace")
        if name in SIMULATED:
            self._simulated_s = now_s if self._simulated_s is None else self._simulated_s
        elif name in _STATIONS:
            self._station = int(np.frombuffer(payload[:4], "<f4")[0])

    def speak(self, vehicle: Ids | None, now_s: float) -> list[Any]:
        """Return the requests, then the pulses that are due, and finally their release."""
        if vehicle is None or self.done:
            return []
        if self._simulated_s is None:
            return self._asked(vehicle, now_s)
        if self._station is None and now_s - self._simulated_s < _ASK_EVERY_S:
            return []  # the answer with the station's id may be on its way
        if self._began_s is None:
            self._began_s = now_s
        if now_s - self._sent_s < _SEND_EVERY_S:
            return []
        self._sent_s = now_s
        at = now_s - self._began_s
        if at > self._t[-1]:
            self._released += 1
            return [_override(vehicle, [0] * CHANNELS)]
        row = max(int(np.searchsorted(self._t, at, side="right")) - 1, 0)
        return [_override(vehicle, self._pulses[row].tolist())]

    def leave(self, now_s: float) -> list[Any] | None:
        """Return nothing, because the vehicle releases an override that ends."""
        return None

    def _asked(self, vehicle: Ids, now_s: float) -> list[Any]:
        if self._first_asked_s is None:
            self._first_asked_s = now_s
        if now_s - self._first_asked_s > _ASK_FOR_S:
            self.refused = True
            return []
        if now_s - self._asked_s < _ASK_EVERY_S:
            return []
        self._asked_s = now_s
        return [
            dialect.MAVLink_param_request_read_message(*vehicle, name.encode(), -1)
            for name in (*SIMULATED, *_STATIONS)
        ]


def _override(vehicle: Ids, pulses: list[int]) -> Any:
    unused = [0xFFFF] * (8 - CHANNELS)
    return dialect.MAVLink_rc_channels_override_message(*vehicle, *pulses, *unused)
