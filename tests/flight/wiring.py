"""A recorded flight whose plain elevator is wired to several outputs, as if built so."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from advisor.aircraft.aircraft import Aircraft
from advisor.flight.maneuvers.maneuver import ManeuverFlown, Notice
from advisor.flight.signals.messages import Columns
from advisor.flight.stream.stream import FlightStream
from advisor.mavlink.logs.logs import open_log
from tests.heard import hear

TRIM_US = 1500

Pulse = Callable[[NDArray[np.float64], NDArray[np.float64]], NDArray[np.float64]]
"""From what the demands of pitch and of another axis add to 1500 us, each of shape (n,), to a pulse."""


def wired(
    outputs: Mapping[int, Pulse], parameters: Mapping[str, float], log: Path
) -> Iterator[list[Columns]]:
    """Batches of the log: its elevator moves these outputs, and nothing else is said of its servos.

    The pitch demand is positive nose down, as the pulses of the log are. Outputs from 17 on come in a
    message of their own right behind that of the first bank.
    """
    rng = np.random.default_rng(3)
    for batch in open_log(log):
        found = []
        for c in batch:
            c = replace(c, order=2 * c.order)
            if c.name == "SERVO_OUTPUT_RAW":
                found += _outputs(c, outputs, rng)
            elif c.name == "PARAM_VALUE":
                found.append(_told(c, parameters))
            else:
                found.append(c)
        yield found


def flown(
    batches: Iterator[list[Columns]], aircraft: Aircraft
) -> tuple[FlightStream, list[ManeuverFlown], list[Notice]]:
    """The stream that has read them, what was flown, and what was noticed."""
    heard = hear(batches, aircraft)
    return heard.stream, [event for event in heard.events if isinstance(event, ManeuverFlown)], heard.notices


def _outputs(c: Columns, outputs: Mapping[int, Pulse], rng: np.random.Generator) -> Sequence[Columns]:
    pitch = c.fields["servo2_raw"].astype(float) - TRIM_US
    t = c.fields["time_usec"] * 1e-6
    other = 25.0 * np.sin(0.7 * t) + 15.0 * np.sign(np.sin(1.9 * t)) + rng.integers(-2, 3, len(t))
    banks = []
    for port in sorted({(n - 1) // 16 for n in outputs} | {0}):
        fields = {**c.fields, "port": np.full(len(t), port, dtype=np.uint8)}
        for n in range(1, 17):
            if port == 0 and n == 3:
                continue  # the throttle
            pulse = outputs.get(16 * port + n)
            raw = TRIM_US + pulse(pitch, other) if pulse else np.zeros(len(t))
            fields[f"servo{n}_raw"] = np.round(raw).astype(np.uint16)
        banks.append(replace(c, order=c.order + port, fields=fields))
    return banks


def _told(c: Columns, parameters: Mapping[str, float]) -> Columns:
    """As many PARAM_VALUEs as the log has, first these parameters, then one without a meaning here."""
    n = len(c.order)
    named = [(name.encode(), value) for name, value in parameters.items()]
    filled = (named + [(b"NONE", 0.0)] * n)[:n]
    fields = {
        **c.fields,
        "param_id": np.array([name for name, _ in filled], dtype="S16"),
        "param_value": np.array([value for _, value in filled]),
    }
    return replace(c, fields=fields)
