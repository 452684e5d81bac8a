from dataclasses import replace

import numpy as np
import pytest

from advisor.model.axes.lateral import LATERAL
from advisor.oem.axis import search as axis_search
from advisor.oem.axis.motion import AxisMotion
from advisor.oem.axis.problem import AxisProblem, lay_out
from advisor.oem.axis.search import not_identifiable, priors_of, solve
from advisor.oem.descent import descended
from advisor.oem.extra import Prior
from advisor.oem.rows import Signal
from advisor.oem.solution import RUNS_AWAY, Solution
from tests.oem.axis.builders import (
    JET,
    aileron_doublet,
    both_inputs,
    flown,
    number,
    rudder_doublet,
    steps,
    vector,
)

T = np.arange(0.0, 15.0, 0.025)
WITHOUT_VANE = ("p", "r", "bank", "a_y")

STILL = Signal(T, 0.0 * T)
"""Record of a control that nobody moves."""


def solved(problem, numbers=()):
    solution = solve(problem, numbers)
    assert isinstance(solution, Solution), solution
    return solution


def errors(solution):
    return (solution.theta - vector(JET)) / np.sqrt(np.diag(solution.widened)[: len(solution.theta)])


def place(name):
    return LATERAL.names.reported.index(name)


@pytest.mark.parametrize("measured", [WITHOUT_VANE, (*WITHOUT_VANE, "beta"), ("p", "r", "bank", "beta")])
def test_two_doublets_tell_every_derivative_with_a_true_error(measured):
    solution = solved(both_inputs(JET, np.random.default_rng(3), measured))
    assert np.max(np.abs(errors(solution))) < 3.5
    assert solution.widened[place("L_p"), place("L_p")] < (0.02 * 2.1) ** 2


def test_everything_is_identifiable_from_aileron_and_rudder():
    solution = solved(both_inputs(JET, np.random.default_rng(1)))
    assert not_identifiable(solution) == {}
    unsure = replace(solution, systematic=1e4 * np.eye(len(solution.covariance)))
    assert not_identifiable(unsure) == {}, "no further input helps against a model's own error"


def test_the_aileron_alone_leaves_the_rudder_unknown_and_says_what_to_fly():
    record = flown(JET, aileron=aileron_doublet(T), rudder=STILL, rng=np.random.default_rng(1))
    told = not_identifiable(solved(AxisProblem(LATERAL, (record,))))
    for name in ("Y_delta_r", "L_delta_r", "N_delta_r"):
        assert told[name] == "the rudder did not move; fly a rudder doublet"
    assert "L_p" not in told


def test_the_rudder_alone_leaves_the_aileron_unknown():
    record = flown(JET, rudder=rudder_doublet(T), aileron=STILL, rng=np.random.default_rng(1))
    told = not_identifiable(solved(AxisProblem(LATERAL, (record,))))
    assert told["L_delta_a"] == "the aileron did not move; fly an aileron doublet"
    assert "N_delta_r" not in told


def test_no_rudder_doublet_is_asked_of_an_aircraft_without_a_rudder():
    record = flown(JET, aileron=aileron_doublet(T), rng=np.random.default_rng(1))
    solution = solved(AxisProblem(LATERAL, (record,)))
    told = not_identifiable(solution)
    assert told["N_delta_r"] == "no output of the rudder is known"
    assert not any("rudder doublet" in text for text in told.values())


def test_a_prior_that_the_data_do_not_sharpen_is_no_knowledge():
    rng = np.random.default_rng(1)
    record = flown(JET, aileron=aileron_doublet(T), measured=WITHOUT_VANE, rng=rng)
    force = record.outputs["a_y"]
    useless = Signal(force.t, force.y + rng.normal(0.0, 3.0, len(force.t)))
    solution = solved(AxisProblem(LATERAL, (replace(record, outputs={**record.outputs, "a_y": useless}),)))
    std = np.sqrt(np.diag(solution.widened)[: len(solution.theta)])
    assert std[place("Y_p")] > 0.015  # of 0.05 before the flight
    assert "Y_r" in not_identifiable(solution)


def test_derivatives_are_given_at_the_reference_speed():
    record = flown(JET, aileron=aileron_doublet(T), rudder=rudder_doublet(T))
    at_half = solved(AxisProblem(LATERAL, (record,), reference_airspeed_m_s=65.0))
    assert at_half.theta[place("L_beta")] == pytest.approx(JET["L_beta"] / 4.0, rel=1e-3)
    assert at_half.theta[place("L_p")] == pytest.approx(JET["L_p"] / 2.0, rel=1e-3)


def test_without_side_force_and_sideslip_only_the_damping_of_the_force_is_free():
    laid = lay_out(both_inputs(JET, measured=("p", "r", "bank")))
    free = {LATERAL.names.shared[k] for k in laid.free if k < 15}
    assert {name for name in LATERAL.names.shared if name not in free} == {
        "Y_p", "Y_r", "Y_delta_a", "Y_delta_r",
    }  # fmt: skip


