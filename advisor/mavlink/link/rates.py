"""Requests for message rates, and a watch on the delivered rates."""

import struct
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

from pymavlink.dialects.v20 import ardupilotmega as dialect

from advisor.mavlink.link.intake import is_ground_station, who_sets_rates
from advisor.mavlink.link.link_watch import Delivery, RebootWatch
from advisor.mavlink.link.outgoing import Talker
from advisor.mavlink.wire.definitions import DEFINITIONS
from advisor.mavlink.wire.framing import Frame

MOST_TRIES = 5
"""Number of requests in the first round, one for each second without an answer. Later rounds have one
request."""
SHORTEST_REST_S, LONGEST_REST_S = 5.0, 60.0
"""Rest after an unsuccessful round, s, doubled with each round up to the second value. The requests for a
message never end."""
AT_ONCE = 3
"""Number of falls of a granted rate that are answered by an immediate request. After this number of requests
another station is allowed to set the rate."""
HELD_S = 60.0
"""Time for which a rate must hold before its falls are counted anew, s."""


@dataclass(slots=True)
class MessageRequest:
    """State of the request for one message."""

    name: str
    message: int
    rate_hz: float
    answer: str = ""
    """Last answer: ``granted``, ``denied``, ``unsupported``, ``failed``, ``rejected for now`` or ``no
    answer``."""
    due_s: float = float("-inf")
    """Time of the next request, s; infinite if no request is needed."""
    tries: int = 0
    rounds: int = 0
    """Number of successive unsuccessful rounds, or of falls of a granted rate."""
    held_since_s: float = float("inf")

    def begin(self) -> None:
        """Reset the request for a vehicle without earlier requests."""
        self.answer, self.due_s, self.tries, self.rounds = "", float("-inf"), 0, 0
        self.held_since_s = float("inf")

    @property
    def is_exhausted(self) -> bool:
        """Whether the round has used its requests."""
        return self.tries >= (1 if self.rounds else MOST_TRIES)

    def settle(self, answer: str, now_s: float) -> None:
        self.answer, self.tries = answer, 0
        if answer == "granted":
            self.due_s = float("inf")
        else:
            self._rest(now_s, self.rounds)

    def fell(self, now_s: float) -> bool:
        """Record the fall of a granted rate, and return whether the rate is requested again at once."""
        self.held_since_s = float("inf")
        if self.rounds < AT_ONCE:
            self.due_s, self.rounds = now_s, self.rounds + 1
            return True
        self._rest(now_s, self.rounds - AT_ONCE)
        return False

    def held(self, now_s: float) -> None:
        """Note that a granted rate is delivered."""
        self.held_since_s = min(self.held_since_s, now_s)
        if now_s - self.held_since_s >= HELD_S:
            self.rounds = 0

    def _rest(self, now_s: float, doubled: int) -> None:
        self.due_s = now_s + min(LONGEST_REST_S, SHORTEST_REST_S * 2.0 ** min(doubled, 10))
        self.rounds += 1


STREAMS = ("ATTITUDE", "AOA_SSA", "SERVO_OUTPUT_RAW", "RAW_IMU", "VFR_HUD", "GLOBAL_POSITION_INT")
"""Messages that identification needs, the indispensable ones first."""

ANSWER_WITHIN_S = 1.0
MEASURE_S = 3.0
ENOUGH = 0.6
"""Share of the requested rate below which a stream counts as slowed down."""
SHORTEST_LIFE_S = 10.0
"""Least time between two reboots, s. Two senders with one system id would seem to reboot alternately."""
PUT_BACK_AGAIN_S = 0.2
"""Time for the vehicle's answers before rates are restored again, s."""
MOST_PUT_BACK = 3

