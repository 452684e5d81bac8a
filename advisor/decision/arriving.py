"""The word ENOUGH during an input, and the error of each derivative with the information so far."""

from collections.abc import Mapping
from dataclasses import dataclass

WITHIN_PERCENT = 100.0
"""Largest error of a derivative within its tolerance, % of the tolerance."""
FIRST_S = 2.0
"""Least length of an input before its information is shown, s. A shorter piece has no oscillation."""


@dataclass(frozen=True, slots=True)
class Arriving:
    """Errors of the derivatives with the information of an input that is being flown."""

    until_s: float
    """Vehicle time up to which samples count, s since boot."""
    percent: Mapping[str, float]
    """Error of each judged derivative of the moved controls, % of its tolerance."""

    unknown: tuple[str, ...] = ()
    """Judged derivatives of the moved controls that the data so far do not determine."""

    @property
    def is_enough(self) -> bool:
        """Whether each judged derivative is known and within its tolerance."""
        return bool(self.percent) and not self.unknown and max(self.percent.values()) <= WITHIN_PERCENT
