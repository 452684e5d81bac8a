"""The air speed is a cause where work was done on the aircraft, not where it was exchanged for height."""

import re
from dataclasses import replace

import numpy as np
import pytest

from advisor.aircraft.aircraft import Aircraft
from advisor.aircraft.standard_gravity import GRAVITY_M_S2
from advisor.gap.candidates.catalogue import variants_for
from advisor.gap.diagnose import diagnose
from advisor.gap.fitting.holdout import hold_out
from advisor.gap.records.airspeed import measures_speed
from advisor.gap.records.prepare import prepare
from advisor.gap.records.unmeasured_speed import speed_of_the_motion
from advisor.gap.search.baseline import fit_baseline
from advisor.gap.search.path_energy import uncommanded_thrust
from advisor.gap.search.ranking import judge
from advisor.gap.search.screen import Screen
from advisor.gap.search.speed import energy_swing
from advisor.gap.simulator.layout import HEIGHT, SPEED, THRUST
from advisor.oem.airspeed import airspeed
from advisor.oem.recursion import accumulated
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


def test_a_speed_exchanged_for_height_is_no_work():
    exchanged = flights_with(phugoid, lambda t: 80.0 - (phugoid(t) ** 2 - 22.0**2) / (2.0 * GRAVITY_M_S2))
    assert energy_swing(exchanged) < 1e-3


def test_a_speed_that_an_engine_changes_in_level_flight_is_all_work():
    flights = flights_with(phugoid, lambda t: np.full_like(t, 80.0))
    speeds = [np.std(flight.slow[SPEED]) / 22.0 for flight in flights.flights]
    assert energy_swing(flights) == pytest.approx(np.median(speeds), rel=0.01)


def test_a_manoeuvre_flown_in_a_climb_makes_no_work_of_the_others():
    level = flights_with(lambda t: np.full_like(t, 22.0), lambda t: np.full_like(t, 80.0))
    climbed = flights_with(lambda t: np.full_like(t, 22.0), lambda t: 80.0 + 3.0 * t)
    one = replace(level, flights=(*level.flights[:2], climbed.flights[2]))
    assert energy_swing(climbed) > 0.05
    assert energy_swing(one) < 1e-3


@pytest.mark.study
def test_manoeuvres_flown_at_different_speeds_are_no_cause_where_the_speed_is_measured():
    found = diagnose(fly(Setup(maneuvers=6, speed_change=0.08, heights_m=HEIGHTS, seed=8)), Aircraft())
    assert found.verdict == "none"
    assert found.waterfall == (("airspeed_variation", found.gap.before),)


def throttled(**thrust):
    return fly(Setup(maneuvers=6, logs_throttle=True, heights_m=HEIGHTS, seed=202, **thrust))


@pytest.mark.study
def test_an_engine_that_drives_the_speed_up_and_down_of_itself_makes_it_the_cause():
    found = diagnose(throttled(surge=0.8, surge_hz=0.1), Aircraft())
    assert [c.effect for c in found.causes if c.present] == ["airspeed_variation"]
    [(effect, left)] = found.waterfall
    assert effect == "airspeed_variation"
    assert left < 0.05 < found.gap.before


@pytest.mark.study
@pytest.mark.parametrize("engine_lag_s", [0.0, 0.6])
def test_a_speed_that_follows_the_throttle_is_no_cause(engine_lag_s):
    found = diagnose(throttled(thrust_amplitude=0.8, engine_lag_s=engine_lag_s), Aircraft())
    assert found.verdict == "none"


def test_thrust_that_nobody_asked_for_is_what_neither_the_throttle_nor_drag_explains():
    asked = uncommanded_thrust(prepare(throttled(thrust_amplitude=0.8, engine_lag_s=0.6), Aircraft()))
    surging = prepare(throttled(surge=0.8, surge_hz=0.1), Aircraft())
    assert uncommanded_thrust(surging) > 5.0 * asked
    assert uncommanded_thrust(replace(surging, has=surging.has - {"a_x"})) is None


