"""Where the angle of attack comes from: an instrument or an estimator."""

from advisor.flight.maneuver import Maneuver
from advisor.flight.renewal import renewed

_ESTIMATED_HZ = 22.0
"""ArduPilot renews its estimate of α 20 times a second at most ..."""
_TELLING_HZ = 15.0
"""... and its ``.bin`` logs hold ten of these: so far apart an estimate is as rough as an instrument."""


def is_estimate(m: Maneuver, smoothed: bool, rough: bool) -> bool:
    """Whether α is made from inertial sensors, as it says of itself.

    ArduPilot says so of whatever it sends. What is renewed too fast for its estimator, or as rough as the
    noise of an instrument where that tells the two apart, is a vane's, unless it is smooth.
    """
    alpha = m.channels.get("alpha")
    if alpha is None or alpha.provenance != "derived":
        return False
    t, _ = renewed(alpha.t, alpha.y)
    hz = len(t) / (alpha.t[-1] - alpha.t[0])
    return (
        (hz < _ESTIMATED_HZ and not (rough and hz > _TELLING_HZ))
        or smoothed
        or not alpha.source.startswith("AOA_SSA")
    )
