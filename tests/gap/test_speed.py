"""The air speed is a cause where work was done on the aircraft, not where it was exchanged for height."""

import re
from dataclasses import replace

import numpy as np
import pytest

from advisor.aircraft.aircraft import Aircraft
from advisor.flight.signals.record import Channel
from advisor.gap.candidates.catalogue import variants_for
from advisor.gap.records.airspeed import airspeed_on, measures_speed
from advisor.gap.records.prepare import prepare
from advisor.gap.records.unmeasured_speed import speed_of_the_motion
from advisor.gap.simulator.layout import HEIGHT, SPEED
from advisor.oem.airspeed import airspeed
from tests.gap.diagnosed import diagnose
from tests.gap.generator import UAV, Setup, fly

HEIGHTS = (80.0, 90.0, 85.0)


def flights_with(speed_of, height_of):
    """Return three manoeuvres whose speed and height follow given courses of time."""
    found = prepare(fly(Setup(maneuvers=3, heights_m=HEIGHTS)), Aircraft())
    flights = []
    for flight in found.flights:
        t = (np.arange(flight.n) + 0.5) * flight.h
        slow = flight.slow.copy()
        slow[SPEED], slow[HEIGHT] = speed_of(t), height_of(t)
        flights.append(replace(flight, slow=slow))
    return replace(found, flights=tuple(flights))


def phugoid(t):
    return 22.0 + 2.0 * np.sin(0.6 * t)


@pytest.mark.parametrize("share", [0.9, 1.1])
def test_a_speed_at_which_nothing_flies_is_none_to_estimator_and_diagnosis_alike(share):
    flown = fly(Setup(maneuvers=1))[0]
    speed = flown.channels["airspeed"]
    slow = replace(speed, y=np.full(len(speed), share * 4.0))
    maneuver = replace(flown, channels={**flown.channels, "airspeed": slow})
    assert measures_speed(maneuver) == (share > 1.0)
    assert (airspeed(maneuver.channels) is not None) == (share > 1.0)


def throttled(**thrust):
    return fly(Setup(maneuvers=6, logs_throttle=True, heights_m=HEIGHTS, seed=202, **thrust))


@pytest.mark.study
@pytest.mark.parametrize("engine_lag_s", [0.0, 0.6])
def test_a_speed_that_follows_the_throttle_is_no_cause(engine_lag_s):
    found = diagnose(throttled(thrust_amplitude=0.8, engine_lag_s=engine_lag_s), Aircraft())
    assert found.verdict == "none"


@pytest.mark.study
def test_forces_that_do_not_grow_with_the_speed_squared_are_named_with_their_power():
    setup = Setup(maneuvers=6, speed_change=0.12, switches={"speed_power": -0.8}, seed=8)
    found = diagnose(fly(setup), Aircraft())
    assert [c.effect for c in found.causes if c.present] == ["airspeed_variation"]
    exponent = found.causes[0].parameters["exponent"]
    assert abs(exponent.value + 0.8) < 2.5 * exponent.std
    # The moments may have a power of their own.
    assert re.search("with (its power )?1.2", found.sentence)
    assert [effect for effect, _ in found.waterfall] == ["airspeed_variation"]


@pytest.mark.study
def test_moments_that_grow_with_another_power_than_the_lift_have_their_own():
    setup = Setup(maneuvers=6, speed_change=0.12, switches={"moment_power": -1.5}, seed=8)
    found = diagnose(fly(setup), Aircraft())
    assert [c.effect for c in found.causes if c.present] == ["airspeed_variation"]
    # Here the damping goes with that power, too.
    assert found.causes[0].parameters["exponent_M"].value == pytest.approx(-1.5, abs=0.35)
    assert found.causes[0].parameters["exponent"].value == pytest.approx(0.0, abs=0.25)
    assert "moments grow with the air speed's power 0." in found.sentence


def test_a_power_of_the_speed_is_not_looked_for_where_the_speed_hardly_moved():
    flown = prepare(fly(Setup(maneuvers=3, speed_change=0.1, seed=8)), Aircraft())
    still = replace(flown, speed_moves=0.02)
    assert "airspeed_variation" in {variant.effect for variant in variants_for(flown)}
    assert "airspeed_variation" not in {variant.effect for variant in variants_for(still)}


def without_instrument(flown):
    return [
        replace(m, channels={name: c for name, c in m.channels.items() if name != "airspeed"}) for m in flown
    ]


def test_without_an_air_speed_in_the_log_the_accelerometers_show_how_it_changes():
    flown = fly(Setup(maneuvers=2, seed=51))
    measured = prepare(flown, Aircraft()).flights
    shown = prepare(without_instrument(flown), Aircraft(airspeed_m_s=UAV.speed)).flights
    for one, other in zip(measured, shown, strict=True):
        swing = np.ptp(one.slow[SPEED])
        assert swing > 1.0
        assert np.max(np.abs(one.slow[SPEED] - other.slow[SPEED])) < 0.25 * swing


