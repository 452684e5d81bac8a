"""Property of an instrument: the value from the data, compared with the stated value.

An instrument has the parameters sign, scale, unit, delay, lag, place, bias and rate. The motion gives these
parameters without aerodynamics, or the fit estimates them with the derivatives. Doctor, screens, fit, verdict
and aircraft file all read this result.
"""

from dataclasses import dataclass
from math import nan
from typing import Literal

from advisor.words.problems import Problem

Quantity = Literal["sign", "scale", "unit", "delay_s", "lag_s", "arm_m", "bias", "rate"]


@dataclass(frozen=True, slots=True)
class InstrumentFinding:
    """One property of one instrument, as found from the data."""

    channel: str
    """Channel name: ``elevator``, ``alpha``, ``q``, ``theta``, ``a_z``, ``airspeed``."""
    quantity: Quantity
    stated: float | str | None
    """Value that the aircraft file, a parameter or the message's definition states, SI; None without one."""
    value: float | str
    """Value from the data, SI, or the name of a unit."""
    std: float = nan
    """Standard deviation of ``value``, SI."""
    contradicts: bool = False
    """Whether the data exclude the stated value, or any value possible for such an instrument."""
    text: str = ""
    """Sentence about the finding, without a full stop."""
    fix: str = ""
    """Line for the aircraft file, or remedy on the aircraft, without a full stop."""
    used: bool = False
    """Whether the estimates use the value from the data."""
    removed_s: float = 0.0
    """Delay that was removed from the channel's stamps, s."""

    @property
    def code(self) -> str:
        """Code of the finding from channel and quantity, equal in all outputs."""
        return f"{self.channel}_{self.quantity}"

    @property
    def sentence(self) -> str:
        """Sentence about the finding with a capital letter, without a full stop."""
        return f"{self.text[:1].upper()}{self.text[1:]}"

    @property
    def problem(self) -> Problem:
        return Problem(self.code, f"{self.sentence}.", f"Fix: {self.fix}.")

    @property
    def refuses(self) -> bool:
        """Whether no estimate can be accepted, because the stated value is excluded and no better one is
        used."""
        return self.contradicts and not self.used
