"""Side gusts and coloured instruments in residuals made by hand."""

from dataclasses import replace

import numpy as np
import pytest

from advisor.aircraft.reference import SIDE_PARAMETERS
from advisor.gap.axis.effects import axis_effects
from advisor.gap.axis.fit import fitted, moved_by, outputs
from advisor.gap.axis.flight import AxisFlight
from advisor.gap.axis.gusts import Gusts, coloured_likelihood, gusts_of
from advisor.gap.axis.laws import axis_laws, lacking
from advisor.gap.axis.models import case_of
from advisor.gap.axis.residual import residual_of
from advisor.gap.axis.setting import moved_to
from advisor.gap.axis.starts import Starts
from advisor.gap.verdict.missing_law import law_in
from advisor.model.axes.lateral import LATERAL
from advisor.oem.axis.disturbance import answered, courses_of
from advisor.oem.driven_motion.setting import Noise
from tests.gap.axis.test_comparison import AIRCRAFT, maneuvers
from tests.oem.axis.builders import JET

ANGLE = 0.01
STEP_S = 0.02  # the response to a disturbance is given at these steps
NOISE = np.array([0.003, 0.001, 0.002, 0.03, 1.0])


@pytest.fixture(scope="module")
def case():
    model = replace(AIRCRAFT, model=dict(JET))
    return case_of(LATERAL, maneuvers(), model, np.array([JET[name] for name in SIDE_PARAMETERS]))


@pytest.fixture(scope="module")
def flight(case):
    """Return a fit with the true derivatives, and what gusts change in its manoeuvres."""
    fit = fitted(case.flown, case.begin, case.natural, case.prior_of(1e-6, case.natural))
    return fit, courses_of(fit.linear(case.flown)), case.prior_of(0.3, fit.free)


def with_residual(fit, residual):
    white = NOISE[fit.assembly.channel] * np.random.default_rng(2).standard_normal(len(residual))
    return replace(fit, fitted=fit.assembly.z - white - residual, noise=NOISE)


def wandering(n, memory, rng):
    x = np.zeros(n)
    for i in range(1, n):
        x[i] = memory * x[i - 1] + np.sqrt(1.0 - memory**2) * rng.standard_normal()
    return x


def flown_law(case, fit, m, block, of):
    """Return the outputs' change by a law x·|x| of a rate in an equation, from the fitted motion."""
    rows, stamps = fit.assembly.rows[m][of], fit.assembly.t[fit.assembly.blocks[m]]
    t = np.arange(np.min(stamps), np.max(stamps), STEP_S)
    x = np.interp(t, fit.assembly.t[rows], fit.fitted[rows])
    return answered(fit.linear(case.flown), m, block, t, (x * np.abs(x))[:, None])[:, 0]


def test_a_gust_angle_enters_all_outputs_and_its_size_is_found(case, flight):
    fit, courses, _ = flight
    rng = np.random.default_rng(3)
    blown = [ANGLE * course.columns @ wandering(len(course.knots), 0.9, rng) for course in courses]
    gusty = with_residual(fit, np.concatenate(blown))
    found = gusts_of(gusty, case.flown)
    assert found.angle == pytest.approx(ANGLE, rel=0.4)
    assert abs(found.angle - ANGLE) < 4.0 * found.angle_std
    assert found.likelihood > coloured_likelihood(gusty) + 20.0


def test_the_likelihood_is_the_normal_density_of_instruments_and_a_markov_gust_angle(case, flight):
    """The gust drives the motion; its angle has the covariance of a first-order process. Trims are free."""
    fit, _, _ = flight
    gusty = with_residual(fit, 0.01 * np.random.default_rng(5).standard_normal(len(fit.fitted)))
    still = Noise.still(2.0 * NOISE)
    gusts, alone = (
        Gusts(noise, np.nan, np.nan, np.empty(0), np.empty(0)).at(gusty, case.flown)
        for noise in (replace(still, gust=ANGLE, gust_memory_s=2.5), still)
    )
    density = 0.0
    for m, rows in enumerate(fit.assembly.blocks):
        t, own = fit.assembly.t[rows], fit.sensitivities[rows][:, fit.assembly.own]
        knots = np.arange(np.min(t), np.max(t) + STEP_S, STEP_S)
        columns = answered(gusty.linear(case.flown), m, "air", knots, np.eye(len(knots)))
        white = np.diag((2.0 * NOISE[fit.assembly.channel[rows]]) ** 2)
        angles = ANGLE**2 * np.exp(-np.abs(knots[:, None] - knots) / 2.5)
        for both, sign in ((white + columns @ angles @ columns.T, 1.0), (white, -1.0)):
            root = np.linalg.cholesky(both)
            left, trims = np.linalg.solve(root, gusty.residual[rows]), np.linalg.solve(root, own)
            left -= trims @ np.linalg.lstsq(trims, left, rcond=None)[0]
            density -= sign * (0.5 * float(left @ left) + float(np.sum(np.log(np.diag(root)))))
    assert gusts.likelihood - alone.likelihood == pytest.approx(density, rel=0.1)


