"""An air speed from the aircraft file, for a log that has none."""

from advisor.aircraft.aircraft import Aircraft
from tests.flight.stream.test_suitability import flight
from tests.heard import hear


def flown(wire, aircraft):
    heard = hear([wire.columns()], aircraft)
    (maneuver,) = heard.maneuvers
    return heard.stream, maneuver


def test_the_air_speed_of_the_aircraft_file_stands_in_for_one_that_never_arrives():
    stream, maneuver = flown(flight(without=("VFR_HUD",)), Aircraft(airspeed_m_s=21.0))
    assert stream.problems() == []
    assert stream.channels["airspeed"].provenance == "given"
    assert set(maneuver.channels["airspeed"].y.tolist()) == {21.0}


def test_an_air_speed_that_arrives_counts_before_that_of_the_aircraft_file():
    stream, maneuver = flown(flight(), Aircraft(airspeed_m_s=21.0))
    assert stream.channels["airspeed"].source == "VFR_HUD.airspeed"
    assert 21.0 not in maneuver.channels["airspeed"].y
