"""A campaign that runs in the server, for the process of a page."""

from multiprocessing.connection import Connection
from threading import Event

from advisor.process.liveness import OLD_AFTER_S
from advisor.session.conducting import Changes, Conducting, SessionReport, Tell

LOOK_EVERY_S = 0.1
"""Time after which a thread without messages tests whether to stop, s."""


class ServerGoneError(Exception):
    """The server has ended, and with it the campaign that the page shows."""


class AttachedConductor(Conducting):
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
        """Receive reports until `stop`.

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
        """End ``run`` at the next possible moment."""
        self._stopped.set()

    def _hear(self) -> object:
        """Return the next message of the server; None if none came in time."""
        try:
            return self._connection.recv() if self._connection.poll(LOOK_EVERY_S) else None
        except (OSError, EOFError) as error:
            raise ServerGoneError("The server of this page has ended.") from error

    def ask(self, name: str, *arguments: object) -> None:
        """Send a request to the server."""
        try:
            self._connection.send((name, arguments))
        except OSError:
            return  # the server has gone, which ``run`` tells
