"""Recorded flights of the bundled aircraft, made once a test run."""

from functools import cache
from pathlib import Path
from tempfile import mkdtemp

from sim.flight import Flight
from sim.record import record
from sim.scenario import Maneuver, Noise, Scenario

FOLDER = Path(mkdtemp(prefix="flights-"))
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
    path = FOLDER / f"{aircraft}-{noise_percent}-{seed}-{len(maneuvers)}.tlog"
    noise = Noise(percent=noise_percent)
    record(Flight(Scenario(aircraft=aircraft, noise=noise, seed=seed, maneuvers=maneuvers)), path)
    return path


@cache
def truth(aircraft: str) -> dict[str, float]:
    """The eight parameters as the simulator linearises its own aircraft."""
    return dict(Flight(Scenario(aircraft=aircraft)).engine.truth.as_dict())
