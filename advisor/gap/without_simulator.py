"""Diagnosis without a simulator, for an aircraft file without a model."""

from dataclasses import replace

from advisor.gap.result import Diagnosis

_NOT_GIVEN = (
    "No simulator was given: the aircraft file holds no complete model. The flight was compared with a model "
    "fitted to it. That shows effects beyond eight parameters, and nothing about a simulator's parameters."
)
_STATEMENT = (
    "No simulator was given, so no gap can be stated. A model fitted to this flight leaves no effect to name."
)


def without_simulator(diagnosis: Diagnosis) -> Diagnosis:
    """Return the diagnosis as a statement about the flight alone, without the claim that there is no gap."""
    notes = (_NOT_GIVEN, *diagnosis.notes)
    if diagnosis.verdict != "none":
        return replace(diagnosis, notes=notes)
    return replace(diagnosis, verdict="untested", sentence=_STATEMENT, notes=notes)
