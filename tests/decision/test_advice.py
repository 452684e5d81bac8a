"""What next: how many more, what holds the stop back, which input helps most within the limits."""

from dataclasses import replace

import numpy as np
import pytest

from advisor.aircraft.aircraft import Aircraft, CampaignPlan, Elevator, Limits
from advisor.aircraft.reference import PARAMETERS
from advisor.bundled.study.campaigns import Scene, estimate_copies, follow
from advisor.decision.advice import next_input
from advisor.decision.conditions import share_after
from advisor.decision.history import CandidateManeuver
from advisor.decision.information import knowledge
from advisor.decision.inputs import StepInput
from advisor.decision.prediction import Instruments, expect
from advisor.decision.stopping import flight_test
from advisor.decision.verdict import NO_CURE_BY_INPUT, Reason, Remaining
from advisor.flight.maneuvers.maneuver import Maneuver, Span
from advisor.flight.signals.record import Channel
from advisor.flight.signals.trust import Distrust
from advisor.oem.surface import Servo
from tests.decision.campaigns import THETA, estimate

INSTRUMENTS = Instruments((0.02, 0.02), (np.radians(0.15), np.radians(0.5)), Servo())
AIRCRAFT = Aircraft(campaign=CampaignPlan(rule="information"))
STANDARD = StepInput("3-2-1-1", 0.7, float(np.radians(2.0)), nose_up_first=True)


def manoeuvre(option: StepInput = STANDARD) -> Maneuver:
    """A manoeuvre of ten seconds, the input after one."""
    signal = option.elevator(0.0, 1.0, 10.0)
    t = np.arange(0.0, 10.0, 0.02)
    first = -option.amplitude_rad if option.nose_up_first else option.amplitude_rad
    steps = ((1.0, first), (1.0 + option.duration_s, 0.0))
    span = Span(0.0, 1.0, 1.0 + option.duration_s, 10.0, "3-2-1-1", steps, "quiet")
    return Maneuver(1, 0, span, {"elevator": Channel("elevator", t, signal.at(t))})


def flown(std_percent: float = 5.0, option: StepInput = STANDARD) -> CandidateManeuver:
    """A usable manoeuvre in which angle of attack moved by three degrees."""
    one = estimate(std_percent=std_percent)
    t = np.arange(0.0, 10.0, 0.02)
    alpha = np.radians(3.0) * np.sin(t)
    fits = {
        name: replace(fit, t=t, measured=alpha, fitted=alpha, noise=noise)
        for (name, fit), noise in zip(one.fits[0].items(), INSTRUMENTS.noise, strict=True)
    }
    return CandidateManeuver(replace(one, fits=(fits,)), maneuver=manoeuvre(option))


def percent_stick(advice: str) -> float:
    return float(advice.rsplit(", ", 1)[1].split(" %")[0])


def test_before_the_first_manoeuvre_the_textbook_input_is_advised_gently() -> None:
    advice = next_input([], AIRCRAFT)
    assert advice.advice == "next: 3-2-1-1, 0.5 s steps, 10 % stick, to begin gently"


@pytest.mark.parametrize("rule", ["continuous", "separate", "information"])
def test_while_no_manoeuvre_was_usable_nothing_is_foretold(rule) -> None:
    aircraft = replace(AIRCRAFT, campaign=CampaignPlan(rule=rule))
    rough = Reason("turbulence", "rough air, 15 % of the pitch rate; fly it in calmer air", 15.0, 8.0)
    for history in ([], [replace(flown(), reasons=(rough,))] * 3):
        advice = next_input(history, aircraft)
        assert advice.remaining is None
        assert advice.foretold == ""


def test_while_none_was_usable_the_remedy_of_the_newest_is_repeated() -> None:
    rough = Reason("turbulence", "rough air, 15 % of the pitch rate; fly it in calmer air", 15.0, 8.0)
    advice = next_input([replace(flown(), reasons=(rough,))], AIRCRAFT)
    assert advice.advice == "next: the elevator's 3-2-1-1 again, fly it in calmer air"


