"""Share of the intervals that hold where lag, delay and parts of a channel are unknown.

    python -m benchmarks.coverage_unknown [--flights 200] [--seed 29113201] [--minutes 8]

Flights of three generators in which nothing is wrong are analysed without model, servo lag and delay in the
aircraft file. In a share of the flights one message is missing for a fifth of the flight. Each main
derivative of the joint estimate is compared with the true one at the same read air speed.
"""

import sys
import tempfile
import time
from collections import Counter
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import click
import numpy as np
import yaml

from advisor.aircraft.reference import SPEED_EXPONENTS
from advisor.flight.signals.track import true_over_read
from advisor.library import find, judge, read
from advisor.report.document import analysis_document
from benchmarks.endure import packets
from benchmarks.gap_draws import DRAWS, WORLDLY
from sim.sealed.cases import SealedCase

DERIVATIVES = ("Z_alpha", "M_alpha", "M_q", "M_delta_e")
HOLES = ("ATTITUDE", "AOA_SSA", "VFR_HUD", "RAW_IMU")
"""Messages of which one may have a hole."""
SHARE, LENGTH = 0.3, 0.2
"""Share of the flights with a hole, and length of the hole over that of the flight."""
GOAL = (0.93, 0.97)
"""Least and largest share of 95 % intervals that holds."""
FAR = 3.0
"""Distance from the truth, in half intervals, that no estimate should have."""


def flights(count: int, seed: int) -> Iterator[tuple[str, SealedCase]]:
    """Yield flights of the generators in turns."""
    each = -(-count // len(WORLDLY))
    streams = {name: DRAWS[name](each, seed, "none", 0.3) for name in WORLDLY}
    for number in range(count):
        name = WORLDLY[number % len(WORLDLY)]
        yield name, next(streams[name])


def with_hole(log: bytes, rng: np.random.Generator) -> bytes:
    """Return the log without one message for a part of the flight."""
    flight = packets.read(log)
    name = HOLES[int(rng.integers(len(HOLES)))]
    first, last = flight[0].arrival_us, flight[-1].arrival_us
    begin = first + float(rng.uniform(0.2, 0.6)) * (last - first)
    end = begin + LENGTH * (last - first)
    kept = [p for p in flight if not (begin <= p.arrival_us < end and packets.name(p.number) == name)]
    return packets.written(kept)


def truth(case: SealedCase, ratio: float) -> tuple[Mapping[str, float], float]:
    """Return the true derivatives, and the air speed that the log's air takes for theirs, m/s.

    A file states the speed as it is read. The day's density makes the true speed half a per cent wrong for
    the derivatives of the flight and of the file alike.
    """
    derivatives = case.truth.get("linear_model") or case.aircraft["model"]
    return derivatives, ratio * float(case.aircraft["reference_airspeed_m_s"])


def unknown(file: Mapping[str, Any]) -> dict[str, Any]:
    """Return the aircraft file without model, lag and delay."""
    elevator = {**file["elevator"], "lag_s": None, "delay_s": None}
    return {**{key: value for key, value in file.items() if key != "model"}, "elevator": elevator}


def distances(case: SealedCase, log: Path, file: Path) -> list[float]:
    """Return the distance of each derivative from the truth, in half 95 % intervals."""
    flight = read(log, file)
    document = analysis_document(judge(flight), [str(log)], flight.aircraft, {})
    model = document.get("model") or {}
    true, at_m_s = truth(case, true_over_read(maneuver.channels for maneuver in find(flight)))
    speed = model.get("reference_airspeed_m_s")
    found = []
    for name in DERIVATIVES:
        told = model.get(name) or {}
        if told.get("value") is None or told.get("ci95") is None or not speed:
            continue
        known = true[name] * (float(speed) / at_m_s) ** SPEED_EXPONENTS[name]
        low, high = told["ci95"]
        found.append(abs(told["value"] - known) / (0.5 * (high - low)))
    return found


@click.command()
@click.option("--flights", "count", default=200, show_default=True, help="Flights in total.")
@click.option("--seed", default=29113201, show_default=True)
@click.option(
    "--minutes", default=8.0, show_default=True, help="Processor time after which no flight begins."
)
def main(count: int, seed: int, minutes: float) -> None:
    """Print the share of the intervals that hold, for each generator, without and with a hole."""
    rng = np.random.default_rng(seed)
    all_of: dict[tuple[str, bool], list[float]] = {}
    flown: Counter[tuple[str, bool]] = Counter()
    with tempfile.TemporaryDirectory() as folder:
        log, file = Path(folder, "flight.tlog"), Path(folder, "aircraft.yaml")
        for name, case in flights(count, seed):
            if time.process_time() > 60.0 * minutes:
                break
            hole = bool(rng.random() < SHARE)
            log.write_bytes(with_hole(case.log, rng) if hole else case.log)
            file.write_text(yaml.safe_dump(unknown(case.aircraft)), encoding="utf-8")
            found = distances(case, log, file)
            all_of.setdefault((name, hole), []).extend(found)
            flown[name, hole] += 1
            print(f"{name}{' with a hole' if hole else ''}: {[round(d, 2) for d in found]}", flush=True)
    for key, found in sorted(all_of.items()):
        print(f"{key[0]}{' with a hole' if key[1] else ''}, {flown[key]} flights: {_said(found)}")
    whole = [distance for found in all_of.values() for distance in found]
    print(f"all, {flown.total()} flights: {_said(whole)}")
    held = np.mean(np.array(whole) <= 1.0) if whole else 0.0
    sys.exit(0 if GOAL[0] <= held <= GOAL[1] and max(whole, default=0.0) <= FAR else 1)


def _said(found: list[float]) -> str:
    hold = sum(distance <= 1.0 for distance in found)
    return (
        f"{hold} of {len(found)} intervals hold, the farthest {max(found, default=0.0):.1f} half widths off"
    )


if __name__ == "__main__":
    main()
