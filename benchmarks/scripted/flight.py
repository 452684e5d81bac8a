"""One flight of a script: every input of its table, then inputs that are ended early."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from advisor.scripts.ardupilot import ardupilot_script
from advisor.scripts.table import Entry, ScriptTable

from .pilot import WALL_S, Airframe, Pilot, airborne

UP_US, DOWN_US, GRABBED_US = 1900, 1000, 1600
LOW_M = 70.0
"""Height below which the plane climbs before the next input, m."""
LONGEST_S = 60.0
"""Longest time of one input with its wait for steady flight, s."""
HELD_S, TRIM_S = 10.0, 4.0
"""Time in which a height and an air speed settle, and the last part that gives the pulses of the trim, s."""
STICK_US = 1000.0
"""Travel of a stick, us."""
SINKING_US, IDLE_US = 1250, 1300
"""Pitch stick and throttle with which the plane sinks in FBWA at a nearly constant air speed, us."""


@dataclass(frozen=True)
class Ended:
    """An input that was ended early."""

    number: int
    event_s: float
    """Vehicle time of the event, s since boot."""
    said: str
    """Text ``ADVISOR END`` of the script."""
    end_s: float


@dataclass
class ScriptFlight:
    """What a pilot saw of a flown table."""

    pilot: Pilot
    table: ScriptTable
    tlog: Path
    done: list[int] = field(default_factory=list)
    """Numbers of the inputs that were flown to their ends, in the order of the table."""
    aborts: dict[str, Ended] = field(default_factory=dict)

    def entry(self, number: int) -> Entry:
        """Return the entry of the table that an input's BEGIN names."""
        name = self.pilot.said(f"ADVISOR BEGIN {number} ").split(maxsplit=3)[3]
        return next(one for one in self.table.entries if one.test.name == name)

    def begun(self, number: int) -> None:
        """Move the switch up until an input begins."""
        pilot = self.pilot
        self._switch(UP_US)
        assert pilot.fly(LONGEST_S, pilot.heard(f"ADVISOR BEGIN {number} ")), pilot.texts[-3:]

    def over(self, number: int) -> None:
        """Wait for the end of an input, and bring sticks, switch and mode back."""
        pilot = self.pilot
        assert pilot.fly(LONGEST_S, pilot.heard(f"ADVISOR END {number} ")), pilot.texts[-3:]
        self._switch(DOWN_US)
        pilot.sticks[:4] = [1500, 1500, 1500, 1500]

    def _switch(self, us: int) -> None:
        self.pilot.sticks[self.table.switch - 1] = us


def _by_switch(flight: ScriptFlight, number: int) -> float:
    channel = flight.table.switch - 1
    flight.pilot.sticks[channel] = DOWN_US
    return _first(flight.pilot.radio, flight, number, lambda us: us[channel] < 1300)


def _by_stick(flight: ScriptFlight, number: int) -> float:
    flight.pilot.sticks[0] = GRABBED_US
    return _first(flight.pilot.radio, flight, number, lambda us: us[0] > 1550)


def _by_mode(flight: ScriptFlight, number: int) -> float:
    at_s = flight.pilot.t
    flight.pilot.link.set_mode("FBWB")
    flight.over(number)
    return at_s


def _by_height(flight: ScriptFlight, number: int) -> float:
    flight.over(number)
    flight.pilot.fly(0.3)
    t, height_m = np.array(flight.pilot.heights[-8:]).T
    below = int(np.argmax(height_m < flight.table.limits.lowest_m))
    two = slice(below - 1, below + 1)
    return float(np.interp(-flight.table.limits.lowest_m, -height_m[two], t[two]))


def _first(
    seen: list[tuple[float, Any]], flight: ScriptFlight, number: int, holds: Callable[[Any], bool]
) -> float:
    """Return the first time after the begin of an input at which a condition of a message holds, s."""
    flight.over(number)
    begin_s = flight.pilot.at(f"ADVISOR BEGIN {number} ")
    return next((t for t, value in seen if t > begin_s and holds(value)), float("nan"))


ABORTS: Mapping[str, Callable[[ScriptFlight, int], float]] = {
    "switch": _by_switch, "stick": _by_stick, "mode": _by_mode, "height": _by_height,
}  # fmt: skip
"""How an input is ended early, by a name: each returns the time of its event, s."""


def fly_table(
    table: ScriptTable,
    folder: Path,
    airframe: Airframe | None = None,
    complete: int | None = None,
    aborts: tuple[str, ...] = tuple(ABORTS),
    longest_s: float = WALL_S,
) -> ScriptFlight:
    """Fly the first ``complete`` inputs of a table (default: all) to their ends, and abort the next ones."""
    with airborne(ardupilot_script(table), folder, airframe, longest_s) as pilot:
        flight = ScriptFlight(pilot, table, folder / "flight.tlog")
        count = len(table.entries) if complete is None else complete
        for number in range(1, count + 1):
            flight.begun(number)
            flight.over(number)
            flight.done.append(number)
            recover(pilot)
        for number, why in enumerate(aborts, count + 1):
            if why == "height":
                sink(pilot, table.limits.lowest_m)
            flight.begun(number)
            pilot.fly(0.7)
            event_s = ABORTS[why](flight, number)
            begin = f"ADVISOR END {number} "
            flight.aborts[why] = Ended(number, event_s, pilot.said(begin), pilot.at(begin))
            recover(pilot)
    return flight


def recover(pilot: Pilot) -> None:
    """Fly level in FBWA for some seconds, after a climb where the plane is low."""
    if pilot.height_m < LOW_M:
        pilot.link.set_mode("FBWB")
        pilot.sticks[1], pilot.sticks[2] = 1800, 1600
        pilot.fly(30.0, lambda: pilot.height_m > LOW_M + 10.0)
        pilot.sticks[1], pilot.sticks[2] = 1500, 1500
        pilot.fly(6.0)
    pilot.link.set_mode("FBWA")
    pilot.fly(3.0)


def level(pilot: Pilot, mode: str = "FBWA") -> None:
    """Hold height and air speed, and then fly on with the pulses of that flight in another mode."""
    pilot.link.set_mode("FBWB")
    pilot.sticks[:4] = [1500, 1800 if pilot.height_m < LOW_M else 1500, 1500, 1500]
    pilot.fly(30.0, lambda: pilot.height_m > LOW_M)
    pilot.sticks[1] = 1500
    pilot.fly(HELD_S)
    t, us = pilot.pulses()
    trims = np.median(us[t > pilot.t - TRIM_S], axis=0)
    pilot.sticks[2] = round(trims[2])
    if mode == "MANUAL":
        travel = pilot.parameters["SERVO2_MAX"] - pilot.parameters["SERVO2_MIN"]
        of_stick = STICK_US / travel
        pilot.sticks[1] = round(1500 + of_stick * (trims[1] - pilot.parameters["SERVO2_TRIM"]))
    pilot.link.set_mode(mode)
    pilot.fly(1.0)


def sink(pilot: Pilot, lowest_m: float) -> None:
    """Begin a steady descent that passes a height a few seconds after an input can begin."""
    pilot.sticks[1], pilot.sticks[2] = SINKING_US, IDLE_US
    assert pilot.fly(60.0, lambda: pilot.height_m < lowest_m + 15.0), pilot.height_m
