from dataclasses import replace

import numpy as np
import pytest

from advisor.model.axes.lateral import LATERAL, Trim, modes_of, state_matrix
from advisor.oem.axis import search as axis_search
from advisor.oem.axis.motion import AxisMotion
from advisor.oem.axis.problem import AxisProblem, lay_out
from advisor.oem.axis.search import Near, search, solve
from advisor.oem.axis.start import starting_point
from advisor.oem.descent import descended
from advisor.oem.extra import Prior, moved_by
from advisor.oem.gauss_newton import CONVERGED
from advisor.oem.prior import Priors
from advisor.oem.rows import Signal
from tests.oem.axis.builders import JET, both_inputs, flown, number, vector

T = np.arange(0.0, 8.0, 0.025)
LAGS = {("aileron", "lag_s"): 0.08, ("rudder", "lag_s"): 0.05}
KNOWN_NOTHING = Priors(np.zeros(15), np.full(15, np.inf))
WIDE = Prior(0.0, 1.0)
SPEED_M_S = 130.0
CLOCKS = (
    number("command", "delay_s", WIDE),
    number("aileron", "lag_s", WIDE),
    number("rudder", "lag_s", WIDE),
    number("bank", "delay_s", WIDE),
    number("beta", "delay_s", WIDE),
    number("beta", "arm_m", WIDE, SPEED_M_S),
    number("a_y", "delay_s", WIDE),
    number("airspeed", "excess", WIDE),
    number("alpha", "excess_rad", WIDE),
)


def still(problem, nuisances, local):
    """Return the fit at the truth, before any step."""
    return descended(AxisMotion(LATERAL), problem, nuisances, KNOWN_NOTHING, (vector(JET), local), most=0)


@pytest.fixture(scope="module")
def waving():
    """Return a problem with smooth inputs and lags, and its local parameters."""
    waves = Signal(T, 0.05 * np.sin(2.0 * T)), Signal(T, 0.05 * np.sin(1.3 * T))
    record = flown(JET, aileron=waves[0], rudder=waves[1], seconds=8.0)
    problem = AxisProblem(LATERAL, (record,), values={**LAGS, ("beta", "arm_m"): 2.0})
    return problem, starting_point(problem)[1]


@pytest.mark.parametrize("x", CLOCKS, ids=lambda x: x.name)
def test_derivatives_by_servos_clocks_and_arms_are_those_of_differences(waving, x):
    problem, local = waving
    by_pass = still(problem, (x,), local).extra.columns[:, 0]
    step = 5e-4 * (SPEED_M_S if x.entry == "arm_m" else 1.0)
    ends = []
    for sign in (-1.0, 1.0):
        moved = x.write(problem, x.read(problem) + sign * step)
        there = local.copy()
        since = lay_out(moved).begin - lay_out(problem).begin
        there[:, 3:7] += since[:, None] * still(problem, (), local).response.begun
        ends.append(still(moved, (), there).optimum.fitted)
    by_difference = (ends[1] - ends[0]) / (2.0 * step)
    for rows in lay_out(problem).rows[0].values():
        scale = np.max(np.abs(by_difference)) + 1e-9
        assert np.max(np.abs(by_pass[rows] - by_difference[rows])) < 0.01 * scale


@pytest.fixture(scope="module")
def doublets():
    """Return an aileron doublet and a rudder doublet without a vane."""
    return both_inputs(JET, np.random.default_rng(2), ("p", "r", "bank", "a_y"))


def lagged(doublets, lag_s, late_s):
    """Return two doublets whose aileron lags, and whose bank angle is late."""
    flights = []
    for record in doublets.records:
        inputs = dict(record.inputs)
        if "aileron" in inputs:
            command = inputs["aileron"]
            ahead = np.gradient(command.y, command.t)
            inputs["aileron"] = Signal(command.t, command.y + lag_s * ahead)
        bank = record.outputs["bank"]
        outputs = {**record.outputs, "bank": Signal(bank.t + late_s, bank.y)}
        flights.append(replace(record, inputs=inputs, outputs=outputs))
    return AxisProblem(LATERAL, tuple(flights), values={("aileron", "lag_s"): 0.01})


