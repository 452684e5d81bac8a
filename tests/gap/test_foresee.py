"""The foresight of a plan: every effect of the catalogue, and the additions that make more visible."""

import io
import json
from dataclasses import replace

import numpy as np
import pytest
from click.testing import CliRunner
from rich.console import Console

from advisor.aircraft.aircraft import Aircraft
from advisor.aircraft.reference import PARAMETERS
from advisor.cli.group import advisor
from advisor.gap.candidates.distinguish import need_of
from advisor.gap.effects import EFFECTS
from advisor.gap.foresight.plan import foresee_flights, foresee_plan
from advisor.gap.records.prepare import prepare
from advisor.gap.search.baseline import prior_derivatives
from advisor.report.gap_plan import ForesightScreen, size_of
from advisor.words.problems import ConfigurationError
from advisor.words.quantities import symbol
from tests.gap.diagnosed import diagnose
from tests.gap.generator import UAV, Setup, fly
from tests.schemas import breaches

MODEL = dict(zip(PARAMETERS, (0.04, -4.3, -0.03, -0.28, 0.0, -37.0, -4.8, -52.0), strict=True))
PLANE = Aircraft(model=MODEL, reference_airspeed_m_s=22.0)
PLAN = ("3211", "rev", "rev", "3211")


@pytest.fixture(scope="module")
def foreseen():
    return {f.effect: f for f in foresee_plan(PLANE, PLAN, 50.0, 2.0)}


def test_every_effect_of_the_catalogue_is_foreseen_in_its_order(foreseen):
    assert tuple(foreseen) == tuple(EFFECTS)


@pytest.mark.parametrize(
    ("known", "sought"),
    [
        ({"unsteady_lift": {"share": 0.3, "lag_s": 0.2}}, False),
        ({"structural_mode": {"frequency_hz": 5.0, "damping": 0.1, "gain": 0.5}}, False),
        ({"transport_delay": {"delay_s": 0.05}}, True),
    ],
)
def test_what_the_aircraft_file_has_is_foreseen_beyond_it_or_taken_as_it_stands(known, sought):
    found = {f.effect: f for f in foresee_plan(replace(PLANE, effects=known), PLAN, 50.0, 2.0)}
    assert tuple(found) == tuple(EFFECTS)
    effect = found[next(iter(known))]
    assert np.isfinite(effect.smallest) == sought
    assert ("in the aircraft file" in effect.add) != sought


def test_what_the_plan_cannot_show_says_what_to_add(foreseen):
    assert not np.isfinite(foreseen["ground_effect"].smallest)
    assert "low and high" in foreseen["ground_effect"].add
    assert all(f.add for f in foreseen.values() if not np.isfinite(f.smallest))


@pytest.mark.parametrize(
    ("without", "effect", "message"),
    [
        ("climb_rate", "alpha_bias", "VFR_HUD"),
        ("airspeed", "airspeed_variation", "VFR_HUD"),
        ("a_z", "accelerometer_offset", "RAW_IMU"),
        ("theta", "attitude_skew", "ATTITUDE"),
        ("alpha", "turbulence", "AOA_SSA"),
    ],
)
def test_without_its_channel_an_effect_is_invisible_and_the_message_is_named(without, effect, message):
    found = {f.effect: f for f in foresee_plan(PLANE, PLAN, 50.0, 2.0, (without,))}[effect]
    assert not np.isfinite(found.smallest)
    assert message in found.add


def flown_with(channel, reading):
    """Return two manoeuvres with a channel that always reads one value, or is absent (None)."""
    maneuvers = fly(Setup(maneuvers=2, heights_m=(80.0, 80.0), thrust_amplitude=0.1))
    return prepare([replace(m, channels=_altered(m.channels, channel, reading)) for m in maneuvers], PLANE)


def _altered(channels, name, reading):
    kept = {key: c for key, c in channels.items() if key != name}
    if reading is None:
        return kept
    return {**kept, name: replace(channels[name], y=np.full(len(channels[name]), reading))}


