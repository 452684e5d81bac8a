"""Compile the kernels of the diagnosis once, before a user waits: ``python -m advisor.gap.precompile``."""

import numpy as np

from advisor.aircraft.aircraft import Aircraft
from advisor.aircraft.reference import PARAMETERS
from advisor.gap.foresight.plan import foresee_plan
from advisor.gap.simulator.layout import ENTRIES, LAYOUT
from advisor.gap.simulator.reading import differences, filtered
from advisor.gap.simulator.right_sides import MOTION, right_sides

_ANY_AIRCRAFT = dict(zip(PARAMETERS, (0.0, -4.0, 0.0, -0.3, 0.0, -30.0, -4.0, -50.0), strict=True))
"""Numerical: parameters of an aircraft that is simulated to compile the kernels."""


def warm_up() -> None:
    """Simulate a tiny plan and filter some samples, so that every kernel is compiled."""
    foresee_plan(Aircraft(model=_ANY_AIRCRAFT), ("pulse", "pulse"), 50.0, 1.0)
    right_sides(LAYOUT, np.zeros((2, len(ENTRIES))), np.ones(len(MOTION)), 1.0, np.ones(2), np.ones(2))
    none = np.zeros(2, dtype=np.int64)
    differences(np.ones((4, 2)), np.ones(4), none, np.ones(2))
    filtered(np.ones((1, 4, 4, 2)), 0.005, none, np.asfortranarray(np.ones((2, 3))))


if __name__ == "__main__":
    warm_up()
