"""Single tests of roll and yaw: do the 95 % intervals of derivatives and modes hold the truth?

    python -m benchmarks.lateral_singles SEED [--flights 24] [--records FOLDER]

The bundled aircraft flies ``--plan lateral`` in still air and in side gusts in turn, with a drawn lag of both
servos, which half of the crews state. Every manoeuvre is estimated alone. With ``--records``, every
manoeuvre of the lateral records in FOLDER is estimated alone too, against what their README says.
"""

import argparse
import sys
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from advisor.aircraft.aircraft import Aircraft
from advisor.aircraft.controls import SideControl
from advisor.aircraft_file.read import load_aircraft
from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.model.axes.lateral import LATERAL, Trim, modes_of, state_matrix
from advisor.oem.axis.estimator import AxisEstimate, estimate_axis
from advisor.words.quantiles import NORMAL_95
from benchmarks.lateral import KNOWN, MODES, Known, analyzed
from benchmarks.lateral_campaigns import GUSTS_M_S, LAGS_S
from benchmarks.lateral_gap import recordings, scenario_of
from sim.lateral import UAV, lateral_flight
from sim.scenario import Servo

SPEEDS_M_S = {"lateral-autopilot": 21.70}
"""Read air speed to which the known values of a record belong; other records hardly change their speed."""
_POWERS = {term.name: term.power for term in LATERAL.shared} | {"omega": 1, "zeta": 0, "T_roll": -1}
"""Power of the air speed of every quantity."""


@dataclass(frozen=True)
class Told:
    """One interval of one single test."""

    group: str
    name: str
    off: float
    """Error over the half-width of the interval."""
    width: float
    """Half-width over the true value."""


def told_of(group: str, estimate: AxisEstimate, truth: Mapping[str, float]) -> Iterator[Told]:
    """Yield every stated interval whose truth is known."""
    found = {n: (estimate.value(n), float(estimate.std[k])) for k, n in enumerate(estimate.names)}
    found = {name: value for name, value in found.items() if name not in estimate.not_identifiable}
    for name, attribute in MODES.items():
        if (mode := getattr(estimate.modes, attribute)) is not None:
            found[name] = mode.value, mode.std
    for name, true in truth.items():
        if name in found:
            half = NORMAL_95 * found[name][1]
            yield Told(group, name, (found[name][0] - true) / half, half / max(abs(true), 1e-9))


def simulated(seed: int, flights: int) -> Iterator[Told]:
    """Yield the intervals of the single tests of simulated flights."""
    rng = np.random.default_rng(seed)
    for number in range(flights):
        gusts = float(rng.uniform(0.05, GUSTS_M_S)) * (number % 2)
        lag_s, states = float(rng.uniform(*LAGS_S)), bool(rng.integers(2))
        effects = {"side_turbulence": {"sigma_v_m_s": gusts}} if gusts else {}
        scenario = replace(scenario_of(int(rng.integers(2**31)), effects), servo=Servo(lag_s=lag_s))
        control = SideControl(lag_s=lag_s if states else None, delay_s=0.0)
        aircraft = Aircraft(aileron=control, rudder=control)
        for maneuver in recordings(lateral_flight(scenario)):
            estimate = estimate_axis(LATERAL, [maneuver], aircraft)
            if isinstance(estimate, AxisEstimate):
                air = "gusts" if gusts else "still air"
                yield from told_of(f"{air}, {_flown(estimate)}", estimate, _truth(maneuver, estimate))


def _flown(estimate: AxisEstimate) -> str:
    return " and ".join(estimate.flown)


def _truth(maneuver: Maneuver, estimate: AxisEstimate) -> Mapping[str, float]:
    """Return the derivatives and modes of the bundled aircraft at a manoeuvre's trim."""
    assert estimate.airspeed_m_s is not None
    alpha, theta = (float(np.mean(maneuver.channels[name].y)) for name in ("alpha", "theta"))
    values = np.array([UAV[name] for name in LATERAL.names.reported])
    modes = modes_of(state_matrix(values, Trim(estimate.airspeed_m_s, alpha, theta)))
    assert modes.dutch_roll is not None
    assert modes.roll is not None
    size = abs(modes.dutch_roll)
    return {**UAV, "omega": size, "zeta": -modes.dutch_roll.real / size, "T_roll": -1.0 / modes.roll}


def recorded(known: Known, folder: Path) -> Iterator[Told]:
    """Yield the intervals of the single tests of one record."""
    aircraft = load_aircraft(folder / f"{known.log}.yaml")
    aircraft = replace(aircraft, aileron=known.aileron, rudder=known.rudder, beta=known.beta)
    for one in analyzed(folder / f"{known.log}.tlog", aircraft).maneuvers:
        if not isinstance(one.estimate, AxisEstimate):
            continue
        speed = one.estimate.airspeed_m_s or 1.0
        ratio = speed / SPEEDS_M_S.get(known.log, speed)
        truth = {name: value * ratio ** _POWERS[name] for name, (value, _) in known.truth.items()}
        yield from told_of(f"{known.log}{known.said}, {_flown(one.estimate)}", one.estimate, truth)


def rows(told: Sequence[Told]) -> Iterator[str]:
    """Yield a row of the table for each group and kind of quantity, and for each air or record."""
    table: dict[tuple[str, str], list[Told]] = {}
    for one in told:
        air, kind = one.group.split(",")[0], "modes" if one.name in MODES else "derivatives"
        for key in {(one.group, one.name if kind == "modes" else kind), (air, kind)}:
            table.setdefault(key, []).append(one)
    for (group, kind), picked in sorted(table.items()):
        inside = sum(abs(one.off) <= 1.0 for one in picked)
        width = 100.0 * float(np.median([one.width for one in picked]))
        share = 100.0 * inside / len(picked)
        yield f"| {group} | {kind} | {inside} of {len(picked)} | {share:.1f} % | {width:.2g} % |"


def main() -> int:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("seed", type=int)
    parser.add_argument("--flights", type=int, default=24)
    parser.add_argument("--records", type=Path)
    asked = parser.parse_args()
    told = list(simulated(asked.seed, asked.flights))
    for known in KNOWN if asked.records else ():
        told += recorded(known, asked.records)
    print("| flown | intervals | hold | share | median half-width |\n|---|---|---|---|---|")
    for row in rows(told):
        print(row)
    return 0


if __name__ == "__main__":
    sys.exit(main())
