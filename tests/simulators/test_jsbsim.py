"""JSBSim as the user's simulator: from a light single to an airliner, with the real engine."""

import shutil

import numpy as np
import pytest

from advisor.aircraft.aircraft import Aircraft
from advisor.process.arrays import FloatArray
from advisor.simulators.interface import side_fault
from advisor.simulators.jsbsim import Jsbsim, make_jsbsim
from advisor.simulators.jsbsim_model import find_model
from advisor.simulators.protocol import Condition, Inputs, Replay
from advisor.words.problems import ConfigurationError, UnusableInputError
from tests.simulators.makeshift import Constant, Damping

STEP_S = 0.005
FLEET = {
    "c172p": Condition(50.0, 1000.0),
    "c310": Condition(85.0, 1500.0),
    "737": Condition(160.0, 5000.0),
}
PULSE_RAD = 0.01

pytestmark = pytest.mark.parametrize("model", FLEET)


def inputs(seconds: float, elevator: FloatArray | None = None, **others: FloatArray) -> Inputs:
    t = STEP_S * (np.arange(round(seconds / STEP_S)) + 0.5)
    return Inputs(t, np.zeros(t.size) if elevator is None else elevator, others)


def doublet(seconds: float) -> FloatArray:
    """Return one second up, one second down, after half a second of rest."""
    t = STEP_S * (np.arange(round(seconds / STEP_S)) + 0.5)
    return PULSE_RAD * (((t > 0.5) & (t < 1.5)) * 1.0 - ((t > 1.5) & (t < 2.5)) * 1.0)


def simulator(model: str) -> Jsbsim:
    return Jsbsim(find_model(model))