@pytest.mark.parametrize(
    ("effect", "channel", "reading", "because", "add"),
    [
        ("airspeed_variation", "airspeed", 22.0, "the air speed was constant", "fly at two air speeds"),
        ("airspeed_variation", "airspeed", 0.0, "reads almost zero", "check the air speed sensor"),
        ("airspeed_variation", "airspeed", None, "no air speed", "VFR_HUD at 10 Hz"),
        ("thrust_moment", "throttle", 0.4, "the throttle did not move", "fly at two air speeds"),
        ("thrust_moment", "throttle", None, "no throttle", "VFR_HUD at 10 Hz"),
        ("ground_effect", "height", 80.0, "the height hardly varied", "fly low and high"),
        ("ground_effect", "height", None, "no height", "range finder"),
    ],
)
def test_a_channel_that_did_not_vary_is_told_from_one_that_was_not_recorded(
    effect, channel, reading, because, add
):
    need = need_of(effect, flown_with(channel, reading))
    assert because in need.because
    assert add in need.add


def test_changes_from_one_manoeuvre_to_the_next_need_three_of_them():
    found = {f.effect: f for f in foresee_plan(PLANE, PLAN[:2], 50.0, 2.0)}
    assert not np.isfinite(found["mass_change"].smallest)
    assert "early and late" in found["mass_change"].add


def test_nothing_is_foreseen_below_what_the_diagnosis_would_name(foreseen):
    assert foreseen["transport_delay"].smallest > 0.004
    assert foreseen["alpha_bias"].smallest >= 0.003
    assert foreseen["airspeed_variation"].smallest >= 0.03


def test_a_latency_that_is_part_of_every_model_hides_as_long_a_delay(foreseen):
    assert foreseen["transport_delay"].smallest > 0.005


def test_a_slow_rate_limit_shows_and_a_limit_no_command_reaches_does_not(foreseen):
    steepest_rad_s = np.radians(2.0) * 2.6 / 0.02
    assert 0.0 < foreseen["actuator_rate_limit"].smallest < steepest_rad_s
    assert size_of(foreseen["actuator_rate_limit"]).startswith("any limit below")


def test_a_curved_term_is_a_share_of_the_linear_one_and_halves_with_twice_the_step(foreseen):
    large = {f.effect: f for f in foresee_plan(PLANE, PLAN, 50.0, 4.0)}
    for effect in ("elevator_nonlinearity", "nonlinear_pitching_moment", "nonlinear_lift"):
        assert large[effect].share == pytest.approx(foreseen[effect].share / 2.0, rel=0.25)
        assert size_of(foreseen[effect]).split(" % of ")[1] in {symbol(name) for name in MODEL}


def test_a_gust_needs_to_be_stronger_than_turbulence_and_looks_like_it(foreseen):
    assert foreseen["gust"].smallest > foreseen["turbulence"].smallest > 0.0
    assert foreseen["gust"].confused_with[0][0] == "turbulence"
    assert "a single gust does not" in foreseen["gust"].add


def test_the_screen_fits_80_columns_and_every_size_has_its_unit(foreseen):
    out = io.StringIO()
    console = Console(file=out, width=80, color_system=None, highlight=False)
    console.print(ForesightScreen("4 manoeuvres", list(foreseen.values())))
    lines = out.getvalue().splitlines()
    assert max(map(len, lines)) <= 80
    assert "…" not in out.getvalue()
    assert all(" " in size_of(f) and "e+" not in size_of(f) for f in foreseen.values())


def test_json_has_every_effect_in_si_and_null_for_what_cannot_be_seen(tmp_path):
    path = tmp_path / "plane.yaml"
    path.write_text(json.dumps({"model": MODEL, "reference_airspeed_m_s": 22.0}))
    arguments = ["gap", "--foresee", "--aircraft", str(path), "--plan", "3211,rev,rev", "--json"]
    result = CliRunner().invoke(advisor, arguments)
    document = json.loads(result.stdout)
    assert breaches("foresee", document) == []
    effects = {e["effect"]: e for e in document["effects"]}
    assert set(effects) == set(EFFECTS)
    assert effects["ground_effect"]["smallest"] is None
    assert 0.005 < effects["transport_delay"]["smallest"] < 0.05
    assert {"effect", "parameter", "smallest", "add", "confused_with"} <= set(effects["gust"])


