"""The next input of aileron or rudder: its step, and its size within the limit of bank.

Bank and information of the next input follow from the last input by linearity, with the amplitude and its
square.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from math import degrees, inf

import numpy as np

from advisor.aircraft.aircraft import Aircraft
from advisor.decision.advice import GENTLE
from advisor.decision.axes.requirements import BANK_DEG
from advisor.decision.conditions import ALPHA_MARGIN, BOLDER, travel_of
from advisor.decision.first_unit import first_unit_s
from advisor.decision.inputs import StepInput
from advisor.decision.verdict import INFORMATION_LIMIT_PERCENT, NextInput, Reason
from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.model.axes.lateral import LATERAL
from advisor.oem.axis.estimate import AxisEstimate
from advisor.oem.estimate import Estimate, NoEstimate


@dataclass(frozen=True, slots=True)
class FlownInput:
    """A flown input with the aircraft's response."""

    control: str
    """Control with the largest movement."""
    amplitude_rad: float
    bank_rad: float
    """Largest bank angle during the manoeuvre, rad."""
    remedy: str = ""
    """Remedy from the first reason against the manoeuvre; empty for an accepted one."""
    estimate: Estimate | NoEstimate | None = None
    """Estimate of the manoeuvre, accepted or not."""
    asked: float = 1.0
    """Factor on the amplitude that the first reason asks for; 1 if the reason asks for another change."""

    @classmethod
    def of(
        cls, maneuver: Maneuver, reasons: Sequence[Reason], estimate: Estimate | NoEstimate | None = None
    ) -> "FlownInput":
        moved = {name: _amplitude(maneuver, name) for name in LATERAL.inputs}
        control = max(moved, key=lambda name: moved[name])
        bank = maneuver.channels.get("bank")
        banked = float(np.max(np.abs(bank.y), initial=0.0)) if bank is not None else 0.0
        remedy = reasons[0].remedy if reasons else ""
        asked = 1.0 / BOLDER if reasons and reasons[0].code == "saturation" else 1.0
        if reasons and reasons[0].code == "amplitude" and reasons[0].value > 0.0:
            asked = reasons[0].limit / reasons[0].value
        return cls(control, moved[control], banked, remedy, estimate, asked)


def _amplitude(maneuver: Maneuver, name: str) -> float:
    """Return the largest deviation of a control from its level before the input, rad."""
    channel = maneuver.channels.get(name)
    if channel is None or not len(channel):
        return 0.0
    return float(np.max(np.abs(channel.y - channel.y[0])))


def next_lateral(
    control: str,
    percent: float,
    accepted: Sequence[AxisEstimate],
    flown: Sequence[FlownInput],
    aircraft: Aircraft,
    holding_back: str,
) -> NextInput:
    """Return the next lateral input.

    Parameters
    ----------
    percent
        Error of the worst derivative of this control, % of its tolerance; infinite if unknown.
    """
    travel = travel_of(getattr(aircraft, control).ends_deg)
    before = next((earlier for earlier in reversed(flown) if earlier.control == control), None)
    amplitude = GENTLE * travel if before is None else _larger(before, percent, aircraft, travel)
    refused = [x.estimate for x in flown if x.estimate is not None]
    unit_s = first_unit_s(control, aircraft, accepted, refused)
    wanted = StepInput("doublet", unit_s, min(amplitude, ALPHA_MARGIN * travel), True, control)
    wanted = wanted.rounded(travel)
    gently = ", to begin gently" if before is None else ""
    # A remedy belongs to the refused input, never to another control. Another amplitude is a remedy.
    repeated = before is not None and before is flown[-1] and before.asked == 1.0
    remedy = f"; {before.remedy}" if before is not None and repeated and before.remedy else ""
    still = f"hands and feet still for {4.0 * unit_s:.0f} s" if control == "rudder" else "stick still"
    said = f"{wanted.spoken(travel)}{gently}, then {still}{remedy}"
    return NextInput(f"next: {said}", None, holding_back, wanted)


def _larger(before: FlownInput, percent: float, aircraft: Aircraft, travel: float) -> float:
    """Return the amplitude that meets the tolerance with one more manoeuvre, within the bank limit.

    A refused input changes only as the refusal asks.
    """
    wanted = max(percent / INFORMATION_LIMIT_PERCENT, 1.0) if percent < inf else 1.0
    factor = min(before.asked if before.remedy else wanted, BOLDER)
    limit = ALPHA_MARGIN * max(BANK_DEG, aircraft.limits.bank_deg)
    if before.bank_rad > 0.0:
        factor = min(factor, limit / degrees(before.bank_rad))
    # A control that moves from one end to the other is no larger than its travel from trim.
    return factor * min(before.amplitude_rad, travel)
