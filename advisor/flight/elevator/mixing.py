"""Deflections that servo outputs command, output by output, and their sum with each output's sign.

Without a known sign of each output, a sum of the outputs could cancel their motion. The samples wait up to a
minute of the vehicle's clock for the signs from the pitch rate. All decisions follow the order of arrival, so
that live and replay decide at one sample.
"""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import product
from typing import Any

import numpy as np
from numpy.typing import NDArray

from advisor.flight.maneuvers.maneuver import Notice
from advisor.flight.signals.channels import Decoded, Pulses
from advisor.flight.signals.derived_alpha import integrated
from advisor.flight.signals.record import Channel
from advisor.flight.signals.tracks import Tracks
from advisor.flight.vehicle.surfaces import Surface, driven, joined_numbers
from advisor.process.arrays import FloatArray, IntArray
from advisor.words.problems import Problem


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


_SURELY = 9.0
"""Least value of twice the log likelihood ratio of both signs at which an output's sign is known. The number
of independent samples follows from the correlation of successive residuals. For eight aircraft with two
outputs that also roll, manoeuvres reach values of 10 to
120. A wrong sign never exceeded a value of 8."""
_LEAST_S = 4.0
"""Shortest flight from which the outputs' signs are determined, s. In records of one to three seconds slow
movements look alike, and a wrong sign reached a value of 22.
"""
_EXPLAINED = 0.7
"""Least share of the pitch rate's power that the regression must explain, as in ``elevator_sign.py``."""
_MOST = 8
"""Largest number of outputs whose signs are tried together, in 256 combinations."""


def pitch_signs(
    t: FloatArray,
    angles: FloatArray,
    shares: Sequence[float],
    q: Channel,
    alpha: Channel | None,
    singly: bool = False,
) -> list[bool | None]:
    """Return whether a positive deflection of each output raises the nose; None for a resting or uncertain
    output.

    The signs come from least squares of the pitch rate on the integrals of elevator, pitch rate and α. The
    elevator is the sum of all outputs, each with either sign. With the right signs the roll parts of elevons
    cancel and the pitch parts add up.

    Parameters
    ----------
    t
        Shape (n,): stamps of the outputs, s.
    angles
        Shape (n, k): deflection of each output, rad.
    shares
        Shares of the k outputs in the elevator's deflection.
    q, alpha
        Pitch rate, and angle of attack if any, over the time of the outputs.
    singly
        Whether an output with an uncertain sign is also regressed alone. Outputs that move in proportion
        explain the pitch rate with either sign, unless each is regressed alone.
    """
    n, k = len(q), angles.shape[1]
    unknown: list[bool | None] = [None] * k
    moves = np.ptp(angles, axis=0) > 0.0
    if n < 20 or k > _MOST or t[-1] - t[0] < _LEAST_S or not moves.any():
        return unknown
    outputs = np.column_stack([_integral(q.t, t, share * angles[:, i]) for i, share in enumerate(shares)])
    motion = [_integral(q.t, c.t, c.y) for c in (q, alpha) if c is not None]
    others, _ = np.linalg.qr(np.column_stack([*motion, q.t - q.t[0], np.ones(n)]))
    # The parts of the outputs and of the pitch rate that the aircraft's own motion and drifts leave.
    free = outputs - others @ (others.T @ outputs)
    left = q.y - others @ (others.T @ q.y)
    signs = np.array(list(product((1.0, -1.0), repeat=k)))
    remaining, residual = _fitted(signs, free, left)
    if not remaining.min() < (1.0 - _EXPLAINED) * n * np.var(q.y):
        return unknown
    up, down = (np.array([remaining[signs[:, i] == sign].min() for i in range(k)]) for sign in (1.0, -1.0))
    evidence = _independent(residual) * np.log(down / up)
    for i in np.flatnonzero(moves & (np.abs(evidence) <= _SURELY)) if singly else ():
        (rises, falls), residual = _fitted(np.array([[1.0], [-1.0]]), free[:, [i]], left)
        evidence[i] = _independent(residual) * np.log(falls / rises)
    if not np.all(np.abs(evidence[moves]) > _SURELY):
        return unknown
    return [bool(e > 0.0) if m else None for e, m in zip(evidence.tolist(), moves.tolist(), strict=True)]


