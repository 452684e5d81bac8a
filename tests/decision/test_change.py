"""Something changed: told apart from noise and from a poor manoeuvre."""

from dataclasses import replace

import numpy as np
import pytest

from advisor.aircraft.aircraft import Aircraft, CampaignPlan
from advisor.aircraft.reference import PARAMETERS
from advisor.bundled.study.campaigns import Scene, fly_named, respond
from advisor.decision.axes.lateral_stop import lateral_flight_test
from advisor.decision.change import find_change
from advisor.decision.history import CandidateManeuver, Heard
from advisor.decision.stopping import flight_test
from advisor.decision.verdict import Reason
from advisor.process.arrays import FloatArray
from sim.linear import ShortPeriod
from tests.campaign.side_builders import estimate as side_estimate
from tests.decision.campaigns import THETA, drawn, estimate, with_change


def flown(rng: np.random.Generator, *thetas: FloatArray) -> list[CandidateManeuver]:
    return [CandidateManeuver(drawn(rng, theta)) for theta in thetas]


@pytest.fixture
def rng() -> np.random.Generator:
    return np.random.default_rng(21)


@pytest.mark.parametrize("parameter", ["Z_alpha", "M_alpha", "M_delta_e", "M_q"])
def test_a_loss_is_suspected_after_one_manoeuvre_and_confirmed_after_two(rng, parameter):
    less = with_change(parameter, 0.85)
    history = flown(rng, THETA, THETA, THETA, less, less)
    first, second = find_change(history[:4]), find_change(history)
    assert first is not None
    assert second is not None
    assert not first.confirmed
    assert second.confirmed
    assert first.after == second.after == 3
    assert second.moved[0].parameter == parameter
    assert second.moved[0].percent == pytest.approx(-15.0, abs=4.0)
    assert abs(second.moved[0].sigma) > 5.0


def test_noise_alone_is_no_change(rng: np.random.Generator) -> None:
    alarms = [find_change(flown(rng, *[THETA] * 6)) for _ in range(60)]
    assert not any(alarms)


def test_a_poor_manoeuvre_is_forgotten_when_the_next_is_like_the_earlier_ones(rng):
    poor = THETA * rng.normal(1.0, 0.2, 8)
    history = flown(rng, THETA, THETA, THETA, poor, THETA)
    suspected = find_change(history[:4])
    assert suspected is not None
    assert "poor manoeuvre, or something changed" in suspected.sentence
    assert find_change(history) is None


def test_two_manoeuvres_alone_cannot_tell_which_is_the_odd_one(rng: np.random.Generator) -> None:
    assert find_change(flown(rng, THETA, with_change("M_alpha", 0.5))) is None


def test_a_change_of_a_few_per_cent_is_not_worth_a_warning(rng: np.random.Generator) -> None:
    slight = with_change("M_alpha", 0.95)
    exact = [
        CandidateManeuver(estimate(theta, std_percent=0.1)) for theta in (THETA, THETA, THETA, slight, slight)
    ]
    assert find_change(exact) is None


@pytest.mark.parametrize(
    ("powers", "looks_like"),
    [
        ((0, 0, 0, 1, 0, 0), "centre of gravity"),
        ((1, 0, 0, 0, 0, 0), "ice on the wing"),
        ((1, 0, 1, 1, 0, 1), "ice on wing and tail"),
        ((1, 0, 1, 1, 1, 1), "another mass"),
        ((0, 0, 1, 0, 0, 1), "elevator's effectiveness or its calibration"),
        ((1, 0, 1, 2, 1, 2), "air speed"),
        ((0, 1, 1, -1, 0, 0), "scale of the angle of attack"),
        ((0, -1, 0, 1, 0, 1), "scale of the pitch rate"),
    ],
)
def test_the_simplest_cause_is_named(rng, powers, looks_like):
    one_plus = np.array([0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0])
    exponents = np.array([0, *powers[:3], 0, *powers[3:]], float)
    after = (THETA + one_plus) * 0.8**exponents - one_plus
    change = find_change(flown(rng, THETA, THETA, THETA, after, after))
    assert change is not None
    assert looks_like in change.looks_like
    assert looks_like in change.sentence


def test_a_scale_error_of_the_angle_of_attack_moves_the_parameters_as_its_cause_says() -> None:
    # Substitute α = α_m/k in Eqs. (1) and (2) and compare trajectories.
    scene, k = Scene(), 0.8
    truth = fly_named(scene, "3211")
    theta = scene.theta.copy()
    theta[[0, 3]] *= k
    theta[2] = (1.0 + theta[2]) * k - 1.0
    theta[5] /= k
    misread = ShortPeriod(*theta)
    response = respond(misread, truth.elevator, truth.trim * [k, 1.0], 1.0 / scene.rate_hz)
    np.testing.assert_allclose(response, truth.response * [k, 1.0], atol=1e-9)


def test_a_cause_is_named_although_the_rest_of_the_aircraft_is_uneven_by_a_few_per_cent() -> None:
    uneven = THETA * [1.0, 1.02, 1.0, 1.03, 1.0, 0.7, 0.98, 1.03]
    history = [
        CandidateManeuver(estimate(theta, std_percent=0.1)) for theta in (THETA, THETA, uneven, uneven)
    ]
    change = find_change(history)
    assert change is not None
    assert [m.parameter for m in change.moved] == ["M_alpha"]
    assert "centre of gravity" in change.looks_like


def test_unusable_manoeuvres_are_no_evidence_of_a_change(rng: np.random.Generator) -> None:
    spoilt = [
        CandidateManeuver(
            estimate(with_change("M_alpha", 0.5)), reasons=(Reason("bank", "banked", 40.0, 30.0),)
        )
    ] * 2
    assert find_change([*flown(rng, THETA, THETA, THETA), *spoilt]) is None


