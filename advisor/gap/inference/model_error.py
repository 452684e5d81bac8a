"""Error of every simulator, below which no number of samples distinguishes two models."""

from collections.abc import Sequence

import numpy as np

_MODEL = 0.005
"""Prior: error of every simulator's outputs, as a share of each output's peak."""
_FORM, _PLAY = 0.03, 0.1
"""Prior: error of an effect's form as a share of its change, in general, and for play, dead bands and
friction."""
_INDEPENDENT = 40.0
"""Prior: number of independent values in the error of a simulator."""


def form_error(names: Sequence[str], change: float) -> float:
    """Return the error of the outputs due to an effect's simplified form, as a share of the peaks."""
    return change * (_PLAY if "half_width_rad" in names else _FORM)


def most_nats(apart: float, *forms: float) -> float:
    """Return the largest log likelihood difference, nats, that two models can have.

    Parameters
    ----------
    apart
        Difference between the outputs of both models, as a share of the peaks.
    """
    error = float(np.linalg.norm((_MODEL, *forms)))
    return 0.5 * _INDEPENDENT * (apart / error) ** 2
