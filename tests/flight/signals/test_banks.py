"""Outputs of two banks of sixteen make one sample, never of two times."""

import numpy as np
import pytest

from advisor.flight.signals.channels import Banks, merged
from tests.flight.columns import Wire, servo


def wire(*sent: tuple[float, int, int]) -> Wire:
    """Messages of (stamp, port, pulse of every output of the bank)."""
    found = Wire()
    for stamp, port, pulse in sent:
        servo(found, 100.0 + stamp, stamp, dict.fromkeys(range(1, 17), pulse), port)
    return found


BOTH = wire((1.0, 0, 1100), (1.001, 1, 1200), (1.02, 0, 1110), (1.021, 1, 1210))


def test_a_sample_comes_with_the_last_bank_and_the_newest_of_the_other() -> None:
    (columns,) = BOTH.columns()
    pulses = Banks().together(columns).of((2, 17))
    np.testing.assert_array_equal(pulses, [[np.nan] * 2, [1100, 1200], [np.nan] * 2, [1110, 1210]])


def test_messages_one_by_one_give_the_same() -> None:
    banks = Banks()
    pulses = [banks.together(BOTH.columns([i])[0]).of((2, 17)) for i in range(4)]
    np.testing.assert_array_equal(
        np.concatenate(pulses), [[np.nan] * 2, [1100, 1200], [np.nan] * 2, [1110, 1210]]
    )


@pytest.mark.parametrize(("lost", "first"), [(2, 1100), (3, 1100)])
def test_a_lost_message_costs_one_sample_and_mixes_no_two_times(lost: int, first: int) -> None:
    sent = [(0.02 * k + 0.001 * port, port, 1100 + 10 * k + 100 * port) for k in range(4) for port in (0, 1)]
    (columns,) = wire(*sent[:lost], *sent[lost + 1 :]).columns()
    pulses = Banks().together(columns).of((2, 17))
    known = pulses[np.isfinite(pulses).all(axis=1)]
    np.testing.assert_array_equal(known[:, 1] - known[:, 0], 100)
    assert len(known) == 3
    assert known[0, 0] == first


def test_one_bank_alone_needs_no_other() -> None:
    (columns,) = BOTH.columns()
    pulses = Banks().together(columns).of((17, 18))
    assert np.flatnonzero(np.isfinite(pulses).all(axis=1)).tolist() == [1, 3]


def test_banks_that_a_log_gives_apart_are_brought_into_one_order() -> None:
    first, second = BOTH.columns([0, 2])[0], BOTH.columns([1, 3])[0]
    (together,) = merged([second, first])
    assert together.order.tolist() == [0, 1, 2, 3]
    assert together.fields["port"].tolist() == [0, 1, 0, 1]
