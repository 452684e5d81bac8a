"""Inputs at once: the command between its samples, rolling with yawing, and a roll faster than its servo."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from advisor.aircraft.aircraft import Aircraft, Alpha, Beta
from advisor.decision.axes.influences import carries_coupling
from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.flight.maneuvers.stepped_input import between_samples, command_of
from advisor.model.axes.lateral import LATERAL
from advisor.oem.axis.estimate import AxisEstimate
from advisor.oem.axis.estimator import estimate_axis
from advisor.oem.estimate import Estimate
from advisor.oem.estimator import estimate
from advisor.oem.known_instruments import with_found
from advisor.oem.rows import Signal
from advisor.scripts.table import Source, script_table
from benchmarks.at_once.body import Body, draw_body
from benchmarks.at_once.flight import fly
from benchmarks.at_once.telemetry import tlog_of
from tests.heard import Heard, hear_log

VANE = replace(Aircraft(), alpha=Alpha("named_value:alpha", 0.0), beta=Beta("named_value:beta", 0.0))


def _flown(kind: int, seed: int, lag_s: float, log: Path) -> tuple[Body, Heard]:
    """Fly two multisines with an aircraft of the fleet whose servos have a lag."""
    rng = np.random.default_rng([seed, kind])
    body = draw_body(rng, kind)
    table = script_table(Aircraft(), Source(), ("multisine",), round(body.short_period_s, 2))
    log.write_bytes(tlog_of(fly(body, table, np.full(3, lag_s), 2), body, True, rng))
    return body, hear_log(log, VANE, lateral=True)


@pytest.fixture(scope="module")
def flown(tmp_path_factory: pytest.TempPathFactory) -> tuple[Body, Maneuver]:
    """An unmanned aircraft of 20 kg, with its second multisine."""
    body, heard = _flown(1, 1, 0.06, tmp_path_factory.mktemp("body") / "flight.tlog")
    return body, heard.maneuvers[1]


def test_a_sine_between_its_samples_keeps_its_size() -> None:
    t, fine = np.arange(0.0, 5.0, 0.02), np.arange(1.0, 4.0, 0.005)
    command, sine = Signal(t, np.sin(17.6 * t)), np.sin(17.6 * fine)
    curve = Signal(*between_samples(*command))
    sizes = [signal.at(fine) @ sine / (sine @ sine) for signal in (command, curve)]
    assert sizes[0] < 0.991
    assert sizes[1] == pytest.approx(1.0, abs=1e-3)


@pytest.mark.parametrize(("kind", "parts"), [("multisine", 4), ("3-2-1-1", 1)])
def test_sines_alone_have_corners_between_their_samples(kind, parts, flown):
    maneuver = replace(flown[1], span=replace(flown[1].span, kind=kind))
    samples = len(maneuver.channels["elevator"])
    assert len(command_of(maneuver, "elevator").t) == parts * (samples - 1) + 1


def test_the_moment_of_rolling_with_yawing_does_not_move_the_stiffness(flown: tuple[Body, Maneuver]) -> None:
    body, maneuver = flown
    found = estimate(maneuver, replace(VANE, elevator=replace(VANE.elevator, lag_s=0.06)))
    assert isinstance(found, Estimate)
    assert found.airspeed_m_s is not None
    assert carries_coupling(found)
    truth = body.derivatives(found.airspeed_m_s)
    for name in ("M_alpha", "M_q", "M_delta_e"):
        off = abs(found.value(name) - truth[name])
        assert off < 2.5 * float(found.std[found.names.index(name)]), name


def test_the_moment_of_rolling_with_yawing_is_no_term_of_the_user(flown: tuple[Body, Maneuver]) -> None:
    found = estimate(flown[1], VANE)
    assert isinstance(found, Estimate)
    assert found.terms == ()
    assert "M:p*r" not in [x.name for x in found.instruments]


def test_a_manoeuvre_of_steps_takes_what_inputs_at_once_have_told_of_its_instruments(flown):
    told = estimate(flown[1], VANE)
    stepped = replace(flown[1], span=replace(flown[1].span, kind="3-2-1-1"))
    assert isinstance(told, Estimate)
    assert told.found is not None
    found = estimate(stepped, with_found(VANE, told.found))
    assert isinstance(found, Estimate)
    assert "M:p*r" not in [x.name for x in found.instruments]


@pytest.mark.study
def test_a_roll_faster_than_its_servo_is_not_exchanged_with_the_servo(tmp_path: Path) -> None:
    body, heard = _flown(0, 5101, 0.1, tmp_path / "flight.tlog")
    found = estimate_axis(LATERAL, heard.sideways[:1], VANE)
    assert isinstance(found, AxisEstimate)
    assert body.derivatives(body.speed)["L_p"] < -3.0 / 0.1
    assert found.value("L_p") == pytest.approx(body.derivatives(found.airspeed_m_s)["L_p"], rel=0.05)
