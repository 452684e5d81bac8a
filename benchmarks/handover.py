"""Derivatives that a diagnosis of roll and yaw hands over, against the truth of simulated flights.

    python -m benchmarks.handover SEED [--each 1]     # about ten seconds a flight

The bundled aircraft flies ``--plan lateral`` with one effect of ``lateral_gap``. Six derivatives of the
aircraft file are wrong by up to 25 %, drawn from the seed. A row has the mean relative error of these six:
of the file, of the estimate without the effect, and of the derivatives handed over. Its last number is how
many of the 95 % intervals of the six handed over hold the truth.
"""

import argparse
import sys
from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from advisor.aircraft.reference import SIDE_PARAMETERS
from advisor.gap.axis.comparison import compare_axis
from advisor.model.axes.lateral import LATERAL
from advisor.oem.axis.estimator import estimate_axis
from advisor.oem.estimate import NoEstimate
from benchmarks.lateral_gap import AIRCRAFT, CASES, recordings, said_of, scenario_of
from sim.lateral import UAV, lateral_flight

WRONG = ("L_beta", "L_p", "L_delta_a", "N_beta", "N_r", "N_delta_r")
"""Derivatives of the file that are wrong."""
MOST = 0.25
"""Largest relative error of a derivative of the file."""


def error_of(values: Mapping[str, float]) -> float:
    """Return the mean relative error of six derivatives, in per cent."""
    return 100.0 * float(np.mean([abs(values[name] / UAV[name] - 1.0) for name in WRONG]))


def flown(seed: int, name: str, size: float, rng: np.random.Generator) -> tuple[str, list[float], int]:
    """Return the answer to a flight with an effect, the errors, and the number of intervals that hold.

    The errors are those of the file, of the estimate without the effect, and of what is handed over.
    """
    flight = recordings(lateral_flight(scenario_of(seed, {name: {CASES[name].parameter: size}})))
    given = dict(UAV) | {one: UAV[one] * (1.0 + rng.uniform(-MOST, MOST)) for one in WRONG}
    aircraft = replace(AIRCRAFT, model=given)
    estimate, found = estimate_axis(LATERAL, flight, aircraft), compare_axis(LATERAL, flight, aircraft)
    assert not isinstance(estimate, NoEstimate)
    assert not isinstance(found, NoEstimate)
    alone = dict(zip(SIDE_PARAMETERS, estimate.theta.tolist(), strict=True))
    over = alone | {one.name: one.found.value for one in found.derivatives}
    told = said_of(found) if found.verdict == "effect" else ""
    hold = sum(abs(UAV[d.name] - d.found.value) <= d.half for d in found.derivatives if d.name in WRONG)
    return told or str(found.verdict), [error_of(one) for one in (given, alone, over)], hold


def main() -> int:
    """Print a row a flight, then the medians."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("seed", type=int)
    parser.add_argument("--each", type=int, default=1)
    asked = parser.parse_args()
    rng = np.random.default_rng(asked.seed)
    print("| withheld | told | file | estimate alone | handed over | hold |\n|---|---|---|---|---|---|")
    errors, held = [], 0
    for name in [one for one in CASES if CASES[one].is_named for _ in range(asked.each)]:
        size = float(rng.uniform(*CASES[name].sizes))
        told, each, hold = flown(int(rng.integers(2**31)), name, size, rng)
        errors.append(each)
        held += hold
        shown = " | ".join(f"{one:.1f} %" for one in each)
        print(f"| {name} {size:.3g} | {told} | {shown} | {hold} of {len(WRONG)} |", flush=True)
    medians = np.median(errors, axis=0)
    shown = " | ".join(f"{one:.1f} %" for one in medians)
    print(f"median of {len(errors)} flights: {shown}; {held} of {len(errors) * len(WRONG)} intervals hold")
    return 0


if __name__ == "__main__":
    sys.exit(main())