def test_one_search_finds_derivatives_lag_and_delay_within_a_few_trials(doublets):
    lag, late = number("aileron", "lag_s", WIDE), number("bank", "delay_s", WIDE)
    problem = lagged(doublets, 0.06, 0.02)
    fit = descended(AxisMotion(LATERAL), problem, (lag, late), KNOWN_NOTHING, starting_point(problem))
    assert fit.optimum.status == CONVERGED
    assert fit.optimum.iterations < 20
    assert lag.read(fit.problem) == pytest.approx(0.06, abs=0.01)
    assert late.read(fit.problem) == pytest.approx(0.02, abs=0.002)
    assert fit.optimum.shared[LATERAL.names.reported.index("L_p")] == pytest.approx(JET["L_p"], rel=0.03)


def test_without_noise_an_air_speed_that_reads_too_little_is_found_and_moves_no_derivative():
    records = []
    for record in both_inputs(JET, measured=("p", "r", "bank", "a_y")).records:
        true = record.airspeed
        records.append(replace(record, given={**record.given, "airspeed": Signal(true.t, true.y / 1.04)}))
    excess = number("airspeed", "excess", WIDE)
    problem = AxisProblem(LATERAL, tuple(records))
    fit = descended(AxisMotion(LATERAL), problem, (excess,), KNOWN_NOTHING, starting_point(problem))
    assert excess.read(fit.problem) == pytest.approx(0.04, abs=0.004)
    assert fit.optimum.shared[LATERAL.names.reported.index("Y_beta")] == pytest.approx(-0.2, abs=0.002)


def test_without_noise_an_angle_of_attack_that_reads_too_much_is_found_and_moves_no_derivative():
    records = []
    for record in both_inputs(JET, measured=("p", "r", "bank", "a_y")).records:
        true = record.given["alpha"]
        records.append(replace(record, given={**record.given, "alpha": Signal(true.t, true.y + 0.01)}))
    excess = number("alpha", "excess_rad", WIDE)
    problem = AxisProblem(LATERAL, tuple(records))
    fit = descended(AxisMotion(LATERAL), problem, (excess,), KNOWN_NOTHING, starting_point(problem))
    assert excess.read(fit.problem) == pytest.approx(-0.01, abs=0.002)
    assert fit.optimum.shared[LATERAL.names.reported.index("Y_p")] == pytest.approx(JET["Y_p"], abs=0.002)


def test_a_lag_stays_within_its_range_and_everything_else_follows(doublets):
    lag = number("aileron", "lag_s", WIDE)
    problem = lagged(doublets, -0.05, 0.0)
    fit = descended(AxisMotion(LATERAL), problem, (lag,), KNOWN_NOTHING, starting_point(problem))
    assert fit.optimum.status == CONVERGED
    assert lag.read(fit.problem) == 0.0
    farther = moved_by(np.array([9.0]), lag.write(problem, 0.4), (lag,))
    assert lag.read(farther) == 0.4


def test_a_prior_of_a_derivative_pulls_by_its_share(doublets):
    k = LATERAL.names.reported.index("N_p")
    known = Priors(np.zeros(15), np.where(np.arange(15) == k, 0.01, np.inf))
    begin = starting_point(doublets)
    free, told, weighed = (
        descended(AxisMotion(LATERAL), doublets, (), prior, begin).optimum.shared[k]
        for prior in (KNOWN_NOTHING, known, replace(known, share=0.1))
    )
    assert abs(weighed) < abs(told) < abs(free)


def test_a_rudder_doublet_without_side_force_tells_the_dutch_roll(doublets):
    rudder = doublets.records[1]
    seen = {name: rudder.outputs[name] for name in ("p", "r", "bank")}
    solution = solve(AxisProblem(LATERAL, (replace(rudder, outputs=seen),)))
    trim = Trim(SPEED_M_S, 0.07, 0.105)
    found, known = (modes_of(state_matrix(theta, trim)).dutch_roll for theta in (solution.theta, vector(JET)))
    assert abs(found) == pytest.approx(abs(known), rel=0.01)
    assert -found.real == pytest.approx(-known.real, abs=0.01)


