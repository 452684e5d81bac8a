"""The source of the angle of attack: an instrument or an estimator."""

from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.flight.signals.renewal import renewed

_ESTIMATED_HZ = 22.0
"""Prior: rate in Hz below which α may be ArduPilot's estimate, which is renewed at most 20 times per
second."""


def is_estimate(m: Maneuver, smoothed: bool) -> bool:
    """Return whether α is an estimate from inertial sensors.

    ArduPilot marks every α as derived, and the bundled aircraft marks its own as simulated. An α that is
    renewed faster than its estimator is a vane's. A smooth record is an estimate all the same.
    """
    alpha = m.channels.get("alpha")
    if alpha is None or alpha.provenance not in ("derived", "simulated"):
        return False
    t, _ = renewed(alpha.t, alpha.y)
    hz = len(t) / (alpha.t[-1] - alpha.t[0])
    return hz < _ESTIMATED_HZ or smoothed or not alpha.source.startswith("AOA_SSA")
