"""The diagnosis names effects of an aircraft that neither it nor the simulator has coded."""

import json
from dataclasses import replace

import numpy as np
import pytest
import yaml

from advisor.aircraft.aircraft import Aircraft, CampaignPlan, Limits
from advisor.aircraft.reference import PARAMETERS, FmuTrim, FmuVariables
from advisor.aircraft_file.read import parse_aircraft
from advisor.gap.foresight.plan import foresee_plan
from advisor.report.gap_document import gap_document
from advisor.report.improved import improved_file, text_of
from advisor.words.problems import ConfigurationError
from tests.gap.diagnosed import diagnose
from tests.gap.generator import LIGHT_AIRCRAFT, Setup, fly
from tests.schemas import breaches

# One diagnosis serves several tests.
pytestmark = pytest.mark.xdist_group("diagnosis")

MODEL = dict(zip(PARAMETERS, (0.04, -4.3, -0.03, -0.28, 0.0, -37.0, -4.8, -52.0), strict=True))


@pytest.fixture(scope="module")
def delayed():
    return diagnose(fly(Setup(maneuvers=4, switches={"delay": 0.06}, seed=3)), Aircraft(name="test"))


def test_a_delay_is_named_sized_and_removed_on_manoeuvres_kept_out(delayed):
    assert delayed.verdict == "effect"
    assert delayed.causes[0].effect == "transport_delay"
    assert delayed.causes[0].parameters["delay_s"].value == pytest.approx(0.06, abs=0.003)
    assert delayed.where.block == "input"
    assert delayed.shrink.percent > 97.0
    assert "ms too early" in delayed.sentence


@pytest.mark.study
@pytest.mark.parametrize(
    ("effect", "changes"),
    [
        ("alpha_lag", {"switches": {"vane_lag": 0.04}}),
        ("accelerometer_skew", {"skew": {"a_z": 0.03}}),
        ("nonlinear_pitching_moment", {"switches": {"cm_a2": -3.0}}),
        ("mass_change", {"mass_step": 0.15}),
    ],
)
def test_effects_of_every_kind_are_named_in_noise_with_memory_and_jitter(effect, changes):
    found = diagnose(fly(Setup(maneuvers=6, coloured=0.6, jitter=0.004, seed=7, **changes)), Aircraft())
    assert found.causes[0].effect == effect
    assert found.verdict == "effect"


@pytest.mark.study
def test_when_the_autopilot_was_booted_is_no_part_of_the_answer():
    flown = fly(Setup(maneuvers=6, mass_step=0.12, noise=0.03, seed=12))
    early, late = diagnose(flown, Aircraft()), diagnose([booted_before(m, 7200.0) for m in flown], Aircraft())
    assert early.causes[0].effect == "mass_change"
    assert [c.effect for c in late.causes] == [c.effect for c in early.causes]
    for one, other in zip(early.causes, late.causes, strict=True):
        assert other.probability == pytest.approx(one.probability, abs=1e-3)
        sizes = {name: v.value - 7200.0 * (name == "at_s") for name, v in other.parameters.items()}
        assert sizes == pytest.approx(
            {name: v.value for name, v in one.parameters.items()}, rel=1e-2, abs=1e-4
        )


def booted_before(maneuver, seconds):
    """Return the manoeuvre of a vehicle that was switched on earlier by this time."""
    span = maneuver.span
    later = replace(
        span,
        **{
            name: getattr(span, name) + seconds
            for name in ("record_from_s", "start_s", "last_step_s", "end_s")
        },
        steps=tuple((t + seconds, level) for t, level in span.steps),
    )
    channels = {name: replace(c, t=c.t + seconds) for name, c in maneuver.channels.items()}
    return replace(maneuver, span=later, channels=channels)


@pytest.mark.study
@pytest.mark.parametrize("late_s", [0.05, -0.03])
def test_a_message_that_is_late_shifts_attitude_and_pitch_rate_together(late_s):
    skew = {"q": late_s, "theta": late_s}
    found = diagnose(fly(Setup(maneuvers=6, skew=skew, attitude_brings_q=True, seed=6)), Aircraft())
    assert [c.effect for c in found.causes if c.present] == ["attitude_skew"]
    assert found.causes[0].parameters["skew_s"].value == pytest.approx(late_s, abs=0.004)
    assert found.causes[0].parameters["with_pitch_rate"].value == 1.0
    assert found.sentence.startswith("Attitude and pitch rate are stamped")


