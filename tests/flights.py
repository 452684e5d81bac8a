"""Recorded flights of the bundled aircraft, made once a test run."""

from functools import cache
from pathlib import Path
from tempfile import mkdtemp

from sim.flight import Flight
from sim.record import record
from sim.scenario import Noise, Scenario

FOLDER = Path(mkdtemp(prefix="flights-"))
SHIPPED = Path(__file__).parent.parent / "logs"


@cache
def recorded(aircraft: str, noise_percent: float, seed: int = 11) -> Path:
    """A log of the paper's seven manoeuvres."""
    path = FOLDER / f"{aircraft}-{noise_percent}-{seed}.tlog"
    record(Flight(Scenario(aircraft=aircraft, noise=Noise(percent=noise_percent), seed=seed)), path)
    return path


@cache
def truth(aircraft: str) -> dict[str, float]:
    """The eight parameters as the simulator linearises its own aircraft."""
    return dict(Flight(Scenario(aircraft=aircraft)).engine.truth.as_dict())
