"""Recorded flights of the bundled aircraft, made once a test run, whichever of its processes asks first."""

import os
from functools import cache
from pathlib import Path
from tempfile import gettempdir, mkdtemp
from zlib import crc32

from sim.flight import Flight
from sim.record import record
from sim.scenario import Maneuver, Noise, Scenario

FOLDER = Path(mkdtemp(prefix="flights-"))
SHARED = Path(gettempdir()) / f"recorded-{os.environ.get('PYTEST_XDIST_TESTRUNUID', FOLDER.name)}"
"""What all processes of this run of tests record."""
TWO = (Maneuver("3211"), Maneuver("rev"))
"""Enough where each manoeuvre is as good as another."""
FOUR = Scenario().maneuvers[:4]
SHIPPED = Path(__file__).parent.parent / "logs"


@cache
def recorded(
    aircraft: str,
    noise_percent: float,
    seed: int = 11,
    maneuvers: tuple[Maneuver, ...] = Scenario().maneuvers,
) -> Path:
    """A log of the paper's seven manoeuvres, or of others."""
    noise = Noise(percent=noise_percent)
    wait_s = {} if len(maneuvers) > 4 else {"gap_s": 5.0, "closing_s": 3.0}
    scenario = Scenario(aircraft=aircraft, noise=noise, seed=seed, maneuvers=maneuvers, **wait_s)
    flown = f"{crc32(repr(scenario).encode()):08x}"
    path = SHARED / f"{aircraft}-{noise_percent}-{seed}-{len(maneuvers)}-{flown}.tlog"
    if not path.exists():
        SHARED.mkdir(exist_ok=True)
        record(Flight(scenario), FOLDER / path.name)
        (FOLDER / path.name).replace(path)
    return path


@cache
def calm_two() -> Path:
    """The first two of the seven manoeuvres of ArduPlane's calm flight."""
    path = FOLDER / "arduplane-two.tlog"
    whole = (SHIPPED / "arduplane-calm.tlog").read_bytes()
    path.write_bytes(whole[: len(whole) // 3])
    return path


@cache
def truth(aircraft: str) -> dict[str, float]:
    """The eight parameters as the simulator linearises its own aircraft."""
    return dict(Flight(Scenario(aircraft=aircraft)).engine.truth.as_dict())