def test_without_side_force_and_sideslip_no_derivative_is_told():
    record = flown(JET, aileron=aileron_doublet(T), measured=("p", "r", "bank"), rng=np.random.default_rng(1))
    told = not_identifiable(solved(AxisProblem(LATERAL, (record,))))
    assert set(told) == set(LATERAL.names.reported)
    assert all("record a_y" in text for text in told.values())


@pytest.mark.parametrize(("share", "flown_too"), [(0.15, False), (0.25, True)])
def test_feet_that_move_a_fifth_of_the_hands_fly_no_rudder_test(share, flown_too):
    feet = Signal(T, share * aileron_doublet(T).y)
    problem = AxisProblem(LATERAL, (flown(JET, aileron=aileron_doublet(T), rudder=feet),))
    assert problem.flies("aileron")
    assert problem.flies("rudder") == flown_too


def test_a_control_that_hardly_moves_takes_less_of_the_models_error_than_a_flown_one():
    twitch = steps(T, (14.85,), (0.002,))
    record = flown(JET, aileron=aileron_doublet(T), rudder=twitch, rng=np.random.default_rng(1))
    rate = record.outputs["r"]
    gust = Signal(rate.t, rate.y + 0.2 * np.maximum(rate.t - 14.85, 0.0))
    solution = solved(AxisProblem(LATERAL, (replace(record, outputs={**record.outputs, "r": gust}),)))
    # A fit without the prior gives 188.
    assert abs(solution.theta[place("N_delta_r")]) < 100.0
    assert solution.theta[place("L_delta_a")] == pytest.approx(JET["L_delta_a"], rel=0.01)


ARM_M, SPEED_M_S = 13.0, 130.0


def on_a_boom():
    """Return two doublets whose sideslip is read ahead of the centre of gravity."""
    problem = both_inputs(JET, np.random.default_rng(5))
    boomed = []
    for record in problem.records:
        beta, rate = record.outputs["beta"], record.outputs["r"]
        read = Signal(beta.t, beta.y + ARM_M / SPEED_M_S * rate.y)
        boomed.append(replace(record, outputs={**record.outputs, "beta": read}))
    return AxisProblem(LATERAL, tuple(boomed))


def test_a_boom_taken_as_the_centre_of_gravity_shifts_the_yaw_damping():
    without_force = tuple(
        replace(record, outputs={n: s for n, s in record.outputs.items() if n != "a_y"})
        for record in on_a_boom().records
    )
    taken = solved(AxisProblem(LATERAL, without_force)).theta[place("N_r")]
    assert taken == pytest.approx(JET["N_r"] - JET["N_beta"] * ARM_M / SPEED_M_S, abs=0.02)
    placed = solved(AxisProblem(LATERAL, without_force, values={("beta", "arm_m"): ARM_M})).theta[
        place("N_r")
    ]
    assert placed == pytest.approx(JET["N_r"], abs=0.02)


def test_an_unknown_boom_is_estimated_and_leaves_the_yaw_damping_true():
    boom = number("beta", "arm_m", Prior(0.0, 0.1 * SPEED_M_S), SPEED_M_S)
    solution = solved(on_a_boom(), (boom,))
    arm, std = solution.nuisances["beta_arm_m"]
    assert abs(arm - ARM_M) < 3.0 * std < 2.0
    assert solution.theta[place("N_r")] == pytest.approx(JET["N_r"], abs=0.02)


def test_a_start_from_which_the_model_runs_away_gives_no_fit():
    problem = both_inputs(JET, np.random.default_rng(1))
    unstable = vector({**JET, "L_p": 60.0})
    local = np.ones((len(problem.records), len(LATERAL.names.local)))
    assert (
        descended(AxisMotion(LATERAL), problem, (), priors_of(problem, unstable), (unstable, local))
        is RUNS_AWAY
    )


def begun_at(monkeypatch, problem, **values):
    """Begin the search of a problem at other derivatives or trims of the aircraft, and look only once."""
    names, local = LATERAL.names, np.zeros((len(problem.records), len(LATERAL.names.local)))
    for name in values.keys() & set(names.local):
        local[:, names.local.index(name)] = values[name]
    shared = vector({name: values.get(name, value) for name, value in JET.items()})
    monkeypatch.setattr(axis_search, "starting_point", lambda problem: (shared, local))
    monkeypatch.setattr(axis_search, "FIRST_LOOK", 0)


def test_a_first_look_that_is_worse_than_no_motion_is_searched_on(monkeypatch):
    problem = both_inputs(JET, np.random.default_rng(1))
    due = solved(problem).theta
    begun_at(monkeypatch, problem, L_p=0.2)
    assert solved(problem).theta == pytest.approx(due, rel=1e-4, abs=1e-6)


def test_a_search_that_stays_worse_than_no_motion_is_refused_before_it_is_evaluated(monkeypatch):
    problem = both_inputs(JET, np.random.default_rng(1))
    begun_at(monkeypatch, problem, L_0=1e3)
    monkeypatch.setattr(axis_search, "descended", lambda *a: descended(*a[:5], 0))
    monkeypatch.setattr(axis_search, "_evaluated", lambda *fit: pytest.fail("the fit was evaluated"))
    assert solve(problem) is RUNS_AWAY
