"""Manoeuvres found in flights with hands between the tests.

    python -m benchmarks.hands [--flights 20] [--seed 29113007] [--rate 10] [--stabilize]

Counts the tests of the elevator that are found whole, and what else is found as a test. The flights are of
the second generator, whose pilot is a loop without noise, and of the third and of those by hand, with hands
of a delay and a remnant. Every other flight by hand tests aileron and rudder alone.
"""

import sys
import tempfile
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import click
import numpy as np
import yaml

from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.library import read
from benchmarks.at_once.telemetry import BOOT_S
from benchmarks.by_hand.cases import cases as rigid
from benchmarks.endure import packets
from benchmarks.second_generator.cases import cases as second
from benchmarks.second_generator.maneuvers import STEPPED
from benchmarks.third_generator.cases import assignments, draw_case
from benchmarks.third_generator.files import aircraft_file, log_bytes
from benchmarks.third_generator.hands import by_hand
from benchmarks.third_generator.nature import drawn

BEGINS_S, ENDS_S = 0.5, 0.8
"""Largest distance of a found test's first and last step from those flown, s."""
MULTISINE_UNITS = 14.0
"""Duration of the second generator's multisine, in its units."""
WHOLE = ("HEARTBEAT", "PARAM_VALUE", "STATUSTEXT")
"""Messages that stay complete at a lower rate."""
STABILIZE = 2
"""Number of the mode in a heartbeat of ArduPlane."""
FOUND, OTHERS = 0.98, 0.02
"""Least share of the tests that is found whole, and largest share of others among what is found."""


@dataclass(frozen=True)
class Flight:
    """A flight with hands between the tests."""

    name: str
    log: bytes
    file: dict[str, Any]
    flown: tuple[tuple[float, float], ...]
    """First and last step of each test, s since the log began."""
    boot_s: float
    """Time since boot at which the log begins, s."""


@dataclass(frozen=True)
class Count:
    """Tests flown, those found whole, and what else was found."""

    flown: int = 0
    whole: int = 0
    others: int = 0

    def __add__(self, other: "Count") -> "Count":
        return Count(self.flown + other.flown, self.whole + other.whole, self.others + other.others)

    @property
    def holds(self) -> bool:
        """Whether enough tests are found whole, and few others."""
        found = max(self.whole + self.others, 1)
        return self.whole >= FOUND * self.flown and self.others <= OTHERS * found


def flights(count: int, seed: int) -> Iterator[Flight]:
    """Yield flights of all generators in turns."""
    for each in zip(_second(count, seed), _third(count, seed), _by_hand(count, seed), strict=True):
        yield from each


def _second(count: int, seed: int) -> Iterator[Flight]:
    for case in second(count, seed, "none"):
        flown = [(m["start"], m["start"] + m["unit"] * _units(m["kind"])) for m in case.truth["maneuvers"]]
        boot_s = case.truth["wiring"]["boot_s"]
        yield Flight(f"second/{case.name}", case.log, case.aircraft, tuple(flown), boot_s)


def _units(kind: str) -> float:
    return sum(length for _, length in STEPPED[kind]) if kind in STEPPED else MULTISINE_UNITS


def _third(count: int, seed: int) -> Iterator[Flight]:
    for index, assignment in enumerate(assignments(count, seed, "none"), start=1):
        case = draw_case(assignment, seed, index)
        for attempt in range(20):
            rng = np.random.default_rng([seed, index, 7, attempt])
            setup = replace(case.setup, plan=by_hand(case.setup.plan, rng))
            try:
                case = replace(case, setup=setup, shown=setup.flight())
            except ArithmeticError:
                continue
            break
        nature = drawn(np.random.default_rng([seed, index, 3]), case.ground_m, 0.3)
        flown = tuple((m.input_s, m.input_end_s) for m in case.setup.plan.maneuvers)
        log, file = log_bytes(case, nature), aircraft_file(case, nature)
        yield Flight(f"third/{index:04d}", log, file, flown, case.wiring.boot_s)


def _by_hand(count: int, seed: int) -> Iterator[Flight]:
    for case in rigid(count, seed, "none"):
        flown = tuple((begin, end) for control, begin, end in case.truth["inputs"] if control == "elevator")
        yield Flight(f"by hand/{case.name}", case.log, dict(case.aircraft), flown, BOOT_S)


def at_rate(log: bytes, rate_hz: float) -> bytes:
    """Return a log with every message at most at a rate, Hz."""
    newest: dict[int, int] = {}
    kept = []
    for packet in packets.read(log):
        if packets.name(packet.number) not in WHOLE:
            since_us = packet.arrival_us - newest.get(packet.number, -(10**9))
            if since_us < 0.95e6 / rate_hz:
                continue
            newest[packet.number] = packet.arrival_us
        kept.append(packet)
    return packets.written(kept)


def stabilized(log: bytes) -> bytes:
    """Return a log in which the vehicle states STABILIZE throughout."""
    mode = STABILIZE.to_bytes(4, "little")
    return packets.written(
        p._replace(payload=mode + p.payload[4:]) if packets.name(p.number) == "HEARTBEAT" else p
        for p in packets.read(log)
    )


def extents(found: Sequence[Maneuver], flight: Flight) -> list[tuple[float, float]]:
    """Return first and last step of what was found, s since the log began."""
    return [(m.span.start_s - flight.boot_s, m.span.last_step_s - flight.boot_s) for m in found]


def counted(found: Sequence[Maneuver], flight: Flight) -> Count:
    """Return how many of the tests were found whole, and how many others."""
    whole = sum(
        any(
            abs(begin_s - test[0]) <= BEGINS_S and abs(last_s - test[1]) <= ENDS_S
            for begin_s, last_s in extents(found, flight)
        )
        for test in flight.flown
    )
    return Count(len(flight.flown), whole, len(found) - whole)


@click.command()
@click.option("--flights", "count", default=20, show_default=True, help="Flights of each generator.")
@click.option("--seed", default=29113007, show_default=True)
@click.option("--rate", "rate_hz", type=float, help="Largest rate of every message, Hz.")
@click.option("--stabilize", is_flag=True, help="State STABILIZE as the flight mode.")
@click.option("--show", is_flag=True, help="Print what was flown and found.")
def main(count: int, seed: int, rate_hz: float | None, stabilize: bool, show: bool) -> None:
    """Print a line for each flight, and the shares."""
    totals: dict[str, Count] = {}
    with tempfile.TemporaryDirectory() as folder:
        log, file = Path(folder, "flight.tlog"), Path(folder, "aircraft.yaml")
        for flight in flights(count, seed):
            written = flight.log if rate_hz is None else at_rate(flight.log, rate_hz)
            log.write_bytes(stabilized(written) if stabilize else written)
            file.write_text(yaml.safe_dump(flight.file))
            found = read(log, file).maneuvers
            one = counted(found, flight)
            name = flight.name.partition("/")[0]
            totals[name] = totals.get(name, Count()) + one
            print(f"{flight.name}: {one.whole} of {one.flown} whole, {one.others} others", flush=True)
            if show and not (one.whole == one.flown and one.others == 0):
                for what, seen in (("flown", flight.flown), ("found", extents(found, flight))):
                    print(f"   {what}", *(f"{begin:.1f}-{last:.1f}" for begin, last in seen))
    for name, total in totals.items():
        print(f"{name}: {total.whole} of {total.flown} whole, {total.others} others")
    sys.exit(0 if all(total.holds for total in totals.values()) else 1)


if __name__ == "__main__":
    main()
