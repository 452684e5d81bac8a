"""Uplink of the next input to the autopilot's script: SCR_USER1 to 4, confirmed by the script's echo.

The script ``advisor/scripts/inflight.lua`` takes an order when the counter in SCR_USER4 changes. The script
answers by a text with the counter, the input, its time unit and its size. An order with input 0 ends the
multisine that is flown.
"""

import re
from dataclasses import dataclass
from typing import Any

from pymavlink.dialects.v20 import ardupilotmega as dialect

from advisor.mavlink.link.outgoing import Ids, Talker
from advisor.mavlink.wire.framing import Frame

ANSWER_WITHIN_S = 2.0
"""Time for the script's echo before an order is sent again, s. A slow radio needs about 1 s for both ways."""
MOST_TRIES = 5
_STATUSTEXT = dialect.MAVLINK_MSG_ID_STATUSTEXT
_ECHO = re.compile(r"ADVISOR NEXT (\d+) (.+) ([\d.]+) s ([\d.]+) deg")
_ENDS = re.compile(r"ADVISOR ENOUGH (\d+)")
_REFUSAL = re.compile(r"ADVISOR REFUSES (\d+): (.+)")
_ROUNDED = 0.051
"""Largest difference between an order and its echo, in which numbers have one or two decimals."""


@dataclass(frozen=True, slots=True)
class NextOrder:
    """Input that the script flies next."""

    which: int
    """Place of the input in the script's table, from 1. 0: the end of the multisine that is flown."""
    size_deg: float
    """Size of the input, deg. For an end the negative number of the multisine, which is no size."""
    unit_s: float

    @property
    def what(self) -> str:
        return "the next input" if self.which else "the end of the input"


class Uplink(Talker):
    """Sender of the next input, which sends PARAM_SET of SCR_USER1 to 4 and nothing else.

    ``order`` may be called from any thread. The link asks for the messages in its own thread.
    """

    def __init__(self) -> None:
        self._wanted: NextOrder | None = None
        self._confirmed: NextOrder | None = None
        self._waiting: NextOrder | None = None
        """Next input that the script had not confirmed before an order to end the present one."""
        self._counter = 0
        self._tries = 0
        self._due_s = float("-inf")
        self._said: list[str] = []

    def order(self, which: int, size_deg: float, unit_s: float) -> None:
        """Take the next input. The uplink sends it unless the script has confirmed an identical input."""
        wanted = NextOrder(which, size_deg, unit_s)
        if wanted not in (self._wanted, self._confirmed):
            if which == 0:
                self._waiting = self._wanted
            self._begin(wanted)

    def _begin(self, wanted: NextOrder | None) -> None:
        self._wanted, self._tries, self._due_s = wanted, 0, float("-inf")

    def _go_on(self) -> None:
        """Forget the order, and send the next input that waited for the end of the present one."""
        waiting, self._waiting = self._waiting, None
        self._begin(waiting)

    def hear(self, frame: Frame, now_s: float) -> None:
        """Take the script's echo or its refusal."""
        if frame.message_id != _STATUSTEXT or self._wanted is None:
            return
        text = frame.payload[1:51].rstrip(b"\0").decode("ascii", "replace")
        if (refused := _REFUSAL.match(text)) and int(refused[1]) == self._counter:
            self._said.append(f"the script refuses {self._wanted.what}: {refused[2]}")
            self._go_on()
        elif (ends := _ENDS.match(text)) and int(ends[1]) == self._counter:
            self._said.append(f"the script ends input {-self._wanted.size_deg:g}: its data are enough")
            self._confirmed = self._wanted
            self._go_on()
        elif (echo := _ECHO.match(text)) and int(echo[1]) == self._counter:
            size_deg, unit_s = float(echo[4]), float(echo[3])
            near = abs(size_deg - self._wanted.size_deg) < _ROUNDED
            # An order of which one message was lost has the number of an earlier one.
            if near and (unit_s == 0.0 or abs(unit_s - self._wanted.unit_s) < _ROUNDED):
                self._said.append(
                    f"the script confirms: switch up: {echo[2]}, {unit_s:g} s, {size_deg:g} deg"
                )
                self._confirmed = self._wanted
                self._go_on()
            else:
                self._due_s = now_s

    def speak(self, vehicle: Ids | None, now_s: float) -> list[Any]:
        """Return the order if it is due; nothing while the vehicle is silent."""
        wanted = self._wanted
        if wanted is None or vehicle is None or now_s < self._due_s:
            return []
        if self._tries == MOST_TRIES:
            self._said.append(
                f"the script has not confirmed {wanted.what} after {MOST_TRIES} tries. "
                "Set SCR_ENABLE 1, restart the vehicle, and fly what its text ADVISOR NEXT says"
            )
            self._go_on()
            return []
        self._tries += 1
        self._due_s = now_s + ANSWER_WITHIN_S
        # A script that was started again knows no counter; one of the clock differs from any earlier one.
        self._counter = self._counter + 1 if self._counter else 1 + int(now_s) % 9000
        values = (wanted.which, wanted.size_deg, wanted.unit_s, self._counter)
        return [_set(vehicle, f"SCR_USER{k}", float(value)) for k, value in enumerate(values, 1)]

    def report(self) -> list[str]:
        """Return sentences about confirmations and refusals, each once."""
        said, self._said = self._said, []
        return said


def _set(vehicle: Ids, name: str, value: float) -> Any:
    return dialect.MAVLink_param_set_message(
        *vehicle, name.encode("ascii"), value, dialect.MAV_PARAM_TYPE_REAL32
    )