def regressed(flown: Replay, elevator: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return rates of α and q regressed on constant, α, q, elevator, air speed and pitch angle."""
    moved = np.interp(flown.t, inputs(4.0).t, elevator)
    speed, pitch = flown.airspeed_m_s - flown.airspeed_m_s[0], flown.theta - flown.theta[0]
    columns = np.column_stack([np.ones(flown.t.size), flown.alpha, flown.q, moved, speed, pitch])
    # A numerical rate blurs over the elevator's jumps.
    calm = np.convolve(np.abs(np.gradient(moved)) > 0.0, np.ones(5), "same") == 0.0
    z, *_ = np.linalg.lstsq(columns[calm], np.gradient(flown.alpha, flown.t)[calm])
    m, *_ = np.linalg.lstsq(columns[calm], np.gradient(flown.q, flown.t)[calm])
    return z, m


def test_trimmed_flight_stays_where_it_is_for_ten_seconds(model: str) -> None:
    condition = FLEET[model]
    flown = simulator(model).replay(condition, inputs(10.0))
    assert flown.t[0] == 0.0
    assert flown.t[-1] == pytest.approx(10.0, abs=STEP_S)
    assert np.ptp(flown.alpha) < 1e-4
    assert np.max(np.abs(flown.q)) < 1e-4
    assert flown.airspeed_m_s == pytest.approx(np.full(flown.t.size, condition.airspeed_m_s), abs=0.05)
    assert flown.height_m == pytest.approx(np.full(flown.t.size, condition.height_m), abs=0.5)
    assert flown.theta[0] == pytest.approx(flown.alpha[0], abs=1e-9)


def test_specific_force_in_level_flight_is_gravity_turned_by_the_pitch_angle(model: str) -> None:
    flown = simulator(model).replay(FLEET[model], inputs(1.0))
    assert flown.a_x is not None
    assert flown.a_z[0] == pytest.approx(-9.80665 * np.cos(flown.theta[0]), abs=0.03)
    assert flown.a_x[0] == pytest.approx(9.80665 * np.sin(flown.theta[0]), abs=0.03)


def test_elevator_trailing_edge_down_pitches_down_and_lifts_less(model: str) -> None:
    flown = simulator(model).replay(FLEET[model], inputs(4.0, doublet(4.0)))
    first = (flown.t > 0.5) & (flown.t < 1.5)
    assert flown.q[first].min() < -0.5 * abs(flown.q).max()
    assert flown.alpha[first][-1] < flown.alpha[0]
    assert flown.a_z[first][-1] > flown.a_z[0]
    assert flown.q[(flown.t > 1.5) & (flown.t < 2.5)].max() > 0.0


def test_the_linearisation_is_what_small_manoeuvres_show(model: str) -> None:
    jsbsim = simulator(model)
    derivatives = jsbsim.linearise(FLEET[model])
    assert derivatives is not None
    small = 0.2 * doublet(4.0)
    z, m = regressed(jsbsim.replay(FLEET[model], inputs(4.0, small)), small)
    assert derivatives["Z_alpha"] == pytest.approx(z[1], rel=0.03)
    assert derivatives["M_alpha"] == pytest.approx(m[1], rel=0.03)
    assert derivatives["M_q"] == pytest.approx(m[2], rel=0.03)
    assert derivatives["M_delta_e"] == pytest.approx(m[3], rel=0.03)
    assert derivatives["Z_delta_e"] == pytest.approx(z[3], abs=0.01 * abs(derivatives["M_delta_e"]))


def test_a_moment_added_changes_the_pitch_acceleration_by_that_much(model: str) -> None:
    jsbsim, added = simulator(model), 0.1
    derivatives = jsbsim.linearise(FLEET[model])
    assert derivatives is not None
    plain = jsbsim.replay(FLEET[model], inputs(0.05))
    pushed = jsbsim.replay(FLEET[model], inputs(0.05), Constant(0.0, added))
    # The first step of Adams and Bashforth takes half of the step before; the aircraft's own damping answers.
    pushed_for = pushed.t - 0.5 * STEP_S
    damped = added / derivatives["M_q"] * np.expm1(derivatives["M_q"] * pushed_for)
    assert (pushed.q - plain.q)[5:] == pytest.approx(damped[5:], rel=0.03)
    assert (pushed.alpha - plain.alpha)[2] == pytest.approx(0.0, abs=1e-5)


def test_a_force_added_changes_the_rate_of_alpha_and_the_specific_force_by_that_much(model: str) -> None:
    jsbsim, added = simulator(model), 0.02
    plain = jsbsim.replay(FLEET[model], inputs(0.05))
    pushed = jsbsim.replay(FLEET[model], inputs(0.05), Constant(added, 0.0))
    assert (pushed.a_z - plain.a_z)[1] == pytest.approx(added * FLEET[model].airspeed_m_s, rel=0.01)
    assert (pushed.alpha - plain.alpha)[2] == pytest.approx(1.5 * STEP_S * added, rel=0.03)
    assert (pushed.q - plain.q)[2] == pytest.approx(0.0, abs=1e-6)


def test_a_damping_added_is_the_damping_of_the_response(model: str) -> None:
    jsbsim, added = simulator(model), -1.5
    small = 0.2 * doublet(4.0)
    _, alone = regressed(jsbsim.replay(FLEET[model], inputs(4.0, small)), small)
    _, damped = regressed(jsbsim.replay(FLEET[model], inputs(4.0, small), Damping(added)), small)
    assert damped[2] - alone[2] == pytest.approx(added, rel=0.05)


def test_increments_of_one_replay_do_not_stay_for_the_next(model: str) -> None:
    jsbsim = simulator(model)
    before = jsbsim.replay(FLEET[model], inputs(2.0))
    jsbsim.replay(FLEET[model], inputs(2.0, doublet(2.0)), Constant(0.05, 0.5))
    after = jsbsim.replay(FLEET[model], inputs(2.0))
    assert after.q == pytest.approx(before.q, abs=1e-4)
    assert after.alpha == pytest.approx(before.alpha, abs=1e-4)


def test_a_heavier_aircraft_flies_at_a_larger_angle_of_attack(model: str) -> None:
    jsbsim, at = simulator(model), FLEET[model]
    own = jsbsim.replay(at, inputs(0.1))
    mass_kg = 0.45359237 * jsbsim._flight.fdm["inertia/weight-lbs"]
    heavier = jsbsim.replay(Condition(at.airspeed_m_s, at.height_m, mass_kg=1.1 * mass_kg), inputs(0.1))
    assert heavier.alpha[0] > own.alpha[0] + 0.005
    assert 0.45359237 * jsbsim._flight.fdm["inertia/weight-lbs"] == pytest.approx(1.1 * mass_kg)


def test_a_descent_is_flown_on_its_own_path(model: str) -> None:
    at = FLEET[model]
    flown = simulator(model).replay(Condition(at.airspeed_m_s, at.height_m, -0.03), inputs(5.0))
    assert flown.theta[0] - flown.alpha[0] == pytest.approx(-0.03, abs=1e-9)
    assert flown.height_m[-1] - at.height_m == pytest.approx(-0.03 * 5.0 * at.airspeed_m_s, rel=0.02)


def test_a_copied_model_flies_as_the_shipped_one_and_its_folder_stays_as_it_was(model, tmp_path):
    shutil.copytree(find_model(model).parent, tmp_path / "mine")
    path = tmp_path / "mine" / "another name.xml"
    (tmp_path / "mine" / f"{model}.xml").rename(path)
    files = sorted(tmp_path.rglob("*"))
    copied = Jsbsim(find_model(str(path))).replay(FLEET[model], inputs(2.0, doublet(2.0)))
    shipped = simulator(model).replay(FLEET[model], inputs(2.0, doublet(2.0)))
    assert copied.q.tolist() == shipped.q.tolist()
    assert sorted(tmp_path.rglob("*")) == files


def test_a_speed_too_low_to_fly_is_one_sentence(model: str) -> None:
    with pytest.raises(UnusableInputError, match="finds no steady flight at 10 m/s and") as caught:
        simulator(model).replay(Condition(10.0, 1000.0), inputs(1.0))
    assert caught.value.problem.code == "simulator_trim"


def test_throttle_accelerates_and_a_positive_aileron_rolls_left(model: str) -> None:
    jsbsim, n = simulator(model), round(3.0 / STEP_S)
    faster = jsbsim.replay(FLEET[model], inputs(3.0, throttle=np.full(n, 0.15)))
    assert faster.airspeed_m_s[-1] > FLEET[model].airspeed_m_s + 0.1
    rolled = jsbsim.replay(FLEET[model], inputs(1.0, aileron=np.full(round(1.0 / STEP_S), 0.05)))
    assert rolled.bank[-1] < -0.005
    assert np.mean(rolled.p) < 0.0
    assert side_fault(rolled) is None


def test_in_a_process_of_its_own_the_model_flies_the_same(model: str) -> None:
    apart = make_jsbsim(model, Aircraft())
    there = apart.replay(FLEET[model], inputs(2.0, doublet(2.0)))
    apart.close()
    here = simulator(model).replay(FLEET[model], inputs(2.0, doublet(2.0)))
    assert there.q.tolist() == here.q.tolist()


def test_a_model_that_does_not_exist_is_a_wrong_configuration(model: str) -> None:
    with pytest.raises(ConfigurationError, match=f"JSBSim has no model '{model}y'; did you mean {model}"):
        make_jsbsim(f"{model}y", Aircraft())
