"""Which effects are accepted, and which of two descriptions of one motion is chosen."""

from dataclasses import replace

import numpy as np
import pytest

from advisor.aircraft.aircraft import Aircraft
from advisor.aircraft.reference import PARAMETERS
from advisor.gap.candidates.catalogue import variants_for
from advisor.gap.diagnose import diagnose
from advisor.gap.fitting.fit import fit
from advisor.gap.fitting.holdout import hold_out
from advisor.gap.fitting.uncertainty import effective_samples
from advisor.gap.records.prepare import prepare
from advisor.gap.search.baseline import fit_baseline
from advisor.gap.search.indistinguishable import indistinguishable_from
from advisor.gap.search.score import addition
from tests.gap.generator import LIGHT_AIRCRAFT, UAV, Setup, fly


@pytest.fixture(scope="module")
def late():
    """Return a flight with late accelerometers, its baseline fit, and the delay as an addition to it."""
    flights = prepare(fly(Setup(maneuvers=6, skew={"a_z": 0.02}, seed=61)), Aircraft())
    problem, plain = fit_baseline(flights, Aircraft())
    variant = next(v for v in variants_for(flights) if v.effect == "accelerometer_skew")
    fitted = fit(problem, plain.point.with_effect(variant, variant.starts[0]), plain.noise, 25)
    effective = effective_samples(problem, fitted.innovations)
    held = hold_out(problem, plain)
    return problem, held, addition(problem, plain, held, fitted, variant.effect, effective)


def test_ice_takes_lift_and_what_leaves_the_lift_alone_is_none(late):
    problem, _, judged = late
    ice = next(v for v in variants_for(problem.flights) if v.effect == "icing")
    iced = replace(
        judged, variant=ice, smallest=2.0 * ice.smallest, value=np.array([-0.06, 0.0, -0.05, -0.05])
    )
    assert iced.large_enough
    assert not replace(iced, value=np.array([0.02, 0.1, 0.3, -0.1])).large_enough


def test_a_late_channel_may_be_a_filtered_one_and_how_to_tell_is_said(late):
    _, _, judged = late
    names, ways = indistinguishable_from(judged, [judged], ("alpha", "q", "a_z", "theta"))
    assert names == ("a filter of that channel with an equal delay",)
    assert "before any filter" in ways


def test_what_other_derivatives_imitate_exactly_is_tied_with_them_whatever_the_file_says(late):
    problem, _, judged = late
    m_alpha_dot = next(v for v in variants_for(problem.flights) if v.effect == "alpha_dot")
    names, ways = indistinguishable_from(
        replace(judged, variant=m_alpha_dot), [judged], ("alpha", "q", "a_z", "theta")
    )
    assert "other derivatives of the pitching moment" in names
    assert "trims level flight" in ways


@pytest.mark.parametrize(("less", "tied"), [(5.0, True), (7.0, False)])
def test_ice_that_explains_nearly_as_much_as_more_mass_is_tied_with_it(late, less, tied):
    problem, _, judged = late
    mass, ice = (
        replace(judged, variant=next(v for v in variants_for(problem.flights) if v.effect == name), gain=gain)
        for name, gain in (("mass_change", 1000.0), ("icing", 1000.0 - less))
    )
    names, ways = indistinguishable_from(mass, [mass, ice], ("alpha", "q", "a_z", "theta"))
    assert names == (("icing",) if tied else ())
    assert ("fuel" in ways) == tied


@pytest.mark.study
@pytest.mark.parametrize("arm_m", [-0.5, 0.5])
def test_of_two_arms_that_are_one_in_the_data_the_file_tells(arm_m):
    still = diagnose(fly(Setup(maneuvers=6, seed=24)), Aircraft())
    file = Aircraft(
        model={name: still.model[name].value for name in PARAMETERS},
        reference_airspeed_m_s=still.reference_airspeed_m_s,
    )
    for switch, effect in (("acc_arm", "accelerometer_offset"), ("vane_arm", "alpha_vane_offset")):
        found = diagnose(fly(Setup(maneuvers=6, switches={switch: arm_m}, seed=62)), file)
        assert found.causes[0].effect == effect
        assert found.causes[0].parameters["arm_m"].value == pytest.approx(arm_m, rel=0.15)


