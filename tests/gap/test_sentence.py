"""The one sentence for the crew says what was found, and no more than is known."""

from dataclasses import replace

import pytest

from advisor.aircraft.aircraft import Accelerometer, Aircraft, Alpha
from advisor.gap.effects import EFFECTS
from advisor.gap.result import Cause, Shrink, Value, Where
from advisor.gap.verdict.statements import in_simulator, what
from advisor.gap.verdict.text import sentence_of
from tests.gap.test_report_screen import diagnosis


@pytest.mark.parametrize(
    ("moment", "places"),
    [
        (1.0, "between the command and the surface or in the pitching moment"),
        (0.995, "between the command and the surface or in the pitching moment"),
        (0.9, "between the command and the surface"),
    ],
)
def test_two_places_that_are_as_likely_are_both_said(moment, places):
    where = Where("input", 0.9, (("input", 1.0), ("moment_equation", moment)))
    sentence = sentence_of("unknown", diagnosis().gap, where, (), None)
    assert sentence == f"Something acts {places} that no known effect explains."


@pytest.mark.parametrize(
    ("by_air", "said"),
    [
        (0.9, "light gusts, as in every flight, make most of the gap"),
        (0.1, "the difference is 1.9 of the noise: this flight cannot tell it from noise"),
    ],
)
def test_where_nothing_is_named_gusts_are_not_credited_to_fitted_parameters(by_air, said):
    gap = replace(diagnosis().gap, before=1.9, after=0.4, by_air=by_air)
    sentence = sentence_of("none", gap, diagnosis().where, (), None)
    assert sentence == f"The simulator flies like the aircraft: {said}."


def test_the_shrink_of_the_sentence_has_the_decimals_of_the_line_below():
    shrink = Shrink((2, 5), 119.0, 0.116, 99.83, (99.7, 99.9), by_numbers_percent=98.61)
    cause = found("actuator_lag", lag_s=0.129)
    sentence = sentence_of("effect", diagnosis().gap, diagnosis().where, (cause,), shrink)
    assert "removes 99.8 % of the gap, and numbers alone leave 8.2 times as much" in sentence


def found(effect, **sizes):
    parameters = {name: Value(size, 0.0) for name, size in sizes.items()}
    return Cause(effect, EFFECTS[effect].block, 1.0, parameters, (), "", 0.0, True)


@pytest.mark.parametrize(
    ("cause", "positive", "negative"),
    [
        (("alpha_vane_offset", "arm_m", 0.3), "0.30 m ahead of", "0.30 m behind"),
        (("alpha_lag", "lag_s", 0.03), "lags by 30 ms", "is 30 ms ahead"),
        (("alpha_scale", "scale", 0.1), "10 % too much", "10 % too little"),
        (("gust", "amplitude_m_s", 2.0), "An upward gust of 2 m/s", "A downward gust of 2 m/s"),
        (("attitude_skew", "skew_s", 0.04), "stamped 40 ms too late", "stamped 40 ms too early"),
        (("transport_delay", "delay_s", 0.06), "60 ms too early", "60 ms too late"),
    ],
)
def test_which_way_an_effect_goes_is_said_in_words_and_never_by_a_sign(cause, positive, negative):
    effect, name, size = cause
    assert positive in what(found(effect, **{name: size}))
    assert negative in what(found(effect, **{name: -size}))


@pytest.mark.parametrize(
    ("aircraft", "expected"),
    [
        (Aircraft(), "sits 0.10 m ahead of the centre of gravity"),
        (Aircraft(alpha=Alpha(vane_arm_m=0.0)), "sits 0.10 m ahead of the centre of gravity"),
        (Aircraft(alpha=Alpha(vane_arm_m=0.4)), "sits 0.10 m further ahead than in the simulator"),
        (
            Aircraft(effects={"alpha_vane_offset": {"arm_m": 0.4}}),
            "sits 0.10 m further ahead than in the simulator",
        ),
        (Aircraft(accelerometer=Accelerometer(arm_m=0.4)), "sits 0.10 m ahead of the centre of gravity"),
    ],
)
def test_what_the_simulator_has_some_of_already_is_said_as_what_it_lacks(aircraft, expected):
    assert what(found("alpha_vane_offset", arm_m=0.1), in_simulator(aircraft)) == f"The vane {expected}"


@pytest.mark.parametrize("effect", EFFECTS)
def test_every_effect_of_the_catalogue_has_a_statement_for_either_sign(effect):
    for sign in (1.0, -1.0):
        sizes = dict.fromkeys(EFFECTS[effect].keys, sign * 0.02)
        assert "{" not in what(found(effect, **sizes))


def test_a_lag_that_the_data_cannot_tell_from_a_delay_is_named_with_it():
    lag = replace(found("actuator_lag", lag_s=0.05), present=False)
    skew = replace(found("pitch_rate_skew", skew_s=0.04), present=False)
    delay = replace(
        found("transport_delay", delay_s=0.06), cannot_be_told_from=("pitch_rate_skew", "actuator_lag")
    )
    where = Where("input", 0.9, (("input", 1.0),))

    def said(*causes):
        return sentence_of("effect", diagnosis().gap, where, causes, None)

    two = "a delay between command and surface, or a servo that lags by 50 ms; adding"
    assert two in said(delay, lag, skew)
    assert "it lacks 50 ms of servo lag, or a delay of 60 ms; adding" in said(
        replace(lag, present=True, cannot_be_told_from=("transport_delay",)), replace(delay, present=False)
    )
    assert ", or " not in said(replace(delay, cannot_be_told_from=()), lag, skew)


def test_where_the_cause_was_taken_back_the_sentence_says_that_the_numbers_remove_the_gap():
    lag = replace(found("actuator_lag", lag_s=0.083), present=False)
    sentence = sentence_of("effect", diagnosis().gap, diagnosis().where, [lag], diagnosis().shrink)
    assert "it lacks 83 ms of servo lag; the eight fitted derivatives alone remove" in sentence
    assert "adding it" not in sentence
