"""Deflections of a surface commanded by servo outputs, output by output."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from advisor.flight.signals.banks import Pulses
from advisor.flight.signals.channels import Decoded
from advisor.flight.signals.messages import FloatArray, IntArray
from advisor.flight.vehicle.surfaces import Surface, driven


@dataclass(frozen=True, slots=True)
class Commanded:
    """Samples of one surface, in order of arrival."""

    channel: str
    message: str
    source: str
    """``MESSAGE.field``."""
    surface: Surface
    t: FloatArray
    """Shape (n,), s since boot."""
    angles: FloatArray
    """Shape (n, number of outputs), rad: deflection that each output commands."""
    order: IntArray
    """Shape (n,), place in the order of arrival."""

    def combined(self, turned: Iterable[int] = ()) -> Decoded:
        """Return the surface's own angle; outputs in ``turned`` count with the opposite sign."""
        y = self.surface.combined(self.angles, turned)
        return Decoded(self.channel, self.source, "commanded", self.t, y, self.order)

    def rows(self, which: slice | NDArray[Any]) -> "Commanded":
        """Return some of the samples."""
        return Commanded(
            self.channel,
            self.message,
            self.source,
            self.surface,
            self.t[which],
            self.angles[which],
            self.order[which],
        )


def commanded(
    surfaces: Mapping[str, Surface], pulses: Pulses, t: FloatArray, autopilot: str
) -> list[Commanded]:
    """Return the deflection that these pulses command for each surface, where all of its outputs carry a
    pulse.

    Pulses outside a calibration give the deflection at its end.

    Parameters
    ----------
    surfaces
        Surfaces by channel.
    pulses
        Pulses of n messages.
    t
        Shape (n,), vehicle time of the messages, s since boot.
    autopilot
        Name of the autopilot in the vehicle's identity.
    """
    found = []
    for channel, surface in surfaces.items():
        pwm = pulses.of(surface.outputs)
        good = driven(pwm, autopilot) & np.isfinite(t)
        message, source = pulses.columns.name, pulses.source(surface.outputs)
        angles, order = surface.angles(pwm[good]), pulses.columns.order[good]
        found.append(Commanded(channel, message, source, surface, t[good], angles, order))
    return found


def joined(pieces: Sequence[Commanded]) -> Commanded:
    """Return pieces of one surface, one after the other."""
    first = pieces[0]
    return Commanded(
        first.channel,
        first.message,
        first.source,
        first.surface,
        np.concatenate([piece.t for piece in pieces]),
        np.concatenate([piece.angles for piece in pieces]),
        np.concatenate([piece.order for piece in pieces]),
    )