def test_what_is_kept_out_is_predicted_alike_by_two_names_of_one_motion():
    """Check that an accelerometer off its place and a vane off its own give one motion."""
    setup = Setup(airframe=LIGHT_AIRCRAFT, maneuvers=6, switches={"acc_arm": 1.5}, seed=63)
    flights = prepare(fly(setup), Aircraft())
    problem, plain = fit_baseline(flights, Aircraft())
    errors = []
    for name in ("accelerometer_offset", "alpha_vane_offset"):
        variant = next(v for v in variants_for(flights) if v.effect == name)
        fitted = fit(problem, plain.point.with_effect(variant, variant.starts[0]), plain.noise, 25)
        errors.append(hold_out(problem, fitted).innovation_square / fitted.noise**2)
    # The accelerometer and the attitude see the two arms differ a little where the speed moves.
    angle_and_rate = slice(0, 2)
    assert errors[0][angle_and_rate] == pytest.approx(errors[1][angle_and_rate], rel=1e-3)


def test_where_an_effect_is_stays_where_only_manoeuvres_kept_out_tell_of_it():
    flights = prepare(fly(Setup(maneuvers=6, switches={"deadband": 0.012}, seed=64)), Aircraft())
    problem, plain = fit_baseline(flights, Aircraft())
    variant = next(v for v in variants_for(flights) if v.effect == "actuator_deadband")
    fitted = fit(problem, plain.point.with_effect(variant, (0.012, 0.0)), plain.noise, 25)
    # As if the band lay above the trim, which the first and the fourth manoeuvre alone can tell.
    shared = fitted.point.shared.copy()
    shared[-1] = 0.01
    told = list(fitted.linear)
    for i in (1, 2, 4, 5):
        columns = told[i].columns.copy()
        columns[:, told[i].m + len(shared) - 1] = 0.0
        told[i] = replace(told[i], columns=columns)
    above = replace(fitted, point=fitted.point.moved(shared, fitted.point.own), linear=tuple(told))
    size = replace(variant, places=())
    as_size = replace(above, point=replace(above.point, effects=(*above.point.effects[:-1], size)))
    kept_out, to_nothing = (hold_out(problem, f).by_maneuver[[0, 3]] for f in (above, as_size))
    assert np.sum(kept_out / fitted.noise**2) < 0.1 * np.sum(to_nothing / fitted.noise**2)


@pytest.mark.study
@pytest.mark.parametrize("tiny", [{"switches": {"acc_arm": 0.05}}, {"q_bias": 0.0014}], ids=["arm", "bias"])
def test_what_every_instrument_has_is_no_cause_however_plain(tiny):
    found = diagnose(fly(Setup(maneuvers=6, noise=0.002, seed=67, **tiny)), Aircraft())
    assert found.verdict == "none"


@pytest.mark.study
def test_what_every_instrument_has_is_not_unknown_where_it_shows_beside_small_motion():
    small = replace(UAV, amplitude_deg=0.2 * UAV.amplitude_deg)
    found = diagnose(fly(Setup(airframe=small, maneuvers=6, q_bias=0.0015, noise=0.01, seed=61)), Aircraft())
    assert found.verdict == "none"


def gained_by_a_gyros_scale(thrust_arm):
    """Return the judgement of a gyro that reads 6 % too much, with a thrust change in one manoeuvre."""
    flown = Setup(
        maneuvers=6, q_scale=0.06, thrust_amplitude=0.5, thrust_moves_in=(2,),
        switches={"thrust_arm": thrust_arm}, seed=4,
    )  # fmt: skip
    problem, plain = fit_baseline(prepare(fly(flown), Aircraft()), Aircraft())
    thrust, scale = (
        next(v for v in variants_for(problem.flights) if v.effect == effect)
        for effect in ("thrust_moment", "pitch_rate_scale")
    )
    before = fit(problem, plain.point.with_effect(thrust, thrust.starts[0]), plain.noise, 25)
    after = fit(problem, before.point.with_effect(scale, (0.0,)), before.noise, 25)
    effective = effective_samples(problem, after.innovations)
    return addition(problem, before, hold_out(problem, before), after, scale.effect, effective).gain


def test_what_one_manoeuvre_alone_tells_of_one_effect_is_not_held_against_another():
    assert gained_by_a_gyros_scale(0.05) == pytest.approx(gained_by_a_gyros_scale(0.0), rel=0.05)