def test_a_step_lost_in_the_noise_shows_next_to_nothing_and_the_document_has_no_infinity(tmp_path):
    path = tmp_path / "plane.yaml"
    path.write_text(json.dumps({"model": MODEL, "reference_airspeed_m_s": 22.0}))
    arguments = [
        "gap",
        "--foresee",
        "--aircraft",
        str(path),
        "--amplitude-deg",
        "0.0001",
        "--plan",
        "3211,rev,rev",
    ]
    result = CliRunner().invoke(advisor, [*arguments, "--json"])
    assert result.exit_code == 0
    effects = {e["effect"]: e for e in json.loads(result.stdout)["effects"]}
    assert effects["transport_delay"]["smallest"] is None
    assert "larger steps" in effects["transport_delay"]["add"]
    assert effects["actuator_rate_limit"]["smallest"] is None
    assert effects["turbulence"]["smallest"] is not None


@pytest.mark.parametrize(
    ("plan", "rate_hz", "without", "said"),
    [
        (("3211", "loop"), 50.0, (), "'loop' is none of"),
        ((), 50.0, (), "at least one"),
        (PLAN, 0.0, (), "above zero"),
        (PLAN, float("inf"), (), "at most 1000 Hz"),
        (("3211",), 50.0, (), "plan at least two"),
        (PLAN, 1.5, (), "plan a rate of"),
        (PLAN, 50.0, ("q",), "'q' is none of"),
    ],
)
def test_a_plan_that_cannot_be_flown_is_refused_with_what_would_do(plan, rate_hz, without, said):
    with pytest.raises(ConfigurationError, match=said):
        foresee_plan(PLANE, plan, rate_hz, 2.0, without)


def test_an_elevator_without_effect_is_refused():
    with pytest.raises(ConfigurationError, match=r"M_delta_e: an elevator without effect"):
        foresee_plan(replace(PLANE, model={**MODEL, "M_delta_e": 0.0}), PLAN, 50.0, 2.0)


def test_a_curve_of_a_term_that_is_nothing_has_its_own_unit_for_it_is_no_share():
    neutral = replace(PLANE, model={**MODEL, "M_alpha": 0.0})
    found = {f.effect: f for f in foresee_plan(neutral, PLAN, 50.0, 2.0)}["nonlinear_pitching_moment"]
    assert found.share is None
    assert size_of(found).endswith("s⁻²rad⁻¹")


@pytest.mark.parametrize(("sign", "unusual"), [(-1.0, False), (1.0, True)])
def test_an_elevator_that_pitches_up_when_it_goes_down_is_foreseen_with_a_note(tmp_path, sign, unusual):
    path = tmp_path / "plane.yaml"
    path.write_text(json.dumps({"model": {**MODEL, "M_delta_e": sign * 52.0}}))
    arguments = ["gap", "--foresee", "--aircraft", str(path), "--plan", "3211,rev"]
    document = json.loads(CliRunner().invoke(advisor, [*arguments, "--json"]).stdout)
    assert any("right for a canard" in note for note in document["notes"]) == unusual
    assert ("right for a canard" in CliRunner().invoke(advisor, arguments).stdout) == unusual


@pytest.mark.study
@pytest.mark.timeout(1200)
@pytest.mark.parametrize(
    ("effect", "changes"),
    [
        ("pitch_rate_scale", lambda size: {"q_scale": size}),
        ("alpha_lag", lambda size: {"switches": {"vane_lag": size}}),
    ],
)
def test_flown_by_another_generator_twice_the_foreseen_size_is_named_and_a_third_is_not(effect, changes):
    flown = prepare(fly(Setup(maneuvers=7, seed=21)), PLANE)
    found = foresee_flights(PLANE, prior_derivatives(PLANE), flown, flown.white, UAV.unit_s)
    smallest = {f.effect: f.smallest for f in found}[effect]
    twice, third = (
        diagnose(fly(Setup(maneuvers=7, seed=22, **changes(share * smallest))), Aircraft())
        for share in (2.0, 0.3)
    )
    assert twice.causes[0].effect == effect
    assert effect not in {cause.effect for cause in third.causes if cause.present}


def test_a_curve_that_no_flight_of_the_plan_shows_has_no_share():
    hidden = [f for f in foresee_plan(PLANE, PLAN[:2], 50.0, 0.02) if np.isinf(f.smallest)]
    assert "elevator_nonlinearity" in {f.effect for f in hidden}
    assert {f.share for f in hidden} == {None}
