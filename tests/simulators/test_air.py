"""The air in which a simulator flies: true air speed, and the height of its density."""

from dataclasses import replace
from typing import Any, ClassVar

import numpy as np
import pytest

from advisor.aircraft.aircraft import Aircraft
from advisor.aircraft.reference import Reference
from advisor.analysis import gap as gap_of_logs
from advisor.analysis.gap_flights import GapFlights
from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.flight.signals.record import Channel
from advisor.flight.signals.track import standard_pressure
from advisor.gap.records.prepare import prepare
from advisor.gap.simulator.layout import HEIGHT
from advisor.simulators.air import by_the_motion, standard_heights
from advisor.simulators.as_given import Flying
from advisor.simulators.compare import compare
from advisor.simulators.linear import LinearSimulator
from advisor.simulators.protocol import Condition
from advisor.words.problems import UnusableInputError
from tests.simulators.nonlinear import Nonlinear, flown

AIRCRAFT = Aircraft()


class Witness(Nonlinear):
    """Remembers the conditions in which it flew."""

    conditions: ClassVar[list[Condition]] = []

    def replay(self, condition, inputs, increments=None):
        self.conditions.append(condition)
        return super().replay(condition, inputs, increments)


def at(maneuver: Maneuver, **air: float | None) -> Maneuver:
    """Return the manoeuvre with constant channels of the air; None leaves a channel out."""
    channels = dict(maneuver.channels)
    for name, value in air.items():
        channels.pop(name, None)
        if value is not None:
            t = channels["q"].t[::10]
            channels[name] = Channel(name, t, np.full(len(t), value), "test", "measured")
    return replace(maneuver, channels=channels)


def test_the_static_pressure_says_the_height_before_the_height_above_sea_level_does():
    maneuver = at(flown(maneuvers=1)[0], static_pressure=float(standard_pressure(1200.0)), altitude=900.0)
    assert standard_heights([maneuver], AIRCRAFT) == {1: pytest.approx(1200.0, abs=0.1)}
    without = at(maneuver, static_pressure=None)
    assert standard_heights([without], AIRCRAFT) == {1: pytest.approx(900.0, abs=0.1)}


def test_warm_air_is_flown_at_the_height_of_its_density():
    warm = Aircraft(reference=Reference(air_temperature_c=25.0))
    maneuver = at(flown(maneuvers=1)[0], altitude=1000.0)
    # 25 deg C at 1,000 m (8.5 deg C in the standard atmosphere) are 1.0501 kg/m3, the density at 1,576 m.
    assert standard_heights([maneuver], warm)[1] == pytest.approx(1576.0, abs=2.0)


def test_a_simulator_flies_at_the_height_of_the_density_and_not_at_that_above_home():
    maneuver = at(flown(maneuvers=1)[0], height=50.0, altitude=1250.0)
    flights = prepare([maneuver], AIRCRAFT)
    heights = {1: 1250.0}
    began = Flying(Witness(), flights, heights, {1: {}}, None, lambda *_: None)
    replays = began.replays(np.zeros((1, 200)), held=False)
    assert Witness.conditions[-1].height_m == 1250.0
    # Ground effect needs the height above the ground, which the simulator does not know.
    assert began.as_flown(replays)[0].slow[HEIGHT, 0] == pytest.approx(50.0)


def test_air_of_unknown_density_is_refused_with_the_key_that_states_it():
    maneuvers = [at(m, altitude=None) for m in flown(maneuvers=3)]
    with pytest.raises(UnusableInputError, match=r"density of the air.*manoeuvre 1.*reference: \{height_m"):
        compare(maneuvers, Nonlinear(), AIRCRAFT)


def test_the_reference_speed_of_linear_is_made_true_as_the_flights_speed_is(monkeypatch):
    read = list(flown(maneuvers=2))
    for i, m in enumerate(read):
        thin = replace(m.channels["airspeed"], gain=1.1)
        read[i] = replace(m, channels={**m.channels, "airspeed": thin})
    asked: dict[str, Any] = {}

    class ToldError(Exception):
        pass

    def told(maneuvers, simulator, aircraft, *_):
        asked.update(simulator=simulator, aircraft=aircraft)
        raise ToldError

    monkeypatch.setattr(gap_of_logs, "compare", told)
    file = Aircraft(reference_airspeed_m_s=20.0)
    with pytest.raises(ToldError):
        gap_of_logs.compare_flown(GapFlights(read, 0, ()), file, LinearSimulator({}, 20.0))
    assert asked["simulator"].reference_m_s == pytest.approx(22.0)
    assert asked["aircraft"].reference_airspeed_m_s == pytest.approx(22.0)


THIN = 1.0605
"""Ratio of the true to the indicated air speed at 1,200 m."""


def logged(maneuver: Maneuver, factor: float, gain: float) -> Maneuver:
    """Return the manoeuvre at 1,200 m, with an air speed that a factor makes wrong."""
    speed, altitude = maneuver.channels["airspeed"], maneuver.channels["altitude"]
    wrong = replace(speed, y=factor * speed.y, gain=gain)
    high = replace(altitude, y=np.full(len(altitude.y), 1200.0))
    return replace(maneuver, channels={**maneuver.channels, "airspeed": wrong, "altitude": high})


@pytest.mark.parametrize(
    ("factor", "gain", "used", "word"),
    [
        (1.0, THIN, 1.0, ""),
        (THIN, THIN, 1.0, "a true one"),
        (1.0 / THIN, 1.0, 1.0, "an indicated one"),
        (1.02, THIN, 1.02, ""),
    ],
    ids=["as the convention says", "true where indicated is expected", "the other way", "a static error"],
)
def test_the_motion_decides_between_true_and_indicated_and_nothing_else(factor, gain, used, word):
    maneuvers = flown(maneuvers=3)
    found = by_the_motion([logged(m, factor, gain) for m in maneuvers], Aircraft())
    ratio = found.maneuvers[0].channels["airspeed"].y / maneuvers[0].channels["airspeed"].y
    assert ratio == pytest.approx(np.full(len(ratio), used), rel=1e-3)
    assert word in found.note
    assert bool(found.note) == bool(word)
