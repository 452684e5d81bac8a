"""Asking the vehicle what its outputs are and which firmware it runs."""

import struct
from typing import Any

from pymavlink.dialects.v20 import ardupilotmega as dialect

from advisor.mavlink.framing import Frame
from advisor.mavlink.outgoing import Talker

OUTPUTS = range(1, 17)
PITCH_FUNCTIONS = (19, 77, 78, 79, 80, 16, 17, 86, 87)
"""SERVOn_FUNCTION of elevator, left and right elevon, left and right V-tail, differential spoilers."""

STREAM_GROUPS = ("EXTRA1", "RAW_SENS", "RC_CHAN", "EXTRA2")
RENAMED = {
    "SYSID_MYGCS": "MAV_GCS_SYSID",
    **{f"SR0_{group}": f"MAV1_{group}" for group in STREAM_GROUPS},
}
"""Names up to ArduPilot 4.6 to names after it; a vehicle has one or the other, so both are asked for."""

ANSWER_WITHIN_S = 1.0
MOST_TRIES = 3
AT_ONCE = 10

_PARAM_VALUE = dialect.MAVLINK_MSG_ID_PARAM_VALUE


class Inquiry(Talker):
    """Reads the parameters that say which output is the elevator and how it moves.

    First SERVOn_FUNCTION of every output, the stream rates and the ground station's id in
    both spellings, then MIN, TRIM, MAX and REVERSED of the outputs that pitch. A few
    questions stand at a time; an unanswered one is repeated, then given up: a vehicle does
    not answer for a parameter it does not have. The answers reach the advisor as every
    other message of the link does; here they only decide what to ask next. Another vehicle
    is asked anew.

    Parameters
    ----------
    outputs_only
        Ask for the outputs alone, not for the stream rates, the ground station's id and the firmware.
    """

    def __init__(self, outputs_only: bool = False) -> None:
        self._outputs_only = outputs_only
        self._vehicle: tuple[int, int] | None = None
        self._begin()

    def _begin(self) -> None:
        self._to_ask = [f"SERVO{n}_FUNCTION" for n in OUTPUTS]
        if not self._outputs_only:
            self._to_ask += [name for pair in RENAMED.items() for name in pair]
        self._standing: dict[str, tuple[float, int]] = {}
        self._firmware_asked = self._outputs_only
        self._told = False
        self.parameters: dict[str, float] = {}
        """What was answered."""

    @property
    def done(self) -> bool:
        """Whether every question was answered or given up."""
        return not self._to_ask and not self._standing

    def hear(self, frame: Frame, now_s: float) -> None:
        """Take an answer."""
        if frame.message_id != _PARAM_VALUE:
            return
        payload = frame.payload.ljust(25, b"\0")
        name = payload[8:24].partition(b"\0")[0].decode("ascii", "replace")
        (value,) = struct.unpack_from("<f", payload)
        known = name in self.parameters
        self.parameters[name] = value
        self._standing.pop(name, None)
        if name in self._to_ask:
            self._to_ask.remove(name)
        stem, _, kind = name.rpartition("_")
        if not known and kind == "FUNCTION" and stem.startswith("SERVO") and value in PITCH_FUNCTIONS:
            details = (f"{stem}_{detail}" for detail in ("MIN", "TRIM", "MAX", "REVERSED"))
            self._to_ask += [detail for detail in details if detail not in self.parameters]

    def speak(self, vehicle: tuple[int, int] | None, now_s: float) -> list[Any]:
        """The questions that are due."""
        if vehicle is None:
            return []
        if self._vehicle not in (None, vehicle):
            self._begin()
        self._vehicle = vehicle
        questions = []
        if not self._firmware_asked:
            self._firmware_asked = True
            questions.append(_ask_for_firmware(vehicle))
        for name, (asked_s, tries) in list(self._standing.items()):
            if now_s - asked_s < ANSWER_WITHIN_S:
                continue
            if tries == MOST_TRIES:
                del self._standing[name]
            else:
                self._standing[name] = (now_s, tries + 1)
                questions.append(_ask_for_parameter(vehicle, name))
        while self._to_ask and len(self._standing) < AT_ONCE:
            name = self._to_ask.pop(0)
            self._standing[name] = (now_s, 1)
            questions.append(_ask_for_parameter(vehicle, name))
        return questions

    def report(self) -> list[str]:
        """What was found, once everything was asked."""
        if self._told or not self.done:
            return []
        self._told = True
        if not self.parameters:
            return ["the vehicle was asked for SERVOn_FUNCTION and did not answer"]
        return [f"{len(self.parameters)} parameters of the vehicle heard"]


def _ask_for_parameter(vehicle: tuple[int, int], name: str) -> Any:
    return dialect.MAVLink_param_request_read_message(*vehicle, name.encode(), -1)


def _ask_for_firmware(vehicle: tuple[int, int]) -> Any:
    return dialect.MAVLink_command_long_message(
        *vehicle,
        dialect.MAV_CMD_REQUEST_MESSAGE,
        0,
        dialect.MAVLINK_MSG_ID_AUTOPILOT_VERSION,
        *[0.0] * 6,
    )
