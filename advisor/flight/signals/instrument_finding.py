"""Property of an instrument: the value that the data tell, next to the stated one.

An instrument is a model with parameters: sign, scale, unit, delay, lag, place, bias, rate. The motion tells
them without aerodynamics, or the fit tells them together with the derivatives. Doctor, screens, fit, verdict
and aircraft file ask this one result.
"""

from dataclasses import dataclass
from math import nan
from typing import Literal

from advisor.words.problems import Problem

Quantity = Literal["sign", "scale", "unit", "delay_s", "lag_s", "arm_m", "bias", "rate"]


@dataclass(frozen=True, slots=True)
class InstrumentFinding:
    """One property of one instrument, as the data tell it."""

    channel: str
    """Channel name: ``elevator``, ``alpha``, ``q``, ``theta``, ``a_z``, ``airspeed``."""
    quantity: Quantity
    stated: float | str | None
    """Value that the aircraft file, a parameter or the message's definition states, in SI; None without a
    statement."""
    value: float | str
    """Value that the data tell, in SI; the name of a unit."""
    std: float = nan
    """Standard deviation of ``value``, SI."""
    contradicts: bool = False
    """Whether the data exclude the statement, or any value that an instrument of this kind can have."""
    text: str = ""
    """The finding in one sentence, without a full stop."""
    fix: str = ""
    """Line for the aircraft file, or what to change on the aircraft, without a full stop."""
    used: bool = False
    """Whether the estimates use the value that the data tell."""
    removed_s: float = 0.0
    """Delay that was removed from the channel's stamps, s."""

    @property
    def code(self) -> str:
        """Name of the finding, equal on every face: channel and quantity."""
        return f"{self.channel}_{self.quantity}"

    @property
    def sentence(self) -> str:
        """Finding with a capital letter, without a full stop."""
        return f"{self.text[:1].upper()}{self.text[1:]}"

    @property
    def problem(self) -> Problem:
        """Finding as an obstacle, with its remedy."""
        return Problem(self.code, f"{self.sentence}.", f"Fix: {self.fix}.")

    @property
    def refuses(self) -> bool:
        """Whether no estimate can be accepted: the statement is excluded, and nothing better is in use."""
        return self.contradicts and not self.used
