"""A number of a flight as it is stated everywhere: name, source, value, 95 % interval, unit, sentence."""

from dataclasses import dataclass
from math import isfinite, nan

from advisor.words.digits import with_half
from advisor.words.quantiles import NORMAL_95


@dataclass(frozen=True, slots=True, kw_only=True)
class Fact:
    """One number about a flight, in the unit for people."""

    name: str
    """Symbol or name for people: ``M_α``, ``Dutch roll ζ``."""
    source: str
    """Origin of the number as a heading: ``Joint estimate from manoeuvres 1, 2``. Facts with equal name and
    source are one number."""
    value: float = nan
    """Value of the number; NaN if the flight does not determine it."""
    half: float = nan
    """Half-width of the 95 % interval, corrected for coloured residuals; NaN without a value."""
    unit: str = ""
    reason: str = ""
    """Reason why the flight does not determine the number."""

    @property
    def is_known(self) -> bool:
        """Whether value and interval are numbers."""
        return isfinite(self.value) and isfinite(self.half)

    @property
    def label(self) -> str:
        """Label of an axis: ``q [deg/s]``."""
        return f"{self.name} [{self.unit}]"

    @property
    def cell(self) -> str:
        """Value with the half-width of its 95 % interval: ``−48.3 ± 2.1``."""
        return with_half(self.value, self.half) if self.is_known else "–"

    @property
    def sentence(self) -> str:
        """Value with the half-width of its 95 % interval and its unit: ``−48.3 ± 2.1 1/s²``."""
        return f"{self.cell} {self.unit.removesuffix('1')}".rstrip()


def fact_of(name: str, source: str, value: float, std: float, unit: str = "", factor: float = 1.0) -> Fact:
    """Return a fact from value and standard deviation in SI; ``factor`` converts from SI."""
    return Fact(name=name, source=source, value=factor * value, half=NORMAL_95 * factor * std, unit=unit)
