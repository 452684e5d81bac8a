"""Advice on the next lateral manoeuvre: the control, the length of a step and the amplitude.

Bank and information follow from the last input by linearity, with the amplitude and its square.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from math import degrees, inf, pi, radians

import numpy as np

from advisor.aircraft.aircraft import Aircraft
from advisor.decision.advice import GENTLE
from advisor.decision.axes.lateral import BANK_DEG
from advisor.decision.conditions import ALPHA_MARGIN, BOLDER, FULL_TRAVEL_RAD
from advisor.decision.inputs import SHORTEST_UNIT_S, StepInput
from advisor.decision.verdict import INFORMATION_LIMIT_PERCENT, NextInput, Reason
from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.oem.axes.lateral.estimate import LateralEstimate

FIRST_UNIT_S = 1.0
"""Duration of the first doublet's step, s, before any mode is known. The duration lies between half a Dutch
roll of a small aircraft (0.9 s) and of a jet (1.7 s). The duration is at least two roll time constants of a
small aircraft (0.1 s) and of a jet (0.5 s)."""
_CONTROLS = ("aileron", "rudder")


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

    @classmethod
    def of(cls, maneuver: Maneuver, reasons: Sequence[Reason]) -> "FlownInput":
        """Return the input of a manoeuvre with these reasons against it."""
        moved = {name: _amplitude(maneuver, name) for name in _CONTROLS}
        control = max(moved, key=lambda name: moved[name])
        bank = maneuver.channels.get("bank")
        banked = float(np.max(np.abs(bank.y), initial=0.0)) if bank is not None else 0.0
        remedy = reasons[0].text.partition("; ")[2] if reasons else ""
        return cls(control, moved[control], banked, remedy)


def _amplitude(maneuver: Maneuver, name: str) -> float:
    """Return the largest deviation of a control from its level before the input, rad."""
    channel = maneuver.channels.get(name)
    if channel is None or not len(channel):
        return 0.0
    return float(np.max(np.abs(channel.y - channel.y[0])))


def next_lateral(
    control: str,
    percent: float,
    accepted: Sequence[LateralEstimate],
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
    ends_deg = getattr(aircraft, control).ends_deg
    travel = min(map(abs, map(radians, ends_deg))) if ends_deg and 0.0 not in ends_deg else FULL_TRAVEL_RAD
    before = next((one for one in reversed(flown) if one.control == control), None)
    amplitude = GENTLE * travel if before is None else _larger(before, percent, aircraft)
    wanted = StepInput(
        "doublet", _unit_s(control, accepted), min(amplitude, ALPHA_MARGIN * travel), True, control
    ).rounded(travel)
    gently = ", to begin gently" if before is None else ""
    remedy = f"; {flown[-1].remedy}" if before is not None and flown[-1].remedy else ""
    said = f"{wanted.spoken(travel)}{gently}, {_after(control, wanted.unit_s)}{remedy}"
    return NextInput(f"next: {said}", None, holding_back, wanted)


def _larger(before: FlownInput, percent: float, aircraft: Aircraft) -> float:
    """Return the amplitude that meets the tolerance with one more manoeuvre, within the bank limit."""
    factor = min(max(percent / INFORMATION_LIMIT_PERCENT, 1.0), BOLDER) if percent < inf else 1.0
    limit = ALPHA_MARGIN * max(BANK_DEG, aircraft.limits.bank_deg)
    if before.bank_rad > 0.0:
        factor = min(factor, limit / degrees(before.bank_rad))
    return factor * before.amplitude_rad


def _unit_s(control: str, accepted: Sequence[LateralEstimate]) -> float:
    """Return the duration of a step, s: two roll time constants, or half a Dutch roll."""
    modes = [one.modes for one in accepted]
    if control == "aileron":
        known = [2.0 * m.roll_time_constant.value for m in modes if m.roll_time_constant is not None]
        # Shorter steps than half a second leave a fast roll no bank to show.
        least = 0.5
    else:
        known = [pi / m.dutch_roll_omega.value for m in modes if m.dutch_roll_omega is not None]
        least = SHORTEST_UNIT_S
    return max(float(np.median(known)), least) if known else FIRST_UNIT_S


def _after(control: str, unit_s: float) -> str:
    if control == "aileron":
        return "then stick still"
    return f"then hands and feet still for {4.0 * unit_s:.0f} s"
