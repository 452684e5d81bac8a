"""Search for the likeliest noise at one setting of all parameters."""

from collections.abc import Iterator, Sequence

import numpy as np

from advisor.flight.signals.robust import robust_std
from advisor.oem.coordinate_search import coordinate_search
from advisor.oem.driven_motion.noise import Noise
from advisor.oem.driven_motion.setting import Setting

MOST_MANEUVERS = 7
"""Number of the newest manoeuvres for the noise estimate. More manoeuvres would change the noise estimate
little."""
STEPS = (1.0, 0.5, 0.2)
"""Numerical: steps of the first noise search in the logarithms of the noise parameters."""
FINE = (0.2,)
"""Numerical: steps of a noise search that goes on from another one."""
_MOST = 0.1
"""Numerical: largest start of an intensity's root, which a state that no output shows begins with, SI."""


def starts(setting: Setting) -> Iterator[Noise]:
    """Yield the starts of the noise search: one with large jolts, and one with large gusts.

    The white noise is that of the residuals' differences.
    """
    channel, outputs = setting.assembly.channel, len(setting.assembly.names.outputs)
    white, size = np.ones(outputs), np.ones(outputs)
    for c in np.unique(channel):
        parts = [setting.residual[rows][channel[rows] == c] for rows in setting.assembly.blocks]
        size[c] = max(
            float(np.std(np.concatenate([part - part.mean() for part in parts if len(part)]))), 1e-9
        )
        white[c] = robust_std(np.concatenate([np.diff(part) for part in parts])) / 2.0**0.5
    seen, forced = np.abs(setting.motions[0].seen), setting.motions[0].forced
    measured = np.isin(np.arange(outputs), channel)
    sizes = size[measured, None] / np.maximum(seen[measured][:, forced], 1e-9)
    moved = np.min(sizes, axis=0, initial=_MOST)
    white = np.clip(white, 1e-3 * size, size)
    for jolts, gusts in ((1.0, 0.1), (0.1, 1.0)):
        yield Noise(white, 0.5 * size, 0.3, jolts * moved, gusts * float(moved[0]), 1.0)


def likeliest(setting: Setting, noise: Noise, steps: Sequence[float]) -> Noise:
    """Return the likeliest noise, by a coordinate search in the logarithms with decreasing steps."""
    outputs = len(noise.white)
    free = [*setting.measured, *(outputs + setting.measured), *range(2 * outputs, len(noise.logarithms))]
    start = noise.logarithms
    x, _ = coordinate_search(lambda y: setting.cost(noise.at(y), MOST_MANEUVERS), start, free, steps)
    return noise.at(x)