def test_a_movement_without_a_name_cannot_be_repeated_so_the_first_input_is_advised() -> None:
    short = Reason("aborted", "free response too short; let the recording run on", 0.0, 0.7)
    moved = flown()
    unnamed = replace(moved.maneuver, span=replace(moved.maneuver.span, kind="other"))
    advice = next_input([replace(moved, maneuver=unnamed, reasons=(short,))], AIRCRAFT)
    assert advice.advice == "next: 3-2-1-1, 0.8 s steps, 10 % stick, to begin gently"


@pytest.mark.parametrize("code", sorted(NO_CURE_BY_INPUT))
def test_while_a_channel_is_wrong_the_next_thing_is_its_mend(code: str) -> None:
    wrong = Reason(code, "pitch rate stands still at 0 deg/s; check the gyro", 0.0, 0.0)
    advice = next_input([flown(), replace(flown(), reasons=(wrong,))], AIRCRAFT)
    assert advice.advice == "next: check the gyro"


def test_while_a_channel_stands_still_the_next_thing_is_its_mend() -> None:
    dead = Distrust(
        "frozen", "airspeed", "air speed stands still at 20 m/s", "check the air speed sensor", 20.0
    )
    newest = replace(flown(), maneuver=replace(manoeuvre(), distrusts=(dead,)))
    assert next_input([flown(), newest], AIRCRAFT).advice == "next: check the air speed sensor"


def test_the_advised_input_is_better_than_the_one_flown() -> None:
    strict = replace(AIRCRAFT, campaign=CampaignPlan(rule="information", tolerance={"M_q": 0.01}))
    advice = next_input([flown()], strict)
    spoken = advice.advice.removeprefix("next: ").removeprefix("reverse ")
    order, unit, _ = spoken.split(", ")
    option = StepInput(
        order, float(unit.removesuffix(" s steps")), np.radians(0.25) * percent_stick(spoken), True
    )
    there = expect(THETA, option.elevator(0.0, 1.0, 1.0 + option.duration_s + 4.0), INSTRUMENTS)
    here = expect(THETA, STANDARD.elevator(0.0, 1.0, 10.0), INSTRUMENTS)
    assert there is not None
    assert here is not None
    assert advice.holding_back == "M_q"
    k = PARAMETERS.index(advice.holding_back)
    assert there.std[k] < 0.9 * here.std[k]


def test_the_direction_alternates() -> None:
    assert "reverse" in next_input([flown()], AIRCRAFT).advice
    other = replace(STANDARD, nose_up_first=False)
    assert "reverse" not in next_input([flown(option=other)], AIRCRAFT).advice


def test_an_angle_of_attack_limit_keeps_the_stick_small() -> None:
    wide = next_input([flown()], replace(AIRCRAFT, limits=Limits(alpha_deg=8.0)))
    narrow = next_input([flown()], replace(AIRCRAFT, limits=Limits(alpha_deg=2.0)))
    assert percent_stick(narrow.advice) < percent_stick(wide.advice)


def test_the_next_input_is_at_most_half_as_large_again_as_any_flown() -> None:
    gentle = replace(STANDARD, amplitude_rad=float(np.radians(0.5)))
    unlimited = replace(AIRCRAFT, limits=Limits(alpha_deg=30.0))
    advice = next_input([flown(option=gentle)], unlimited)
    assert percent_stick(advice.advice) <= round(100.0 * 0.75 / 25.0)


def test_full_stick_is_the_travel_of_the_calibration() -> None:
    short = replace(AIRCRAFT, elevator=Elevator(calibration=((1000, -10.0), (1500, 0.0), (2000, 10.0))))
    assert percent_stick(next_input([flown()], short).advice) > percent_stick(
        next_input([flown()], AIRCRAFT).advice
    )


