"""The process behind a `RemoteConductor`: task and requests on standard input, reports on standard output.

python -m advisor.session.worker
"""

import os
import pickle
import sys
import traceback
from contextlib import suppress
from threading import Thread
from typing import IO

from advisor.process import interrupt
from advisor.session.conducting import SessionReport, changes
from advisor.session.conductor import Conductor


class Reporter:
    """Writes the first report, then the changes of each later one."""

    def __init__(self, pipe: IO[bytes]) -> None:
        self._pipe = pipe
        self._last: SessionReport | None = None

    def tell(self, report: SessionReport) -> None:
        """Send one report."""
        self.send(report if self._last is None else changes(self._last, report))
        self._last = report

    def send(self, message: object) -> None:
        """Write a message immediately."""
        pickle.dump(message, self._pipe, pickle.HIGHEST_PROTOCOL)
        self._pipe.flush()


def serve(conductor: Conductor, requests: IO[bytes]) -> None:
    """Carry out requests, and stop when no process can send any more."""
    with suppress(EOFError):
        while True:
            name, arguments = pickle.load(requests)
            getattr(conductor, name)(*arguments)
    conductor.stop()


def main() -> None:
    """Run one campaign from its task to its end. An error that ends the campaign is the last message."""
    # A signal is for the screens, which then stop this process in order.
    interrupt.ignore()
    # Closed at the end, after which the other side closes the requests and ``serve`` returns.
    with suppress(BrokenPipeError), os.fdopen(os.dup(sys.stdout.fileno()), "wb") as reports:
        # A library's output must not fall among the reports.
        os.dup2(sys.stderr.fileno(), sys.stdout.fileno())
        reporter = Reporter(reports)
        try:
            task = pickle.load(sys.stdin.buffer)
            conductor = Conductor(task.open_source(), task.make_campaign, task.by_hand)
            Thread(target=serve, args=(conductor, sys.stdin.buffer)).start()
            conductor.run(reporter.tell)
        except Exception as failure:
            failure.add_note(traceback.format_exc())
            reporter.send(failure)


if __name__ == "__main__":
    main()
