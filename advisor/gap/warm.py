"""Compile the gap's kernels once, so that no user waits for it: ``python -m advisor.gap.warm``."""

import numpy as np

from advisor.aircraft import PARAMETERS, Aircraft
from advisor.gap.plan import foresee_plan
from advisor.oem.innovations import AirModel, gains_of

_ANY_AIRCRAFT = dict(zip(PARAMETERS, (0.0, -4.0, 0.0, -0.3, 0.0, -30.0, -4.0, -50.0), strict=True))


def warm_up() -> None:
    """Foresee a tiny plan and filter a few samples: between them they run through every compiled function."""
    foresee_plan(Aircraft(model=_ANY_AIRCRAFT), ("pulse", "pulse"), 50.0, 1.0)
    one = np.ones(4)
    gains = gains_of(np.linspace(0.0, 0.06, 4), np.arange(4), np.ones(5), AirModel(one, one, 1.0, 0.1, 1.0))
    gains.innovations(np.ones((4, 2)))


if __name__ == "__main__":
    warm_up()
