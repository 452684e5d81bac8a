"""One flight as telemetry and as the autopilot's own log, at its rates and with its tails: one aircraft."""

from functools import cache
from pathlib import Path

import numpy as np
import pytest

from advisor.aircraft.aircraft import Aircraft
from advisor.aircraft.reference import PARAMETERS
from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.oem.estimate import Estimate
from advisor.oem.estimator import estimate_jointly
from tests.flights import FOLDER, calm_two
from tests.heard import hear_log
from tests.mavlink.from_telemetry import DEFAULT, FAST, dataflash_of

DERIVATIVES = [PARAMETERS.index(name) for name in ("Z_alpha", "M_alpha", "M_q", "M_delta_e")]


@cache
def as_telemetry() -> list[Maneuver]:
    return flown(calm_two())


@cache
def own_log(fast: bool, tail: str) -> list[Maneuver]:
    """The flight's manoeuvres in the log that the autopilot of an aircraft with such a tail keeps."""
    return logged(dataflash_of(calm_two(), FAST if fast else DEFAULT, tail))


def flown(path: Path) -> list[Maneuver]:
    return hear_log(path).maneuvers


def model(maneuvers: list[Maneuver]) -> Estimate:
    found = estimate_jointly(maneuvers, Aircraft())
    assert isinstance(found, Estimate)
    return found


@cache
def model_of_telemetry() -> Estimate:
    return model(as_telemetry())


def apart(ours: Estimate) -> np.ndarray:
    """Differences of the derivatives, in shares of their joint 95 % interval."""
    theirs = model_of_telemetry()
    return (np.abs(ours.theta - theirs.theta) / (1.96 * np.hypot(ours.std, theirs.std)))[DERIVATIVES]


def logged(content: bytes) -> list[Maneuver]:
    path = FOLDER / "own-log.bin"
    path.write_bytes(content)
    return flown(path)


@pytest.mark.parametrize("fast", [False, True], ids=["default", "fast"])
def test_the_autopilots_own_log_tells_of_the_same_aircraft(fast: bool) -> None:
    maneuvers = own_log(fast, "elevon")
    assert [m.span.kind for m in maneuvers] == [m.span.kind for m in as_telemetry()]
    assert np.all(apart(model(maneuvers)) < 1.0)


@pytest.mark.parametrize("tail", ["elevon", "V-tail"])
def test_a_mixed_tail_is_read_as_the_elevator_that_it_makes(tail: str) -> None:
    plain, mixed = own_log(False, "elevator"), own_log(False, tail)
    assert [m.span.kind for m in mixed] == [m.span.kind for m in plain]
    for ours, theirs in zip(mixed, plain, strict=True):
        np.testing.assert_allclose(ours.channels["elevator"].y, theirs.channels["elevator"].y, atol=1e-9)


def test_without_imu_the_angles_tell_of_the_same_aircraft() -> None:
    content = dataflash_of(calm_two(), DEFAULT, "elevator").replace(b"IMU\0Q", b"XXX\0Q")
    assert np.all(apart(model(logged(content))) < 1.0)
