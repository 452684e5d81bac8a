"""Where the angle of attack comes from: an instrument or an estimator."""

from advisor.flight.maneuver import Maneuver
from advisor.flight.renewal import renewed

_ESTIMATED_HZ = 22.0
"""ArduPilot renews its estimate of α 20 times a second at most."""


def is_estimate(m: Maneuver, smoothed: bool, rough: bool) -> bool:
    """Whether α is made from inertial sensors, as it says of itself.

    ArduPilot says so of whatever it sends. What is renewed too fast for its estimator, or as rough as the
    noise of an instrument, is a vane's, unless it is smooth.
    """
    alpha = m.channels.get("alpha")
    if alpha is None or alpha.provenance != "derived":
        return False
    t, _ = renewed(alpha.t, alpha.y)
    slow = len(t) < _ESTIMATED_HZ * (alpha.t[-1] - alpha.t[0])
    return (slow and not rough) or smoothed or not alpha.source.startswith("AOA_SSA")
