"""Guess of a control's servo output without a parameter, and the elevator's sign by the aircraft's
response.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from advisor.flight.maneuvers.maneuver import FlightEvent, InputKind, Maneuver, Notice
from advisor.flight.maneuvers.markers import MARKED
from advisor.flight.signals.derived_alpha import integrated
from advisor.flight.signals.messages import Columns
from advisor.flight.signals.record import Channel
from advisor.process.arrays import FloatArray

KEEP_S = 60.0
"""Length of flight that a guess of the elevator's output uses, s. The length holds two test inputs with their
pauses.
"""
EVERY_S = 10.0
"""Vehicle time between two guesses of the elevator's output, s."""
LATE_S = 1.0
"""Length of the newest flight that a guess leaves out, s, because its packets may still be on the way."""
SHORTEST_S = 5.0
"""Least length of flight for a guess of the elevator's output, s."""
LEAST_TRAVEL_US = 10.0
"""Least travel of an output for a guess, us, above the resolution of a pulse."""
LEAST_SHARE = 0.05
"""Least share of the pitch rate's one-step prediction error that the guessed output must explain. On the
recorded flights of this project elevators explain 0.06 (turbulence) to 0.9, and all other outputs at most
0.02.
"""
LEAST_LEAD = 5.0
"""Least ratio of the best output's share to the next output's share. At 4 Hz a wrong output led by 2.7."""
_OUTPUTS = 16
_MEMORY = 2
"""Number of past samples of pitch rate and output in the prediction: two, because a short period is of second
order."""


_SIDE_RATES: Mapping[str, tuple[str, str]] = {"aileron": ("p", "roll rate"), "rudder": ("r", "yaw rate")}
"""Channel and name of the rate that responds to a control of roll and yaw."""


@dataclass(frozen=True, slots=True)
class Guess:
    """Servo output that may be a control's, with its shares of the error of the control's rate."""

    output: int
    share: float
    """Share of the rate's one-step prediction error that the output explains."""
    next_share: float
    """Largest share of that error that any other output explains."""
    rate: str = "pitch rate"
    """Name of the rate that responds to the control."""

    def __str__(self) -> str:
        return (
            f"output {self.output} is a guess: it explains {100.0 * self.share:.0f} % of what moves the "
            f"{self.rate}, the next output {100.0 * self.next_share:.0f} %"
        )


class ElevatorGuess:
    """Memory of the outputs' movements, for a comparison with the pitch rate."""

    def __init__(self) -> None:
        self._t = np.empty(0)
        self._pulses = np.empty((0, _OUTPUTS))

    def hear(self, columns: Columns, t: FloatArray) -> None:
        """Take SERVO_OUTPUT_RAW messages of the first bank at their vehicle times, shape (n,)."""
        if columns.name != "SERVO_OUTPUT_RAW":
            return
        idle = np.zeros(len(columns))
        pulses = np.stack([columns.fields.get(f"servo{n}_raw", idle) for n in range(1, _OUTPUTS + 1)], axis=1)
        good = np.isfinite(t) & (np.asarray(columns.fields["port"]) == 0)
        self._t = np.concatenate((self._t, t[good]))
        self._pulses = np.concatenate((self._pulses, pulses[good].astype(np.float64)))
        if len(self._t):
            kept = self._t > self._t[-1] - 2.0 * KEEP_S
            self._t, self._pulses = self._t[kept], self._pulses[kept]

    def made(self, q: Channel | None, named: str = "pitch rate") -> Guess | None:
        """Return the guessed output from one stretch of a rate and the outputs; None if no guess is good
        enough."""
        if q is None or len(q) < 2:
            return None
        inside = (self._t >= q.t[0]) & (self._t <= q.t[-1])
        t, rows = np.unique(self._t[inside], return_index=True)
        if len(t) < 2 or t[-1] - t[0] < SHORTEST_S:
            return None
        step_s = max(float(np.median(np.diff(q.t))), float(np.median(np.diff(t))))
        grid = np.arange(t[0], t[-1], step_s)
        rate = np.interp(grid, q.t, q.y)
        shares = np.zeros(_OUTPUTS)
        for i, pulses in enumerate(self._pulses[inside][rows].T):
            if pulses.min() > 0.0 and np.ptp(pulses) >= LEAST_TRAVEL_US:
                shares[i] = _share(rate, np.interp(grid, t, pulses))
        best, following = (int(i) for i in np.argsort(shares)[::-1][:2])
        if shares[best] < LEAST_SHARE or shares[best] < LEAST_LEAD * shares[following]:
            return None
        return Guess(best + 1, float(shares[best]), float(shares[following]), named)


