"""Request for one message's rate: the times of asking and of asking again."""

from dataclasses import dataclass

MOST_TRIES = 5
"""Requests in the first round, one for each second without an answer. Later rounds have one request."""
SHORTEST_REST_S, LONGEST_REST_S = 5.0, 60.0
"""Rest after a round without success, s, doubled with each round up to the second value. No message is given
up for good."""
AT_ONCE = 3
"""Falls of a granted rate that are answered with a request at once. After so many requests at once another
station may win."""
HELD_S = 60.0
"""Time for which a rate must hold before falls are counted anew, s."""


@dataclass(slots=True)
class MessageRequest:
    """State of the request for one message."""

    name: str
    message: int
    rate_hz: float
    answer: str = ""
    """``granted``, ``denied``, ``unsupported``, ``failed``, ``rejected for now`` or ``no answer``."""
    due_s: float = float("-inf")
    """Time of the next request, s; infinite while none is needed."""
    tries: int = 0
    rounds: int = 0
    """Rounds without success, or falls of a granted rate, in a row."""
    held_since_s: float = float("inf")

    def begin(self) -> None:
        """Begin with a vehicle without requests so far."""
        self.answer, self.due_s, self.tries, self.rounds = "", float("-inf"), 0, 0
        self.held_since_s = float("inf")

    @property
    def is_exhausted(self) -> bool:
        """Whether the round has used its requests."""
        return self.tries >= (1 if self.rounds else MOST_TRIES)

    def settle(self, answer: str, now_s: float) -> None:
        """Take the answer, or the absence of one."""
        self.answer, self.tries = answer, 0
        if answer == "granted":
            self.due_s = float("inf")
        else:
            self._rest(now_s, self.rounds)

    def fell(self, now_s: float) -> bool:
        """Take the fall of a granted rate; return True when the rate is requested again at once."""
        self.held_since_s = float("inf")
        if self.rounds < AT_ONCE:
            self.due_s, self.rounds = now_s, self.rounds + 1
            return True
        self._rest(now_s, self.rounds - AT_ONCE)
        return False

    def held(self, now_s: float) -> None:
        """Take a granted rate that is delivered."""
        self.held_since_s = min(self.held_since_s, now_s)
        if now_s - self.held_since_s >= HELD_S:
            self.rounds = 0

    def _rest(self, now_s: float, doubled: int) -> None:
        self.due_s = now_s + min(LONGEST_REST_S, SHORTEST_REST_S * 2.0 ** min(doubled, 10))
        self.rounds += 1
