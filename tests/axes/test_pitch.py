"""Pitch as a table of the common rooms, on flights of a nonlinear aircraft of another coding."""

from dataclasses import replace

import numpy as np
import pytest

from advisor.aircraft.aircraft import Aircraft, Elevator
from advisor.gap.axis.effects import axis_effects, changes_of
from advisor.gap.axis.fit import Begun, Flying, _Motion, outputs
from advisor.gap.axis.laws import along, axis_laws, curves_of
from advisor.gap.axis.models import Case, case_of, free_near, free_with
from advisor.gap.axis.residual import noise_at_rest
from advisor.gap.axis.setting import laid_out, moved_to
from advisor.gap.axis.starts import Starts
from advisor.gap.verdict.causes import parameters_of
from advisor.model.axes.pitch import NAMES, PITCH
from advisor.oem.axis.estimate import AxisEstimate
from advisor.oem.axis.estimator import estimate_axis
from advisor.oem.axis.parameter import Parameter
from advisor.oem.extra import Prior
from tests.gap.generator import UAV, Setup, fly

SETUP = Setup(maneuvers=3, speed_change=0.03, thrust_amplitude=0.2, logs_throttle=True, seed=11)
FLOWN = fly(SETUP, 7.0)
AIRCRAFT = Aircraft(elevator=Elevator(lag_s=0.008))


@pytest.fixture(scope="module", autouse=True)
def estimate() -> AxisEstimate:
    """The estimate of the flight, which compiles the motion of two states on a new machine."""
    made = estimate_axis(PITCH, FLOWN, AIRCRAFT)
    assert isinstance(made, AxisEstimate)
    return made


@pytest.fixture(scope="module")
def case(estimate: AxisEstimate) -> Case:
    model = dict(zip(NAMES[:6], estimate.theta[:6].tolist(), strict=True))
    made = case_of(PITCH, FLOWN, replace(AIRCRAFT, model=model), estimate.theta)
    assert isinstance(made, Case)
    return made


def test_derivatives_are_those_of_the_nonlinear_aircraft(estimate):
    """By the coefficients in level flight at the mean air speed."""
    q_bar, v = 0.5 * 1.225 * UAV.speed**2, UAV.speed
    force, moment = q_bar * UAV.area / (UAV.mass * v), q_bar * UAV.area * UAV.chord / UAV.iyy
    expected = {
        "Z_alpha": -force * UAV.cl_alpha,
        "M_alpha": moment * UAV.cm_alpha,
        "M_q": moment * UAV.cm_q * UAV.chord / (2.0 * v),
        "M_delta_e": moment * UAV.cm_de,
    }
    found = dict(zip(NAMES, estimate.theta, strict=True))
    assert {name: found[name] for name in expected} == pytest.approx(expected, rel=0.08)


@pytest.mark.parametrize(
    ("place", "value", "step"),
    [
        (("mass@1", "step"), 0.1, 1e-4), (("arms@2", "step"), -0.2, 1e-4),
        (("stability@1", "step"), 0.0, 1e-4),
        (("ice@1", "M_delta_e"), -0.1, 1e-4), (("power@drift", "step"), 0.2, 1e-4),
        (("alpha", "arm_m"), 0.3, 1e-3), (("q", "scale"), 0.05, 1e-4),
        (("airspeed", "excess"), 0.03, 1e-5), (("elevator", "lag_s"), 0.03, 1e-5),
    ],
    ids=lambda x: "_".join(x) if isinstance(x, tuple) else "",
)  # fmt: skip
def test_the_column_of_a_number_is_the_difference_of_the_outputs(case, place, value, step):
    """Behind a filter of the angle of attack as well, which every column passes."""
    filtered = moved_to(case.begin.setting, [("alpha", "filter_s")], np.array([0.05]))
    point = case.begin._replace(setting=moved_to(filtered, [place], np.array([value])))
    problem, laid = Flying(case.flown, point.setting), laid_out(case.flown, point.setting)
    number = Parameter(place, Prior(0.0, 1.0), step=step)
    response = _Motion(PITCH.names).respond(problem, laid, point.theta, point.local, [number])
    begun = Begun(laid.begin, response.begun)
    up, down = (
        outputs(case.flown, point._replace(setting=moved_to(point.setting, [place], np.array([x]))), begun)
        for x in (value + step, value - step)
    )
    difference = (up - down) / (2.0 * step)
    size = np.max(np.abs(difference))
    assert size > 0.0
    np.testing.assert_allclose(response.columns()[:, 0], difference, atol=0.03 * size)


