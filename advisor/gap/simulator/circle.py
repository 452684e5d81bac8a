"""Cosine and sine as polynomials.

A library function takes one number at a time. The compiler evaluates a polynomial for all lanes of a pack at
once (``advisor.gap.simulator.simulate``).
"""

import numpy as np

from advisor.process.compiled import kernel


@kernel(error_model="numpy", fastmath={"contract"})
def cos_sin(x: float) -> tuple[float, float]:
    """Return cosine and sine of an angle in rad, exact but for the last digit."""
    half_turns = np.floor(x * (1.0 / np.pi) + 0.5)
    sign = 1.0 - 2.0 * (half_turns - 2.0 * np.floor(0.5 * half_turns))
    y = x - half_turns * np.pi
    s = y * y
    s2 = s * s
    s4 = s2 * s2
    cos = ((1.0 - s * (1 / 2)) + s2 * (1 / 24 - s * (1 / 720))
           + s4 * ((1 / 40320 - s * (1 / 3628800)) + s2 * (1 / 479001600 - s * (1 / 87178291200)))
           + s4 * s4 * (1 / 20922789888000 - s * (1 / 6402373705728000)))  # fmt: skip
    sin = ((1.0 - s * (1 / 6)) + s2 * (1 / 120 - s * (1 / 5040))
           + s4 * ((1 / 362880 - s * (1 / 39916800)) + s2 * (1 / 6227020800 - s * (1 / 1307674368000)))
           + s4 * s4 * (1 / 355687428096000 - s * (1 / 121645100408832000)))  # fmt: skip
    return sign * cos, sign * y * sin