class ElevatorGuesses:
    """Series of guesses at fixed vehicle times, independent of the batches of messages.

    Parameters
    ----------
    sides
        Whether aileron and rudder are guessed as well.
    """

    def __init__(self, sides: bool = False) -> None:
        self.guesses_sides = sides
        self.sides: dict[str, Guess] = {}
        """Best guess of the aileron's and of the rudder's output."""
        self.newest: Guess | None = None
        """Newest guess of the elevator's output. The guess is kept over a power-on, because the wiring does
        not change."""
        self.begin()

    def begin(self) -> None:
        """Begin another power-on, or follow another vehicle."""
        self._outputs = ElevatorGuess()
        self._at_s = -np.inf

    def hear(self, columns: Columns, t: FloatArray) -> None:
        """Take servo output messages at their vehicle times, shape (n,)."""
        self._outputs.hear(columns, t)

    def advance(
        self, first_s: float, now_s: float, cut: Callable[[str, float, float], Channel | None]
    ) -> list[FlightEvent]:
        """Make every due guess of the elevator's output, and return an event for a new one.

        Parameters
        ----------
        first_s, now_s
            Vehicle times of the first and of the newest message since boot, s.
        cut
            Function that returns a stretch of a channel by name, start and end, s.
        """
        events: list[FlightEvent] = []
        next_s = max(self._at_s + EVERY_S, EVERY_S * np.ceil(first_s / EVERY_S))
        for at_s in np.arange(next_s, now_s, EVERY_S).tolist():
            self._at_s = at_s
            guess = self._outputs.made(cut("q", at_s - KEEP_S, at_s - LATE_S))
            if guess is not None and (self.newest is None or guess.output != self.newest.output):
                events.append(
                    Notice("elevator_guess", f"No parameter says which output is the elevator; {guess}.")
                )
            self.newest = guess or self.newest
            if self.guesses_sides:
                self._guess_sides(cut, at_s)
        return events

    def _guess_sides(self, cut: Callable[[str, float, float], Channel | None], at_s: float) -> None:
        for name, (channel, rate) in _SIDE_RATES.items():
            guess = self._outputs.made(cut(channel, at_s - KEEP_S, at_s - LATE_S), rate)
            earlier = self.sides.get(name)
            if guess is not None and (earlier is None or guess.share > earlier.share):
                self.sides[name] = guess


def _share(rate: FloatArray, moved: FloatArray) -> float:
    """Return the share of the one-step prediction error of the pitch rate that the past output explains."""
    alone = _left(rate[_MEMORY:], _past(rate))
    both = _left(rate[_MEMORY:], [*_past(rate), *_past(moved)])
    return 1.0 - both / alone if alone > 0.0 else 0.0


def _past(y: FloatArray) -> list[FloatArray]:
    centred = y - np.mean(y)
    return [centred[_MEMORY - k : len(y) - k] for k in range(1, _MEMORY + 1)]


def _left(y: FloatArray, regressors: Sequence[FloatArray]) -> float:
    """Return the residual sum of squares after a regression on the regressors and a constant."""
    columns = np.column_stack([*regressors, np.ones(len(y))])
    solution, *_ = np.linalg.lstsq(columns, y, rcond=None)
    left: float = float(np.sum((y - columns @ solution) ** 2))
    return left


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
