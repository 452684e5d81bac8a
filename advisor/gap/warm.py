"""Compile the gap's kernels once, so that no user waits for it: ``python -m advisor.gap.warm``."""

import numpy as np

from advisor.aircraft import PARAMETERS, Aircraft
from advisor.gap.foresight.plan import foresee_plan
from advisor.oem.innovations import AirModel, cost_of, gains_of

_ANY_AIRCRAFT = dict(zip(PARAMETERS, (0.0, -4.0, 0.0, -0.3, 0.0, -30.0, -4.0, -50.0), strict=True))


def warm_up() -> None:
    """Foresee a tiny plan and filter a few samples: between them they run through every compiled function."""
    foresee_plan(Aircraft(model=_ANY_AIRCRAFT), ("pulse", "pulse"), 50.0, 1.0)
    one, channels, t = np.ones(4), np.arange(4), np.linspace(0.0, 0.06, 4)
    air = AirModel(one, one, 1.0, 0.1, 1.0)
    gains_of(t, channels, np.ones(5), air).innovations(np.ones((4, 2)))
    cost_of(t, channels, one, np.ones(5), air)


if __name__ == "__main__":
    warm_up()
