"""An angle of attack that no instrument measures: the motion gives its trim, and no output is compared.

Estimate and diagnosis leave out the same angle of attack. One derived from the climb rate says less than
pitch rate and specific force, and in moving air it is wrong.
"""

from collections.abc import Sequence
from dataclasses import replace

from advisor.aircraft.aircraft import Aircraft
from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.flight.signals.renewal import renewed
from advisor.gap.simulator.layout import OUTPUTS
from advisor.oem.alpha_use import can_do_without, infer, why_not_measured

_INFERRED = "inferred"
"""Provenance of an angle of attack that the motion implies."""


def is_known_by_motion(maneuver: Maneuver) -> bool:
    """Return whether the motion gives the angle of attack, which no instrument measures."""
    alpha = maneuver.channels.get("alpha")
    return alpha is not None and alpha.provenance == _INFERRED


def outputs_with(maneuver: Maneuver) -> tuple[str, ...]:
    """Return the outputs that a simulation of the manoeuvre is compared with, as far as they were recorded.

    Without a measured angle of attack these are those of the estimate. The residual of the attitude is the
    integral of every gust, and nothing but the angle of attack shows gusts.
    """
    return ("q", "a_z") if is_known_by_motion(maneuver) else OUTPUTS


def is_known(maneuvers: Sequence[Maneuver]) -> bool:
    """Return whether every manoeuvre has an angle of attack, measured or by the motion."""
    return all("alpha" in m.channels for m in maneuvers)


def alpha_by_motion(maneuvers: Sequence[Maneuver], aircraft: Aircraft) -> list[Maneuver]:
    """Return the manoeuvres with the angle of attack that the motion implies, where none was measured.

    Manoeuvres are unchanged where the motion lacks a channel to imply an angle.
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

    ArduPilot marks every α as derived, and the bundled aircraft marks its own as simulated. An α that is
    renewed faster than its estimator is a vane's. A smooth record is an estimate all the same.
    """
    alpha = m.channels.get("alpha")
    if alpha is None or alpha.provenance not in ("derived", "simulated"):
        return False
    t, _ = renewed(alpha.t, alpha.y)
    hz = len(t) / (alpha.t[-1] - alpha.t[0])
    return hz < _ESTIMATED_HZ or smoothed or not alpha.source.startswith("AOA_SSA")
