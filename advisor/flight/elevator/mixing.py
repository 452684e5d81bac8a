"""Elevator samples from several outputs, each output with the sign found from the aircraft's response.

Without a known sign of each output, a sum of the outputs could cancel their motion. The samples wait up to a
minute of the vehicle's clock for the signs from the pitch rate. All decisions follow the order of arrival, so
that live and replay decide at one sample.
"""

from collections.abc import Iterator

import numpy as np

from advisor.flight.elevator.commanded import Commanded, joined
from advisor.flight.elevator.output_signs import pitch_signs
from advisor.flight.maneuvers.events import Notice
from advisor.flight.signals.channels import Decoded
from advisor.flight.signals.tracks import Tracks
from advisor.flight.vehicle.surfaces import Surface, joined_numbers
from advisor.words.problems import Problem

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
