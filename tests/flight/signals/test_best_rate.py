"""One rate of a channel, whoever asks and however the packets came."""

import numpy as np
import pytest

from advisor.flight.signals.track import BestRate


def rate(*batches: np.ndarray) -> float:
    best = BestRate()
    for t in batches:
        best.add(t)
    return best.rate_hz


def test_a_rate_cut_at_the_end_of_a_log_does_not_lower_it() -> None:
    assert rate(np.arange(0.0, 60.0, 0.02), np.arange(60.0, 120.0, 0.5)) == pytest.approx(50.0, rel=1e-3)


def test_packets_that_come_twice_count_once() -> None:
    t = np.arange(3.0, 40.0, 0.2)
    assert rate(np.repeat(t, 2)) == rate(t) == pytest.approx(5.0)


def test_batches_make_no_difference() -> None:
    t = np.sort(np.random.default_rng(1).uniform(0.0, 35.0, 900))
    assert rate(*np.array_split(t, 37)) == rate(t)


def test_a_short_log_has_the_rate_of_what_there_is() -> None:
    assert rate(np.arange(7.0, 9.0, 0.1)) == pytest.approx(10.0)
    assert np.isnan(rate(np.array([1.0])))
    assert np.isnan(rate(np.array([])))
