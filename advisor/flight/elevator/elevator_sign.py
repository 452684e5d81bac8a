"""Sign of an elevator without calibration, from the aircraft's pitch response."""

from dataclasses import replace

import numpy as np

from advisor.flight.maneuvers.events import Notice
from advisor.flight.maneuvers.maneuver import InputKind, Maneuver
from advisor.flight.maneuvers.markers import MARKED
from advisor.flight.signals.motion import integrated
from advisor.process.arrays import FloatArray

_SURELY = 10.0
"""Least absolute value of M_δe, in standard errors under white noise, at which its sign is significant."""
_EXPLAINED = 0.7
"""Least share of the pitch rate's power that the regression must also explain."""
_OTHER: dict[InputKind, InputKind] = {"3-2-1-1": "reverse 3-2-1-1", "reverse 3-2-1-1": "3-2-1-1"}

SAID = (
    "The nose moved opposite to the direction that the elevator's output suggests, so its deflections have "
    "the opposite sign. Give a calibration if that is wrong, as for a canard."
)


class ElevatorSign:
    """Sign of an elevator with an assumed scale: trailing edge down pitches down.

    An autopilot's parameters give the direction of an output, not of the surface linked to it. The first
    conclusive manoeuvre determines the sign for all later manoeuvres.
    """

    def __init__(self) -> None:
        self._direction: bool | None = None
        self.backwards: bool | None = None
        """Whether the elevator's sign is reversed. None before the first conclusive manoeuvre."""

    def right(self, maneuver: Maneuver) -> tuple[Maneuver, list[Notice]]:
        """Return the manoeuvre with the right elevator sign, and a notice about a reversed sign."""
        notices = []
        stated = maneuver.scale is not None and maneuver.scale.reversed
        if self._direction is not None:
            # A parameter that is heard after the answer may state another direction. The answer stays.
            self.backwards = stated != self._direction
        elif (backwards := answers_backwards(maneuver)) is not None:
            self._direction, self.backwards = stated != backwards, backwards
            notices = [Notice("elevator_backwards", SAID)] if backwards else []
        return (turned(maneuver) if self.backwards else maneuver), notices


def turned(maneuver: Maneuver) -> Maneuver:
    """Return the manoeuvre with the elevator's deflections reversed in sign."""
    kind = maneuver.span.kind
    # A script states the name of its input by the motion of the nose.
    is_named = maneuver.span.closed_by == MARKED["script"]
    span = replace(
        maneuver.span,
        kind=kind if is_named else _OTHER.get(kind, kind),
        steps=tuple((onset, -level) for onset, level in maneuver.span.steps),
    )
    scale = maneuver.scale and replace(maneuver.scale, reversed=not maneuver.scale.reversed)
    return replace(maneuver.deflected(np.negative), span=span, scale=scale)


def answers_backwards(maneuver: Maneuver) -> bool | None:
    """Return whether a trailing edge that moves down raises the nose (M_δe > 0); None if this is uncertain.

    The sign comes from least squares of the pitch rate on the integrals of elevator, pitch rate and α.
    """
    channels = maneuver.channels
    if "q" not in channels or len(channels["q"]) < 20:
        return None
    t, q = channels["q"].t, channels["q"].y
    motion = [np.interp(t, channels[n].t, channels[n].y) for n in ("elevator", "q", "alpha") if n in channels]
    X = np.column_stack([*(integrated(t, x - x[0]) for x in motion), t - t[0], np.ones(len(t))])
    scale = np.maximum(np.max(np.abs(X), axis=0), 1e-12)
    factors, *_ = np.linalg.lstsq(X / scale, q, rcond=None)
    left: FloatArray = q - (X / scale) @ factors
    variance = float(left @ left) / (len(q) - len(factors))
    std = np.sqrt(variance * np.linalg.pinv((X / scale).T @ (X / scale))[0, 0])
    sure = abs(factors[0]) > _SURELY * std and np.var(left) < (1.0 - _EXPLAINED) * np.var(q)
    return bool(factors[0] > 0.0) if sure else None
