"""What the comparison with a user's own simulator says, where JSBSim flies on both sides.

    python -m benchmarks.own_simulator [--case NAME ...] [--seed N]

A JSBSim aircraft flies with an effect that its unchanged model lacks, and ``advisor gap`` compares the log
with that model. ``sim`` flies the aircraft: an independent program, which shares JSBSim and nothing else with
the adapter. Its own replay, with the effects and sizes that were found, gives the shrink that the report
should state. One row a case, as a Markdown table; the exit code is 1 where a row does not hold.
"""

import re
import sys
import tempfile
import time
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path

import click
import numpy as np

from advisor.aircraft.aircraft import Aircraft
from advisor.analysis.gap import compare_logs
from advisor.flight.signals.track import SEA_LEVEL_DENSITY_KG_M3, standard_density, standard_pressure
from advisor.gap.result import Diagnosis
from advisor.simulators.jsbsim_model import find_model
from sim.compare import distances
from sim.effects.fitting import flight_of
from sim.faults import Faults
from sim.motion import HOME_HEIGHT_M
from sim.record import record
from sim.scenario import Maneuver, Noise, Scenario

_PLAN = tuple(Maneuver(name) for name in ("3211", "rev", "doublet", "3211", "rev", "doublet"))
_WITHIN = 0.1
"""Relative error of a size that holds: the goal of the work on the user's simulator."""
_POINTS = 5.0
"""Points by which the reported shrink may exceed that of the own replay."""
Effects = Mapping[str, Mapping[str, float]]


@dataclass(frozen=True)
class Case:
    """One flight, and what the unchanged model lacks."""

    scenario: Scenario
    indicated: bool = False
    """Whether the log's air speed is the indicated one."""
    damping: float = 1.0
    """Factor of the pitch damping in the model that is the simulator."""

    @property
    def withheld(self) -> str:
        """Name of the answer that is right."""
        return "parameters" if self.damping != 1.0 else next(iter(self.scenario.effects), "none")


def _cessna(**effects: dict[str, float]) -> Scenario:
    return Scenario(
        aircraft="c172p",
        engine="jsbsim",
        airspeed_m_s=53.0,
        height_m=1200.0,
        maneuvers=_PLAN,
        effects=effects,
    )


def _jet(**effects: dict[str, float]) -> Scenario:
    return Scenario(
        aircraft="T37", engine="jsbsim", airspeed_m_s=110.0, height_m=2400.0, unit_s=0.4, amplitude_deg=1.5,
        maneuvers=_PLAN, effects=effects,
    )  # fmt: skip


CASES = {
    "c172p, nothing, true": Case(_cessna()),
    "c172p, nothing, indicated": Case(_cessna(), indicated=True),
    "T37, nothing, true": Case(_jet()),
    "T37, nothing, indicated": Case(_jet(), indicated=True),
    "c172p, delay": Case(_cessna(transport_delay={"delay_s": 0.06}), indicated=True),
    "T37, lag": Case(_jet(actuator_lag={"lag_s": 0.1}), indicated=True),
    "c172p, rate limit": Case(_cessna(actuator_rate_limit={"rate_rad_s": 0.25}), indicated=True),
    "T37, play": Case(_jet(actuator_backlash={"half_width_rad": 0.006})),
    "c172p, q late": Case(_cessna(pitch_rate_skew={"skew_s": 0.05}), indicated=True),
    "c172p, damping": Case(_cessna(), damping=1.4),
}


def flown(case: Case, log: Path, seed: int) -> None:
    """Write the log of a case, with the static pressure of the air flown in."""
    scenario = replace(case.scenario, seed=seed)
    thin = (
        float(standard_density(standard_pressure(HOME_HEIGHT_M + scenario.height_m)))
        / SEA_LEVEL_DENSITY_KG_M3
    )
    scale = {} if case.indicated else {"airspeed": float(1.0 / np.sqrt(thin))}
    record(flight_of(replace(scenario, faults=Faults(scale=scale, thin_air_m=HOME_HEIGHT_M))), log)


