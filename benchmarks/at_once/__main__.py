"""Inputs of three surfaces at once against the truth: derivatives within tolerance, intervals that hold.

    python -m benchmarks.at_once --fleet [--seed N] [--inputs N] [--derived] [--keep DIR]
    python -m benchmarks.at_once --airframes 9 [--seed N] [--inputs N] [--mode MODE] [--keep DIR]
    python -m benchmarks.at_once [TLOG ...] [--coefficients FILE] [--inputs N] [--mode MODE] [--keep DIR]

``--fleet`` flies nine aircraft of the generators as rigid bodies in six degrees of freedom, with a vane or
with an autopilot's angle of attack (``--derived``). With ``--airframes`` ArduPlane in software in the loop
flies the script that the advisor writes for an unknown aircraft, on drawn airframes
(``benchmarks.arduplane_generator``). Otherwise ArduPlane flies one airframe, or its logs are read.
ArduPlane's ground speed is its true air speed, because no wind blows. The exit code is 0 if every stretch is
found once and accepted on each axis.
"""

import argparse
import json
import sys
import tempfile
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from advisor.aircraft.aircraft import Aircraft, Alpha, Beta
from advisor.scripts.inputs import MULTISINE
from advisor.scripts.table import Source, script_table
from benchmarks.arduplane_generator.airframe import draw_airframe
from benchmarks.scripted.pilot import SITL

from . import arduplane
from .body import FLEET, draw_body
from .flight import fly
from .score import Truth, score, totals
from .telemetry import tlog_of

VANE = replace(Aircraft(), alpha=Alpha("named_value:alpha", 0.0), beta=Beta("named_value:beta", 0.0))
"""Aircraft file of the fleet with a vane at the centre of gravity."""
PERIOD_OFF = (0.75, 1.3)
"""Range of the short period that the crew states, over the true one."""
LAG_S = (0.02, 0.12)
"""Range of the servos' lag, s, which the aircraft file does not state."""


@dataclass(frozen=True)
class Case:
    """A log that is flown or read, with its aircraft file and its truth."""

    log: Path
    aircraft: Aircraft
    truth: Truth
    of_log: bool = False
    """Whether the truth holds at the true air speed by the log's ground speed."""


def main() -> int:
    """Print the table of each flight and the totals; 1 if a stretch is not accepted on both axes."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("logs", nargs="*", type=Path)
    parser.add_argument("--coefficients", type=Path, default=SITL / "light.json")
    parser.add_argument("--keep", type=Path, help="folder of the logs; a temporary one by default")
    parser.add_argument("--fleet", action="store_true", help="nine aircraft of the generators")
    parser.add_argument("--derived", action="store_true", help="the fleet has no vane")
    parser.add_argument("--airframes", type=int, default=0, help="number of drawn airframes of ArduPlane")
    parser.add_argument("--seed", type=int, default=29)
    parser.add_argument("--inputs", type=int, default=1, help="number of multisines")
    parser.add_argument("--mode", choices=("FBWA", "MANUAL"), default="FBWA")
    given = parser.parse_args()
    if not given.fleet and not given.logs and not (SITL / "arduplane.xz").exists():
        print(f"No log is given, and {SITL} holds no simulator: give a log, or --fleet.", file=sys.stderr)
        return 2
    with tempfile.TemporaryDirectory() as name:
        folder = given.keep or Path(name)
        folder.mkdir(exist_ok=True)
        scores = [score(one.log, one.aircraft, one.truth, one.of_log) for one in _cases(given, folder)]
    print(totals(scores))
    return 0 if all(one.accepted == (given.inputs, given.inputs) for one in scores) else 1


def _cases(given: argparse.Namespace, folder: Path) -> Iterator[Case]:
    if given.fleet:
        yield from (_of_fleet(given, folder, kind) for kind in range(len(FLEET)))
        return
    stated = json.loads(given.coefficients.read_text(encoding="utf-8"))
    if given.logs:
        yield from (Case(log, Aircraft(), _formulas(_beside(log, stated)), True) for log in given.logs)
        return
    planes: dict[str, Mapping[str, float]] = {"at-once": stated}
    if given.airframes:
        seeds = {f"at-once-{given.seed}-{k}": [given.seed, k] for k in range(given.airframes)}
        planes = {
            name: draw_airframe(np.random.default_rng(seed)).coefficients for name, seed in seeds.items()
        }
    for name, coefficients in planes.items():
        log = folder / f"{name}.tlog"
        try:
            arduplane.fly(coefficients, log, given.inputs, given.mode)
        except AssertionError as waits:
            print(f"\n{name}: not flown to its end: {waits}", flush=True)
            continue
        yield Case(log, Aircraft(), _formulas(coefficients), True)


def _beside(log: Path, stated: Mapping[str, float]) -> Mapping[str, float]:
    """Return the coefficients that were written next to a log, else those stated."""
    beside = log.with_suffix(".json")
    return json.loads(beside.read_text(encoding="utf-8")) if beside.exists() else stated  # type: ignore[no-any-return]


def _formulas(coefficients: Mapping[str, float]) -> Callable[[float], Mapping[str, float]]:
    return lambda speed_m_s: arduplane.derivatives(coefficients, speed_m_s)


def _of_fleet(given: argparse.Namespace, folder: Path, kind: int) -> Case:
    """Fly one aircraft of the fleet, and write its log."""
    rng = np.random.default_rng([given.seed, kind])
    body = draw_body(rng, kind)
    period_s = round(body.short_period_s * float(rng.uniform(*PERIOD_OFF)), 2)
    table = script_table(Aircraft(), Source(), (MULTISINE,), period_s)
    lags_s = np.full(3, rng.uniform(*LAG_S))
    flown = fly(body, table, lags_s, given.inputs)
    log = folder / f"{body.pitching.name.replace(' ', '-')}-{given.seed}.tlog"
    log.write_bytes(tlog_of(flown, body, not given.derived, rng))
    print(f"\n{body.pitching.name}: servo lag {lags_s[0]:.3f} s, bank up to {_bank_deg(flown.state):.0f} deg")
    return Case(log, Aircraft() if given.derived else VANE, body.derivatives)


def _bank_deg(state: np.ndarray) -> float:
    return float(np.degrees(np.max(np.abs(state[:, 6]))))


if __name__ == "__main__":
    sys.exit(main())
