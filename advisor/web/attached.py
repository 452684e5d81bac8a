"""A campaign that the server conducts, as the process of a page sees it."""

from multiprocessing.connection import Connection
from threading import Event

from advisor.tui.changes import Changes
from advisor.tui.conducting import Report, Tell
from advisor.tui.hand import HandDecision
from advisor.tui.source import Order, Tempo

LOOK_EVERY_S = 0.1
"""Time after which a thread without news looks whether it shall stop, s."""


class ServerGoneError(Exception):
    """The server has ended, and with it the campaign that the page shows."""


class AttachedConductor:
    """A `Conducting` whose campaign runs in the server.

    Parameters
    ----------
    connection
        To the server, which has told its `Viewing` already.
    """

    def __init__(self, connection: Connection) -> None:
        self._connection = connection
        self._stopped = Event()

    def run(self, tell: Tell) -> None:
        """Hear reports until `stop`.

        Raises
        ------
        ServerGoneError
            The server has ended.
        Exception
            Whatever has broken the campaign off.
        """
        last: Report | None = None
        while not self._stopped.is_set():
            match self._hear():
                case Report() as first:
                    tell(last := first)
                case Changes() as changes if last is not None:
                    tell(last := changes.applied_to(last))
                case BaseException() as failure:
                    raise failure

    def stop(self) -> None:
        """End ``run`` at the next opportunity."""
        self._stopped.set()

    def decide(self, decision: HandDecision) -> None:
        """Exclude, include, note, mark, begin or end a marked manoeuvre."""
        self._ask("decide", decision)

    def order(self, order: Order) -> None:
        """Do what a crew wants of the link."""
        self._ask("order", order)

    def jump(self, number: int) -> None:
        """Play on, or from the beginning, to just before a manoeuvre."""
        self._ask("jump", number)

    def play(self, tempo: Tempo) -> None:
        """Hold a replay, let it go on, faster or slower."""
        self._ask("play", tempo)

    def step(self) -> None:
        """Play the next tenth of a second of a held replay."""
        self._ask("step")

    def _hear(self) -> object:
        """Return the next message of the server, or None when none came in time."""
        try:
            return self._connection.recv() if self._connection.poll(LOOK_EVERY_S) else None
        except (OSError, EOFError) as error:
            raise ServerGoneError("The server of this page has ended.") from error

    def _ask(self, name: str, *arguments: object) -> None:
        try:
            self._connection.send((name, arguments))
        except OSError:
            return  # the server has gone, which ``run`` tells
