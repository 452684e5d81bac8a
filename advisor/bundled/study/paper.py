"""Figures that the paper prints: the campaign, the noise levels, and Table 1."""

from collections.abc import Mapping
from dataclasses import dataclass

from advisor.aircraft.aircraft import Rule
from advisor.aircraft.reference import PARAMETERS

NOISE_PERCENT = (1.0, 2.5, 5.0)
ORDER = ("3211", "rev", "rev", "3211", "rev", "3211", "rev")
"""Inputs of the seven manoeuvres of the campaign."""


@dataclass(frozen=True, slots=True)
class PaperRow:
    """One row of Table 1 of the paper."""

    needed: int | None
    """Number of manoeuvres until the stop. None: the campaign never stopped."""
    error_percent: Mapping[str, float]
    """Error of each parameter in percent of its true value."""


def _row(needed: int | None, *errors: float) -> PaperRow:
    return PaperRow(needed, dict(zip(PARAMETERS, errors, strict=True)))


TABLE_1: Mapping[tuple[Rule, float], PaperRow] = {
    ("continuous", 1.0): _row(3, 0.12, 0.28, 0.54, 0.44, 0.32, 0.15, 0.56, 0.07),
    ("continuous", 2.5): _row(7, 0.87, 0.74, 6.38, 3.35, 0.73, 0.10, 1.69, 1.21),
    ("continuous", 5.0): _row(None, 0.07, 5.50, 16.37, 0.89, 2.18, 2.35, 1.28, 0.70),
    ("separate", 1.0): _row(3, 0.12, 0.28, 0.54, 0.44, 0.32, 0.14, 0.56, 0.07),
    ("separate", 2.5): _row(4, 0.29, 2.79, 3.59, 0.70, 1.19, 0.60, 1.82, 0.88),
    ("separate", 5.0): _row(4, 5.43, 4.86, 30.85, 9.41, 1.26, 0.56, 3.46, 1.20),
}