def test_a_coloured_instrument_is_no_gust(case, flight):
    fit, *_ = flight
    rng = np.random.default_rng(4)
    left = np.zeros(len(fit.fitted))
    for rows in (named["r"] for named in fit.assembly.rows):
        left[rows] = 0.004 * wandering(rows.stop - rows.start, 0.95, rng)
    coloured = with_residual(fit, left)
    found = gusts_of(coloured, case.flown)
    assert found.angle < 0.1 * ANGLE
    assert found.likelihood < coloured_likelihood(coloured) + 5.0


def test_still_air_has_no_gusts(case, flight):
    fit, *_ = flight
    still = with_residual(fit, np.zeros(len(fit.fitted)))
    found = gusts_of(still, case.flown)
    assert found.angle < 0.1 * ANGLE
    assert found.likelihood == pytest.approx(coloured_likelihood(still), abs=15.0)


@pytest.mark.parametrize(
    "block",
    ["aileron", "rudder", "rolling_moment", "yawing_moment", "roll_rate_sensor", "yaw_rate_sensor", "air"],
)
def test_a_disturbance_is_found_in_its_block(case, flight, block):
    fit, _, _ = flight
    courses = courses_of(fit.linear(case.flown), block)
    rng = np.random.default_rng(5)
    seen = np.concatenate([c.columns @ wandering(len(c.knots), 0.8, rng) for c in courses])
    largest = np.max(np.abs(seen) / NOISE[fit.assembly.channel])
    found = residual_of(with_residual(fit, 20.0 / largest * seen), case.flown, 1.0)
    if block == "air":
        right, lacking = found.nats(in_moving_air=False)
        assert lacking < right, "air that moves at rest as in motion repeats with no motion"
    else:
        assert max(found.blocks, key=lambda one: found.blocks[one]) == block


@pytest.mark.parametrize(("everywhere", "repeats"), [(True, True), (False, False)])
def test_a_residual_with_the_yaw_rate_scatters_less_where_every_manoeuvre_has_it(
    case, flight, everywhere, repeats
):
    """The second manoeuvre is a rudder input."""
    fit, _, _ = flight
    left = np.zeros(len(fit.fitted))
    for named in fit.assembly.rows if everywhere else fit.assembly.rows[1:2]:
        left[named["r"]] = 0.05 * fit.fitted[named["r"]]
    found = residual_of(with_residual(fit, left), case.flown, 1.0)
    assert found.freedom == len(fit.assembly.rows) - 1
    assert found.size > 1.0
    assert (found.error < 0.6 * found.size**2) is repeats


def test_white_noise_leaves_no_residual(case, flight):
    fit, _, _ = flight
    still = with_residual(fit, np.zeros(len(fit.fitted)))
    right, lacking = residual_of(still, case.flown, 1.0).nats(in_moving_air=False)
    assert lacking < right - 1.0


def test_the_derivatives_are_estimated_anew_in_gusts(case, flight):
    """A fit under white noise takes a part of the gusts for derivatives, which a scale then explains."""
    fit, courses, known = flight
    rng = np.random.default_rng(3)
    blown = [ANGLE * course.columns @ wandering(len(course.knots), 0.9, rng) for course in courses]
    gusty = with_residual(fit, np.concatenate(blown))
    found = gusts_of(gusty, case.flown)
    step = np.linalg.solve(found.matrix + np.diag(known.precision), found.gradient)
    white = gusty.columns * gusty.weight[:, None]
    by_white = np.linalg.solve(
        white.T @ white + np.diag(known.precision), white.T @ (gusty.residual * gusty.weight)
    )
    told = np.flatnonzero(np.abs(by_white) > 0.0)
    assert np.linalg.norm((step / np.abs(fit.values + 1e-9))[told]) < np.linalg.norm(
        (by_white / np.abs(fit.values + 1e-9))[told]
    )


def test_a_fit_moves_as_its_derivatives_say_and_its_trims_follow(case, flight):
    fit, _, _ = flight
    change = 0.02 * fit.values
    moved = moved_by(case.flown, fit, change)
    np.testing.assert_allclose(moved.values, fit.values + change, rtol=1e-12)
    told = fit.columns @ change
    assert np.max(np.abs(told)) > 1e-3
    weight = fit.weight
    assert np.linalg.norm(weight * (moved.fitted - fit.fitted - told)) < 0.1 * np.linalg.norm(weight * told)


def test_a_delay_that_moves_the_first_event_leaves_the_first_states_on_the_motion(case, flight):
    """A difference of late outputs is then the derivative that the simulated motion gives."""
    fit, _, _ = flight
    k = [f.place for f in fit.free].index(("bank", "delay_s"))
    late = moved_to(fit.point.setting, [("bank", "delay_s")], fit.values[15 + k] + np.array([1e-3]))
    change = outputs(case.flown, fit.point._replace(setting=late), fit.begun) - fit.fitted
    assert np.max(np.abs(change / 1e-3 - fit.slopes[:, k])) < 0.02 * np.max(np.abs(fit.slopes[:, k]))


