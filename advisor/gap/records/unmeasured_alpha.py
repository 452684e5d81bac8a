"""An angle of attack without a sensor: the motion gives its trim, and it is not compared.

The estimate and the diagnosis leave out the same inferred angle of attack. An α derived from the climb rate
adds no information to pitch rate and specific force.
"""

from collections.abc import Sequence
from dataclasses import replace

from advisor.aircraft.aircraft import Aircraft
from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.flight.signals.record import renewed
from advisor.gap.simulator.layout import OUTPUTS
from advisor.oem.alpha_use import can_do_without, infer, why_not_measured

_INFERRED = "inferred"
"""Provenance of an angle of attack that is inferred from the motion."""


def is_known_by_motion(maneuver: Maneuver) -> bool:
    """Return whether the angle of attack comes from the motion and not from an instrument."""
    alpha = maneuver.channels.get("alpha")
    return alpha is not None and alpha.provenance == _INFERRED


def outputs_with(maneuver: Maneuver) -> tuple[str, ...]:
    """Return the recorded outputs with which a simulation of the manoeuvre is compared.

    Without a measured angle of attack these outputs are those of the estimate. The attitude's residual
    integrates every gust, and only the angle of attack shows gusts.
    """
    return ("q", "a_z") if is_known_by_motion(maneuver) else OUTPUTS


def is_known(maneuvers: Sequence[Maneuver]) -> bool:
    """Return whether every manoeuvre has an angle of attack, measured or from the motion."""
    return all("alpha" in m.channels for m in maneuvers)


def alpha_by_motion(maneuvers: Sequence[Maneuver], aircraft: Aircraft) -> list[Maneuver]:
    """Return the manoeuvres with an angle of attack from the motion, where none was measured.

    Manoeuvres without the required channels are unchanged.
    """
    replaceable = [m for m in maneuvers if can_do_without(m, aircraft)]
    if not replaceable or not why_not_measured(maneuvers, aircraft):
        return list(maneuvers)
    return [replace(m, channels={**m.channels, "alpha": infer(m, aircraft)}) for m in replaceable]


_ESTIMATED_HZ = 22.0
"""Prior: rate in Hz below which α may be ArduPilot's estimate, which is renewed at most 20 times per
second."""


def is_estimate(m: Maneuver, smoothed: bool) -> bool:
    """Return whether α is an estimate from inertial sensors.

    ArduPilot marks every α as derived, and the bundled aircraft marks its own as simulated. An α renewed
    faster than ArduPilot's estimator comes from a vane. A smooth record of α is an estimate at any rate.
    """
    alpha = m.channels.get("alpha")
    if alpha is None or alpha.provenance not in ("derived", "simulated"):
        return False
    t, _ = renewed(alpha.t, alpha.y)
    hz = len(t) / (alpha.t[-1] - alpha.t[0])
    return hz < _ESTIMATED_HZ or smoothed or not alpha.source.startswith("AOA_SSA")