def test_fewer_manoeuvres_remain_the_more_have_been_flown() -> None:
    strict = replace(AIRCRAFT, campaign=CampaignPlan(rule="information", tolerance={"M_alpha": 0.03}))
    remaining = []
    for n in (1, 6, 11):
        median = next_input([flown(2.0)] * n, strict).remaining.median
        assert median is not None
        remaining.append(median)
    assert remaining[0] > remaining[1] > remaining[2] > 0


@pytest.mark.parametrize("rule", ["continuous", "separate"])
def test_where_chance_decides_ninety_per_cent_need_more_than_half_and_the_more_the_noisier(rule) -> None:
    aircraft = replace(AIRCRAFT, campaign=CampaignPlan(rule=rule))
    calm, noisy = (next_input([flown(n)], aircraft).remaining for n in (1.0, 2.0))
    assert calm.median is not None
    assert calm.p90 is not None
    assert noisy.p90 is not None
    assert 1 <= calm.median < calm.p90 < noisy.p90


def test_one_time_in_ten_a_manoeuvre_is_spoilt_or_not_predicted() -> None:
    aircraft = replace(AIRCRAFT, campaign=CampaignPlan(rule="information"))
    remaining = next_input([flown(1.0)], aircraft).remaining
    assert (remaining.median, remaining.p90) == (1, 2)


def test_a_crew_that_spoils_half_of_its_manoeuvres_is_promised_more() -> None:
    aircraft = replace(AIRCRAFT, campaign=CampaignPlan(rule="information", tolerance={"M_alpha": 0.05}))
    spoilt = replace(flown(2.0), reasons=(Reason("bank", "banked", 40.0, 30.0),))
    clean = next_input([flown(2.0)] * 8, aircraft).remaining
    poor = next_input([spoilt, flown(2.0)] * 8, aircraft).remaining
    assert None not in (clean.p90, poor.p90)
    assert poor.median > clean.median
    assert poor.p90 > clean.p90


def test_the_forecast_is_of_inputs_as_flown_and_not_of_the_advised_one() -> None:
    strict = replace(AIRCRAFT, campaign=CampaignPlan(rule="information", tolerance={"M_alpha": 0.03}))
    history = [flown(2.0)] * 2
    known = knowledge(history, strict.campaign)
    needed = 1
    while share_after(known, history[0].estimate.covariance, needed) >= 1.0:
        needed += 1
    assert next_input(history, strict).remaining.median >= needed


def test_no_end_in_sight_is_said_as_none() -> None:
    aircraft = replace(AIRCRAFT, campaign=CampaignPlan(rule="continuous"))
    assert next_input([flown(30.0)] * 3, aircraft).remaining.median is None


def test_what_remains_is_said_as_a_pilot_hears_it() -> None:
    assert Remaining(2, 4).spoken == "about 2 more, 9 times in 10 at most 4"
    assert Remaining(30, None).spoken == "about 30 more"
    assert Remaining(None, None).spoken == "no end in sight"


def test_every_flight_test_verdict_comes_with_advice() -> None:
    for history in ([], [flown()], [flown()] * 3):
        assert flight_test(history, AIRCRAFT.campaign, AIRCRAFT).next is not None


def test_the_expected_error_is_that_of_repeated_estimates() -> None:
    scene = Scene()
    alpha, trim = scene.aircraft.trim()
    t = np.arange(501) / 50.0
    elevator = STANDARD.elevator(trim, 1.0, 10.0).at(t)
    flight = follow(scene, t, elevator)
    noise = np.array(INSTRUMENTS.noise)
    found = estimate_copies(flight, 0.1 * noise, 150, np.random.default_rng(12))
    expected = expect(scene.theta, STANDARD.elevator(trim, 1.0, 10.0), INSTRUMENTS)
    assert expected is not None
    scatter = np.std([e.theta for e in found], axis=0)
    np.testing.assert_allclose(scatter, 0.1 * expected.std, rtol=0.2)
    deviation = np.max(np.abs(flight.response[:, 0] - alpha))
    assert expected.alpha_excursion == pytest.approx(deviation, rel=0.01)
