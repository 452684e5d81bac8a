"""A simulator that has an effect already is judged with it: what is found is what is missing beyond it."""

from dataclasses import replace

import numpy as np
import pytest

from advisor.aircraft.aircraft import Aircraft
from advisor.aircraft_file.estimation import mistakes_in
from advisor.gap.candidates.known import beyond_known, changes_in, together, variants_for, with_known
from advisor.gap.effects import EFFECTS
from advisor.gap.fitting.problem import EffectProblem, SearchPoint
from advisor.gap.records.prepare import prepare
from advisor.gap.search.baseline import fit_unfiltered, of_this_flight
from advisor.gap.simulator.layout import ENTRIES, INDEX
from advisor.gap.verdict.causes import parameters_of
from sim.effects.terms import problems_with
from tests.gap.generator import Setup, fly
from tests.maneuvers import changed


@pytest.fixture(scope="module")
def late():
    return fly(Setup(maneuvers=6, switches={"delay": 0.06}, seed=21))


def test_numbers_of_the_file_become_the_simulations_own(late):
    flights = prepare(late, Aircraft())
    effects = {
        "structural_mode": {"frequency_hz": 5.0, "damping": 0.1, "gain": 0.3, "displacement_gain": 0.05},
        "actuator_rate_limit": {"rate_rad_s": 0.5},
        "actuator_lag": {"lag_s": 0.04, "damping": 0.7},
        "alpha_scale": {"scale": 0.1},
    }
    numbers = with_known(np.zeros(len(ENTRIES)), effects, flights, variants_for(flights))
    expected = {
        "mode_rad_s": 10.0 * np.pi, "mode_damping": 0.1, "mode_rate_gain": 0.3, "mode_gain": 0.05,
        "slowness_s_rad": 2.0, "lag_s": 0.04, "lag_damping": 0.7, "alpha_scale": 0.1,
    }  # fmt: skip
    assert len(numbers) == len(flights)
    for row in numbers:
        assert {name: row[INDEX[name]] for name in expected} == pytest.approx(expected)
        assert np.count_nonzero(row) == len(expected)


@pytest.mark.parametrize("effect", EFFECTS)
def test_a_file_may_have_any_effect_of_the_catalogue(effect):
    flown = fly(Setup(maneuvers=3, heights_m=(5.0, 9.0, 7.0), thrust_amplitude=1.0, speed_change=0.1))
    moved = [changed(m, "elevator", y=m.channels["elevator"].y + 0.01 * k) for k, m in enumerate(flown)]
    flights = prepare(moved, Aircraft())
    effects = {effect: dict.fromkeys(EFFECTS[effect].keys, 0.02)}
    problem = EffectProblem(
        flights, with_known(np.zeros(len(ENTRIES)), effects, flights, variants_for(flights))
    )
    assert np.all(np.isfinite(problem.driving(SearchPoint(np.zeros(6), np.zeros((3, 4))))))


def everything_tried():
    """Flights in which every effect can be told, and every description of every effect."""
    flown = fly(
        Setup(maneuvers=6, heights_m=(5.0, 9.0, 7.0, 6.0, 8.0, 10.0), thrust_amplitude=1.0, speed_change=0.2)
    )
    flights = prepare(flown, Aircraft())
    tried = [(w, v) for v in variants_for(flights) for w in (v, *v.likewise)]
    # Of a rate limit the other description is how the command is read, and not the servo.
    return flights, [w for w, v in tried if not (w is not v and v.inverted)]


def test_what_was_found_is_read_back_from_the_improved_file_as_it_was_fitted():
    flights, tried = everything_tried()
    assert {"about_rad"} <= {name for v in tried for name in v.fixed}
    for variant in [v for v in tried if not EFFECTS[v.effect].of_one_flight]:
        sizes = np.array(variant.starts[0]) + 0.01 * np.array([1.0, 2.0, 3.0, 4.0])[: len(variant.names)]
        in_file = parameters_of(variant, sizes, np.zeros(len(sizes)))
        fitted = np.zeros((len(flights), len(ENTRIES)))
        variant.apply(fitted, sizes, flights)
        effects = {variant.effect: {name: value.value for name, value in in_file.items()}}
        read = with_known(np.zeros(len(ENTRIES)), effects, flights, variants_for(flights))
        assert read == pytest.approx(fitted, abs=1e-9), variant