@pytest.mark.study
def test_nothing_is_named_when_nothing_is_there():
    found = diagnose(fly(Setup(maneuvers=6, coloured=0.8, seed=9, airframe=LIGHT_AIRCRAFT)), Aircraft())
    assert found.verdict == "none"
    assert not any(c.present for c in found.causes)


@pytest.mark.study
def test_moving_air_is_called_turbulence_and_not_an_effect_of_the_aircraft():
    found = diagnose(fly(Setup(maneuvers=6, gust_std=0.5, seed=2)), Aircraft())
    assert found.causes[0].effect == "turbulence"
    assert found.where.block == "air"


@pytest.mark.study
def test_a_name_that_explains_the_gap_with_the_files_own_numbers_is_likelier_than_numbers_that_imitate_it():
    sound = diagnose(fly(Setup(maneuvers=5, noise=0.005, seed=9)), Aircraft())
    model = {name: number.value for name, number in sound.model.items()}
    nearly = {**model, "M_q": 0.8 * model["M_q"], "Z_alpha": 1.08 * model["Z_alpha"]}
    plane = Aircraft(model=nearly, reference_airspeed_m_s=sound.reference_airspeed_m_s)
    behind = Setup(maneuvers=6, switches={"acc_arm": -2.5}, noise=0.002, seed=18)
    found = diagnose(fly(behind), plane)
    assert (found.verdict, found.causes[0].effect) == ("effect", "accelerometer_offset")
    assert found.causes[0].parameters["arm_m"].value == pytest.approx(-2.5, rel=0.05)


@pytest.mark.study
def test_wrong_numbers_in_the_file_are_told_from_missing_structure():
    wrong = Aircraft(model={**MODEL, "M_alpha": -25.0})
    found = diagnose(fly(Setup(maneuvers=6, seed=4)), wrong)
    assert found.verdict == "parameters"
    assert found.model["M_alpha"].value == pytest.approx(-37.4, rel=0.03)


@pytest.mark.study
def test_what_fitted_numbers_do_does_not_pass_for_the_work_of_the_effect_beside_them():
    wrong = Aircraft(model={**MODEL, "M_alpha": 0.7 * MODEL["M_alpha"], "M_q": 1.5 * MODEL["M_q"]})
    flown = fly(Setup(maneuvers=6, q_scale=0.1, seed=41))
    found = diagnose(flown, wrong)
    assert found.causes[0].effect == "pitch_rate_scale"
    assert 0.0 < found.shrink.by_numbers_percent < found.shrink.percent
    assert "and numbers alone leave" in found.sentence
    assert diagnose(flown, Aircraft()).shrink.by_numbers_percent is None


@pytest.mark.study
@pytest.mark.parametrize(
    "wrong",
    [
        {"M_alpha": 37.0},
        pytest.param({"M_delta_e": 52.0}),
        pytest.param({"M_delta_e": 0.0}),
        pytest.param({"M_delta_e": -0.9}),
        pytest.param({"M_q": 9.0}),
        pytest.param({"M_q": 40.0}),
    ],
)
def test_a_sign_or_a_unit_that_is_wrong_in_the_file_does_not_hide_the_cause(wrong):
    flown = fly(Setup(maneuvers=6, switches={"delay": 0.06}, seed=3))
    found = diagnose(flown, Aircraft(model={**MODEL, **wrong}))
    assert found.causes[0].effect == "transport_delay"
    assert found.causes[0].parameters["delay_s"].value == pytest.approx(0.06, abs=0.004)
    (name,) = wrong
    assert found.model[name].value == pytest.approx(MODEL[name], rel=0.1)


@pytest.mark.study
def test_numbers_that_are_right_to_a_per_cent_are_no_gap_to_mend_and_the_sentence_says_what_they_leave():
    nearly = {**MODEL, "M_alpha": 1.02 * MODEL["M_alpha"], "M_delta_e": 0.985 * MODEL["M_delta_e"]}
    found = diagnose(fly(Setup(maneuvers=6, noise=0.01, seed=4)), Aircraft(model=nearly))
    assert found.verdict == "none"
    assert found.gap.before > 0.1
    assert "its parameters are right to a few per cent" in found.sentence


