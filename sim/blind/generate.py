"""Write sealed cases: logs and aircraft files under meaningless names."""

import os
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import yaml

from ..effects.fitting import flight_of
from ..record import record
from ..servo import Calibration
from .draw import GROUPS, SHARES, Case, Group, draw_case
from .seal import seal
from .simulated import SimulatedCase, draw_simulated

LOG, AIRCRAFT = "flight.tlog", "aircraft.yaml"
MADE_AT = 1_790_000_000
"""Time stamp of every file, s since 1970, so that the order of making is hidden."""


def key_beside(folder: Path) -> Path:
    """Return the path of the key of a folder of cases, next to the folder."""
    return folder.with_name(folder.name + ".key.json")


def generate(
    count: int,
    seed: int,
    folder: Path,
    groups: Sequence[Group] = GROUPS,
    tell: Callable[[str], None] = lambda text: None,
) -> str:
    """Draw and fly ``count`` cases into ``folder``; return the seal's hash.

    The key is sealed before the first log is written.
    """
    generator = np.random.default_rng([seed, 2026])
    shares = np.array([SHARES[GROUPS.index(group)] for group in groups])
    if not shares.any():
        shares = np.ones(len(groups))
    folder.mkdir(parents=True, exist_ok=True)
    cases: dict[str, Case] = {}
    for number in range(count):
        group = groups[int(generator.choice(len(groups), p=shares / shares.sum()))]
        own = np.random.default_rng([seed, number])
        name = own.bytes(6).hex()
        cases[name] = draw_simulated(own) if group == "simulator" else draw_case(group, own)
        tell(f"drawn {number + 1} of {count}")
    digest = seal({name: cases[name].key() for name in sorted(cases)}, key_beside(folder), folder)
    for number, name in enumerate(sorted(cases)):
        write_case(cases[name], folder / name)
        tell(f"flown {number + 1} of {count}")
    return digest


def write_case(case: Case, folder: Path) -> None:
    """Write one case's log and aircraft file."""
    folder.mkdir(exist_ok=True)
    record(flight_of(case.scenario), folder / LOG)
    (folder / AIRCRAFT).write_text(yaml.safe_dump(aircraft_file(case), sort_keys=False), encoding="utf-8")
    for path in (folder / LOG, folder / AIRCRAFT, folder):
        os.utime(path, (MADE_AT, MADE_AT))


def aircraft_file(case: Case) -> dict[str, Any]:
    """Return the crew's aircraft file, with equal keys for every case of a group."""
    elevator: dict[str, Any] = {
        "output": "auto",
        "calibration": [list(point) for point in Calibration().points],
        "lag_s": 0.0,
        "delay_s": 0.0,
    }
    if isinstance(case, SimulatedCase):
        return {
            "name": "aircraft",
            "elevator": elevator | dict(case.servo),
            "accelerometer": {"arm_m": round(case.scenario.instruments.accelerometer_arm_m, 4)},
            "simulator": case.simulator,
        }
    return {
        "name": "aircraft",
        "elevator": elevator,
        "accelerometer": {"arm_m": round(case.scenario.instruments.accelerometer_arm_m, 4)},
        "reference_airspeed_m_s": round(case.scenario.airspeed_m_s or 0.0, 3),
        "model": {name: float(f"{value:.6g}") for name, value in case.prior.as_dict().items()},
    }
