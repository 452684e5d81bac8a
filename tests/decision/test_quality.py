"""Bad manoeuvres flown by the bundled aircraft: each rejected, its own reason first; good ones not."""

from dataclasses import replace
from functools import cache
from io import BytesIO

import numpy as np
import pytest

from advisor.aircraft.aircraft import Aircraft, Elevator, Limits
from advisor.aircraft.reference import PARAMETERS
from advisor.decision.axes.requirements import judge, pitch_limits
from advisor.decision.first_unit import natural_period
from advisor.flight.maneuvers.maneuver import Maneuver as Record
from advisor.flight.maneuvers.maneuver import Span
from advisor.flight.signals.record import Channel
from advisor.flight.signals.trust import Distrust
from advisor.mavlink.wire.frames import FrameScanner
from advisor.oem.estimate import NoEstimate
from advisor.oem.estimator import estimate
from sim.effects.fitting import flight_of
from sim.record import write_tlog
from sim.scenario import Air, Maneuver, Noise, Scenario
from tests.heard import hear
from tests.maneuvers import changed, without

# The flight of bad manoeuvres is flown once.
pytestmark = pytest.mark.xdist_group("bad manoeuvres")

AIRCRAFT = Aircraft(elevator=Elevator(calibration=((1100.0, -25.0), (1500.0, 0.0), (1900.0, 25.0))))
RATES = {
    "ATTITUDE": 50.0,
    "AOA_SSA": 50.0,
    "SERVO_OUTPUT_RAW": 50.0,
    "RAW_IMU": 50.0,
    "VFR_HUD": 50.0,
    "HEARTBEAT": 10.0,
}


def flown(scenario, aircraft=AIRCRAFT):
    """(manoeuvre, its estimate, what speaks against it) for everything found in the flight."""
    log = BytesIO()
    write_tlog(flight_of(scenario), log)
    found = hear([FrameScanner().feed(log.getvalue())], aircraft).maneuvers
    estimates = [estimate(maneuver, aircraft) for maneuver in found]
    return [(m, e, judge("pitch", m, e, aircraft)) for m, e in zip(found, estimates, strict=True)]


BAD_MANOEUVRES = {
    "amplitude": Maneuver("3211", amplitude_deg=0.2),
    "steps": Maneuver("3211", unit_s=0.08),
    "bank": Maneuver("rev", bank_deg=45.0),
    "throttle": Maneuver("3211", throttle_change=0.4),
    "aileron": Maneuver("rev", aileron=0.3),
    "rudder": Maneuver("3211", rudder=0.4),
    "turbulence": Maneuver("3211", turbulence_m_s=2.0),
    "gap": Maneuver("3211", outage_s=0.5),
    "airspeed": Maneuver("rev", unit_s=1.2),
    "saturation": Maneuver("3211", amplitude_deg=30.0, unit_s=0.2),
}
BAD_FLIGHTS = {
    "rate": (Scenario(rates=RATES | {"SERVO_OUTPUT_RAW": 8.5}, maneuvers=(Maneuver("3211"),)), AIRCRAFT),
    "alpha": (
        Scenario(maneuvers=(Maneuver("3211"),)),
        Aircraft(elevator=AIRCRAFT.elevator, limits=Limits(alpha_deg=4.0)),
    ),
    "amplitude": (Scenario(noise=Noise(percent=15.0), maneuvers=(Maneuver("3211"),)), AIRCRAFT),
    "q_delay_s": (
        Scenario(effects={"pitch_rate_skew": {"skew_s": 0.3}}, maneuvers=(Maneuver("3211"),)),
        AIRCRAFT,
    ),
}


@cache
def bad_flight():
    return flown(Scenario(rates=RATES, maneuvers=(Maneuver("3211"), *BAD_MANOEUVRES.values())))


NEEDLESS = ("bank", "aileron", "rudder", "airspeed")
"""Manoeuvres beyond a limit whose estimate has a bias within its interval."""


