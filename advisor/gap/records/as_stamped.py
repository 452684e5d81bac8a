"""Channels with their stamps from the log, so that the diagnosis finds a late stream itself.

The instrument examination shifts late streams forward for the estimates. The removed delays differ between
manoeuvres, so the diagnosis restores them.
"""

from dataclasses import replace

from advisor.flight.maneuvers.maneuver import Maneuver

_TOGETHER = {"a_z": ("a_z", "a_x")}
"""Channels of one message, by the name of the channel in the findings."""


def as_stamped(maneuver: Maneuver) -> Maneuver:
    """Return the manoeuvre with the delays that were removed from its channels put back."""
    channels = dict(maneuver.channels)
    for finding in maneuver.findings:
        for name in _TOGETHER.get(finding.channel, (finding.channel,)):
            if name in channels and finding.removed_s:
                channels[name] = replace(channels[name], t=channels[name].t + finding.removed_s)
    findings = tuple(replace(finding, removed_s=0.0) for finding in maneuver.findings)
    return replace(maneuver, channels=channels, findings=findings)