@pytest.mark.study
def test_numbers_that_are_off_by_a_few_per_cent_each_are_told_where_they_leave_a_gap():
    names = ("M_alpha", "Z_alpha", "M_delta_e", "M_q")
    wrong = {**MODEL, **{n: f * MODEL[n] for n, f in zip(names, (0.94, 1.07, 0.93, 1.05), strict=True)}}
    found = diagnose(fly(Setup(maneuvers=6, noise=0.02, seed=4)), Aircraft(model=wrong))
    assert found.gap.before > 0.5
    assert found.verdict == "parameters"


@pytest.mark.study
def test_an_arm_that_the_file_leaves_open_comes_first_where_next_to_nothing_else_is_there():
    flown = fly(Setup(maneuvers=6, switches={"acc_arm": 1.5, "cl_a2": -3.0}, noise=0.005, seed=10))
    found = diagnose(flown, Aircraft(model=MODEL))
    assert found.causes[0].effect == "accelerometer_offset"


@pytest.mark.study
def test_a_faint_error_of_an_instrument_is_named_when_it_is_certain_in_still_air():
    found = diagnose(fly(Setup(maneuvers=6, alpha_scale=0.03, noise=0.03, seed=5)), Aircraft())
    assert found.gap.before < 0.05
    assert [c.effect for c in found.causes if c.present] == ["alpha_scale"]
    assert found.causes[0].parameters["scale"].value == pytest.approx(0.03, abs=0.01)


@pytest.mark.study
def test_of_two_effects_each_has_the_size_it_has_beside_the_other():
    setup = Setup(maneuvers=6, alpha_scale=0.19, skew={"a_z": 0.047}, seed=5)
    found = {c.effect: c.parameters for c in diagnose(fly(setup), Aircraft()).causes if c.present}
    assert set(found) == {"alpha_scale", "accelerometer_skew"}
    assert found["alpha_scale"]["scale"].value == pytest.approx(0.19, abs=0.012)
    assert found["accelerometer_skew"]["skew_s"].value == pytest.approx(0.047, abs=0.003)


@pytest.mark.study
def test_an_angle_of_attack_that_comes_early_is_no_vane_that_lags():
    found = diagnose(fly(Setup(maneuvers=6, skew={"alpha": -0.015}, seed=31)), Aircraft())
    assert found.causes[0].effect == "alpha_skew"
    assert found.causes[0].parameters["skew_s"].value == pytest.approx(-0.015, abs=0.003)
    assert all(c.effect != "alpha_lag" for c in found.causes)


@pytest.mark.study
def test_a_slow_servo_is_not_taken_for_a_late_one_though_its_response_has_kinks():
    setup = Setup(maneuvers=6, switches={"rate_limit": 0.7}, seed=5)
    found = diagnose(fly(setup), Aircraft())
    assert found.causes[0].effect == "actuator_rate_limit"
    assert found.causes[0].parameters["rate_rad_s"].value == pytest.approx(0.7, rel=0.1)


def test_the_document_is_json_without_nan_and_has_every_key_of_the_contract(delayed):
    document = json.loads(json.dumps(gap_document(delayed), allow_nan=False))
    assert breaches("gap", document) == []
    assert set(document) >= {
        "usable", "problems", "verdict", "gap", "where", "causes", "shrink", "waterfall", "cannot_see",
        "improved_model",
    }  # fmt: skip
    assert set(document["gap"]) >= {"before", "floor", "by_channel", "by_maneuver", "by_phase", "by_band_hz"}
    assert set(document["gap"]["floor"]) == {"alpha", "q", "a_z", "theta"}
    assert set(document["where"]) >= {"block", "share", "ranking"}
    assert set(document["causes"][0]) >= {
        "effect", "probability", "parameters", "cannot_be_told_from", "tell_apart_by", "gap_after",
    }  # fmt: skip
    assert set(document["shrink"]) >= {"holdout", "before", "after", "percent", "ci95_percent"}
    assert sum(c["probability"] for c in document["causes"]) <= 1.0 + 1e-9
    assert document["shrink"]["before"] == pytest.approx(document["gap"]["before"])


