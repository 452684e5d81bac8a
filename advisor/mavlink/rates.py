"""Asking the vehicle for message rates, and looking at what it then delivers."""

import struct
from collections import Counter
from collections.abc import Mapping
from typing import Any

from pymavlink.dialects.v20 import ardupilotmega as dialect

from advisor.mavlink.definitions import DEFINITIONS
from advisor.mavlink.framing import Frame

STREAMS = ("ATTITUDE", "AOA_SSA", "SERVO_OUTPUT_RAW", "RAW_IMU", "VFR_HUD", "GLOBAL_POSITION_INT")
"""What identification lives on, the indispensable first."""

ANSWER_WITHIN_S = 1.0
MOST_TRIES = 5
MEASURE_S = 3.0
ASK_AGAIN_AFTER_S = 60.0
ENOUGH = 0.6
"""Share of the requested rate below which a stream counts as fallen."""

_COMMAND_ACK = dialect.MAVLINK_MSG_ID_COMMAND_ACK
_SET_INTERVAL = dialect.MAV_CMD_SET_MESSAGE_INTERVAL
_NAMES = {definition.id: name for name, definition in DEFINITIONS.items()}
_ANSWERS = {
    dialect.MAV_RESULT_ACCEPTED: "granted",
    dialect.MAV_RESULT_DENIED: "denied",
    dialect.MAV_RESULT_UNSUPPORTED: "unsupported",
    dialect.MAV_RESULT_FAILED: "failed",
}


class RateRequest:
    """Asks for one rate after the other, waits for each answer, then measures what comes.

    MAVLink, command protocol: SET_MESSAGE_INTERVAL (511) in a COMMAND_LONG, answered by a
    COMMAND_ACK that does not say which message it is about, so only one is asked at a time;
    an unanswered one is sent again with its confirmation counted up. Rates are watched
    afterwards: a reboot or a second ground station can take them away in flight; then they
    are asked for again, at most once a minute.

    Parameters
    ----------
    rates_hz
        Message name to wanted rate in Hz.
    """

    def __init__(self, rates_hz: Mapping[str, float]) -> None:
        self._wanted = {DEFINITIONS[name].id: rate for name, rate in rates_hz.items()}
        self._to_ask = list(self._wanted)
        self._tries = 0
        self._asked_s = float("-inf")
        self._began_s = float("-inf")
        self._measured_since_s: float | None = None
        self._counts: Counter[int] = Counter()
        self._said: list[str] = []
        self.answers: dict[str, str] = {}
        """Message name to ``granted``, ``denied``, ``unsupported``, ``failed`` or ``no answer``."""
        self.delivered_hz: dict[str, float] = {}
        """Message name to the rate found over the last ``MEASURE_S``."""

    def hear(self, frame: Frame, now_s: float) -> None:
        """Count what was asked for; take the answer that is waited for."""
        if frame.message_id in self._wanted:
            self._counts[frame.message_id] += 1
        elif frame.message_id == _COMMAND_ACK and self._to_ask and self._tries:
            command, result = struct.unpack("<HB", frame.payload.ljust(3, b"\0")[:3])
            if command == _SET_INTERVAL and result in _ANSWERS:
                self._settle(_ANSWERS[result])

    def speak(self, vehicle: tuple[int, int] | None, now_s: float) -> list[Any]:
        """The request that is due, if one is."""
        if vehicle is None:
            return []
        if not self._to_ask:
            self._measure(now_s)
        elif now_s - self._asked_s >= ANSWER_WITHIN_S or not self._tries:
            if self._tries == MOST_TRIES:
                self._settle("no answer")
            if self._to_ask:
                return [self._request(vehicle, now_s)]
        return []

    def report(self) -> list[str]:
        """Answers and delivered rates, once."""
        said, self._said = self._said, []
        return said

    def _request(self, vehicle: tuple[int, int], now_s: float) -> Any:
        message = self._to_ask[0]
        if not self._tries:
            self._began_s = now_s
        self._tries += 1
        self._asked_s = now_s
        return dialect.MAVLink_command_long_message(
            *vehicle, _SET_INTERVAL, self._tries - 1, message, 1e6 / self._wanted[message], 0, 0, 0, 0, 0
        )

    def _settle(self, answer: str) -> None:
        name = _NAMES[self._to_ask.pop(0)]
        self._tries = 0
        self._measured_since_s = None
        self.answers[name] = answer
        if answer == "no answer":
            self._said.append(
                f"{name}: no answer to {MOST_TRIES} requests for its rate; an autopilot told to obey one "
                "ground station only (SYSID_ENFORCE, MAV_OPTIONS) obeys the system id in SYSID_MYGCS "
                "(MAV_GCS_SYSID)"
            )
        elif answer != "granted":
            self._said.append(f"{name}: the vehicle answers '{answer}' to the request for its rate")

    def _measure(self, now_s: float) -> None:
        if self._measured_since_s is None:
            self._measured_since_s = now_s
            self._counts.clear()
            return
        elapsed_s = now_s - self._measured_since_s
        if elapsed_s < MEASURE_S:
            return
        first = not self.delivered_hz
        self.delivered_hz = {_NAMES[m]: self._counts[m] / elapsed_s for m in self._wanted}
        if first:
            self._said.append("delivered: " + self._table(self._wanted))
        fallen = [
            message
            for message, rate in self._wanted.items()
            if self.answers[_NAMES[message]] == "granted"
            and self._counts[message] / elapsed_s < ENOUGH * rate
        ]
        silent = not self._counts
        if fallen and not silent and not first and now_s - self._began_s >= ASK_AGAIN_AFTER_S:
            self._said.append(
                "rates fell (a reboot, or another ground station), asked for again: " + self._table(fallen)
            )
            self._to_ask = list(fallen)
        self._measured_since_s = now_s
        self._counts.clear()

    def _table(self, messages: Any) -> str:
        return ", ".join(
            f"{_NAMES[m]} {self.delivered_hz[_NAMES[m]]:.1f} Hz of {self._wanted[m]:g} asked"
            for m in messages
        )
