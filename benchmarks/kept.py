"""Are the forecasts of recorded flights kept?

    python -m benchmarks.kept LOG [LOG ...]

Each log is heard as a link delivers it. After every manoeuvre the crew hears how many more are needed. A line
a log and axis has these forecasts as FLOWN:MEDIAN/MOST and the stop. The last line has the share that is kept
(goal 85 to 95 %) and the number of forecasts that leave the band of the one before. An aircraft file of the
same name next to a log is used.
"""

import argparse
import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from advisor.aircraft.aircraft import Aircraft
from advisor.aircraft_file.read import load_aircraft
from advisor.campaign.campaign import Campaign
from advisor.campaign.state import CampaignState, LateralState
from advisor.mavlink.logs.logs import read_whole_log
from advisor.session.timeline import Timeline
from benchmarks.studies.forecast import Forecast, score

HEARD_EVERY_S = 2.0
"""Time between two looks at a log, s: less than the shortest time between two manoeuvres."""


class Course:
    """Forecasts of one axis, from its first manoeuvre to its stop."""

    def __init__(self) -> None:
        self.forecasts: list[Forecast] = []
        self.stop: int | None = None
        self.flown = 0

    def hear(self, axis: CampaignState | LateralState) -> None:
        """Keep the forecast after a new manoeuvre."""
        verdict, flown = axis.flight_test, len(axis.maneuvers)
        is_new, self.flown = flown > self.flown, flown
        if self.stop is not None or not flown:
            return
        if verdict.decision == "stop":
            self.stop = flown
        elif is_new and verdict.next is not None and verdict.next.remaining is not None:
            more = verdict.next.remaining
            self.forecasts.append(Forecast(flown, more.median, more.p90))


def courses(log: Path, aircraft: Aircraft) -> Iterator[tuple[str, Course]]:
    """Yield the name and the course of each axis that a log tests."""
    campaign = Campaign(aircraft, lateral=True)
    timeline = Timeline([columns for batch in read_whole_log(log) for columns in batch])
    heard = {"pitch": Course(), "roll and yaw": Course()}
    for position_s in [*np.arange(0.0, timeline.duration_s + HEARD_EVERY_S, HEARD_EVERY_S), np.inf]:
        if np.isfinite(position_s):
            campaign.feed(timeline.up_to(float(position_s)))
        else:
            campaign.finish()
        state = campaign.state
        heard["pitch"].hear(state)
        if state.lateral is not None:
            heard["roll and yaw"].hear(state.lateral)
    yield from ((axis, course) for axis, course in heard.items() if course.forecasts)


def main() -> int:
    """Print the table and the score."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("logs", nargs="+", type=Path)
    flown: list[Course] = []
    print("| log | axis | stop | forecasts |\n|---|---|---|---|")
    for log in parser.parse_args().logs:
        file = log.with_suffix(".yaml")
        for axis, course in courses(log, load_aircraft(file) if file.exists() else Aircraft()):
            flown.append(course)
            said = " ".join(f"{one.flown}:{one.median}/{one.p90}" for one in course.forecasts)
            print(
                f"| {log.stem} | {axis} | {course.stop or f'none of {course.flown}'} | {said} |", flush=True
            )
    told = score([(one.forecasts, one.stop, one.flown) for one in flown])
    print(
        f"{told.kept} of {told.checked} forecasts are kept, {told.jumped} of {told.followed} leave the band."
    )
    return 0


if __name__ == "__main__":
    sys.exit(main())