def test_a_search_that_goes_on_from_earlier_records_ends_where_one_from_a_regression_does(monkeypatch):
    trials = []

    def counted(*told):
        fit = descended(*told)
        trials[-1] += fit.optimum.iterations
        return fit

    rng = np.random.default_rng(6)
    measured = ("p", "r", "bank", "a_y")
    tests = [problem for _ in range(2) for problem in both_inputs(JET, rng, measured).records]
    clocks = [
        replace(x, prior=Prior(0.0, 0.02)) for x in CLOCKS if x.name in ("command_delay_s", "bank_delay_s")
    ]
    earlier = search(AxisProblem(LATERAL, tuple(tests[:3])), clocks)
    whole = AxisProblem(LATERAL, tuple(tests))
    monkeypatch.setattr(axis_search, "descended", counted)
    trials.append(0)
    resumed = search(whole, clocks, Near(earlier, [0, 1, 2, None])).solution
    trials.append(0)
    anew = solve(whole, clocks)
    std = np.sqrt(np.diag(anew.widened))[:15]
    assert np.max(np.abs(resumed.theta - anew.theta) / std) < 0.02
    assert np.sqrt(np.diag(resumed.widened))[:15] == pytest.approx(std, rel=0.02)
    assert trials[0] < 0.6 * trials[1]


def test_a_long_record_with_little_sideslip_starts_near_the_stiffness_in_yaw():
    """An aileron without yaw moves a small aircraft of 20 m/s, whose side force is noisy."""
    elevons = JET | {"Y_beta": -2.7, "L_beta": -26.0, "L_p": -4.9, "L_r": 1.4, "L_delta_a": -64.0}
    elevons |= {"N_beta": 41.0, "N_p": 0.2, "N_r": -2.4, "N_delta_a": 0.0}
    t, rng = np.arange(0.0, 20.0, 0.02), np.random.default_rng(0)
    sines = Signal(t, 0.012 * sum(np.sin(2.0 * np.pi * f * t + f) for f in (0.3, 0.5, 0.7, 0.9, 1.1)))
    record = flown(
        elevons, aileron=sines, seconds=20.0, rate_hz=50.0, airspeed=20.0,
        measured=("p", "r", "bank", "a_y"), rng=rng, initial=(0.0, 0.0, 0.0, 0.0),
    )  # fmt: skip
    force = record.outputs["a_y"]
    noisy = Signal(t, force.y + rng.normal(0.0, 0.15, len(t)))
    problem = AxisProblem(LATERAL, (replace(record, outputs={**record.outputs, "a_y": noisy}),))
    stiffness = starting_point(problem)[0][LATERAL.names.shared.index("N_beta")]
    assert elevons["N_beta"] / 6.0 < stiffness < elevons["N_beta"]


def test_a_search_that_goes_on_looks_for_no_other_hill_where_earlier_records_have_one(doublets, monkeypatch):
    fits = []

    def counted(*told, **ends):
        fits.append(told)
        return descended(*told, **ends)

    lag = number("aileron", "lag_s", Prior(0.05, 0.03))
    whole = lagged(doublets, 0.06, 0.0)
    earlier = search(whole, (lag,))
    assert earlier.merged
    monkeypatch.setattr(axis_search, "descended", counted)
    resumed = search(whole, (lag,), Near(earlier, [0, 1]))
    assert len(fits) == 1
    assert resumed.merged
    search(whole, (lag,), Near(earlier._replace(merged=False), [0, 1]))
    assert len(fits) == 3


def test_a_lag_near_zero_has_the_interval_of_its_posterior(doublets, monkeypatch):
    """With a delay of the command the lag may be long, by which L_p bends: a linear interval is too short."""
    clocks = number("command", "delay_s", Prior(0.0, 0.02)), number("aileron", "lag_s", Prior(0.05, 0.05))
    problem = lagged(doublets, 0.0, 0.0)
    problem = replace(problem, records=problem.records[:1])
    whole = solve(problem, clocks)
    monkeypatch.setattr(axis_search, "profiled", lambda solution, *_: solution)
    linear = solve(problem, clocks)
    k = LATERAL.names.reported.index("L_p")
    assert whole.theta[k] == linear.theta[k]
    assert whole.widened[k, k] > 1.1 * linear.widened[k, k]