@pytest.mark.parametrize(
    ("block", "of"),
    [("rolling_moment", "p"), ("rolling_moment", "beta"), ("yawing_moment", "r"),
     ("roll_rate_sensor", "roll_rate_sensor")],
)  # fmt: skip
def test_a_curve_is_found_in_its_block_with_what_bends_it(case, flight, block, of):
    fit, _, _ = flight
    laws = {law.name: law for law in axis_laws(case, fit) if law.columns is not None}
    bent = f"{block}_curve_of_{of}"
    seen = laws[bent].columns @ laws[bent].std
    largest = np.max(np.abs(seen) / NOISE[fit.assembly.channel])
    left = with_residual(fit, 20.0 / largest * seen)
    found = min(Starts(case, left, list(laws.values())).of_each, key=lambda start: start.price)
    assert found.name == bent


@pytest.mark.parametrize(("block", "of"), [("rolling_moment", "p"), ("yawing_moment", "r")])
def test_a_law_in_an_equation_is_named_with_its_quantity_and_coefficient(case, flight, block, of):
    fit, _, _ = flight
    seen = np.concatenate([flown_law(case, fit, m, block, of) for m in range(fit.assembly.maneuvers)])
    size = 60.0 / np.max(np.abs(seen) / NOISE[fit.assembly.channel])
    found = law_in(block, lacking(case, with_residual(fit, size * seen), block), heat=1.0)
    assert (found.variable, found.nearest) == (of, f"{of}*abs({of})")
    assert found.coefficient.value == pytest.approx(size, rel=0.1)
    assert found.term == f"{'N' if block == 'yawing_moment' else 'L'}:{found.nearest}"


def test_a_bent_reading_is_the_square_and_the_cube_of_the_reading(case, flight):
    fit, _, _ = flight
    bent = "roll_rate_sensor_curve_of_roll_rate_sensor"
    law = next(one for one in axis_laws(case, fit) if one.name == bent)
    rows = fit.assembly.rows[0]["p"]
    p = fit.fitted[rows]
    most = max(np.max(np.abs(fit.fitted[named["p"]])) for named in fit.assembly.rows)
    share = p / most
    assert law.columns[rows, 0] == pytest.approx(share * np.abs(share), abs=0.03)
    assert law.columns[rows, 1] == pytest.approx(share**3, abs=0.03)


def test_a_late_roll_rate_promises_as_much_as_an_early_yaw_rate_where_all_other_clocks_are_free(case):
    """A plain fit puts the lateness of one rate onto all other clocks."""
    late = [
        replace(
            record,
            outputs={**record.outputs, "p": record.outputs["p"]._replace(t=record.outputs["p"].t + 0.045)},
        )
        for record in case.flown.problem.records
    ]
    flown = replace(case.flown, problem=replace(case.flown.problem, records=tuple(late)))
    case = replace(case, flown=flown)
    plain = case.fit(case.begin, case.natural)
    table = [one for one in axis_effects(flown) if one.name.startswith("late_")]
    promised = {one.name: one.price + 2.0 * plain.likelihood for one in Starts(case, plain, table).of_each}
    assert promised["late_roll_rate_stamps"] < -50.0
    assert promised["late_roll_rate_stamps"] == pytest.approx(promised["late_yaw_rate_stamps"], rel=0.1)


def test_a_coloured_nat_counts_less_in_the_screening(case, flight):
    """At a tenth of the white noise's nats, an effect saves a tenth."""
    fit, _, _ = flight
    table = [one for one in axis_effects(case.flown) if one.name == "roll_rate_scale"]
    left = with_residual(fit, 0.05 * fit.fitted)
    white, coloured = (Starts(case, left, table, share=share).of_each[0] for share in (1.0, 0.1**0.5))
    gains = [-2.0 * scale * left.likelihood - one.cost for scale, one in ((1.0, white), (0.1, coloured))]
    assert gains[1] == pytest.approx(0.1 * gains[0], rel=0.05)


def test_a_delay_of_all_commands_beyond_that_of_telemetry_is_evidence_of_one_cause(case):
    late = [
        replace(record, inputs={n: s._replace(t=s.t - 0.2) for n, s in record.inputs.items()})
        for record in case.flown.problem.records
    ]
    flown = replace(case.flown, problem=replace(case.flown.problem, records=tuple(late)))
    case = replace(case, flown=flown)
    table = [one for one in axis_effects(flown) if one.name.endswith("_transport_delay")]
    plain = case.fit(case.begin, case.natural)
    _, (without, *models) = AxisFlight(case, plain, table).explained(None, len(table))
    gained = {one.name: one.evidence.either - without.evidence.either for one in models}
    size = next(one.fit.values[-1] for one in models if one.name == "common_transport_delay")
    assert size == pytest.approx(0.2, abs=0.03)
    assert gained["common_transport_delay"] > 5.0
    assert max(gained["aileron_transport_delay"], gained["rudder_transport_delay"]) < 2.0