@pytest.mark.study
def test_the_waterfall_ends_at_the_gap_that_stays_whatever_the_manoeuvres_lengths():
    flown = fly(Setup(maneuvers=6, switches={"vane_lag": 0.06, "cl_a2": 12.0}, seed=4))
    for k in (1, 4):
        end = flown[k].span.end_s - 3.0
        channels = {n: replace(c, t=c.t[c.t < end], y=c.y[c.t < end]) for n, c in flown[k].channels.items()}
        flown[k] = replace(flown[k], span=replace(flown[k].span, end_s=end), channels=channels)
    found = diagnose(flown, Aircraft())
    assert len(found.waterfall) > 1
    assert found.waterfall[-1][1] == pytest.approx(found.gap.after, rel=1e-9, abs=1e-12)


def test_the_improved_simulators_file_keeps_what_else_the_crew_wrote_about_its_aircraft(delayed):
    crews = Aircraft(
        name="ours",
        airspeed_m_s=22.0,
        limits=Limits(bank_deg=20.0),
        campaign=CampaignPlan(rule="information", tolerance={"M_0": 0.1}),
        fmu=FmuVariables("delta_e", "alpha", "q", "theta", "n_z", trim=FmuTrim(airspeed="V")),
    )
    written = parse_aircraft(improved_file(delayed, crews))
    assert (written.limits, written.campaign, written.airspeed_m_s) == (crews.limits, crews.campaign, 22.0)
    assert written.fmu == crews.fmu
    assert written.name == "ours, improved"


def test_the_improved_simulator_is_a_file_with_the_effect_in_it(delayed, tmp_path):
    path = tmp_path / "improved.yaml"
    path.write_text(text_of(improved_file(delayed, Aircraft(name="test"))), encoding="utf-8")
    written = yaml.safe_load(path.read_text())
    assert written["effects"]["transport_delay"]["delay_s"] == pytest.approx(0.06, abs=0.003)
    assert set(written["model"]) == set(PARAMETERS)
    assert improved_file(delayed, Aircraft())["name"].endswith("improved")


def test_foreseeing_says_that_without_an_accelerometer_a_lag_must_be_larger_to_be_seen():
    plane = Aircraft(model=MODEL, reference_airspeed_m_s=22.0)
    plan = ("3211", "rev", "rev", "3211")
    smallest = [
        {f.effect: f.smallest for f in foresee_plan(plane, plan, 50.0, 2.0, without)}["alpha_lag"]
        for without in ((), ("a_z",))
    ]
    assert smallest[1] > 1.5 * smallest[0]


def test_foreseeing_knows_the_exact_twin_of_a_vane_off_the_centre_of_gravity():
    plane = Aircraft(model=MODEL, reference_airspeed_m_s=22.0)
    found = {f.effect: f for f in foresee_plan(plane, ("3211", "rev"), 50.0, 2.0)}
    twin, cosine = found["alpha_vane_offset"].confused_with[0]
    assert twin == "accelerometer_offset"
    assert cosine > 0.999
    assert found["alpha_vane_offset"].add


def test_foreseeing_needs_a_model():
    with pytest.raises(ConfigurationError, match="Z_0"):
        foresee_plan(Aircraft(), ("3211",), 50.0, 2.0)


def test_half_the_step_makes_the_smallest_detectable_size_twice_as_large():
    plane = Aircraft(model=MODEL, reference_airspeed_m_s=22.0)
    sizes = [
        {f.effect: f.smallest for f in foresee_plan(plane, ("3211", "rev"), 50.0, deg)}["pitch_rate_scale"]
        for deg in (1.0, 2.0)
    ]
    assert sizes[0] / sizes[1] == pytest.approx(2.0, rel=0.1)
    assert np.isfinite(sizes[0])


@pytest.mark.study
def test_stated_errors_of_the_terms_at_zero_angles_cover_their_scatter():
    found = [diagnose(fly(Setup(noise=0.05, maneuvers=6, seed=seed)), Aircraft()).model for seed in range(8)]
    for name in ("M_0", "Z_0"):
        scatter = np.std([model[name].value for model in found], ddof=1)
        stated = np.mean([model[name].std for model in found])
        # Eight flights know a scatter to within a factor of two (chi-square, 99 %).
        assert 0.5 * scatter < stated < 3.0 * scatter