def test_without_an_air_speed_in_the_log_the_motion_shows_it():
    flown = without_instrument(fly(Setup(maneuvers=6, seed=51)))
    assert speed_of_the_motion(flown) == pytest.approx(UAV.speed, rel=0.02)


@pytest.mark.study
def test_a_speed_that_the_motion_shows_serves_as_well_as_one_that_the_file_states():
    flown = without_instrument(fly(Setup(maneuvers=6, switches={"delay": 0.06}, seed=51)))
    shown, stated = (diagnose(flown, Aircraft(airspeed_m_s=v)) for v in (None, UAV.speed))
    assert shown.gap.after == pytest.approx(stated.gap.after, abs=0.05)
    assert any("No air speed in the log" in note for note in shown.notes)
    assert [c.effect for c in shown.causes if c.present] == ["transport_delay"]


def test_without_an_air_speed_in_the_log_the_motion_shows_how_the_manoeuvres_speeds_differ():
    logged = fly(Setup(maneuvers=8, speed_change=0.12, seed=52))
    flown = without_instrument(logged)
    measured = [f.slow[SPEED].mean() for f in prepare(logged, Aircraft()).flights]
    shown = [f.slow[SPEED].mean() for f in prepare(flown, Aircraft(airspeed_m_s=UAV.speed)).flights]
    assert np.array(shown) / np.mean(shown) == pytest.approx(np.array(measured) / np.mean(measured), abs=0.02)


@pytest.mark.study
@pytest.mark.parametrize(
    ("off", "height_m", "verdict"),
    [(0.95, 0.0, "none"), (1.03, 0.0, "none"), (0.86, 0.0, "unknown")],
)
def test_an_air_speed_that_is_not_quite_the_true_one_is_said_and_no_cause_where_thin_air_explains_it(
    off, height_m, verdict
):
    read = []
    for m in fly(Setup(maneuvers=6, speed_change=0.06, seed=53)):
        true = m.channels["airspeed"]
        height = replace(true, y=np.full(len(true.y), height_m))
        indicated = replace(true, y=off * true.y)
        read.append(replace(m, channels={**m.channels, "airspeed": indicated, "altitude": height}))
    found = diagnose(read, Aircraft())
    assert found.verdict == verdict
    [said] = [note for note in found.notes if note.startswith("The motion shows a true air speed")]
    assert float(said.split()[8]) == pytest.approx(100.0 / off - 100.0, abs=0.7)


@pytest.mark.study
def test_a_pitot_tube_that_reads_nothing_is_no_air_speed():
    flown = fly(Setup(maneuvers=6, seed=8))
    dead = [
        replace(
            m,
            channels={
                **m.channels,
                "airspeed": replace(m.channels["airspeed"], y=0.0 * m.channels["airspeed"].y),
            },
        )
        for m in flown
    ]
    none = [replace(m, channels={n: c for n, c in m.channels.items() if n != "airspeed"}) for m in flown]
    found, without = diagnose(dead, Aircraft()), diagnose(none, Aircraft())
    assert found.verdict == without.verdict == "none"
    assert found.reference_airspeed_m_s == without.reference_airspeed_m_s
    assert found.reference_airspeed_m_s == pytest.approx(22.0, rel=0.05)


@pytest.mark.study
def test_the_files_air_speed_counts_only_where_the_log_has_none():
    found = diagnose(fly(Setup(maneuvers=6, seed=8)), Aircraft(airspeed_m_s=27.0))
    assert found.verdict == "none"
    assert found.kinematics.finding == "consistent"
    assert found.reference_airspeed_m_s == pytest.approx(22.0, rel=0.05)


@pytest.mark.parametrize(("amplitude_m_s", "follows"), [(0.4, False), (2.0, True)])
def test_an_air_speed_that_disagrees_with_the_motion_by_more_than_3_percent_is_taken_as_read(
    amplitude_m_s, follows
):
    t = np.arange(0.0, 12.0, 0.05)
    still = {"a_x": 0.0, "a_z": -9.80665, "theta": 0.0, "alpha": 0.0}
    reading = 20.0 + amplitude_m_s * np.sin(2.0 * np.pi * t / 3.0)
    told = {**{name: np.full_like(t, value) for name, value in still.items()}, "airspeed": reading}
    flown = fly(Setup(maneuvers=1))[0]
    channels = {name: Channel(name, t, y, "VFR_HUD.airspeed", "measured") for name, y in told.items()}
    grid = np.arange(0.0, 12.0, 0.005)
    found = airspeed_on(grid, replace(flown, channels=channels), 0.0)
    assert (np.ptp(found) > amplitude_m_s) == follows
