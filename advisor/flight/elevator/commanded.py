"""Deflections of a surface that its servo outputs command, output by output."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from advisor.flight.signals.banks import Pulses
from advisor.flight.signals.channels import Decoded
from advisor.flight.vehicle.surfaces import Surface, driven
from advisor.process.arrays import FloatArray, IntArray


@dataclass(frozen=True, slots=True)
class Commanded:
    """Samples of one control surface, in order of arrival."""

    channel: str
    message: str
    source: str
    """``MESSAGE.field``."""
    surface: Surface
    t: FloatArray
    """Shape (n,): stamps of the samples, s since boot."""
    angles: FloatArray
    """Shape (n, number of outputs): deflection that each output commands, rad."""
    order: IntArray
    """Shape (n,): index of each sample in the order of arrival."""

    def combined(self, turned: Iterable[int] = ()) -> Decoded:
        """Return the surface's deflection; outputs in ``turned`` are added with the opposite sign."""
        y = self.surface.combined(self.angles, turned)
        return Decoded(self.channel, self.source, "commanded", self.t, y, self.order)

    def rows(self, which: slice | NDArray[Any]) -> "Commanded":
        return replace(self, t=self.t[which], angles=self.angles[which], order=self.order[which])


def commanded(
    surfaces: Mapping[str, Surface], pulses: Pulses, t: FloatArray, autopilot: str
) -> list[Commanded]:
    """Return the deflection of each surface that pulses command. The result needs a pulse of one output of
    each demand.

    Pulses outside a calibration give the deflection at its end.

    Parameters
    ----------
    t
        Shape (n,), vehicle time of the messages, s since boot.
    """
    pieces = []
    for channel, surface in surfaces.items():
        pwm = pulses.of(surface.outputs)
        alive = driven(pwm, autopilot)
        good = np.all(np.isfinite(pwm), axis=1) & np.any(alive, axis=1) & np.isfinite(t)
        for rows in _alike(alive, np.flatnonzero(good)):
            carry = alive[rows[0]]
            heard = surface.without(
                [n for n, carries in zip(surface.outputs, carry, strict=True) if not carries]
            )
            if heard is None:
                continue
            angles, order = heard.angles(pwm[rows][:, carry]), pulses.columns.order[rows]
            source = pulses.source(heard.outputs)
            pieces.append(Commanded(channel, pulses.columns.name, source, heard, t[rows], angles, order))
    return pieces


def _alike(alive: NDArray[np.bool_], rows: IntArray) -> list[IntArray]:
    """Return the rows in stretches. Within a stretch the same outputs carry pulses."""
    if len(rows) == 0:
        return []
    changes = np.flatnonzero(np.any(alive[rows[1:]] != alive[rows[:-1]], axis=1))
    return np.split(rows, changes + 1) if len(changes) else [rows]


def joined(pieces: Sequence[Commanded]) -> Commanded:
    """Return pieces of one surface, joined one after the other."""
    return replace(
        pieces[0],
        t=np.concatenate([piece.t for piece in pieces]),
        angles=np.concatenate([piece.angles for piece in pieces]),
        order=np.concatenate([piece.order for piece in pieces]),
    )
