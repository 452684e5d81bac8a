"""Natural nuisances of the sealed flights: each generator has them in a third of its flights."""

import numpy as np
import pytest

from benchmarks.sealed.generator import quiet_factor
from benchmarks.sealed.tlog import Stream
from benchmarks.second_generator.nature import Nature as SecondNature
from benchmarks.second_generator.nature import draw_nature
from benchmarks.second_generator.nature import in_the_world as in_the_second_world
from benchmarks.second_generator.telemetry import Noise as SecondNoise
from benchmarks.second_generator.telemetry import quieter
from benchmarks.third_generator.flight import STEP_S
from benchmarks.third_generator.nature import Nature as ThirdNature
from benchmarks.third_generator.nature import drawn
from sim.blind.natural import in_the_world, natural, read_airspeed, without_vane_noise
from sim.scenario import Noise, Scenario


def servo(stamps):
    return {"servo": Stream(np.asarray(stamps), {"command": np.zeros(len(stamps))})}


@pytest.mark.parametrize(
    "draw", [lambda rng: draw_nature(rng, (), 500.0, 1 / 3), lambda rng: drawn(rng, 500.0)]
)
def test_a_third_of_the_flights_has_a_late_command(draw):
    late = [draw(np.random.default_rng(seed)) for seed in range(600)]
    moved = [getattr(n, "command_late", None) or getattr(n, "command_late_s", 0.0) for n in late]
    assert np.count_nonzero(moved) / 600 == pytest.approx(1 / 3, abs=0.06)
    assert -0.006 <= min(moved) < 0.0 < max(moved) <= 0.010


def test_a_late_command_has_stamps_ahead_of_its_effect():
    for nature in (SecondNature(command_late=0.01), ThirdNature(command_late_s=0.01)):
        sent = nature.sent if isinstance(nature, SecondNature) else nature.stamped
        assert sent(servo([1.0, 1.02]))["servo"].stamps == pytest.approx([0.99, 1.01])


@pytest.mark.parametrize(
    ("shown_by", "step_s"),
    [
        (SecondNature(cutoff=20.0).shown, 0.002),
        (lambda c, _: ThirdNature(filter_hz=20.0).measured(c), STEP_S),
    ],
)
def test_filters_delay_rate_and_force_alone(shown_by, step_s):
    t = step_s * np.arange(1000)
    swings, still = np.sin(2.0 * t), np.zeros(len(t))
    quiet = {"alpha": swings, "theta": swings, "climb": still, "airspeed": still + 20.0}
    found = shown_by(quiet | dict.fromkeys(("q", "imu_q", "a_x", "a_z"), swings), step_s)
    due = np.sin(2.0 * (t - np.sqrt(2.0) / (2.0 * np.pi * 20.0)))
    assert found["q"][200:] == pytest.approx(due[200:], abs=0.005)
    assert found["theta"] is swings


def test_parameters_state_a_filter_that_is_there():
    assert SecondNature(cutoff=20.0, stated=True).parameters["INS_GYRO_FILTER"] == 20.0
    assert ThirdNature(filter_hz=20.0).parameters() == SecondNature(stated=True).parameters == {}


def test_an_angle_of_attack_that_the_autopilot_computes_is_a_late_staircase():
    stamps = 0.02 * np.arange(100)
    streams = servo([0.0]) | {"alpha": Stream(stamps, {"alpha": stamps.copy()})}
    seen = SecondNature(alpha_lag=0.05).sent(streams)["alpha"].channels["alpha"]
    assert len(np.unique(seen)) == 40
    assert np.all(seen <= stamps)


def test_an_own_flight_with_nature_is_drawn_by_its_seed_alone():
    scenario = Scenario(seed=5, noise=Noise(alpha_deg=0.06), airspeed_m_s=25.0)
    one, again = natural(scenario, [], 1.0), natural(scenario, [], 1.0)
    assert one == again
    assert -0.006 <= one.faults.command_late_s <= 0.010
    assert 0.85 * 25.0 < read_airspeed(one) < 25.0 == read_airspeed(scenario)
    assert natural(scenario, ["alpha_skew"], 1.0).alpha.source == "vane"
    assert natural(scenario, ["gust"], 1.0).air.turbulence_m_s == 0.0
    computed = next(
        s for s in (natural(Scenario(seed=k), [], 1.0) for k in range(20)) if s.alpha.source == "derived"
    )
    assert without_vane_noise(computed).noise.alpha_deg == 0.0
    assert without_vane_noise(scenario) == scenario


@pytest.mark.parametrize(
    "shown_by",
    [
        lambda c: SecondNature(indicated=0.6).shown(c, 0.002),
        lambda c: ThirdNature(pitot=0.6).measured(c),
    ],
)
def test_thin_air_slows_the_pitot_tube_but_not_the_receiver(shown_by):
    found = shown_by({"airspeed": np.array([50.0]), "climb": np.array([14.0])})
    assert found["airspeed"].tolist() == pytest.approx([30.0])
    assert found["groundspeed"].tolist() == pytest.approx([48.0])


def test_in_the_world_filters_act_in_every_own_flight_and_the_noise_is_smaller():
    for seed in range(20):
        scenario = natural(Scenario(seed=seed, noise=Noise(alpha_deg=0.1, colour=0.4)), [], 1.0)
        world = in_the_world(scenario, 0.2)
        assert world.faults.filters.gyro_hz == (scenario.faults.filters.gyro_hz or 20.0)
        assert world.faults.command_late_s == scenario.faults.command_late_s
        assert 0.02 <= world.noise.alpha_deg <= 0.1
        assert world.noise.colour == 0.4


def test_in_the_world_filters_act_in_every_flight_of_the_second_generator():
    assert in_the_second_world(SecondNature()).cutoff == 20.0
    assert in_the_second_world(SecondNature(cutoff=15.0)).cutoff == 15.0


def test_the_noise_of_a_flight_is_smaller_by_a_factor_that_its_seed_draws():
    factors = [quiet_factor(seed, 0.2) for seed in range(200)]
    assert 0.2 <= min(factors) < 0.3 < 0.9 < max(factors) <= 1.0
    assert quiet_factor(3, 0.2) == quiet_factor(3, 0.2)
    noise = quieter(SecondNoise(*[1.0] * 8, colour=0.5), 0.25)
    assert (noise.alpha, noise.height, noise.colour) == (0.25, 0.25, 0.5)