@pytest.mark.parametrize("code", NEEDLESS)
def test_a_limit_refuses_nothing_where_the_estimate_holds(code):
    maneuver, estimated, reasons = bad_flight()[1 + list(BAD_MANOEUVRES).index(code)]
    assert reasons == ()
    untold = NoEstimate("x", "x")
    assert code in {reason.code for reason in judge("pitch", maneuver, untold, AIRCRAFT)}
    imprecise = replace(estimated, prediction=dict.fromkeys(estimated.prediction, 0.5))
    assert code in {reason.code for reason in judge("pitch", maneuver, imprecise, AIRCRAFT)}


@pytest.mark.parametrize("name", ["beta", "p", "r"])
def test_the_bank_has_its_limit_where_the_record_lacks_a_part_of_the_turn(name):
    maneuver, estimated, _ = bad_flight()[1 + list(BAD_MANOEUVRES).index("bank")]
    found = judge("pitch", without(maneuver, name), estimated, AIRCRAFT)
    assert [reason.code for reason in found] == ["bank"]


@pytest.mark.parametrize("code", BAD_MANOEUVRES.keys() - NEEDLESS)
def test_a_bad_manoeuvre_is_rejected_with_its_right_reason_first(code):
    _, _, reasons = bad_flight()[1 + list(BAD_MANOEUVRES).index(code)]
    assert reasons[0].code == code


@pytest.mark.parametrize("code", BAD_FLIGHTS)
def test_what_spoils_a_whole_flight_is_named_on_its_manoeuvres(code):
    scenario, aircraft = BAD_FLIGHTS[code]
    for _, _, reasons in flown(scenario, aircraft):
        assert reasons[0].code == code


def cut_short(maneuver, after_s, closed_by="end of log"):
    """The manoeuvre with its record ended ``after_s`` after the last step, at trim."""
    end_s = maneuver.span.last_step_s + after_s
    channels = {name: channel.cut(0.0, end_s) for name, channel in maneuver.channels.items()}
    steps = (*maneuver.span.steps[:-1], (maneuver.span.last_step_s, 0.0))
    return replace(
        maneuver,
        span=replace(maneuver.span, end_s=end_s, closed_by=closed_by, steps=steps),
        channels=channels,
    )


def uncertain(estimated):
    """The estimate with a prediction that misses a third of the pitch rate."""
    return replace(estimated, prediction={"q": 0.33})


def test_a_record_that_ends_with_the_last_step_is_good_where_it_tells_enough():
    maneuver, whole, _ = bad_flight()[0]
    cut = cut_short(maneuver, 0.1)
    estimated = estimate(cut, AIRCRAFT)
    assert judge("pitch", cut, estimated, AIRCRAFT) == ()
    for name in ("M_alpha", "M_q", "M_delta_e", "Z_alpha"):
        wide = estimated.std[PARAMETERS.index(name)]
        assert abs(estimated.value(name) - whole.value(name)) < 3.0 * wide


def test_a_record_that_breaks_off_in_its_last_step_is_good_where_it_tells_enough():
    maneuver, _, _ = bad_flight()[0]
    end_s = maneuver.span.last_step_s - 0.05
    channels = {name: channel.cut(0.0, end_s) for name, channel in maneuver.channels.items()}
    steps = maneuver.span.steps[:-1]
    span = replace(maneuver.span, last_step_s=steps[-1][0], end_s=end_s, closed_by="end of log", steps=steps)
    cut = replace(maneuver, span=span, channels=channels)
    estimated = estimate(cut, AIRCRAFT)
    assert judge("pitch", cut, estimated, AIRCRAFT) == ()
    assert judge("pitch", cut, uncertain(estimated), AIRCRAFT)[0].code == "aborted"


def test_a_record_that_the_advisor_itself_has_cut_is_not_laid_to_the_pilots_hands():
    maneuver, estimated, _ = bad_flight()[0]
    cut = cut_short(maneuver, 0.3, "gap")
    assert judge("pitch", cut, uncertain(estimated), AIRCRAFT)[0].code != "advisor_down"
    (reason,) = judge("pitch", replace(cut, missed_s=5.2), uncertain(estimated), AIRCRAFT)
    assert reason.code == "advisor_down"
    assert reason.text == "5.2 s are missing: the advisor was down; fly it again"


