"""Forms of unkindness: pure functions of a flight and a few words, with a draw of the words for each."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from benchmarks.endure.packets import Flight, changed, fields, moved, name, seconds, value

Word = float | str
_PARAMETER = "PARAM_VALUE"
MOTION = frozenset(
    [
        *("AOA_SSA", "ATTITUDE", "ATTITUDE_QUATERNION", "VFR_HUD", "NAMED_VALUE_FLOAT", "HEARTBEAT"),
        *("RAW_IMU", "SCALED_IMU", "SCALED_IMU2", "SCALED_IMU3", "HIGHRES_IMU", "SCALED_PRESSURE"),
        *("GLOBAL_POSITION_INT", "LOCAL_POSITION_NED", "NAV_CONTROLLER_OUTPUT"),
        *("SERVO_OUTPUT_RAW", "RC_CHANNELS", _PARAMETER),
    ]
)
"""Messages whose channels are made unkind."""
CHANGES: dict[str, Callable[[float], float]] = {
    "zero": lambda x: 0.0,
    "nan": lambda x: math.nan,
    "million": lambda x: 1e6 * x,
    "millionth": lambda x: 1e-6 * x,
    "negative": lambda x: -x,
}
SAMPLES = 32
"""Samples of a message that tell whether a channel changes. A channel that rests carries nothing to spoil."""
IDLE_HZ = 4.0
"""Rate of every message while nothing happens, Hz."""


@dataclass(frozen=True)
class Form:
    """A kind of unkindness."""

    apply: Callable[..., Flight]
    """Function of the flight and the words."""
    draw: Callable[[Flight, np.random.Generator], Sequence[Word]]
    """Draws the words for a flight that is not empty."""


def channels(flight: Flight) -> tuple[str, ...]:
    """Return the channels of motion and control that change in a flight, as ``MESSAGE.field``."""
    found = []
    for number in sorted(n for n in {packet.number for packet in flight} if name(n) in MOTION):
        sent = [packet for packet in flight if packet.number == number]
        some = sent[:: max(1, len(sent) // SAMPLES)]
        named = [field for field in fields(number) if not field.endswith(("_id", "name"))]
        found += [f"{name(number)}.{field}" for field in named if len({value(p, field) for p in some}) > 1]
    return tuple(found)


def _each(flight: Flight, channel: str, change: Callable[[float], float]) -> Flight:
    message, field = channel.split(".")
    return tuple(changed(p, field, change) if name(p.number) == message else p for p in flight)


def cut(flight: Flight, begin: float, end: float) -> Flight:
    """Keep the packets between two shares of the flight's packets, and the parameters."""
    return _since(flight[: round(end * len(flight))], round(begin * len(flight)))


def _since(flight: Flight, begin: int) -> Flight:
    """Return the flight from a place on, with the parameters of before in front: most logs repeat them."""
    if begin >= len(flight):
        return ()
    arrival_us = flight[begin].arrival_us
    known = [p._replace(arrival_us=arrival_us) for p in flight[:begin] if name(p.number) == _PARAMETER]
    return (*known, *flight[begin:])


def rate(flight: Flight, message: str, hz: float) -> Flight:
    """Thin a message, or every one by the name ``all``, to at most ``hz``."""
    last: dict[tuple[int, bytes], int] = {}
    kept = []
    for packet in flight:
        key, every_us = (packet.number, packet.sender), 1e6 / hz
        if message in ("all", name(packet.number)) and name(packet.number) in MOTION - {_PARAMETER}:
            if packet.arrival_us - last.get(key, -math.inf) < 0.9 * every_us:
                continue
            last[key] = packet.arrival_us
        kept.append(packet)
    return tuple(kept)


def faster(flight: Flight, factor: float) -> Flight:
    """Let all clocks run ``factor`` times as slowly, so that every rate rises by the factor."""
    if not flight:
        return flight
    first = {False: 1e-6 * flight[0].arrival_us, True: 0.0}

    def clock(t: float) -> float:
        begin_s = first[t < 1e8]  # stamps count from 1970, vehicles from their boot
        return begin_s + (t - begin_s) / factor

    return tuple(moved(packet, clock) for packet in flight)


def length(flight: Flight, message: str, samples: float) -> Flight:
    """End the flight behind so many samples of a message."""
    found = [i for i, packet in enumerate(flight) if name(packet.number) == message]
    return flight[: found[int(samples) - 1] + 1] if 0 < samples <= len(found) else flight


