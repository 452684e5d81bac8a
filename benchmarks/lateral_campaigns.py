"""Whole campaigns of roll and yaw: do intervals hold, are stops right, and are forecasts kept?

    python -m benchmarks.lateral_campaigns SEED [--campaigns 20] [--flights 3]

The bundled aircraft flies ``--plan lateral`` several times with drawn side gusts and a drawn lag of both
servos, which half of the crews state. ``LateralCampaign`` takes the manoeuvres one after the other. A stop is
false where a judged derivative is outside its tolerance.
"""

import argparse
import sys
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from advisor.aircraft.aircraft import Aircraft, SideControl
from advisor.campaign.axis_campaign import LateralCampaign
from advisor.campaign.state import ByHand
from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.oem.axis.estimate import AxisEstimate
from advisor.process.parts import Parts
from benchmarks.lateral_gap import recordings, scenario_of
from benchmarks.studies.forecast import Forecast, score
from sim.lateral import UAV, lateral_flight
from sim.scenario import Servo

JUDGED = ("L_p", "L_delta_a", "N_beta", "N_delta_r")
"""Derivatives whose intervals and tolerances are checked."""
TOLERANCE = 0.10
"""Twice the default tolerance of a campaign, which is 5 %."""
NORMAL_95 = 1.96
GUSTS_M_S = 0.4
"""Largest standard deviation of the side gusts; half of the flights have none."""
LAGS_S = (0.02, 0.08)


@dataclass(frozen=True)
class Flown:
    """One campaign at its end."""

    gusts_m_s: float
    states_lag: bool
    flown: int
    accepted: int
    stopped_at: int | None
    outside: tuple[str, ...]
    """Judged derivatives outside their tolerance at the stop."""
    held: tuple[bool, ...]
    """Whether each interval of the last joint estimate holds the truth."""
    forecasts: tuple[Forecast, ...]

    @property
    def row(self) -> str:
        """Row of the table."""
        stop = "–" if self.stopped_at is None else str(self.stopped_at)
        said = " ".join("?" if f.median is None else f"{f.flown}:{f.median}/{f.p90}" for f in self.forecasts)
        return (
            f"| {self.gusts_m_s:.2f} | {'yes' if self.states_lag else 'no'} | {self.accepted}/{self.flown}"
            f" | {stop} | {', '.join(self.outside) or '–'} | {sum(self.held)}/{len(self.held)} | {said} |"
        )


def campaigns(seed: int, count: int, flights: int) -> Iterator[Flown]:
    """Yield campaigns of several flights each."""
    rng = np.random.default_rng(seed)
    for number in range(count):
        gusts = float(rng.uniform(0.05, GUSTS_M_S)) * (number % 2)
        lag_s = float(rng.uniform(*LAGS_S))
        states = bool(rng.integers(2))
        effects = {"side_turbulence": {"sigma_v_m_s": gusts}} if gusts else {}
        flown = []
        for _ in range(flights):
            scenario = replace(scenario_of(int(rng.integers(2**31)), effects), servo=Servo(lag_s=lag_s))
            flown += recordings(lateral_flight(scenario))
        yield _taken(flown, gusts, lag_s if states else None)


def _taken(flown: Sequence[Maneuver], gusts: float, stated_s: float | None) -> Flown:
    """Return what a crew hears of manoeuvres one after the other, and the estimate at the end."""
    control = SideControl(lag_s=stated_s, delay_s=0.0)
    campaign = LateralCampaign(Aircraft(aileron=control, rudder=control), Parts())
    forecasts: list[Forecast] = []
    stopped_at, outside = None, list[str]()
    for number, maneuver in enumerate(flown, 1):
        campaign.take(replace(maneuver, number=number), ByHand())
        if stopped_at is not None:
            continue
        verdict, model = campaign.state().flight_test, campaign.state().model
        if verdict.decision == "stop" and model is not None:
            stopped_at = number
            outside = [name for name in JUDGED if abs(model.value(name) / UAV[name] - 1.0) > TOLERANCE]
        elif verdict.next is not None and (more := verdict.next.remaining) is not None:
            forecasts.append(Forecast(number, more.median, more.p90))
    campaign.finish()
    return Flown(
        gusts, stated_s is not None, len(flown), sum(one.verdict.accepted for one in campaign.judged),
        stopped_at, tuple(outside), tuple(_held(campaign.state().model)), tuple(forecasts),
    )  # fmt: skip


def _held(model: AxisEstimate | None) -> Iterator[bool]:
    """Yield whether each stated interval holds the truth."""
    for name in JUDGED:
        if model is not None and name not in model.not_identifiable:
            half = NORMAL_95 * float(model.std[model.names.index(name)])
            yield abs(model.value(name) - UAV[name]) <= half


def main() -> int:
    """Print the table and the counts; 1 where a stop is false."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("seed", type=int)
    parser.add_argument("--campaigns", type=int, default=20)
    parser.add_argument("--flights", type=int, default=3)
    asked = parser.parse_args()
    print("| gusts, m/s | lag stated | accepted | stop | outside | intervals that hold | forecasts |")
    print("|---|---|---|---|---|---|---|")
    found = []
    for one in campaigns(asked.seed, asked.campaigns, asked.flights):
        found.append(one)
        print(one.row, flush=True)
    held = [holds for one in found for holds in one.held]
    stops = [one for one in found if one.stopped_at is not None]
    wrong = sum(bool(one.outside) for one in stops)
    told = score([(one.forecasts, one.stopped_at, one.flown) for one in found])
    print(
        f"{sum(held)} of {len(held)} intervals hold; {wrong} of {len(stops)} stops are false, in "
        f"{len(found)} campaigns; {told.kept} of {told.checked} forecasts held, "
        f"{told.jumped} of {told.followed} jumped."
    )
    return int(wrong > 0)


if __name__ == "__main__":
    sys.exit(main())