def test_a_thrust_that_swings_slowly_does_not_pass_for_drag():
    """While it grows the aircraft speeds up, and while it fades it slows down: as if drag pushed."""
    swinging, excess, hz = prepare(throttled(), Aircraft()), 0.03, 0.04
    for i, flight in enumerate(swinging.flights):
        t = np.arange(flight.n) * flight.h - 1.0
        flight.slow[THRUST] = excess * np.sin(2.0 * np.pi * hz * t + np.pi * i + 0.2 * (i // 2 - 2))
        flight.slow[SPEED] = 22.0 + GRAVITY_M_S2 * np.cumsum(flight.slow[THRUST]) * flight.h
        flight.slow[HEIGHT] = 80.0
    swung = np.median([np.std(flight.slow[THRUST]) for flight in swinging.flights])
    assert uncommanded_thrust(swinging) > 0.7 * GRAVITY_M_S2 * swung


def test_thrust_that_changes_before_the_first_step_only_is_the_pilots():
    settled = prepare(throttled(), Aircraft())
    quiet = uncommanded_thrust(settled)
    for flight in settled.flights:
        t = np.arange(flight.n) * flight.h
        flight.slow[THRUST] += 0.05 * np.maximum(1.0 - t / flight.first_step_s, 0.0)
    assert uncommanded_thrust(settled) == pytest.approx(quiet, abs=1e-4)


def test_noise_of_an_accelerometer_is_no_thrust_though_the_speed_swings():
    noise, found = 0.03, []
    for seed in range(8):
        noisy = prepare(throttled(thrust_amplitude=0.8, engine_lag_s=0.6), Aircraft())
        rng = np.random.default_rng(seed)
        for flight in noisy.flights:
            wandering = accumulated(rng.standard_normal(flight.n), np.exp(-flight.h / 0.5))
            flight.slow[THRUST] += noise * wandering / np.std(wandering)
        found.append(uncommanded_thrust(noisy))
    assert abs(np.mean(found)) < 0.1 * noise * GRAVITY_M_S2


@pytest.mark.study
def test_beside_a_named_effect_the_gap_is_what_a_simulator_leaves_that_knows_neither():
    found = diagnose(throttled(surge=0.8, surge_hz=0.1, q_scale=0.08), Aircraft())
    assert [c.effect for c in found.causes if c.present] == ["pitch_rate_scale", "airspeed_variation"]
    assert [effect for effect, _ in found.waterfall] == ["airspeed_variation", "pitch_rate_scale"]
    left = [found.gap.before, *(after for _, after in found.waterfall)]
    assert left == sorted(left, reverse=True)


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


def test_what_the_air_speed_tells_takes_more_in_air_that_moves_with_it():
    needed = {}
    for gust_std in (0.0, 0.3):
        setup = Setup(
            maneuvers=4, speed_change=0.12, switches={"speed_power": -1.5}, gust_std=gust_std, seed=8
        )
        problem, plain = fit_baseline(prepare(fly(setup), Aircraft()), Aircraft())
        power = [v for v in variants_for(problem.flights) if v.effect == "airspeed_variation"]
        found = Screen(problem, plain).quick_fits(power)
        [judged] = judge(problem, plain, hold_out(problem, plain), found)
        needed[gust_std] = judged.least_gain
    assert needed[0.0] == 6.0
    assert needed[0.3] >= 24.0


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
def test_without_an_air_speed_in_the_log_speeds_that_differ_between_manoeuvres_are_the_cause_and_no_mass():
    flown = without_instrument(fly(Setup(maneuvers=8, speed_change=0.12, seed=52)))
    found = diagnose(flown, Aircraft(airspeed_m_s=UAV.speed))
    assert [c.effect for c in found.causes if c.present] == ["airspeed_variation"]
    assert any("by the motion" in note for note in found.notes)


@pytest.mark.study
def test_speeds_that_nothing_measured_come_before_numbers_that_are_a_little_off_besides():
    setup = Setup(maneuvers=8, speed_change=0.2, seed=54)
    model = {
        name: v.value for name, v in diagnose(fly(replace(setup, speed_change=0.0)), Aircraft()).model.items()
    }
    model["M_alpha"] *= 1.15
    found = diagnose(without_instrument(fly(setup)), Aircraft(airspeed_m_s=UAV.speed, model=model))
    assert found.verdict == "effect"
    assert found.causes[0].effect == "airspeed_variation"


@pytest.mark.study
def test_speeds_that_nothing_measured_come_before_a_smaller_effect_besides():
    flown = without_instrument(fly(Setup(maneuvers=8, speed_change=0.25, switches={"delay": 0.06}, seed=54)))
    found = diagnose(flown, Aircraft(airspeed_m_s=UAV.speed))
    present = {c.effect: c.parameters for c in found.causes if c.present}
    assert [*present][:2] == ["airspeed_variation", "transport_delay"]
    assert present["transport_delay"]["delay_s"].value == pytest.approx(0.06, abs=0.004)


@pytest.mark.study
@pytest.mark.parametrize(
    ("off", "height_m", "verdict"),
    [(0.95, 0.0, "none"), (1.03, 0.0, "none"), (0.86, 3000.0, "none"), (0.86, 0.0, "unknown")],
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
    assert float(said.split()[7]) == pytest.approx(100.0 / off - 100.0, abs=0.7)


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
