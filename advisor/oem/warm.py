"""Compile the estimator once, so that no pilot waits for it: ``python -m advisor.oem.warm``.

The compiled code is kept beside the modules (or where ``NUMBA_CACHE_DIR`` says), and every later start
loads it in a fraction of a second.
"""

import numpy as np

from advisor.oem.problem import Problem, Record, Signal
from advisor.oem.solution import solve


def warm() -> None:
    """Run every compiled function on a small problem of the kind that flights bring."""
    t = np.arange(0.0, 6.0, 0.05)
    u = np.where((t > 1.0) & (t < 2.0), 0.03, 0.0) - np.where((t > 2.0) & (t < 3.0), 0.03, 0.0)
    rng = np.random.default_rng(1)
    outputs = {
        name: Signal(t, np.sin(2.0 * t + phase) * 0.05 + 0.01 * rng.standard_normal(len(t)))
        for name, phase in (("alpha", 0.0), ("q", 1.5), ("a_z", 0.3), ("theta", 0.6))
    }
    speed = Signal(t, np.full(len(t), 20.0))
    solve(Problem((Record(Signal(t, u), outputs, airspeed=speed),)))


if __name__ == "__main__":
    warm()
