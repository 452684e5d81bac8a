"""Requests to the vehicle: roles and scales of its outputs, and its firmware."""

import struct
from collections.abc import Sequence
from typing import Any

from pymavlink.dialects.v20 import ardupilotmega as dialect

from advisor.mavlink.link.outgoing import Talker
from advisor.mavlink.wire.framing import Frame

ANSWER_WITHIN_S = 1.0
MOST_TRIES = 3
LONGEST_PAUSE_S = 10.0
"""Longest time between two requests for a parameter that the vehicle certainly has, s."""
AT_ONCE = 10

_HEARTBEAT, _PARAM_VALUE = dialect.MAVLINK_MSG_ID_HEARTBEAT, dialect.MAVLINK_MSG_ID_PARAM_VALUE


class Inquiry(Talker):
    """Requests for the parameters that give the elevator's output and its scale.

    ArduPilot's parameters are requested until a heartbeat shows PX4. Only a few requests are open at a time.
    An unanswered request is repeated and finally dropped, because a vehicle does not answer for an unknown
    parameter. Limits of a known output exist, and are requested until they arrive. The answers reach the
    advisor like every other message of the link. Here an answer only determines the next request. If another
    vehicle is followed later, its parameters are requested too.

    Parameters
    ----------
    outputs_only
        Whether only the outputs are requested, without stream rates, the ground station's id and the
        firmware.
    """

    def __init__(self, outputs_only: bool = False) -> None:
        self._outputs_only = outputs_only
        self._vehicle: tuple[int, int] | None = None
        self._begin()

    def _begin(self) -> None:
        self._questions: ArduPilotQuestions | Px4Questions = ArduPilotQuestions()
        self._to_ask = self._first_questions()
        self._standing: dict[str, tuple[float, int]] = {}
        self._existing: set[str] = set()
        self._firmware_asked = self._outputs_only
        self._told = False
        self.parameters: dict[str, float] = {}
        """Received parameters by name."""

    def _first_questions(self) -> list[str]:
        return list(self._questions.outputs if self._outputs_only else self._questions.first)

    @property
    def done(self) -> bool:
        """Whether every request was answered or dropped."""
        return not self._to_ask and all(tries >= MOST_TRIES for _, tries in self._standing.values())

    def hear(self, frame: Frame, now_s: float) -> None:
        """Take an answer to a request, or the autopilot's heartbeat."""
        payload = frame.payload.ljust(25, b"\0")
        if frame.message_id == _HEARTBEAT:
            is_px4 = payload[5] == dialect.MAV_AUTOPILOT_PX4
            if is_px4 and not isinstance(self._questions, Px4Questions):
                self._questions = Px4Questions()
                self._to_ask = [name for name in self._first_questions() if name not in self.parameters]
                self._standing.clear()
        if frame.message_id != _PARAM_VALUE:
            return
        name = payload[8:24].partition(b"\0")[0].decode("ascii", "replace")
        is_new = name not in self.parameters
        value = self.parameters[name] = self._questions.value(payload)
        self._standing.pop(name, None)
        if name in self._to_ask:
            self._to_ask.remove(name)
        if is_new:
            details = self._questions.follow(name, value)
            self._to_ask += [detail for detail in details if detail not in self.parameters]
            self._existing.update(details)

    def speak(self, vehicle: tuple[int, int] | None, now_s: float) -> list[Any]:
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
            exists = name in self._existing
            pause_s = LONGEST_PAUSE_S if exists and tries >= MOST_TRIES else ANSWER_WITHIN_S
            if now_s - asked_s < pause_s:
                continue
            if tries >= MOST_TRIES and not exists:
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
        """Return a sentence about the answers when all requests are finished."""
        if self._told or not self.done:
            return []
        self._told = True
        if not self.parameters:
            return ["the vehicle was asked which output is the elevator and did not answer"]
        return [f"{len(self.parameters)} parameters of the vehicle heard"]


def _ask_for_parameter(vehicle: tuple[int, int], name: str) -> Any:
    return dialect.MAVLink_param_request_read_message(*vehicle, name.encode(), -1)


def _ask_for_firmware(vehicle: tuple[int, int]) -> Any:
    return dialect.MAVLink_command_long_message(
        *vehicle, dialect.MAV_CMD_REQUEST_MESSAGE, 0, dialect.MAVLINK_MSG_ID_AUTOPILOT_VERSION, *[0.0] * 6
    )


OUTPUTS = range(1, 17)
_FUNCTIONS = [f"FUNC{k}" for k in range(1, 9)]
"""Functions of the eight outputs that a bank of PX4 has at most."""
_SERVOS = range(201, 217)
"""Output function numbers of PX4 for servos."""
PITCH_FUNCTIONS = (19, 77, 78, 79, 80, 16, 17, 86, 87)
"""Values of SERVOn_FUNCTION for elevator, elevons, V-tails and differential spoilers."""

STREAM_GROUPS = ("EXTRA1", "RAW_SENS", "RC_CHAN", "EXTRA2")
RENAMED = {"SYSID_MYGCS": "MAV_GCS_SYSID", **{f"SR0_{group}": f"MAV1_{group}" for group in STREAM_GROUPS}}
"""New name of each parameter that ArduPilot 4.6 still had under an old name. A vehicle knows only one of both
names, so both are requested."""


class ArduPilotQuestions:
    """Requests for SERVOn_FUNCTION of every output, the stream rates and the ground station's id."""

    outputs: Sequence[str] = tuple(f"SERVO{n}_FUNCTION" for n in OUTPUTS)
    first: Sequence[str] = (*outputs, *(name for pair in RENAMED.items() for name in pair))

    def value(self, payload: bytes) -> float:
        """Return the value, which ArduPilot sends converted to floating point."""
        return float(struct.unpack_from("<f", payload)[0])

    def follow(self, name: str, value: float) -> list[str]:
        """Return MIN, TRIM, MAX and REVERSED of the outputs that pitch."""
        stem, _, kind = name.rpartition("_")
        if kind != "FUNCTION" or not stem.startswith("SERVO") or value not in PITCH_FUNCTIONS:
            return []
        return [f"{stem}_{detail}" for detail in ("MIN", "TRIM", "MAX", "REVERSED")]


class Px4Questions:
    """Requests for CA_SV_CSn_TYPE of every surface and the functions of the two PWM banks' outputs."""

    outputs: Sequence[str] = (
        "CA_SV_CS_COUNT",
        *(f"CA_SV_CS{n}_TYPE" for n in range(8)),
        *(f"{bank}_{what}" for bank in ("PWM_MAIN", "PWM_AUX") for what in ("REV", *_FUNCTIONS)),
    )
    first = outputs

    def value(self, payload: bytes) -> float:
        """Return the value, which PX4 sends as bytes of an integer."""
        is_float = payload[24] == dialect.MAV_PARAM_TYPE_REAL32
        return float(struct.unpack_from("<f" if is_float else "<i", payload)[0])

    def follow(self, name: str, value: float) -> list[str]:
        """Return the torque in pitch of every surface, and the limits of the outputs that drive one."""
        if name.startswith("CA_SV_CS") and name.endswith("_TYPE") and value:
            return [f"{name.removesuffix('_TYPE')}_TRQ_P"]
        bank, _, number = name.partition("_FUNC")
        return [f"{bank}_{end}{number}" for end in ("MIN", "MAX")] if number and value in _SERVOS else []