def few(flight: Flight, message: str, samples: float) -> Flight:
    """Keep only so many samples of a message, the middle ones."""
    found = [i for i, packet in enumerate(flight) if name(packet.number) == message]
    begin = max(0, (len(found) - int(samples)) // 2)
    lost = {*found} - {*found[begin : begin + int(samples)]}
    return tuple(packet for i, packet in enumerate(flight) if i not in lost)


def moves(flight: Flight, channel: str) -> list[int]:
    """Return the places of the flight where a channel has moved by a quarter of its range or more."""
    message, field = channel.split(".")
    at = [i for i, packet in enumerate(flight) if name(packet.number) == message]
    values = np.array([value(flight[i], field) for i in at])
    if len(values) < 2 or np.ptp(values) == 0.0:
        return []
    steps = np.abs(values[2:] - values[:-2]) > 0.25 * np.ptp(values)
    return [at[i + 2] for i in np.flatnonzero(steps)]


def begins(flight: Flight, channel: str, which: float) -> Flight:
    """Let the record begin with a movement of the channel."""
    found = moves(flight, channel)
    return _since(flight, found[int(which * len(found))]) if found else flight


def ends(flight: Flight, channel: str, which: float) -> Flight:
    """Let the record end with a movement of the channel."""
    found = moves(flight, channel)
    return flight[: found[int(which * len(found))] + 1] if found else flight


def step(flight: Flight, channel: str, which: float) -> Flight:
    """Hold a channel behind a movement: a single step is left."""
    found = moves(flight, channel)
    return stop(flight, channel, found[int(which * len(found))] / len(flight)) if found else flight


def constant(flight: Flight, channel: str) -> Flight:
    """Hold a channel at its first value."""
    return stop(flight, channel, 0.0)


def stop(flight: Flight, channel: str, since: float, at: float = math.nan) -> Flight:
    """Hold a channel from a share of the flight on, at a value or, with NaN, where it is."""
    message, field = channel.split(".")
    begin, held, out = round(since * len(flight)), at, []
    for i, packet in enumerate(flight):
        if i < begin or name(packet.number) != message:
            out.append(packet)
            continue
        held = value(packet, field) if math.isnan(held) else held
        out.append(changed(packet, field, lambda _, held=held: held))
    return tuple(out)


def slow(flight: Flight, since: float) -> Flight:
    """Let air speed and ground speed fall to zero, from a share of the flight to its end."""
    begin, out = round(since * len(flight)), []
    for i, packet in enumerate(flight):
        if i >= begin and name(packet.number) == "VFR_HUD":
            left = (len(flight) - 1 - i) / (len(flight) - begin)
            for field in ("airspeed", "groundspeed"):
                packet = changed(packet, field, lambda v, left=left: v * left)
        out.append(packet)
    return tuple(out)


def pause(flight: Flight, at: float, long_s: float) -> Flight:
    """Let nothing be heard for so many seconds."""
    begin = round(at * len(flight))
    late = tuple(moved(packet, lambda t: t + long_s) for packet in flight[begin:])
    return flight[:begin] + late


def idle(flight: Flight, at: float, long_s: float) -> Flight:
    """Let every message repeat its last values for so many seconds, `IDLE_HZ` times a second."""
    begin = round(at * len(flight))
    last = {(p.number, p.sender): p for p in flight[:begin] if name(p.number) in MOTION - {_PARAMETER}}
    still = [
        moved(packet, lambda t, k=k: t + k / IDLE_HZ)
        for k in range(1, int(long_s * IDLE_HZ))
        for packet in last.values()
    ]
    return flight[:begin] + tuple(still) + pause(flight[begin:], 0.0, long_s)


def _channel(flight: Flight, rng: np.random.Generator) -> str:
    return str(rng.choice(channels(flight) or ("ATTITUDE.pitch",)))


def _message(flight: Flight, rng: np.random.Generator) -> str:
    return _channel(flight, rng).split(".")[0]


def _output(flight: Flight, rng: np.random.Generator) -> str:
    """Draw the servo output that a form watches: of outputs 1 to 4, one that moves where one does."""
    outputs = [f"SERVO_OUTPUT_RAW.servo{n}_raw" for n in (1, 2, 4)]
    return str(rng.choice([one for one in outputs if moves(flight, one)] or outputs))


def _share(rng: np.random.Generator) -> float:
    return round(float(rng.random()), 4)


def _a_cut(flight: Flight, rng: np.random.Generator) -> Sequence[Word]:
    """Draw a beginning, an end, or a piece whose length is uniform in its logarithm from one second on."""
    kind, place = int(rng.integers(3)), float(rng.random())
    if kind < 2:
        return (0.0, round(place, 4)) if kind == 0 else (round(place, 4), 1.0)
    long = math.exp(float(rng.uniform(-math.log(max(seconds(flight), 1.0)), 0.0)))
    begin = place * (1.0 - long)
    return round(begin, 4), round(begin + long, 4)


def _near_a_power(flight: Flight, rng: np.random.Generator) -> int:
    return max(1, 2 ** int(rng.integers(0, 13)) + int(rng.integers(-2, 3)))


def _changing(change: Callable[[float], float]) -> Form:
    return Form(lambda flight, channel: _each(flight, channel, change), lambda f, rng: [_channel(f, rng)])


FORMS: dict[str, Form] = {
    "cut": Form(cut, _a_cut),
    "rate": Form(
        rate,
        lambda f, rng: [
            "all" if rng.random() < 0.6 else _message(f, rng),
            round(4.0 * 12.5 ** float(rng.random()), 2),
        ],
    ),
    "faster": Form(faster, lambda f, rng: [round(0.2 * 40.0 ** float(rng.random()), 3)]),
    "length": Form(length, lambda f, rng: [_message(f, rng), _near_a_power(f, rng)]),
    "few": Form(few, lambda f, rng: [_message(f, rng), int(rng.integers(1, 3))]),
    "begins": Form(begins, lambda f, rng: [_output(f, rng), _share(rng)]),
    "ends": Form(ends, lambda f, rng: [_output(f, rng), _share(rng)]),
    "step": Form(step, lambda f, rng: [_output(f, rng), _share(rng)]),
    "constant": Form(constant, lambda f, rng: [_channel(f, rng)]),
    **{word: _changing(change) for word, change in CHANGES.items()},
    "stop": Form(
        stop,
        lambda f, rng: [_output(f, rng), _share(rng), int(rng.choice([800, 1000, 1100, 1900, 2000, 2200]))],
    ),
    "slow": Form(slow, lambda f, rng: [_share(rng)]),
    "pause": Form(pause, lambda f, rng: [_share(rng), float(rng.choice([1.0, 10.0, 600.0, 3600.0]))]),
    "idle": Form(
        idle, lambda f, rng: [_share(rng), float(rng.choice([60.0, 600.0, 3600.0], p=[0.6, 0.3, 0.1]))]
    ),
}
"""Every form by its name. Rates of 4 to 400 Hz come from ``rate`` and ``faster``."""