def test_an_estimate_whose_damping_may_be_zero_needs_a_free_response():
    maneuver, estimated, _ = bad_flight()[0]
    covariance = estimated.covariance.copy()
    covariance[PARAMETERS.index("M_q"), PARAMETERS.index("M_q")] = estimated.value("M_q") ** 2
    (reason,) = judge("pitch", cut_short(maneuver, 0.1), replace(estimated, covariance=covariance), AIRCRAFT)
    assert reason.code == "free_response"


@pytest.mark.parametrize(
    ("closed_by", "mend"),
    [
        ("end of log", "let the recording run on"), ("gap", "check the link"),
        ("mode change", "stay in the mode"), ("next input", "stick still"),
    ],
)  # fmt: skip
def test_a_free_response_cut_short_is_laid_to_what_ended_it(closed_by, mend):
    maneuver, estimated, _ = bad_flight()[0]
    reason, *_ = judge("pitch", cut_short(maneuver, 0.3, closed_by), uncertain(estimated), AIRCRAFT)
    assert reason.code == "free_response"
    assert mend in reason.text


@pytest.mark.parametrize(("kind", "cure"), [("3-2-1-1", "1.9 times the stick"), ("pulse", "fly a 3-2-1-1")])
def test_a_manoeuvre_that_predicts_its_own_response_badly_is_told_the_cure_for_its_input(kind, cure):
    maneuver, estimated, _ = bad_flight()[0]
    flown_as = replace(maneuver, span=replace(maneuver.span, kind=kind))
    (reason,) = judge("pitch", flown_as, replace(estimated, prediction={"q": 0.425}), AIRCRAFT)
    assert reason.code == "information"
    assert (reason.value, reason.limit) == (pytest.approx(42.5), 25.0)
    assert cure in reason.text


def test_the_good_manoeuvre_among_bad_ones_is_accepted():
    assert bad_flight()[0][2] == ()


@pytest.mark.parametrize(
    ("aircraft", "percent"), [("uav", 1.0), ("uav", 5.0), ("linear", 2.5), ("light", 5.0)]
)
def test_good_manoeuvres_are_not_rejected(aircraft, percent):
    both = (Maneuver("3211"), Maneuver("rev"))
    judged = flown(Scenario(aircraft=aircraft, seed=3, noise=Noise(percent=percent), maneuvers=both))
    assert [reasons for _, _, reasons in judged] == [(), ()]


def test_light_turbulence_is_lived_with():
    judged = flown(Scenario(air=Air(turbulence_m_s=0.2), maneuvers=(Maneuver("3211"), Maneuver("rev"))))
    assert [reasons for _, _, reasons in judged] == [(), ()]


def test_every_reason_holds_a_number_beside_its_limit_and_says_what_to_do():
    for _, _, reasons in bad_flight():
        for reason in reasons:
            assert np.isfinite([reason.value, reason.limit]).all()
            assert ";" in reason.text
            assert any(character.isdigit() for character in reason.text)


def test_a_gentle_manoeuvre_is_told_how_much_more_stick_it_needs():
    _, _, (reason, *_) = bad_flight()[1]
    assert reason.text.startswith("too gentle, ")
    assert "times the stick" in reason.text
    assert reason.value < reason.limit


def test_following_the_advice_on_amplitude_makes_the_manoeuvre_good():
    _, _, (reason, *_) = bad_flight()[1]
    factor = float(reason.text.split("about ")[1].split(" times")[0])
    gentle = BAD_MANOEUVRES["amplitude"].amplitude_deg
    again = flown(
        Scenario(rates=RATES, maneuvers=(Maneuver("3211"), Maneuver("3211", amplitude_deg=factor * gentle)))
    )
    assert again[1][2] == ()


def test_without_an_estimate_the_data_are_judged_all_the_same():
    maneuver, _, _ = bad_flight()[1 + list(BAD_MANOEUVRES).index("bank")]
    reasons = judge("pitch", maneuver, NoEstimate("not_converged", "the fit did not converge"), AIRCRAFT)
    assert reasons[0].code == "bank"


