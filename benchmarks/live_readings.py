"""How often the number on the pilot's screen holds the truth while a manoeuvre is being flown.

    python -m benchmarks.live_readings [--campaigns 6] [--seed 71]

Recorded flights are heard as a link would deliver them, five states a second. Every state whose M_α may be
read counts once. The truth is the simulator's own linearisation, at the estimate's air speed.
"""

import argparse
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import product
from pathlib import Path

import numpy as np

from advisor.aircraft.aircraft import Aircraft
from advisor.aircraft.controls import Elevator
from advisor.aircraft.reference import PARAMETERS, SPEED_EXPONENTS
from advisor.campaign.campaign import Campaign
from advisor.campaign.state import CampaignState
from advisor.mavlink.logs.logs import open_log
from advisor.session.timeline import Timeline
from sim.flight import Flight
from sim.record import record
from sim.scenario import Noise, Scenario, Servo

EVERY_S = 0.2
SHOWN = "M_alpha"
Z95 = 1.96
AIRFRAMES = {"linear": 0.0, "uav": 0.1}
"""Aircraft to the lag of its servo, s."""


@dataclass(frozen=True)
class Readings:
    """What the pilot could read in some flights."""

    states: int
    """States with a manoeuvre in the air and a fit of it."""
    off: np.ndarray
    """Errors of the numbers shown, in half-widths of their 95 % intervals."""

    def text(self, name: str) -> str:
        """Return one line of the table."""
        share = 100.0 * float(np.mean(np.abs(self.off) <= 1.0)) if len(self.off) else float("nan")
        far = int(np.sum(np.abs(self.off) > 10.0))
        return f"{name:<34}{self.states:>8}{len(self.off):>8}{share:>9.1f} %{far:>8}"


def heard(log: Path, aircraft: Aircraft) -> Iterator[CampaignState]:
    """Yield the states of a flight with a manoeuvre in the air, about five a second of the vehicle's time."""
    campaign = Campaign(aircraft, settle=True)
    timeline = Timeline([columns for batch in open_log(log) for columns in batch])
    for position_s in np.arange(0.0, timeline.duration_s + EVERY_S, EVERY_S):
        campaign.feed(timeline.up_to(float(position_s)))
        state = campaign.state
        if state.flying is not None and state.settling is not None:
            yield state


def readings(log: Path, aircraft: Aircraft, truth: float, truth_at_m_s: float | None) -> Readings:
    """Return what could be read during one flight."""
    states, off = 0, []
    row = PARAMETERS.index(SHOWN)
    for state in heard(log, aircraft):
        states += 1
        estimate = state.settling
        if not state.readable or estimate is None:
            continue
        scale = 1.0
        if truth_at_m_s and estimate.airspeed_m_s:
            scale = (estimate.airspeed_m_s / truth_at_m_s) ** SPEED_EXPONENTS[SHOWN]
        off.append((estimate.theta[row] - scale * truth) / (Z95 * estimate.std[row]))
    return Readings(states, np.array(off))


def flown(airframe: str, lag_s: float, noise_percent: float, lag_known: bool, seeds: range) -> Readings:
    """Return the readings of recorded campaigns of one aircraft."""
    found = []
    with tempfile.TemporaryDirectory() as folder:
        for seed in seeds:
            noise, servo = Noise(percent=noise_percent), Servo(lag_s=lag_s)
            flight = Flight(Scenario(aircraft=airframe, noise=noise, servo=servo, seed=seed))
            truth, speed = flight.engine.truth.as_dict()[SHOWN], flight.engine.motion().airspeed
            log = Path(folder) / f"{seed}.tlog"
            record(flight, log)
            aircraft = Aircraft(elevator=Elevator(lag_s=lag_s if lag_known else None))
            found.append(readings(log, aircraft, truth, speed))
    return Readings(sum(r.states for r in found), np.concatenate([r.off for r in found]))


def main() -> None:
    """Fly, hear and print."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--campaigns", type=int, default=6)
    parser.add_argument("--seed", type=int, default=71)
    given = parser.parse_args()
    seeds = range(given.seed, given.seed + given.campaigns)
    print(f"{'aircraft, noise, servo':<34}{'states':>8}{'shown':>8}{'hold':>11}{'> 10 x':>8}")
    for (airframe, lag_s), noise_percent, known in product(AIRFRAMES.items(), (1.0, 5.0), (True, False)):
        found = flown(airframe, lag_s, noise_percent, known, seeds)
        servo = "servo known" if known else "servo unknown"
        print(found.text(f"{airframe}, {noise_percent:g} %, {servo}"), flush=True)


if __name__ == "__main__":
    main()
