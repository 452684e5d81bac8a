"""A dead band about the trim is another cause than one about a fixed angle only where the trims differ."""

from types import SimpleNamespace

import pytest

from advisor.gap.effects.actuator_deadband import EFFECT


@pytest.mark.parametrize(("apart_rad", "variants"), [(0.0045, 1), (0.0055, 2)])
def test_trims_that_lie_a_third_of_a_degree_apart_tell_both_dead_bands(apart_rad, variants):
    flown = [SimpleNamespace(u_trim=trim) for trim in (-0.02, -0.02 + apart_rad)]
    assert len(EFFECT.variants(SimpleNamespace(flights=flown))) == variants  # type: ignore[arg-type]
