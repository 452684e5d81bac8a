"""What a campaign learns of the servo, and what becomes of verdicts that knew less."""

from dataclasses import replace

import numpy as np
import pytest

from advisor.aircraft.aircraft import Aircraft, Elevator
from advisor.campaign.servo_lag import learnt, of_another_power_on, reserved, told
from advisor.decision.verdict import ManeuverVerdict
from advisor.oem.estimate import InstrumentEstimate
from tests.decision.campaigns import estimate

GOOD = ManeuverVerdict(True, "ACCEPTED: good manoeuvre", (), {})


def with_lag(lag_s, std_s, **changed):
    told = (InstrumentEstimate("servo_lag_s", lag_s, std_s),)
    return replace(estimate(), instruments=told, servo_lag_s=lag_s, **changed)


def test_a_lag_known_to_a_tenth_is_learnt():
    assert learnt(Aircraft(), with_lag(0.14, 0.01)).elevator.lag_found_s == 0.14


@pytest.mark.parametrize("model", [None, estimate(), with_lag(0.14, 0.02)])
def test_a_lag_that_is_unknown_or_unsure_is_not_learnt(model):
    nothing = Aircraft()
    assert learnt(nothing, model) is nothing


def against(stated_s, told_s, std_s, *, contradicts):
    value_s = told_s if contradicts else stated_s
    lag = InstrumentEstimate("servo_lag_s", value_s, std_s, stated_s, told_s, std_s, contradicts)
    return replace(estimate(), instruments=(lag,), servo_lag_s=value_s)


GIVEN = Aircraft(elevator=Elevator(lag_s=0.14))


def test_a_lag_that_the_crew_gives_stands_while_the_data_do_not_exclude_it():
    now = learnt(GIVEN, against(0.14, 0.15, 0.01, contradicts=False))
    assert now.elevator.lag_found_s == pytest.approx(0.14)
    assert now.elevator.lag_found_std_s == pytest.approx(0.01)
    assert learnt(GIVEN, estimate()) is GIVEN


def test_a_lag_that_the_data_tell_takes_the_place_of_an_excluded_one():
    now = learnt(GIVEN, against(0.14, 0.22, 0.004, contradicts=True))
    assert now.elevator.lag_found_s == 0.22
    assert "0.220 s, against 0.140 s in elevator.lag_s" in told(now)


def test_the_crew_s_lag_returns_when_later_manoeuvres_agree_with_it():
    misled = learnt(GIVEN, against(0.14, 0.22, 0.004, contradicts=True))
    back = learnt(misled, against(0.14, 0.15, 0.01, contradicts=False))
    assert back.elevator.lag_found_s == pytest.approx(0.14)
    assert "as elevator.lag_s says" in told(back)


def test_a_surer_value_of_the_same_lag_is_news():
    used = learnt(Aircraft(), with_lag(0.14, 0.01))
    assert learnt(used, with_lag(0.14, 0.004)).elevator.lag_found_std_s == 0.004


def test_the_delay_of_the_command_holds_within_its_power_on_alone():
    told_of = replace(Aircraft(), elevator=Elevator(lag_s=0.1, delay_found_s=0.01, delay_found_std_s=0.002))
    assert of_another_power_on(told_of).elevator == Elevator(lag_s=0.1)


def test_a_lag_within_its_own_error_of_the_one_used_changes_nothing_but_at_the_end():
    used = learnt(Aircraft(), with_lag(0.14, 0.01))
    assert learnt(used, with_lag(0.145, 0.01)) is used
    assert learnt(used, with_lag(0.145, 0.01), exactly=True).elevator.lag_found_s == 0.145


def test_no_verdict_praises_a_control_derivative_that_the_joint_estimate_contradicts():
    alone = estimate()
    twice = np.array(alone.theta)
    twice[7] *= 2.3
    judged = reserved(GOOD, alone, with_lag(0.14, 0.01, theta=twice))
    assert judged.accepted
    assert "good manoeuvre" not in judged.sentence
    assert "M_delta_e" in judged.sentence


def test_a_verdict_that_the_joint_estimate_confirms_stays():
    assert reserved(GOOD, estimate(), with_lag(0.14, 0.01)) is GOOD
