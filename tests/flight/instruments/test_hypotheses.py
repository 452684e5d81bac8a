"""Hypotheses on a scale, weighed against a measured one."""

import pytest

from advisor.flight.instruments.measured import ANY, AS_STATED, Measured, pooled, weigh

FACTORS = {"reversed": -1.0, "in rad": 0.01745}


@pytest.mark.parametrize(
    ("value", "best"),
    [(1.1, AS_STATED), (0.8, AS_STATED), (-0.95, "reversed"), (0.018, "in rad"), (0.35, ANY)],
)
def test_the_likeliest_hypothesis_is_the_one_whose_factor_is_near(value: float, best: str) -> None:
    weighed = weigh(Measured(value, 0.01 * abs(value)), FACTORS, 0.1)
    assert weighed.best == best
    assert weighed.contradicts == (best != AS_STATED)


def test_a_scale_within_its_error_of_zero_contradicts_nothing() -> None:
    assert not weigh(Measured(-0.3, 0.15), FACTORS, 0.1).contradicts


def test_a_poorly_measured_scale_contradicts_nothing() -> None:
    assert not weigh(Measured(0.6, 0.2), FACTORS, 0.1).contradicts


def test_records_that_scatter_widen_the_pooled_error() -> None:
    one, other = {"k": Measured(0.9, 0.01)}, {"k": Measured(1.1, 0.01)}
    together = pooled((one, other))["k"]
    assert together.value == pytest.approx(1.0)
    assert together.std > 0.05


def test_a_stated_scale_is_excluded_below_one_per_cent() -> None:
    """The density of the stated scale is that of a normal deviate; any other scale has 1/(8·ln 10·scale).

    At 4.2 of its standard deviations the stated scale has .000589 of .0388, and at 4.4 .000249 of .0380.
    """
    likely, unlikely = (weigh(Measured(1.0 + 0.1 * z, 1e-6), {}, 0.1) for z in (4.2, 4.4))
    assert likely.stated_probability == pytest.approx(0.0152, abs=2e-4)
    assert unlikely.stated_probability == pytest.approx(0.0066, abs=2e-4)
    assert not likely.contradicts
    assert unlikely.contradicts


def test_a_scale_counts_from_three_of_its_errors_on() -> None:
    assert not weigh(Measured(-1.0, 0.35), {"reversed": -1.0}, 0.1).resolved
    assert weigh(Measured(-1.0, 0.32), {"reversed": -1.0}, 0.1).resolved