def test_thrust_behind_the_throttle_moves_the_nose_later(case):
    """A moment by known signals is a part of the motion, and a lag of the engine smooths it."""
    put = lambda lag: outputs(  # noqa: E731
        case.flown,
        case.begin._replace(
            setting=moved_to(
                case.begin.setting, [("throttle", "M_throttle"), ("throttle", "lag_s")], np.array([5.0, lag])
            )
        ),
    )
    still = outputs(case.flown, case.begin)
    prompt, late = (put(lag) - still for lag in (0.0, 0.5))
    assert np.max(np.abs(prompt)) > 0.01
    assert 0.0 < np.max(np.abs(late)) < 0.9 * np.max(np.abs(prompt))


def test_an_effect_that_relieves_a_nuisance_parameter_at_its_prior_is_promising(case):
    """A vane 0.2 s early is far from what gyro filters of 20 Hz make it, and the effect frees the fit."""
    late = [replace(r, outputs={**r.outputs}) for r in case.flown.problem.records]
    for record in late:
        angle = record.outputs["alpha"]
        record.outputs["alpha"] = angle._replace(t=angle.t - 0.2)
    flown = replace(case.flown, problem=replace(case.flown.problem, records=tuple(late)))
    case = replace(case, flown=flown)
    plain = case.fit(case.begin, case.natural)
    assert plain.point.setting["alpha", "delay_s"][0] == pytest.approx(-0.02)
    starts = Starts(case, plain, list(axis_effects(flown)))
    gained = {s.name: s.price - (starts._cost + float(starts._begin @ starts._begin)) for s in starts.of_each}
    assert gained["late_alpha_stamps"] < -5.0


def test_a_strong_curve_is_found_along_the_motion_that_it_bends(estimate):
    """The true M_α2 is q̄·S·c/I_yy of C_m,α2. Along the motion without the curve a sixth is missing."""
    flown = fly(replace(SETUP, switches={"cm_a2": 6.0}), 7.0)
    bent = case_of(PITCH, flown, AIRCRAFT, estimate.theta)
    assert isinstance(bent, Case)
    plain = bent.fit(bent.begin, bent.natural)
    curves = (curve for curve in PITCH.curves if curve.effect == "nonlinear_pitching_moment")
    (effect,) = curves_of(bent, plain, curves)
    sizes = []
    for _ in range(3):
        fit = bent.fit(plain.point, free_with(bent, effect, plain))
        sizes.append(fit.point.setting[effect.places[0]][0])
        effect = along(bent, effect, fit)
    true = 0.5 * 1.225 * UAV.speed**2 * UAV.area * UAV.chord / UAV.iyy * 6.0
    assert sizes[2] == pytest.approx(true, rel=0.1)
    assert abs(sizes[2] - true) < abs(sizes[0] - true)
    beside = free_near(bent, fit)
    assert [f.column is not None for f in beside if f.place in effect.places] == [True, True]


def test_noise_at_rest_is_what_does_not_grow_with_the_motion(case):
    """White noise of 0.01 rad/s, and a residual of 5 % of the pitch rate."""
    plain = case.fit(case.begin, case.natural)
    rows, white = plain.assembly.channel == 1, np.random.default_rng(4).standard_normal(len(plain.fitted))
    residual = 0.01 * white + 0.05 * (plain.fitted - np.median(plain.fitted[rows]))
    noisy = replace(plain, fitted=plain.assembly.z - residual)
    whole = np.sqrt(np.mean(residual[rows] ** 2))
    assert noise_at_rest(noisy)[1] == pytest.approx(0.01, rel=0.1)
    assert whole > 0.011


def test_every_effect_and_law_of_the_table_is_offered(case):
    plain = case.fit(case.begin, case.natural)
    named = {
        e.name
        for e in [*axis_effects(case.flown), *curves_of(case, plain, (c for c in PITCH.curves if c.has_name))]
    }
    assert named >= {
        "actuator_lag", "transport_delay", "actuator_backlash", "late_pitch_rate_stamps", "pitch_rate_scale",
        "alpha_vane_offset", "accelerometer_offset", "thrust_moment", "mass_change", "cg_shift", "icing",
        "airspeed_variation", "nonlinear_lift", "elevator_nonlinearity", "unsteady_lift", "structural_mode",
    }  # fmt: skip
    laws = {law.name for law in axis_laws(case, plain)}
    assert laws >= {"servo_sticks", "servo_rings", "damping_curve", "oscillator", "elevator_loss"}
    assert not named & laws
    changes = {e.places[0][0]: e.variant for e in changes_of(case.flown) if e.name == "mass_change"}
    assert changes.keys() == {"mass@drift", "mass@1", "mass@2"}
    for since in (1, 2):
        at_s = changes[f"mass@{since}"].fixed["at_s"]
        assert case.flown.ends_s[since - 1] < at_s < case.flown.begins_s[since]
    assert parameters_of(changes["mass@drift"], np.array([0.1]), np.zeros(1))["rate_per_s"].value == (
        pytest.approx(0.1 / (case.flown.begins_s[2] - case.flown.begins_s[0]))
    )
