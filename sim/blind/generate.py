"""Draw and fly sealed cases of the bundled aircraft."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np

from ..effects.fitting import flight_of
from ..record import write_tlog
from ..sealed.cases import SealedCase, write_set
from ..servo import Calibration
from .draw import GROUPS, SHARES, Case, Group, draw_case
from .natural import SHARE, in_the_world, read_airspeed
from .simulated import SimulatedCase, draw_simulated


def generate(
    count: int,
    seed: int,
    folder: Path,
    groups: Sequence[Group] = GROUPS,
    tell: Callable[[str], None] = lambda text: None,
) -> str:
    """Draw and fly ``count`` cases into ``folder``, and return the seal's hash."""

    def told() -> Iterator[SealedCase]:
        for number, case in enumerate(draw(count, seed, groups), start=1):
            yield case
            tell(f"flown {number} of {count}")

    return write_set(folder, told())


def draw(
    count: int, seed: int, groups: Sequence[Group], natural_share: float = SHARE, noise_factor: float = 0.0
) -> Iterator[SealedCase]:
    """Yield the flown cases of a set, of which a share has natural nuisances.

    With a ``noise_factor`` filters act in every flight, and the noise is smaller by down to that factor.
    """
    generator = np.random.default_rng([seed, 2026])
    shares = np.array([SHARES[GROUPS.index(group)] for group in groups])
    if not shares.any():
        shares = np.ones(len(groups))
    for number in range(count):
        group = groups[int(generator.choice(len(groups), p=shares / shares.sum()))]
        own = np.random.default_rng([seed, number])
        name = own.bytes(6).hex()
        case = draw_simulated(own) if group == "simulator" else draw_case(group, own, natural_share)
        if noise_factor:
            case = replace(case, scenario=in_the_world(case.scenario, noise_factor))
        log = BytesIO()
        write_tlog(flight_of(case.scenario), log)
        yield SealedCase(name, case.key(), log.getvalue(), aircraft_file(case))


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
        "reference_airspeed_m_s": round(read_airspeed(case.scenario), 3),
        "model": {name: float(f"{value:.6g}") for name, value in case.prior.as_dict().items()},
    }
