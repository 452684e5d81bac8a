"""A campaign conducted by the server, as the process of a page sees it."""

from multiprocessing.connection import Connection
from threading import Event

from advisor.process.liveness import OLD_AFTER_S
from advisor.session.conducting import Changes, SessionReport, Tell
from advisor.session.hand import HandDecision
from advisor.session.source import LinkRequest, Tempo

LOOK_EVERY_S = 0.1
"""Time after which a thread without news tests whether to stop, s."""


class ServerGoneError(Exception):
    """The server has ended, and with it the campaign that the page shows."""


class AttachedConductor:
    """A `Conducting` whose campaign runs in the server.

    Parameters
    ----------
    connection
        Connection to the server, after its first message `Viewing`.
    """

    def __init__(self, connection: Connection) -> None:
        self._connection = connection
        self._stopped = Event()

    def run(self, tell: Tell) -> None:
        """Take reports until `stop`.

        Raises
        ------
        ServerGoneError
            The server has ended.
        Exception
            The error that ended the campaign.
        """
        last: SessionReport | None = None
        silent_s = 0.0
        while not self._stopped.is_set():
            news = self._hear()
            silent_s = silent_s + LOOK_EVERY_S if news is None else 0.0
            match news:
                case None if silent_s >= OLD_AFTER_S and last and last.health.condition != "ended":
                    tell(last.grown_old("SERVER", silent_s))
                case SessionReport() as first:
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

    def order(self, order: LinkRequest) -> None:
        """Carry out a crew's request to the link."""
        self._ask("order", order)

    def jump(self, number: int) -> None:
        """Play on to just before a manoeuvre, or play to it from the beginning."""
        self._ask("jump", number)

    def seek(self, position_s: float) -> None:
        """Play on to a position of the replay, s, or play to it from the beginning."""
        self._ask("seek", position_s)

    def play(self, tempo: Tempo) -> None:
        """Pause a replay, continue it, or change its speed."""
        self._ask("play", tempo)

    def step(self) -> None:
        """Play the next tenth of a second of a paused replay."""
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
