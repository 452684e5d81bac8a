"""Columns of messages as a vehicle would send them, from plain arrays."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from advisor.flight.signals.messages import Columns

Sent = tuple[float, int, str, int, int, Mapping[str, Any]]
"""Arrival, place among the messages sent, name, system, component, fields."""


class Wire:
    """Collects messages in their order of arrival and packs them into columns."""

    def __init__(self) -> None:
        self._sent: list[Sent] = []
        self._arrived: list[Sent] = []

    def send(self, message: str, at_s: float, /, system: int = 1, component: int = 1, **fields: Any) -> None:
        """Put one message on the wire; it arrives at ``at_s``."""
        self._sent.append((at_s, len(self._sent), message, system, component, fields))

    def columns(self, rows: Sequence[int] | None = None) -> list[Columns]:
        """All messages, or the given places in the order of arrival, as one batch."""
        arrived = self._in_order()
        chosen = range(len(arrived)) if rows is None else rows
        groups: dict[tuple[str, int, int], list[int]] = {}
        for i in chosen:
            groups.setdefault(arrived[i][2:5], []).append(i)
        return [
            Columns(
                name,
                system,
                component,
                np.array(places, dtype=np.int64),
                np.array([arrived[i][0] for i in places]),
                {key: np.array([arrived[i][5][key] for i in places]) for key in arrived[places[0]][5]},
            )
            for (name, system, component), places in groups.items()
        ]

    def _in_order(self) -> list[Sent]:
        """All messages in the order of arrival, sorted once for the many pieces of one wire."""
        if len(self._arrived) != len(self._sent):
            self._arrived = sorted(self._sent, key=lambda message: message[:2])
        return self._arrived

    def __len__(self) -> int:
        return len(self._sent)


def heartbeat(
    wire: Wire, at_s: float, mode: int = 0, autopilot: int = 3, kind: int = 1, **sender: int
) -> None:
    """A HEARTBEAT of an ArduPlane unless said otherwise."""
    wire.send("HEARTBEAT", at_s, **sender, type=kind, autopilot=autopilot, custom_mode=mode, base_mode=217)


def parameter(wire: Wire, at_s: float, name: str, value: float, **sender: int) -> None:
    """A PARAM_VALUE."""
    wire.send("PARAM_VALUE", at_s, **sender, param_id=name.encode(), param_value=value)


def attitude(
    wire: Wire, at_s: float, boot_s: float, q: float = 0.0, pitch: float = 0.05, **sender: int
) -> None:
    """An ATTITUDE, its stamp wrapped as the message has it."""
    wire.send(
        "ATTITUDE", at_s, **sender, time_boot_ms=round(boot_s * 1000) % 2**32,
        roll=0.0, pitch=pitch, yaw=0.0, rollspeed=0.0, pitchspeed=q, yawspeed=0.0,
    )  # fmt: skip


def servo(
    wire: Wire, at_s: float, boot_s: float, pwm: Mapping[int, int], port: int = 0, **sender: int
) -> None:
    """A SERVO_OUTPUT_RAW with its 32-bit counter of microseconds; other outputs are idle."""
    outputs = {f"servo{n}_raw": pwm.get(n, 0) for n in range(1, 17)}
    wire.send("SERVO_OUTPUT_RAW", at_s, **sender, time_usec=round(boot_s * 1e6) % 2**32, port=port, **outputs)


def aoa(wire: Wire, at_s: float, boot_s: float, alpha_deg: float, **sender: int) -> None:
    """An AOA_SSA as ArduPilot stamps it: 64 bits filled from a 32-bit counter."""
    wire.send("AOA_SSA", at_s, **sender, time_usec=round(boot_s * 1e6) % 2**32, AOA=alpha_deg, SSA=0.0)


def hud(wire: Wire, at_s: float, airspeed: float = 20.0, climb: float = 0.0, **sender: int) -> None:
    """A VFR_HUD; it has no stamp."""
    wire.send(
        "VFR_HUD",
        at_s,
        **sender,
        airspeed=airspeed,
        groundspeed=airspeed,
        throttle=50,
        alt=100.0,
        climb=climb,
    )


def plane_parameters(wire: Wire, at_s: float, **sender: int) -> None:
    """What an ArduPlane with the usual outputs says of its servos."""
    functions = {"SERVO1_FUNCTION": 4, "SERVO2_FUNCTION": 19, "SERVO3_FUNCTION": 70, "SERVO4_FUNCTION": 21}
    for i, (name, value) in enumerate(functions.items()):
        parameter(wire, at_s + 1e-4 * i, name, value, **sender)


STEPS = ((3.0, 1), (2.0, -1), (1.0, 1), (1.0, -1))


def pull(since_s: float, unit_s: float = 0.4) -> int:
    """ElevatorSign of a 3-2-1-1 at a time after its onset: 1 nose up, -1 nose down."""
    for units, sense in STEPS:
        if 0.0 <= since_s < units * unit_s:
            return sense
        since_s -= units * unit_s
    return 0


def fly(
    wire: Wire,
    start_s: float,
    boot_s: float,
    onsets_s: Sequence[float],
    duration_s: float,
    rate_hz: float = 50.0,
    mode: int = 0,
    **sender: int,
) -> None:
    """Send a flight of 3-2-1-1 inputs (20 us to either side), onsets counted from its beginning."""
    heartbeat(wire, start_s, mode=mode, **sender)
    plane_parameters(wire, start_s + 1e-3, **sender)
    for k in range(int(duration_s * rate_hz)):
        since = k / rate_hz
        now, boot = start_s + 0.01 + since, boot_s + since
        sense = sum(pull(since - onset) for onset in onsets_s)
        attitude(wire, now, boot, q=0.2 * sense, **sender)
        aoa(wire, now + 1e-4, boot, 2.0 + sense, **sender)
        servo(wire, now + 2e-4, boot, {1: 1500, 2: 1500 + 20 * sense, 3: 1600, 4: 1500}, **sender)
        hud(wire, now + 3e-4, airspeed=20.0 + 0.01 * (k % 2), **sender)


def switch(wire: Wire, at_s: float, boot_s: float, pulse_us: int, channel: int = 9) -> None:
    """An RC_CHANNELS in which one channel is a switch."""
    pulses = {f"chan{n}_raw": pulse_us if n == channel else 1500 for n in range(1, 19)}
    wire.send("RC_CHANNELS", at_s, time_boot_ms=round(boot_s * 1000) % 2**32, chancount=18, **pulses)


def text(wire: Wire, at_s: float, said: str, **sender: int) -> None:
    """A STATUSTEXT."""
    wire.send("STATUSTEXT", at_s, **sender, severity=6, text=said.encode())