_COMMAND_ACK = dialect.MAVLINK_MSG_ID_COMMAND_ACK
_SET_INTERVAL = dialect.MAV_CMD_SET_MESSAGE_INTERVAL
_ANSWERS = {
    dialect.MAV_RESULT_ACCEPTED: "granted",
    dialect.MAV_RESULT_TEMPORARILY_REJECTED: "rejected for now",
    dialect.MAV_RESULT_DENIED: "denied",
    dialect.MAV_RESULT_UNSUPPORTED: "unsupported",
    dialect.MAV_RESULT_FAILED: "failed",
}


class RateRequest(Talker):
    """Requests for message rates, one after another, with a watch on the delivered rates.

    MAVLink, command protocol: SET_MESSAGE_INTERVAL (511) in a COMMAND_LONG is answered by a COMMAND_ACK that
    names no message. Therefore only one request is open at a time. An unanswered request is repeated with a
    higher confirmation count. A refused or unanswered request is repeated after a rest that doubles, see
    `advisor.mavlink.link.rates`. After a reboot all rates are requested again. A granted rate that
    falls is requested again a few times at once, then after rests. At the end every message gets its default
    rate back.

    Parameters
    ----------
    rates_hz
        Requested rate of each message, Hz, by the message's name.
    """

    def __init__(self, rates_hz: Mapping[str, float]) -> None:
        self._requests = {
            DEFINITIONS[n].id: MessageRequest(n, DEFINITIONS[n].id, hz) for n, hz in rates_hz.items()
        }
        self._standing: MessageRequest | None = None
        self._asked_s = self._began_s = float("-inf")
        self._vehicle: tuple[int, int] | None = None
        self._reboots = RebootWatch()
        self._delivery = Delivery(self._requests, MEASURE_S)
        self._stations: set[int] = set()
        self._put_back_s = float("-inf")
        self._put_back = self._unanswered = 0
        self._said: list[str] = []
        self.answers: dict[str, str] = {}
        """Last answer for each message, such as ``granted`` or ``no answer``, by the message's name."""
        self.delivered_hz: dict[str, float] = {}
        """Rate of each message over the last ``MEASURE_S``, Hz, by the message's name."""

    def hear(self, frame: Frame, now_s: float) -> None:
        """Count requested messages, take the awaited answer, and record other stations."""
        if self._vehicle is not None and frame.system != self._vehicle[0]:
            if is_ground_station(frame):
                self._stations.add(frame.system)
            return
        self._delivery.hear(frame, now_s)
        if self._reboots.hear(frame):
            self._begin_anew(now_s)
        elif frame.message_id == _COMMAND_ACK:
            command, result = struct.unpack("<HB", frame.payload.ljust(3, b"\0")[:3])
            if command == _SET_INTERVAL and result in _ANSWERS:
                self._answered(_ANSWERS[result], now_s)

    def speak(self, vehicle: tuple[int, int] | None, now_s: float) -> list[Any]:
        """Return the request that is due; nothing while the vehicle is silent."""
        if vehicle is None:
            self._delivery.restart()
            self._asked_s = float("-inf")
            return []
        if self._vehicle not in (None, vehicle):
            self._forget()
        self._vehicle = vehicle
        standing = self._standing
        if standing is not None:
            if now_s - self._asked_s < ANSWER_WITHIN_S:
                return []
            if not standing.is_exhausted:
                return [self._request(standing, now_s)]
            self._settle("no answer", now_s)
        due = next((request for request in self._requests.values() if request.due_s <= now_s), None)
        if due is not None:
            self._standing = due
            return [self._request(due, now_s)]
        if (rates := self._delivery.look(now_s)) is not None:
            self._measured(rates, now_s)
        return []

    def leave(self, now_s: float) -> list[Any] | None:
        """Restore every requested rate. Return None after the vehicle has answered, or if no answer is
        expected any more.
        """
        asked = [
            request for request in self._requests.values() if request.answer or request is self._standing
        ]
        if self._vehicle is None or not asked:
            return None
        if self._put_back and self._unanswered <= 0:
            return None
        if now_s - self._put_back_s < PUT_BACK_AGAIN_S:
            return []
        if self._put_back == MOST_PUT_BACK:
            return None
        self._put_back += 1
        self._put_back_s, self._unanswered = now_s, len(asked)
        return [_set_interval(self._vehicle, request.message, 0.0, self._put_back - 1) for request in asked]

    def report(self) -> list[str]:
        """Return sentences about answers and delivered rates, each once."""
        said, self._said = self._said, []
        return said

    def _request(self, request: MessageRequest, now_s: float) -> Any:
        assert self._vehicle is not None
        request.tries += 1
        self._asked_s = now_s
        return _set_interval(self._vehicle, request.message, 1e6 / request.rate_hz, request.tries - 1)

    def _begin_anew(self, now_s: float) -> None:
        """Begin again after a reboot, in which the vehicle has lost every rate."""
        if now_s - self._began_s < SHORTEST_LIFE_S:
            return
        self._began_s = now_s
        self._forget()
        self._said.append("the vehicle rebooted: every rate is requested again")

    def _forget(self) -> None:
        """Reset the requests for a vehicle without earlier requests."""
        for request in self._requests.values():
            request.begin()
        self._standing = None
        self.delivered_hz = {}
        self._delivery.restart()

    def _answered(self, answer: str, now_s: float) -> None:
        if self._put_back:
            self._unanswered -= 1
        elif self._standing is not None and self._standing.tries:
            self._settle(answer, now_s)
            # The vehicle receives our messages: earlier unanswered requests need not wait.
            for request in self._requests.values():
                if request.answer == "no answer":
                    request.due_s = now_s

    def _settle(self, answer: str, now_s: float) -> None:
        request, self._standing = self._standing, None
        assert request is not None
        said = self.answers.get(request.name)
        request.settle(answer, now_s)
        self.answers[request.name] = answer
        self._delivery.restart()
        if answer == said:
            return
        if answer == "no answer":
            self._said.append(
                f"{request.name}: no answer to {MOST_TRIES} requests for its rate, which come again later; "
                "an autopilot told to obey one ground station only (SYSID_ENFORCE, MAV_OPTIONS) obeys the "
                "system id in SYSID_MYGCS (MAV_GCS_SYSID)"
            )
        elif answer != "granted":
            self._said.append(f"{request.name}: the vehicle answers '{answer}' to the request for its rate")

    def _measured(self, rates: Mapping[int, float], now_s: float) -> None:
        before = self.delivered_hz
        self.delivered_hz = {request.name: rates[request.message] for request in self._requests.values()}
        if not before:
            self._said.append("delivered: " + self._table(self._requests.values()))
        granted = [request for request in self._requests.values() if request.answer == "granted"]
        fallen = [request for request in granted if rates[request.message] < ENOUGH * request.rate_hz]
        for request in granted:
            if request not in fallen:
                request.held(now_s)
        news = [request for request in fallen if before.get(request.name, 0.0) >= ENOUGH * request.rate_hz]
        at_once = [request.fell(now_s) for request in fallen]
        if news:
            how = "at once" if any(at_once) else f"after a rest of up to {LONGEST_REST_S:.0f} s"
            self._said.append(
                f"rates fell, asked for again {how}: {self._table(news)}; {who_sets_rates(self._stations)}"
            )

    def _table(self, requests: Iterable[MessageRequest]) -> str:
        return ", ".join(
            f"{request.name} {self.delivered_hz[request.name]:.1f} Hz of {request.rate_hz:g} asked"
            for request in requests
        )


def _set_interval(vehicle: tuple[int, int], message: int, interval_us: float, confirmation: int) -> Any:
    """Return SET_MESSAGE_INTERVAL. An interval of 0 restores the default rate (MAVLink common.xml)."""
    return dialect.MAVLink_command_long_message(
        *vehicle, _SET_INTERVAL, confirmation, message, interval_us, 0, 0, 0, 0, 0
    )
