"""Elevator samples out of several outputs, each counted the way in which the aircraft answers to it.

Where neither a calibration nor a parameter tells the sense of an output, adding outputs could cancel
them. Their samples then wait until the pitch rate has told, at most a minute of the vehicle's clock.
All is decided in the order of arrival, so that live and replay decide at the same sample.
"""

from collections.abc import Iterator

import numpy as np

from advisor.flight.answer import answers
from advisor.flight.channels import Decoded
from advisor.flight.commanded import Commanded, joined
from advisor.flight.events import Notice
from advisor.flight.surfaces import Surface, joined_numbers
from advisor.flight.tracks import Tracks
from advisor.problems import Problem

_WINDOW_S = 15.0
"""The answer is looked for in so much of the newest flight: a test input of a slow aircraft."""
_EVERY_S = 1.0
"""... once in this time."""
_WAIT_S = 60.0
"""Longest time that samples wait for the answer: half of what the channels keep."""
_CHECK_SIGNS = (
    "Check the signs of the calibrations in elevator.outputs: a deflection that lowers the nose is positive."
)


class Mixing:
    """Forms the elevator's samples.

    Parameters
    ----------
    tracks
        The vehicle's channels.
    """

    def __init__(self, tracks: Tracks) -> None:
        self._tracks = tracks
        self._lifts: dict[int, bool] = {}
        self._answered = ""
        self.contradiction: Problem | None = None
        """What is wrong where the signs of the aircraft file make the outputs cancel; else None."""
        self.begin()

    def begin(self) -> None:
        """Another power-on of the vehicle."""
        self._recent: list[Commanded] = []
        self._waiting: list[Commanded] = []
        self._next_s = -np.inf
        self._open_since_s = -np.inf

    def said(self, surface: Surface) -> str:
        """What is known of the sense of several outputs, in a sentence; empty where nothing is in doubt."""
        if self._answered or not surface.unsure:
            return self._answered
        listed = joined_numbers(surface.unsure)
        moves = f"outputs {listed} move" if len(surface.unsure) > 1 else f"output {listed} moves"
        return f"Nothing says which way {moves} the nose; the aircraft's answer in MANUAL decides."

    def take(self, new: Commanded, loop_is_closed: bool) -> Iterator[Decoded | Notice]:
        """Yield the elevator's samples that are known by now, and what was found out on the way.

        Parameters
        ----------
        new
            Newest samples of the outputs.
        loop_is_closed
            Whether an autopilot moves the elevator by itself, so that its movements answer the pitch rate.
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
        """Return all that wait, each output with the sign that is known by now."""
        if not self._waiting:
            return []
        waiting, self._waiting = joined(self._waiting), []
        return [waiting.combined(self._turned(waiting.surface))]

    def _is_settled(self, surface: Surface) -> bool:
        """Return whether an answer could neither decide nor contradict any more."""
        is_asked = len(surface.parts) > 1 and (surface.calibrated or surface.unsure)
        return not is_asked or all(n in self._lifts for n in surface.outputs)

    def _turned(self, surface: Surface) -> list[int]:
        """Return outputs that count with the other sign: only where nothing else tells the sense of all."""
        return [n for n in surface.outputs if self._lifts.get(n, False)] if surface.unsure else []

    def _pieces(self, new: Commanded) -> Iterator[tuple[Commanded, bool]]:
        """Yield the samples up to each time at which the answer is looked for, and whether it is due."""
        start = 0
        while start < len(new.t):
            late = np.flatnonzero(new.t[start:] >= self._next_s)
            stop = start + int(late[0]) + 1 if len(late) else len(new.t)
            if len(late):
                self._next_s = float(new.t[stop - 1]) + _EVERY_S
            yield new.rows(slice(start, stop)), bool(len(late))
            start = stop

    def _given_up(self, before_s: float) -> list[Decoded]:
        """What has waited too long."""
        waiting = joined(self._waiting)
        old = waiting.t < before_s
        self._waiting = [waiting.rows(~old)]
        return [waiting.rows(old).combined(self._turned(waiting.surface))] if old.any() else []

    def _listen(self, surface: Surface, loop_is_closed: bool) -> list[Notice]:
        """Look for the aircraft's answer to each output in the newest flight."""
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
            told = answers(t, window.angles[first], shares, q, alpha, singly=bool(surface.unsure))
            for n, lifts in zip(surface.outputs, told, strict=True):
                if lifts is not None:
                    self._lifts.setdefault(n, lifts)
        return self._tell(surface) if self._is_settled(surface) else []

    def _tell(self, surface: Surface) -> list[Notice]:
        turned = [n for n in surface.outputs if self._lifts[n]]
        listed = joined_numbers(turned)
        if surface.unsure:
            self._answered = (
                f"The aircraft's answer in pitch decides: the sign of output {listed} is turned."
                if turned
                else "The aircraft's answer in pitch decides: no output's sign is turned."
            )
        elif turned and len(turned) < len(surface.outputs):
            others = joined_numbers([n for n in surface.outputs if n not in turned])
            self._answered = (
                f"The aircraft answers in pitch to output {listed} the other way than to output {others}, so "
                "they cancel."
            )
            self.contradiction = Problem("elevator_signs", self._answered, _CHECK_SIGNS)
        return [Notice("elevator_mixing", self._answered)] if self._answered else []
