"""The process behind a `RemoteConductor`: task and requests on standard input, reports on standard output.

python -m advisor.session.worker
"""

import pickle
import sys
from contextlib import suppress
from threading import Thread
from typing import IO

from advisor.session.conducting import SessionReport, changes
from advisor.session.conductor import Conductor
from advisor.session.remote import messages_to_parent, send


class Reporter:
    """Writes the first report, then the changes of each later one."""

    def __init__(self, pipe: IO[bytes]) -> None:
        self._pipe = pipe
        self._last: SessionReport | None = None

    def tell(self, report: SessionReport) -> None:
        send(self._pipe, report if self._last is None else changes(self._last, report))
        self._last = report


def serve(conductor: Conductor, requests: IO[bytes]) -> None:
    """Carry out requests, and stop when no process can send any more."""
    with suppress(EOFError):
        while True:
            name, arguments = pickle.load(requests)
            getattr(conductor, name)(*arguments)
    conductor.stop()


def main() -> None:
    """Run one campaign from its task to its end. An error that ends the campaign is the last message."""
    with messages_to_parent() as reports:
        task = pickle.load(sys.stdin.buffer)
        conductor = Conductor(task.open_source(), task.make_campaign, task.by_hand)
        Thread(target=serve, args=(conductor, sys.stdin.buffer)).start()
        conductor.run(Reporter(reports).tell)


if __name__ == "__main__":
    main()