def _fitted(signs: FloatArray, free: FloatArray, left: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return each combination's residual sum of squares (s,), and the residual of the best."""
    # A combination of signs is used only if its sum has a positive effect.
    power = np.maximum(np.einsum("si,ij,sj->s", signs, free.T @ free, signs), 1e-30)
    effect = np.maximum(signs @ (free.T @ left), 0.0) / power
    total = float(left @ left)
    remaining = np.maximum(total - effect**2 * power, 1e-12 * total)
    best = int(np.argmin(remaining))
    return remaining, left - effect[best] * (free @ signs[best])


def _independent(residual: FloatArray) -> float:
    """Return the number of independent samples with equal information about a mean, from the correlation at
    lag one.
    """
    power = float(residual @ residual)
    correlation = float(residual[1:] @ residual[:-1]) / power if power > 0.0 else 0.0
    correlation = min(max(correlation, 0.0), 1.0)
    return len(residual) * (1.0 - correlation) / (1.0 + correlation)


def _integral(at: FloatArray, t: FloatArray, y: FloatArray) -> FloatArray:
    """Return the integral over ``at``, from its first value, of a signal with samples ``y`` at ``t``."""
    on = np.interp(at, t, y)
    return integrated(at, on - on[0])


_WINDOW_S = 15.0
"""Length of the newest flight that is searched for the outputs' signs, s: a test input of a slow aircraft."""
_EVERY_S = 1.0
"""Time between two searches for the outputs' signs, s."""
_WAIT_S = 60.0
"""Longest time that samples wait for the outputs' signs, s: half of the time that channels are kept."""
_CHECK_SIGNS = (
    "Check the signs of the calibrations in elevator.outputs: a deflection that lowers the nose is positive."
)


class Mixing:
    """Elevator samples formed from several servo outputs."""

    def __init__(self, tracks: Tracks) -> None:
        self._tracks = tracks
        self._lifts: dict[int, bool] = {}
        self._answered = ""
        self.contradiction: Problem | None = None
        """Problem of signs in the aircraft file with which the outputs cancel; else None."""
        self.begin()

    def begin(self) -> None:
        """Begin another power-on of the vehicle."""
        self._recent: list[Commanded] = []
        self._waiting: list[Commanded] = []
        self._next_s = -np.inf
        self._open_since_s = -np.inf

    def said(self, surface: Surface) -> str:
        """Return a sentence about the signs of several outputs that the response has shown; empty if the
        signs were certain.
        """
        if self._answered or not surface.unsure:
            return self._answered
        listed = joined_numbers(surface.unsure)
        moves = f"outputs {listed} move" if len(surface.unsure) > 1 else f"output {listed} moves"
        return f"Nothing says which way {moves} the nose; the aircraft's response in MANUAL decides."

    def take(self, new: Commanded, loop_is_closed: bool) -> Iterator[Decoded | Notice]:
        """Yield elevator samples with known signs, and notices about the signs.

        Parameters
        ----------
        loop_is_closed
            Whether an autopilot closes a loop, so that the elevator answers the pitch rate.
        """
        surface = new.surface
        if self._waiting and self._waiting[0].surface != surface:
            yield from self.finish()
        if self._is_settled(surface):
            yield new.combined(self._turned(surface))
            return
        for piece, is_due in self._pieces(new):
            self._recent.append(piece)
            self._waiting.append(piece)
            if is_due and not self._is_settled(surface):
                yield from self._listen(surface, loop_is_closed)
            if not surface.unsure or self._is_settled(surface):
                yield from self.finish()
            elif is_due:
                yield from self._given_up(float(piece.t[-1]) - _WAIT_S)

    def finish(self) -> list[Decoded]:
        """Return all waiting elevator samples, with each output's present sign."""
        if not self._waiting:
            return []
        waiting, self._waiting = joined(self._waiting), []
        return [waiting.combined(self._turned(waiting.surface))]

    def _is_settled(self, surface: Surface) -> bool:
        """Return whether no further response could decide or contradict the signs."""
        is_asked = len(surface.parts) > 1 and (surface.calibrated or surface.unsure)
        return not is_asked or all(n in self._lifts for n in surface.outputs)

    def _turned(self, surface: Surface) -> list[int]:
        """Return the outputs with a reversed sign, if no other source gives all signs."""
        return [n for n in surface.outputs if self._lifts.get(n, False)] if surface.unsure else []

    def _pieces(self, new: Commanded) -> Iterator[tuple[Commanded, bool]]:
        """Yield the samples up to each time of a search for the signs, and whether a search is due."""
        start = 0
        while start < len(new.t):
            late = np.flatnonzero(new.t[start:] >= self._next_s)
            stop = start + int(late[0]) + 1 if len(late) else len(new.t)
            if len(late):
                self._next_s = float(new.t[stop - 1]) + _EVERY_S
            yield new.rows(slice(start, stop)), bool(len(late))
            start = stop

    def _given_up(self, before_s: float) -> list[Decoded]:
        """Return the elevator samples that have waited too long for the signs."""
        waiting = joined(self._waiting)
        old = waiting.t < before_s
        self._waiting = [waiting.rows(~old)]
        return [waiting.rows(old).combined(self._turned(waiting.surface))] if old.any() else []

    def _listen(self, surface: Surface, loop_is_closed: bool) -> list[Notice]:
        """Search the newest flight for the aircraft's response to each output, and return notices."""
        window = joined([piece for piece in self._recent if piece.surface == surface])
        now_s = float(window.t[-1])
        if loop_is_closed:
            self._open_since_s = now_s
        window = window.rows(window.t >= max(now_s - _WINDOW_S, self._open_since_s))
        self._recent = [window]
        t, first = np.unique(window.t, return_index=True)
        q, alpha = (self._tracks.cut(name, t[0], t[-1], int(window.order[-1])) for name in ("q", "alpha"))
        if q is not None:
            shares = [part.share for part in surface.parts]
            signs = pitch_signs(t, window.angles[first], shares, q, alpha, singly=bool(surface.unsure))
            for n, lifts in zip(surface.outputs, signs, strict=True):
                if lifts is not None:
                    self._lifts.setdefault(n, lifts)
        return self._tell(surface) if self._is_settled(surface) else []

    def _tell(self, surface: Surface) -> list[Notice]:
        turned = [n for n in surface.outputs if self._lifts[n]]
        listed = joined_numbers(turned)
        if surface.unsure:
            self._answered = (
                f"The aircraft's response in pitch decides: the sign of output {listed} is turned."
                if turned
                else "The aircraft's response in pitch decides: every output keeps its sign."
            )
        elif turned and len(turned) < len(surface.outputs):
            others = joined_numbers([n for n in surface.outputs if n not in turned])
            self._answered = (
                f"The aircraft pitches one way by output {listed} and the other way by output {others}, so "
                "the outputs cancel."
            )
            self.contradiction = Problem("elevator_signs", self._answered, _CHECK_SIGNS)
        return [Notice("elevator_mixing", self._answered)] if self._answered else []
