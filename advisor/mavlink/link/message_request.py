"""Request for one message's rate, with the times of its repetitions."""

from dataclasses import dataclass

MOST_TRIES = 5
"""Number of requests in the first round, one for each second without an answer. Later rounds have one
request."""
SHORTEST_REST_S, LONGEST_REST_S = 5.0, 60.0
"""Rest after an unsuccessful round, s, doubled with each round up to the second value. The requests for a
message never end."""
AT_ONCE = 3
"""Number of falls of a granted rate that are answered by an immediate request. After this number of requests
another station is allowed to set the rate."""
HELD_S = 60.0
"""Time for which a rate must hold before its falls are counted anew, s."""


@dataclass(slots=True)
class MessageRequest:
    """State of the request for one message."""

    name: str
    message: int
    rate_hz: float
    answer: str = ""
    """Last answer: ``granted``, ``denied``, ``unsupported``, ``failed``, ``rejected for now`` or ``no
    answer``."""
    due_s: float = float("-inf")
    """Time of the next request, s; infinite if no request is needed."""
    tries: int = 0
    rounds: int = 0
    """Number of successive unsuccessful rounds, or of falls of a granted rate."""
    held_since_s: float = float("inf")

    def begin(self) -> None:
        """Reset the request for a vehicle without earlier requests."""
        self.answer, self.due_s, self.tries, self.rounds = "", float("-inf"), 0, 0
        self.held_since_s = float("inf")

    @property
    def is_exhausted(self) -> bool:
        """Whether the round has used its requests."""
        return self.tries >= (1 if self.rounds else MOST_TRIES)

    def settle(self, answer: str, now_s: float) -> None:
        """Take the answer to a request, or its absence."""
        self.answer, self.tries = answer, 0
        if answer == "granted":
            self.due_s = float("inf")
        else:
            self._rest(now_s, self.rounds)

    def fell(self, now_s: float) -> bool:
        """Record the fall of a granted rate, and return whether the rate is requested again at once."""
        self.held_since_s = float("inf")
        if self.rounds < AT_ONCE:
            self.due_s, self.rounds = now_s, self.rounds + 1
            return True
        self._rest(now_s, self.rounds - AT_ONCE)
        return False

    def held(self, now_s: float) -> None:
        """Note that a granted rate is delivered."""
        self.held_since_s = min(self.held_since_s, now_s)
        if now_s - self.held_since_s >= HELD_S:
            self.rounds = 0

    def _rest(self, now_s: float, doubled: int) -> None:
        self.due_s = now_s + min(LONGEST_REST_S, SHORTEST_REST_S * 2.0 ** min(doubled, 10))
        self.rounds += 1
