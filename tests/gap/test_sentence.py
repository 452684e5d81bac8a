"""Every cause is a statement that can be made, whatever is certain of its numbers."""

import pytest

from advisor.gap.candidates.catalogue import BLOCK_OF
from advisor.gap.result import Cause, Value
from advisor.gap.verdict.text import what


def cause(effect, **parameters):
    return Cause(effect, BLOCK_OF[effect], 0.9, parameters, (), "", 0.0, True)


@pytest.mark.parametrize("std", [0.05, 0.25])
def test_a_power_of_the_air_speed_is_told_however_certain_it_is(std):
    told = what(cause("airspeed_variation", exponent=Value(-0.5, std)))
    assert told == "The real forces do not grow with air speed squared, but with its power 1.5"


@pytest.mark.parametrize(
    ("std", "ending"), [(0.05, "300 ms behind the throttle"), (0.2, "the real aircraft")]
)
def test_a_lag_that_may_as_well_be_none_is_not_told(std, ending):
    thrust = cause("thrust_moment", M_throttle=Value(2.0, 0.1), lag_s=Value(0.3, std))
    assert what(thrust).endswith(ending)


def test_a_moment_of_the_rate_of_angle_of_attack_is_not_called_the_simulators_for_its_sign():
    up, down = (what(cause("alpha_dot", M_alpha_dot=Value(size, 0.1))) for size in (1.5, -1.5))
    assert up == down