def test_every_description_of_an_effect_is_one_that_the_simulator_can_fly():
    _, tried = everything_tried()
    for variant in tried:
        value = np.array([0.5 * (low + high) for low, high in variant.bounds])
        sizes = parameters_of(variant, value, np.zeros(len(value)))
        effects = {variant.effect: {name: size.value for name, size in sizes.items()}}
        assert [*mistakes_in(effects), *problems_with(effects)] == []


def test_every_effect_stands_in_the_block_that_the_catalogue_says():
    _, tried = everything_tried()
    assert {v.effect for v in tried} == EFFECTS.keys() - {"alpha_bias", "turbulence", "gust"}
    assert all(v.block == EFFECTS[v.effect].block for v in tried)


def test_a_curve_keeps_the_angle_that_the_file_states_wherever_it_is_flown():
    flights = prepare(fly(Setup(maneuvers=3, seed=10)), Aircraft())
    trim = flights.flights[0].alpha_trim
    curve = {"M_alpha2": 20.0, "M_alpha3": 0.0, "about_rad": trim - 0.05}
    effects = {"nonlinear_pitching_moment": curve}
    numbers = with_known(np.zeros(len(ENTRIES)), effects, flights, variants_for(flights))
    assert numbers[0, INDEX["M_alpha"]] == pytest.approx(2.0 * 20.0 * 0.05)


def test_a_dead_band_keeps_the_deflection_that_the_file_states_whatever_the_trim():
    flown = []
    for maneuver, above in zip(fly(Setup(maneuvers=3, seed=10)), (0.03, -0.02, 0.01), strict=True):
        flown.append(changed(maneuver, "elevator", y=maneuver.channels["elevator"].y + above))
    flights = prepare(flown, Aircraft())
    effects = {"actuator_deadband": {"half_width_rad": 0.012, "neutral_rad": -0.02}}
    numbers = with_known(np.zeros(len(ENTRIES)), effects, flights, variants_for(flights))
    middles = numbers[:, INDEX["neutral_rad"]] + [flight.u_trim for flight in flights.flights]
    assert middles == pytest.approx(-0.02)


def test_what_is_found_beyond_a_number_of_the_file_is_added_to_it():
    known = {"transport_delay": {"delay_s": 0.03}, "unsteady_lift": {"share": 0.3, "lag_s": 0.1}}
    found = {"transport_delay": {"delay_s": 0.02}, "alpha_scale": {"scale": 0.1}}
    both = together(known, found)
    assert both["transport_delay"]["delay_s"] == pytest.approx(0.05)
    assert both["unsteady_lift"] == known["unsteady_lift"]
    assert both["alpha_scale"] == {"scale": 0.1}


def test_what_is_found_beyond_one_number_leaves_the_files_others_as_they_are():
    both = together(
        {"thrust_moment": {"M_throttle": 1.0, "lag_s": 0.5}}, {"thrust_moment": {"M_throttle": 0.2}}
    )
    assert both["thrust_moment"] == pytest.approx({"M_throttle": 1.2, "lag_s": 0.5})


def test_the_damping_of_a_servo_is_said_anew_and_its_lag_added():
    known = {"actuator_lag": {"lag_s": 0.05, "damping": 0.7}}
    both = together(known, {"actuator_lag": {"lag_s": 0.03, "damping": 0.7}})
    assert both["actuator_lag"] == pytest.approx({"lag_s": 0.08, "damping": 0.7})


