"""Which way the elevator moves, where no calibration says so: as the aircraft answered."""

from dataclasses import replace

import numpy as np

from advisor.flight.events import Notice
from advisor.flight.maneuver import InputKind, Maneuver
from advisor.flight.messages import FloatArray
from advisor.flight.motion import integrated

_SURELY = 10.0
"""Standard errors of M_δe, as if the noise were white, from which on its sign is beyond doubt ..."""
_EXPLAINED = 0.7
"""... if the regression explains that much of the pitch rate."""
_OTHER: dict[InputKind, InputKind] = {"3-2-1-1": "reverse 3-2-1-1", "reverse 3-2-1-1": "3-2-1-1"}

SAID = (
    "The nose went the other way than the elevator's output suggests: its deflections count with the other "
    "sign. Give a calibration if that is wrong, as for a canard."
)


class Sense:
    """Turns an elevator of assumed scale the right way round: trailing edge down pitches down.

    Parameters of an autopilot say which way an output moves, not which way the surface is linked to it.
    The first manoeuvre that tells decides for all that follow.
    """

    def __init__(self) -> None:
        self.backwards: bool | None = None
        """What was found; None before a manoeuvre has told."""

    def right(self, maneuver: Maneuver) -> tuple[Maneuver, list[Notice]]:
        """Return the manoeuvre with the elevator the right way round; a notice where that is found out."""
        found = []
        if self.backwards is None:
            self.backwards = answers_backwards(maneuver)
            if self.backwards:
                found = [Notice("elevator_backwards", SAID)]
        return (turned(maneuver) if self.backwards else maneuver), found


def turned(maneuver: Maneuver) -> Maneuver:
    """Return the manoeuvre with the elevator's deflections the other way round."""
    elevator = maneuver.channels["elevator"]
    span = replace(
        maneuver.span,
        kind=_OTHER.get(maneuver.span.kind, maneuver.span.kind),
        steps=tuple((onset, -level) for onset, level in maneuver.span.steps),
    )
    return replace(
        maneuver, span=span, channels={**maneuver.channels, "elevator": replace(elevator, y=-elevator.y)}
    )


def answers_backwards(maneuver: Maneuver) -> bool | None:
    """Return whether a trailing edge that goes down lifts the nose, M_δe > 0; None where that is not sure.

    Least squares of the pitch rate on the integrals of elevator, pitch rate and angle of attack.
    """
    channels = maneuver.channels
    if "q" not in channels or len(channels["q"]) < 20:
        return None
    t, q = channels["q"].t, channels["q"].y
    motion = [np.interp(t, channels[n].t, channels[n].y) for n in ("elevator", "q", "alpha") if n in channels]
    X = np.column_stack([*(integrated(t, x - x[0]) for x in motion), t - t[0], np.ones(len(t))])
    scale = np.maximum(np.max(np.abs(X), axis=0), 1e-12)
    found, *_ = np.linalg.lstsq(X / scale, q, rcond=None)
    left: FloatArray = q - (X / scale) @ found
    variance = float(left @ left) / (len(q) - len(found))
    std = np.sqrt(variance * np.linalg.pinv((X / scale).T @ (X / scale))[0, 0])
    sure = abs(found[0]) > _SURELY * std and np.var(left) < (1.0 - _EXPLAINED) * np.var(q)
    return bool(found[0] > 0.0) if sure else None