def simulator_of(case: Case, folder: Path) -> str:
    """Return the specification of the simulator: the aircraft's model, or one with another pitch damping."""
    name = case.scenario.aircraft
    if case.damping == 1.0:
        return f"jsbsim:{name}"
    damped = r'(<function name="aero/coefficient/Cmq">.*?<product>)'
    text, found = re.subn(
        damped, rf"\1<value>{case.damping}</value>", find_model(name).read_text(), flags=re.DOTALL
    )
    assert found == 1, name
    path = folder / f"{name}.xml"
    path.write_text(text)
    return f"jsbsim:{path}"


def own_shrink(case: Case, found: Effects, folder: Path, seed: int) -> float | None:
    """Return the share of the gap that effects remove in ``sim``'s own flight of the plan, in per cent.

    None where the effects are not those of ``sim``'s catalogue, or where nothing was withheld there.
    """
    if not case.scenario.effects or not found:
        return None
    still = replace(case.scenario, seed=seed, noise=Noise())
    logs = {"truth": still, "plain": replace(still, effects={})}
    logs["improved"] = replace(still, effects={name: dict(sizes) for name, sizes in found.items()})
    for name, scenario in logs.items():
        record(flight_of(scenario), folder / f"{name}.tlog")
    gaps = [
        [d.difference for d in distances(folder / "truth.tlog", folder / f"{name}.tlog")]
        for name in ("plain", "improved")
    ]
    before, after = map(np.array, gaps)
    # An instrument's effect leaves the other channels as they are.
    changed = before > 0.0
    return 100.0 * (1.0 - float(np.mean(after[changed] ** 2 / before[changed] ** 2)))


def answer_of(diagnosis: Diagnosis) -> tuple[str, float | None]:
    """Return the first cause with its first size, or the verdict."""
    first = next((cause for cause in diagnosis.causes if cause.present), None)
    if diagnosis.verdict != "effect" or first is None:
        return diagnosis.verdict, None
    return first.effect, next(iter(first.parameters.values())).value


def holds(case: Case, name: str, size: float | None) -> bool:
    """Return whether an answer is right: the withheld effect within 10 %, or for nothing a model that
    agrees."""
    if name != case.withheld:
        return False
    sizes = case.scenario.effects.get(name)
    return size is None or sizes is None or abs(size / next(iter(sizes.values())) - 1.0) <= _WITHIN


def row(name: str, case: Case, seed: int) -> tuple[str, bool]:
    """Return the row of a case, and whether it holds."""
    with tempfile.TemporaryDirectory() as made:
        folder = Path(made)
        log = folder / "flight.tlog"
        flown(case, log, seed)
        aircraft = Aircraft(simulator=simulator_of(case, folder))
        began = time.process_time()
        told = compare_logs([log], aircraft).diagnosis
        spent = time.process_time() - began
        cause, size = answer_of(told)
        effects = {e: s for e, s in told.effects.items() if e in case.scenario.effects}
        own = own_shrink(case, effects, folder, seed)
    reported = None if told.in_simulator is None else told.in_simulator.percent
    fits = holds(case, cause, size)
    if own is not None and reported is not None:
        fits = fits and reported <= own + _POINTS
    sizes = case.scenario.effects.get(case.withheld, {})
    due = "" if not sizes else f"{next(iter(sizes.values())):.3g}"
    cells = (
        name, due, cause, "" if size is None else f"{size:.3g}",
        "" if reported is None else f"{reported:.0f}", "" if own is None else f"{own:.0f}",
        f"{spent:.0f}", "yes" if fits else "no",
    )  # fmt: skip
    return f"| {' | '.join(cells)} |", fits


@click.command
@click.option("--case", "names", multiple=True, type=click.Choice(list(CASES)), help="Only these cases.")
@click.option("--seed", default=1, show_default=True, help="Seed of the noise.")
def main(names: tuple[str, ...], seed: int) -> None:
    """Fly the cases, diagnose them against JSBSim's own aircraft, and print one row each."""
    click.echo("| withheld | size | answer | size | shrink, % | own replay, % | CPU, s | holds |")
    click.echo("|---|---|---|---|---|---|---|---|")
    held = []
    for name in names or CASES:
        text, fits = row(name, CASES[name], seed)
        click.echo(text)
        held.append(fits)
    sys.exit(int(not all(held)))


if __name__ == "__main__":
    main()
