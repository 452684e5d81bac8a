"""Share of frames of the pilot's screen with the right word, while a log is flown at its own pace.

    python -m benchmarks.frames [--log logs/arduplane-calm.tlog] [--aircraft logs/arduplane-calm.yaml]

Samples arrive as from a link, and wait until this computer reads them. A frame a second shows the word of the
newest state. The right word is that of the same samples on a computer without delay.
"""

import argparse
import os
import time
from bisect import bisect_right
from pathlib import Path
from typing import NamedTuple

from advisor.aircraft.aircraft import Aircraft
from advisor.campaign.campaign import Campaign
from advisor.cli.options import read_aircraft
from advisor.mavlink.logs.logs import open_log
from advisor.session.behind import BEHIND_S
from advisor.session.source import LinkHealth
from advisor.session.timeline import Timeline
from advisor.session.view import View
from advisor.tui.advice import advise

TICK_S = 0.1


class Frame(NamedTuple):
    """Word of a state."""

    read_to_s: float
    """Time of the newest sample, s."""
    shown_s: float
    """Time at which the word was shown, s."""
    word: str


def flown(log: Path, aircraft: Aircraft, *, waits: bool) -> list[Frame]:
    """Return the words of a flight; ``waits`` is a flight that waits for the computer."""
    timeline = Timeline([columns for batch in open_log(log) for columns in batch])
    campaign = Campaign(aircraft, informs=True, lateral=True, aside=not waits)
    begun_s, at_s, frames = time.monotonic(), 0.0, []
    while at_s < timeline.duration_s:
        if not waits:
            time.sleep(max(0.0, begun_s + at_s + TICK_S - time.monotonic()))
        at_s = at_s + TICK_S if waits else time.monotonic() - begun_s
        campaign.feed(timeline.up_to(at_s))
        view = View(campaign.state, LinkHealth("good", ""), None, aircraft, log.name)
        frames.append(Frame(at_s, at_s if waits else time.monotonic() - begun_s, advise(view).word))
    return frames


def newest(frames: list[Frame], times_s: list[float], at_s: float) -> Frame:
    """Return the frame that is newest at a time."""
    return frames[max(bisect_right(times_s, at_s) - 1, 0)]


def main() -> None:
    """Fly twice, compare and print."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--log", type=Path, default=Path("logs/arduplane-calm.tlog"))
    parser.add_argument("--aircraft", type=Path, default=Path("logs/arduplane-calm.yaml"))
    given = parser.parse_args()
    aircraft = read_aircraft(given.aircraft)
    ideal, here = (flown(given.log, aircraft, waits=waits) for waits in (True, False))
    ideal_s, shown_s = [frame.read_to_s for frame in ideal], [frame.shown_s for frame in here]
    seconds = range(1, int(ideal_s[-1]))
    shown = [newest(here, shown_s, second) for second in seconds]
    right = sum(
        frame.word == newest(ideal, ideal_s, second).word
        for frame, second in zip(shown, seconds, strict=True)
    )
    ages = [second - frame.read_to_s for frame, second in zip(shown, seconds, strict=True)]
    print(f"load average {os.getloadavg()[0]:.1f} on {os.cpu_count()} processors")
    print(f"frames with the right word {right} of {len(seconds)} (goal all)")
    print(f"frames older than {BEHIND_S:g} s {sum(age > BEHIND_S for age in ages)}, oldest {max(ages):.1f} s")


if __name__ == "__main__":
    main()