def test_the_propellers_share_counts_from_nothing_and_leaves_what_the_throttle_does():
    known = {"thrust_moment": {"M_throttle": 2.0, "M_thrust": 1.0}}
    both = together(known, {"thrust_moment": {"M_thrust": 1.5, "washed_share": 0.1, "blown_share": 0.0}})
    assert both["thrust_moment"] == {
        "M_throttle": 2.0, "M_thrust": 1.5, "washed_share": 0.1, "blown_share": 0.0,
    }  # fmt: skip


@pytest.mark.parametrize("known", [{"lag_s": 0.1}, {"lag_s": 0.1, "damping": 0.7}])
def test_a_servo_is_searched_for_as_the_file_describes_it(late, known):
    left = beyond_known({"actuator_lag": known}, variants_for(prepare(late, Aircraft())))
    servos = [v for v in left if v.effect == "actuator_lag"]
    assert [dict(v.fixed) for v in servos] == [{k: x for k, x in known.items() if k == "damping"}]
    assert servos[0].bounds[0][0] == -0.1


def test_a_change_in_flight_of_the_file_scales_the_derivatives_after_it(late):
    flights = prepare(late, Aircraft())
    variants = variants_for(flights)
    at_s = next(v.fixed["at_s"] for v in variants if v.effect == "mass_change" and "at_s" in v.fixed)
    known = changes_in({"mass_change": {"step": 0.25, "at_s": float(f"{at_s:.6g}")}}, variants)
    problem = EffectProblem(flights, np.zeros(len(ENTRIES)), changes=known)
    lift = problem.driving(SearchPoint(np.full(6, -1.0), np.zeros((6, 4))))[:, INDEX["Z_alpha"]]
    assert lift == pytest.approx([-1.0, *[-0.8] * 5])


def test_a_change_that_the_flight_does_not_show_is_left_aside_by_the_baseline(late):
    flights = prepare(late, Aircraft())
    onset = next(v.fixed["at_s"] for v in variants_for(flights) if "at_s" in v.fixed)
    file = Aircraft(effects={"mass_change": {"step": 0.3, "at_s": onset}, "alpha_scale": {"scale": 0.0}})
    assert of_this_flight(flights, file).effects == {"alpha_scale": {"scale": 0.0}}


def test_the_slope_of_a_curve_of_the_file_adds_to_the_derivatives(late):
    flights = prepare(late, Aircraft())
    curve = {"M_alpha2": 20.0, "M_alpha3": 0.0, "about_rad": flights.flights[0].alpha_trim - 0.05}
    base = with_known(
        np.zeros(len(ENTRIES)), {"nonlinear_pitching_moment": curve}, flights, variants_for(flights)
    )
    numbers = EffectProblem(flights, base).driving(SearchPoint(np.full(6, -1.0), np.zeros((6, 4))))
    assert numbers[0, INDEX["M_alpha"]] == pytest.approx(2.0 * 20.0 * 0.05 - 1.0)


def resting(flights, file, sides):
    """Return the flights as an aircraft with the file's effects flies them, its play on these sides."""
    problem, fitted = fit_unfiltered(flights, file)
    numbers = problem.driving(replace(fitted.point, sides=np.array(sides)))
    again = []
    for flight, p in zip(flights.flights, numbers, strict=True):
        read = problem.read(flight, problem.fly(flight, p), p)
        rows = dict(zip(problem.channels, problem.rows(flight), strict=True))
        outputs = {c: out._replace(y=read[rows[c]]) for c, out in flight.outputs.items() if c in rows}
        again.append(replace(flight, outputs=outputs))
    return replace(flights, flights=tuple(again))


def test_play_of_the_file_rests_on_a_side_of_its_own_in_every_manoeuvre():
    file = Aircraft(effects={"actuator_backlash": {"half_width_rad": 0.012}})
    flights = prepare(fly(Setup(maneuvers=3, switches={"play": 0.012}, seed=7)), Aircraft())
    _, fitted = fit_unfiltered(resting(flights, file, [1.0, -1.0, 1.0]), file)
    assert list(fitted.point.sides) == [1.0, -1.0, 1.0]