def test_a_slow_angle_of_attack_is_lived_with():
    slow = Scenario(rates=RATES | {"AOA_SSA": 8.0}, maneuvers=(Maneuver("3211"),))
    assert [reasons for _, _, reasons in flown(slow)] == [()]


def test_an_aircraft_without_an_angle_of_attack_is_lived_with():
    channels = RATES | {"AOA_SSA": 0.0}
    blind = Scenario(rates=channels, maneuvers=(Maneuver("3211"), Maneuver("rev")))
    judged = flown(blind)
    assert [estimated.outputs for _, estimated, _ in judged] == [("q", "a_z")] * 2
    assert [reasons for _, _, reasons in judged] == [(), ()]


def test_a_manoeuvre_without_pitch_rate_says_so_and_nothing_else():
    maneuver, estimated, _ = bad_flight()[0]
    (reason,) = judge("pitch", without(maneuver, "q"), estimated, AIRCRAFT)
    assert reason.code == "missing"


def test_a_pitch_rate_that_stands_still_is_a_broken_gyro_and_no_gentle_input():
    maneuver, estimated, _ = bad_flight()[0]
    rate = maneuver.channels["q"]
    (reason,) = judge("pitch", changed(maneuver, "q", y=np.zeros_like(rate.y)), estimated, AIRCRAFT)
    assert reason.code == "frozen"
    assert "check the gyro" in reason.text


def test_no_larger_input_is_asked_for_while_the_pitch_rate_is_too_slow():
    maneuver, _, _ = bad_flight()[0]
    rate = maneuver.channels["q"]
    slow = {**maneuver.channels, "q": replace(rate, t=rate.t[::40], y=1e-4 * rate.y[::40])}
    reasons = judge(
        "pitch",
        replace(maneuver, channels=slow),
        NoEstimate("not_converged", "the fit did not converge"),
        AIRCRAFT,
    )
    assert "rate" in {reason.code for reason in reasons}
    assert not any("stick" in reason.text for reason in reasons)


def test_the_natural_period_is_that_of_the_aircraft_flown():
    maneuver, estimated, _ = bad_flight()[0]
    # Bundled UAV: natural frequency about 8.5 rad/s at its usual speed.
    assert natural_period(maneuver, estimated) == pytest.approx(0.85, abs=0.1)
    assert natural_period(maneuver, NoEstimate("x", "x")) == pytest.approx(0.75, abs=0.05)


def poorly_fitted(estimated, share):
    """The estimate with a pitch rate that misses this share of the measured one."""
    fit = estimated.fits[0]["q"]
    poor = replace(fit, fitted=(1.0 - share) * fit.measured)
    return replace(estimated, fits=({**estimated.fits[0], "q": poor},))


def test_a_period_is_not_read_off_a_fit_that_explains_little_or_an_uncertain_stiffness():
    maneuver, estimated, _ = bad_flight()[0]
    by_input = natural_period(maneuver, NoEstimate("x", "x"))
    assert natural_period(maneuver, poorly_fitted(estimated, 0.6)) == by_input
    covariance = estimated.covariance.copy()
    place = PARAMETERS.index("M_alpha")
    covariance[place, place] = (0.6 * estimated.value("M_alpha")) ** 2
    assert natural_period(maneuver, replace(estimated, covariance=covariance)) == by_input


def without_late_airspeed(maneuver, after_s, *missing):
    """The manoeuvre whose air speed ends some time after the first step, without further channels."""
    speed = maneuver.channels["airspeed"].cut(0.0, maneuver.span.start_s + after_s)
    return changed(without(maneuver, *missing), "airspeed", t=speed.t, y=speed.y)


def test_an_air_speed_that_ends_is_missed_where_no_accelerometer_carries_it():
    maneuver, estimated, _ = bad_flight()[0]
    (reason,) = judge("pitch", without_late_airspeed(maneuver, 0.5, "a_x"), estimated, AIRCRAFT)
    assert reason.code == "gap"
    assert "of airspeed are missing" in reason.text


def test_an_air_speed_that_ends_is_carried_by_the_accelerometers():
    maneuver, estimated, _ = bad_flight()[0]
    assert judge("pitch", without_late_airspeed(maneuver, 1.5), estimated, AIRCRAFT) == ()


