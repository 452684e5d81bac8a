"""A relative error of the response that all manoeuvres have in common is part of an estimate's covariance."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from advisor.aircraft.aircraft import Aircraft, Elevator
from advisor.flight.signals.record import Channel
from advisor.oem.estimator import fit_jointly
from advisor.oem.model_error import _filtered
from advisor.oem.solution import Solution
from tests.oem.builders import UAV, flown
from tests.oem.test_weighing import flight

KNOWN = Aircraft(elevator=Elevator(lag_s=0.0))
SHARE = 0.1
"""Part of the response that comes a second time, 0.3 s late."""


def fitted(maneuvers):
    fit = fit_jointly(maneuvers, KNOWN)
    solution = fit.plain
    assert isinstance(solution, Solution)
    return solution


def alike(count, noise=0.004):
    return [
        flown(UAV, noise=noise, length_s=8.0, rate_hz=25.0, unit_s=0.3, seed=seed) for seed in range(count)
    ]


def with_an_echo(maneuver):
    """Return the manoeuvre with a part of the pitch rate again, later: no short period does that."""
    q = maneuver.channels["q"]
    late = np.interp(q.t - 0.3, q.t, q.y - q.y[0], left=0.0)
    return replace(
        maneuver, channels={**maneuver.channels, "q": Channel("q", q.t, np.asarray(q.y + SHARE * late))}
    )


@pytest.fixture(scope="module")
def echoed():
    return fitted([with_an_echo(maneuver) for maneuver in alike(4)])


def std(covariance):
    return np.sqrt(np.diag(covariance)[:8])


def test_white_noise_leaves_an_estimate_as_certain_as_it_was():
    solution = fitted(alike(4))
    assert np.all(std(solution.widened) < 1.2 * std(solution.covariance))


def test_an_echo_in_all_manoeuvres_makes_the_moment_uncertain(echoed):
    """The noise within the manoeuvres explains a part of the error only."""
    moment = [5, 6, 7]
    assert np.all(std(echoed.systematic)[moment] > std(echoed.covariance)[moment])


def test_the_truth_lies_within_three_errors_only_with_the_common_error(echoed):
    m_delta = 7
    off = abs(echoed.theta[m_delta] - UAV[m_delta])
    assert 3.0 * std(echoed.covariance)[m_delta] < off < 3.0 * std(echoed.widened)[m_delta]


def test_more_manoeuvres_do_not_average_a_common_error_out(echoed):
    twice = fitted([with_an_echo(maneuver) for maneuver in alike(8)])
    ratio = std(twice.systematic)[5:] / std(echoed.systematic)[5:]
    assert np.all(ratio > 0.9), ratio


@pytest.mark.parametrize(("count", "told"), [(1, False), (2, False), (3, True)])
def test_three_manoeuvres_are_witnesses_of_a_common_error(count, told):
    """Two may move two controls, and then have no response in common."""
    assert np.any(fitted([with_an_echo(maneuver) for maneuver in alike(count)]).systematic) == told


@pytest.mark.parametrize("memory", [0.0, 0.95])
def test_noise_of_no_memory_and_of_a_long_one_shows_no_error_in_common(memory):
    shown = []
    for seed in range(4):
        maneuvers = [flight(10 * seed + k, memory=memory, number=k) for k in range(3)]
        shown.append(np.any(fitted(maneuvers).systematic))
    assert not any(shown)


def test_each_weight_is_one_width_of_two_tenths_of_a_second_later_than_the_one_before():
    """The mean of a ramp over a triangle is the ramp at the triangle's middle."""
    t = np.arange(0.0, 4.0, 0.01)
    ramp = SimpleNamespace(rows=({"q": slice(0, len(t))},), t=t)
    filtered = _filtered(ramp, 5.0 + t)
    late = 0.2 * np.arange(1, 9)
    np.testing.assert_allclose(filtered[-1], t[-1] - late, atol=1e-9)
