"""Compile the gap's kernels once, so that no user waits for it: ``python -m advisor.gap.warm``."""

from advisor.aircraft import PARAMETERS, Aircraft
from advisor.gap.plan import foresee_plan

_ANY_AIRCRAFT = dict(zip(PARAMETERS, (0.0, -4.0, 0.0, -0.3, 0.0, -30.0, -4.0, -50.0), strict=True))


def warm_up() -> None:
    """Foresee a tiny plan: it runs through every compiled function of the gap's simulation."""
    foresee_plan(Aircraft(model=_ANY_AIRCRAFT), ("pulse", "pulse"), 50.0, 1.0)


if __name__ == "__main__":
    warm_up()