def test_a_pitch_angle_that_ends_is_missed():
    maneuver, estimated, _ = bad_flight()[0]
    theta = maneuver.channels["theta"].cut(0.0, maneuver.span.start_s + 0.5)
    cut = replace(maneuver, channels={**maneuver.channels, "theta": theta})
    assert judge("pitch", cut, estimated, AIRCRAFT)[0].code == "gap"


def test_no_amplitude_is_judged_beyond_a_limit_of_the_model():
    maneuver, estimated, _ = bad_flight()[1]
    assert judge("pitch", maneuver, estimated, AIRCRAFT)[0].code == "amplitude"
    banked = changed(maneuver, "bank", y=np.full(len(maneuver.channels["bank"].t), 3.0))
    codes = [reason.code for reason in judge("pitch", banked, estimated, AIRCRAFT)]
    assert codes[0] == "bank"
    assert "amplitude" not in codes


@pytest.mark.study
@pytest.mark.timeout(1800)
def test_good_manoeuvres_are_rejected_in_at_most_two_percent_of_cases():
    judged = [
        reasons
        for aircraft in ("uav", "linear", "light")
        for percent in (1.0, 2.5, 5.0)
        for seed in range(5)
        for _, _, reasons in flown(Scenario(aircraft=aircraft, seed=seed, noise=Noise(percent=percent)))
    ]
    assert len(judged) == 9 * 5 * 7
    assert np.mean([bool(reasons) for reasons in judged]) <= 0.02


def test_no_larger_input_is_asked_for_while_a_channel_stands_still():
    maneuver, estimated, _ = bad_flight()[1]
    dead = Distrust(
        "frozen", "a_z", "normal acceleration stands still at 0 m/s^2", "check the accelerometer", 0.0
    )
    told = judge("pitch", maneuver, estimated, AIRCRAFT)
    assert any("times the stick" in reason.text for reason in told)
    mended = judge("pitch", replace(maneuver, distrusts=(dead,)), estimated, AIRCRAFT)
    assert [reason.code for reason in mended] == [reason.code for reason in told]
    assert not any("times the stick" in reason.text for reason in mended)
    assert any("check the accelerometer" in reason.text for reason in mended)


def test_the_limits_of_the_flight_come_before_the_hands_of_the_pilot():
    maneuver, estimated, _ = bad_flight()[1 + list(BAD_MANOEUVRES).index("airspeed")]
    codes = [
        reason.code for reason in judge("pitch", cut_short(maneuver, 0.1), uncertain(estimated), AIRCRAFT)
    ]
    assert codes.index("airspeed") < codes.index("free_response")


def test_two_steps_of_one_onset_give_no_period_of_zero():
    maneuver, _, _ = bad_flight()[0]
    first, *others = maneuver.span.steps
    twice = replace(maneuver, span=replace(maneuver.span, steps=(first, first, *others)))
    untold = NoEstimate("x", "x")
    assert natural_period(twice, untold) == natural_period(maneuver, untold)
    assert natural_period(replace(twice, span=replace(twice.span, steps=(first, first))), untold) == 1.0
    assert "steps" in {reason.code for reason in judge("pitch", twice, untold, AIRCRAFT)}


@pytest.mark.parametrize(("elevator_deg", "codes"), [(1.9, ["follows"]), (2.1, [])])
def test_an_elevator_that_moves_less_than_a_fifth_of_the_aileron_follows_the_motion(elevator_deg, codes):
    t = np.arange(0.0, 10.0, 0.02)
    moved = {"elevator": elevator_deg, "aileron": 10.0}
    channels = {
        name: Channel(name, t, np.radians(deg / 2.0) * np.sin(t), "SERVO_OUTPUT_RAW", "commanded")
        for name, deg in moved.items()
    }
    span = Span(0.0, 1.0, 4.0, 10.0, "other", (), "quiet")
    found = pitch_limits(Record(1, 0, span, channels), Aircraft())
    assert [reason.code for reason in found if reason.code != "aileron"] == codes
