"""Diagnosis of a flight without the findings behind it."""

from typing import Any

from advisor.gap.diagnose import examine
from advisor.gap.result import Diagnosis


def diagnose(*given: Any, **named: Any) -> Diagnosis:
    """Return the diagnosis; arguments as in ``advisor.gap.diagnose.examine``."""
    return examine(*given, **named).diagnosis
