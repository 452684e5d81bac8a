"""Channels with the stamps that the log gave them, so that the diagnosis names a late stream itself.

The examination of instruments sets late streams earlier for the estimates. It removes from each manoeuvre
what was known until then, so that the rest differs from manoeuvre to manoeuvre.
"""

from dataclasses import replace

from advisor.flight.maneuvers.maneuver import Maneuver

_TOGETHER = {"a_z": ("a_z", "a_x")}
"""Channels of one message, by the channel that the findings name."""


def as_stamped(maneuver: Maneuver) -> Maneuver:
    """Return the manoeuvre with the delays that were removed from its channels put back."""
    channels = dict(maneuver.channels)
    for finding in maneuver.findings:
        for name in _TOGETHER.get(finding.channel, (finding.channel,)):
            if name in channels and finding.removed_s:
                channels[name] = replace(channels[name], t=channels[name].t + finding.removed_s)
    findings = tuple(replace(finding, removed_s=0.0) for finding in maneuver.findings)
    return replace(maneuver, channels=channels, findings=findings)
