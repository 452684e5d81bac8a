"""Inflight advisor: was that manoeuvre good, and may we stop testing.

The public library is imported when first used: ``read`` a log, ``find`` its manoeuvres, ``estimate`` the
parameters, ``judge`` a campaign, ``diagnose`` the gap. What ``__all__`` does not list may change.
"""

from importlib import import_module
from typing import Any

_PUBLIC = {
    "Aircraft": "advisor.aircraft.aircraft",
    "CampaignState": "advisor.campaign.state",
    "ConfigurationError": "advisor.words.problems",
    "Diagnosis": "advisor.gap.result",
    "Estimate": "advisor.oem.estimate",
    "Flight": "advisor.library",
    "Maneuver": "advisor.flight.maneuvers.maneuver",
    "NoEstimate": "advisor.oem.estimate",
    "UnusableInputError": "advisor.words.problems",
    "diagnose": "advisor.library",
    "estimate": "advisor.library",
    "find": "advisor.library",
    "judge": "advisor.library",
    "read": "advisor.library",
}
"""Public name to the module that defines the name."""

__all__ = ["__version__", *_PUBLIC]


def __getattr__(name: str) -> Any:
    """Import a public name at its first use, so that the command line starts fast."""
    if name == "__version__":
        return _installed_version()
    if name not in _PUBLIC:
        raise AttributeError(f"module 'advisor' has no attribute {name!r}")
    value = getattr(import_module(_PUBLIC[name]), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    """Return the public names, for completion in a shell."""
    return sorted(__all__)


def _installed_version() -> str:
    """Return the version of the installed package; without an installation one below all others."""
    from importlib.metadata import PackageNotFoundError, version

    try:
        return version("inflight-advisor")
    except PackageNotFoundError:
        return "0+unknown"
