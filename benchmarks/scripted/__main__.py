"""The script of ``advisor script ardupilot``, flown by ArduPlane itself: asked against flown.

    python -m benchmarks.scripted [--airframe NAME] [--aircraft FILE.yaml] [--switch N] [--keep DIR]

The first table compares each control of each input with what the telemetry shows. Edges must lie within 20 ms
after the first one. Levels must lie within 3 %, or within 1 us of a pulse. The second table shows the time
from an event until the script has given its surfaces back. The third one shows what the advisor finds and
decides on each axis. The exit code is 0 if all limits hold, and if the advisor finds every complete input and
nothing else. Edges are not judged where the script reports late calls: the machine is then too slow.
"""

import argparse
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path

from advisor.aircraft.aircraft import Aircraft
from advisor.campaign.campaign import Campaign
from advisor.campaign.state import JudgedManeuver
from advisor.cli.options import read_aircraft
from advisor.mavlink.logs.logs import read_whole_log
from advisor.scripts.table import FlightLimits, Source, script_table

from .airframes import AIRFRAMES
from .flight import ScriptFlight, fly_table
from .measured import deflections, flown_of
from .pilot import SITL

LATE_MS, SIZE_PERCENT, ABORT_S = 20.0, 3.0, 0.1
LOWEST_M = 55.0
LONGEST_S = 1800.0
"""Longest real time of a flight, s."""
_TELEMETRY_MS = 20.0
"""Interval of the servo outputs in the telemetry, ms, by which an edge may seem late."""


def main(arguments: Sequence[str] | None = None) -> int:
    """Fly, print the tables, and return 1 if a limit does not hold."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--airframe", choices=sorted(AIRFRAMES), default="light")
    parser.add_argument("--aircraft", type=Path)
    parser.add_argument("--switch", type=int, default=7)
    parser.add_argument("--keep", type=Path, help="folder of the flight; a temporary one by default")
    given = parser.parse_args(arguments)
    if not (SITL / "arduplane.xz").exists():
        print(f"{SITL} holds no simulator.", file=sys.stderr)
        return 2
    aircraft = read_aircraft(given.aircraft)
    limits = FlightLimits.of(aircraft, LOWEST_M)
    table = script_table(aircraft, Source(dict(aircraft.model)), switch=given.switch, limits=limits)
    with tempfile.TemporaryDirectory() as name:
        folder = given.keep or Path(name)
        folder.mkdir(exist_ok=True)
        flight = fly_table(table, folder, AIRFRAMES[given.airframe](), longest_s=LONGEST_S)
        held = [_asked(flight, aircraft), _aborted(flight), _found(flight, aircraft)]
    return 0 if all(held) else 1


def _asked(flight: ScriptFlight, aircraft: Aircraft) -> bool:
    """Print asked against flown, and return whether each input lies within the limits."""
    t, read = deflections(flight.pilot, aircraft)
    print("| input | control | asked, deg | time error, ms | size error, % | |\n|---|---|---|---|---|---|")
    holds = True
    for number in flight.done:
        late = next((x for _, x in flight.pilot.texts if "LATE" in x and x.endswith(f" in {number}")), "")
        begin_s = flight.pilot.at(f"ADVISOR BEGIN {number} ")
        for one in flown_of(flight.entry(number), begin_s, t, read):
            good = one.late_ms <= LATE_MS and one.size_percent <= max(SIZE_PERCENT, one.pulse_percent)
            word = late.partition(": ")[2] or ("✓" if good else "✗")
            holds = holds and (good or bool(late))
            print(
                f"| {one.input} | {one.control} | {one.asked_deg:.2f} | {one.late_ms:.0f} "
                f"| {one.size_percent:.1f} | {word} |"
            )
    return holds


def _aborted(flight: ScriptFlight) -> bool:
    """Print the time from each event to the end of its input, and return whether all lie within the limit."""
    print("\n| event | text | after, ms | |\n|---|---|---|---|")
    holds = True
    for why, ended in flight.aborts.items():
        after_s = ended.end_s - ended.event_s
        good = "aborted" in ended.said and after_s <= ABORT_S + 1e-3 * _TELEMETRY_MS
        holds = holds and good
        print(f"| {why} | {ended.said} | {1e3 * after_s:.0f} | {'✓' if good else '✗'} |")
    return holds


def _found(flight: ScriptFlight, aircraft: Aircraft) -> bool:
    """Print what the advisor makes of the flight, and return whether it finds each complete input alone."""
    campaign = Campaign(aircraft, lateral=True)
    for columns in read_whole_log(flight.tlog):
        campaign.feed(columns)
    campaign.finish()
    state = campaign.state
    side = state.lateral.maneuvers if state.lateral is not None else ()
    print("\n| begins, s | axis | input | verdict |\n|---|---|---|---|")
    for axis, judged in (("pitch", state.maneuvers), ("roll and yaw", side)):
        for one in judged:
            span = one.maneuver.span
            print(f"| {span.start_s:.1f} | {axis} | {span.kind} | {one.verdict.sentence} |")
    spans = [one.maneuver.span for one in (*state.maneuvers, *side)]
    found = sorted({(round(span.start_s), span.kind) for span in spans})
    asked = [flight.entry(number).test.name for number in flight.done]
    whole = [kind for _, kind in found] == asked
    both = all(_axes(one, state.maneuvers, side) for one in asked if one == "multisine")
    print(f"\nFound {len(found)} of {len(asked)} inputs{'' if whole else ', not those that were flown'}.")
    return whole and both


def _axes(name: str, *axes: Sequence[JudgedManeuver]) -> bool:
    return all(any(one.maneuver.span.kind == name for one in axis) for axis in axes)


if __name__ == "__main__":
    sys.exit(main())