def test_the_flight_test_warns_whichever_rule_decides(rng: np.random.Generator) -> None:
    less = with_change("M_alpha", 0.8)
    history = flown(rng, THETA, THETA, THETA, less, less)
    for rule in ("continuous", "separate", "information"):
        warnings = flight_test(history, CampaignPlan(rule=rule)).warnings
        assert any(w.startswith("Something changed after manoeuvre 3: M_α -20 %") for w in warnings)


def test_manoeuvres_are_numbered_as_flown_even_with_unusable_ones_between(rng: np.random.Generator) -> None:
    less = with_change("M_alpha", 0.8)
    spoilt = CandidateManeuver(estimate(), reasons=(Reason("bank", "banked", 40.0, 30.0),))
    before, after = flown(rng, THETA, THETA, THETA), flown(rng, less, less)
    change = find_change([before[0], spoilt, *before[1:], *after])
    assert change is not None
    assert change.after == 4


def of_side(rng: np.random.Generator, control: str, **factors: float) -> CandidateManeuver:
    """A manoeuvre of aileron or rudder, with noise, by the jet whose derivatives have these factors."""
    sound = side_estimate(control, percent=2.0)
    names, std = sound.names, np.sqrt(np.diag(sound.covariance))
    theta = sound.theta * [factors.get(name, 1.0) for name in names]
    return CandidateManeuver(replace(sound, theta=theta + std * rng.standard_normal(len(std))))


def test_a_weaker_aileron_is_found_in_roll_and_yaw_with_its_cause(rng: np.random.Generator) -> None:
    weaker = {f"{letter}_delta_a": 0.7 for letter in "YLN"}
    history = [of_side(rng, control) for control in ("aileron", "rudder", "aileron")]
    history += [of_side(rng, control, **weaker) for control in ("rudder", "aileron")]
    change = find_change(history)
    assert change is not None
    assert (change.after, change.confirmed) == (3, True)
    moved = {one.parameter: one.percent for one in change.moved}
    assert moved["L_delta_a"] == pytest.approx(-30.0, abs=4.0)
    assert set(moved) <= set(weaker)
    assert change.looks_like == "the aileron's effectiveness or its calibration"


def test_noise_alone_is_no_change_in_roll_and_yaw(rng: np.random.Generator) -> None:
    alarms = [find_change([of_side(rng, c) for c in ("aileron", "rudder") * 3]) for _ in range(30)]
    assert not any(alarms)


def test_a_change_ends_the_stop_of_roll_and_yaw_and_is_said(rng: np.random.Generator) -> None:
    history = [of_side(rng, control) for control in ("aileron", "rudder", "aileron", "rudder")]
    both = side_estimate("aileron", "rudder", percent=2.0)
    estimates = [one.estimate for one in history]
    heard = [Heard.of(lateral_flight_test(estimates, both, Aircraft()))]
    weaker = {f"{letter}_delta_a": 0.7 for letter in "YLN"}
    change = find_change([*history, *(of_side(rng, c, **weaker) for c in ("aileron", "rudder"))])
    poor = side_estimate("aileron", "rudder", percent=60.0)
    verdict = lateral_flight_test(estimates, poor, Aircraft(), (), heard, change)
    assert verdict.decision == "continue"
    # The rudder's manoeuvre 4 does not show the aileron, so the change may lie on either side of it.
    assert verdict.sentence.startswith("CONTINUE: Something changed after manoeuvre ")
    assert "L_δa -30 %" in verdict.sentence
    assert verdict.warnings == (change.sentence,)
    assert lateral_flight_test(estimates, poor, Aircraft(), (), heard).decision == "stop"


def exactly(std_percent: float, *changes: dict[str, float]) -> list[CandidateManeuver]:
    """Three manoeuvres of the reference aircraft, then one for each of these shares of its derivatives."""
    found = [THETA] * 3
    for shares in changes:
        theta = THETA.copy()
        for name, share in shares.items():
            theta[PARAMETERS.index(name)] *= share
        found.append(theta)
    return [CandidateManeuver(estimate(theta, std_percent=std_percent)) for theta in found]


SIGMA_PERCENT = 2.0 * np.sqrt(1 / 3 + 1 / 2)
"""Standard deviation of the difference between the means of three and of two manoeuvres of 2 %, per cent."""


@pytest.mark.parametrize(("sigmas", "found"), [(5.0, False), (7.0, True)])
def test_five_standard_deviations_of_one_derivative_are_noise_and_seven_are_not(sigmas, found):
    moved = {"M_q": 1.0 + 0.01 * sigmas * SIGMA_PERCENT}
    assert (find_change(exactly(2.0, moved, moved)) is not None) is found


@pytest.mark.parametrize(("sigmas", "named"), [(2.5, False), (3.5, True)])
def test_a_derivative_is_named_from_three_standard_deviations_on(sigmas: float, named: bool) -> None:
    sigma_percent = 2.0 * SIGMA_PERCENT
    moved = {"M_q": 1.0 + 0.01 * sigmas * sigma_percent, "M_delta_e": 0.5}
    found = find_change(exactly(4.0, moved, moved))
    assert found is not None
    assert ("M_q" in [one.parameter for one in found.moved]) is named


def test_manoeuvres_that_scatter_more_than_they_state_hide_a_change() -> None:
    moved = 1.0 + 0.01 * 7.0 * SIGMA_PERCENT
    scattered = exactly(2.0, *({"M_q": moved, "M_alpha": share} for share in (1.08, 0.92)))
    assert find_change(scattered) is None
