"""A conductor in a separate process, so that no estimate delays the screens."""

import os
import pickle
import signal
import sys
import traceback
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass, replace
from functools import partial
from queue import Empty, SimpleQueue
from subprocess import DEVNULL, PIPE, Popen
from threading import Event, Lock, Thread
from typing import IO, TYPE_CHECKING

from advisor.campaign.state import NOTHING, ByHand
from advisor.mavlink.link.health import LinkStatistics
from advisor.mavlink.link.kept_link import Door
from advisor.mavlink.link.observer import LinkObserver
from advisor.process import interrupt
from advisor.process.children import python_module
from advisor.process.liveness import Watch
from advisor.session.behind import BehindTeller
from advisor.session.conducting import Changes, Conducting, LinkHealth, SessionReport, Source, Tell
from advisor.session.live import renewed

if TYPE_CHECKING:
    from advisor.campaign.campaign import Campaign


_LONGEST_PAUSE_S = 10.0


def start_child(module: str, shows_errors: bool = False) -> "Popen[bytes]":
    """Start a module of the advisor as a process that exchanges pickles over its standard streams.

    Parameters
    ----------
    module
        Name of the module for ``python -m``.
    """
    return Popen(python_module(module), stdin=PIPE, stdout=PIPE, stderr=None if shows_errors else DEVNULL)


@contextmanager
def messages_to_parent() -> Iterator[IO[bytes]]:
    """Yield the pipe of messages to the parent of this process. An error is the last message."""
    interrupt.ignore()  # a signal is for the parent, which then ends this process in order
    # Closed at the end, after which the other side closes the requests.
    with suppress(BrokenPipeError), os.fdopen(os.dup(sys.stdout.fileno()), "wb") as messages:
        # A library's output must not fall among the messages.
        os.dup2(sys.stderr.fileno(), sys.stdout.fileno())
        try:
            yield messages
        except Exception as failure:
            failure.add_note(traceback.format_exc())
            send(messages, failure)


def send(pipe: IO[bytes], message: object) -> None:
    """Write a message immediately."""
    pickle.dump(message, pipe, pickle.HIGHEST_PROTOCOL)
    pipe.flush()


def said_of(code: int, watch: Watch) -> str:
    """Return a clause on the end of a process, from the exit code and the watch."""
    if watch.ended_after_s is not None:
        return f"did not answer for {watch.ended_after_s:.0f} s and was ended"
    if code >= 0:
        return f"ended with exit code {code}"
    try:
        return f"was killed by {signal.Signals(-code).name}"
    except ValueError:
        return f"was killed by signal {-code}"


def pause_s(deaths: int) -> float:
    """Return the pause before a process is restarted, s: zero at first, a second more after each death."""
    return min(deaths - 1.0, _LONGEST_PAUSE_S)


Request = tuple[str, tuple[object, ...]]
"""Request to the conductor: the name of a method of `Conducting`, and its arguments."""

_ENOUGH: Request = ("", ())
"""Empty request, which ends the thread that sends requests to the other process."""


@dataclass(frozen=True, slots=True)
class ConductorTask:
    """Task of a conductor in another process. All fields of the task must be picklable, because another
    process uses them."""

    open_source: Callable[[], Source]
    make_campaign: "Callable[[ByHand], Campaign]"
    by_hand: ByHand = NOTHING
    """Earlier decisions by hand of the engineer."""
    kept: Callable[[], ByHand] | None = None
    """Function that reads the decisions by hand since the start. None: the source cannot be read again from
    its beginning."""
    door: Door | None = None
    """Address of the link's process, from which the link's health comes without delay. None: the source has
    no process for a link."""
    first: SessionReport | None = None
    """Report that is shown until the other process sends one. None: no report is shown before."""


class RemoteConductor(Conducting):
    """A `Conducting` that sends requests to another process, and receives its reports.

    If the source can be read again from its beginning, the death of the other process does not end the
    campaign. The process is restarted, and the last report stays until the new process has caught up. A
    process that hangs is ended and restarted as well, and meanwhile the last report is shown with its age.
    The health of a link comes directly from the process of the link, so that a slow estimate never makes it
    old.

    Parameters
    ----------
    task : Task
        Task for the process that ``run`` starts.
    """

    def __init__(self, task: ConductorTask) -> None:
        self._task = task
        self._requests: SimpleQueue[Request] = SimpleQueue()
        self._last = task.first
        self._deaths: list[str] = []
        self._hangs = 0
        self._watch: Watch | None = None
        self._stopped = Event()
        self._lock = Lock()
        self._link: LinkStatistics | None = None
        self._age_s = 0.0
        """Age of the last report, s, if the estimating process does not answer; else 0."""
        self._behind = BehindTeller()
        self._observer: LinkObserver | None = None

    def run(self, tell: Tell) -> None:
        """Start the process and receive its reports until it ends.

        Raises
        ------
        UnusableInputError
            The input can never be used. Any other error of the other process is raised as well.
        RuntimeError
            The process was ended from outside, and the source cannot be read again.
        """
        with LinkObserver(self._task.door, partial(self._hear_link, tell)) as self._observer:
            self._conduct_to_the_end(tell)

    def stop(self) -> None:
        """End ``run`` at the next opportunity."""
        self._stopped.set()
        self.ask("stop")
        if self._watch is not None:
            self._watch.hurry()

    def ask(self, name: str, *arguments: object) -> None:
        """Send a request when a process can receive it."""
        self._requests.put((name, arguments))

    def _conduct_to_the_end(self, tell: Tell) -> None:
        """Run one process after another until one finishes its work."""
        while (ended := self._conduct(tell))[0]:
            if self._stopped.is_set():
                return
            if self._task.kept is None:
                raise RuntimeError(f"The estimating process ended with exit code {ended[0]}.")
            self._deaths.append(f"the estimating process {said_of(*ended)}; it is started again")
            self._tell_of_death(tell)
            self._stopped.wait(pause_s(len(self._deaths)))
            self._task = replace(self._task, by_hand=self._task.kept())

    def _conduct(self, tell: Tell) -> tuple[int, Watch]:
        """Run one process from its start to its end; return its exit code and its watch."""
        may_end = self._task.kept is not None
        with (
            start_child("advisor.session.worker") as process,
            Watch(process, partial(self._tell_of_age, tell), self._hangs if may_end else None) as watch,
        ):
            self._watch = watch
            if self._stopped.is_set():
                watch.hurry()
            assert process.stdin is not None
            assert process.stdout is not None
            asking = Thread(target=self._pass_on, args=(process.stdin,), daemon=True)
            asking.start()
            with suppress(EOFError, pickle.UnpicklingError):
                self._pass_back(process.stdout, tell, watch)
            self._requests.put(_ENOUGH)
            asking.join()
            self._keep_what_is_asked()
            with suppress(BrokenPipeError):
                process.stdin.close()  # upon which a process that has finished ends
            code = process.wait()
        self._hangs += watch.ended_after_s is not None
        return code, watch

    def _pass_on(self, pipe: IO[bytes]) -> None:
        """Send the task to the process, then every request. A request that cannot be sent is kept for the
        next process.
        """
        request = _ENOUGH
        with suppress(BrokenPipeError, ValueError):
            pickle.dump(self._task, pipe)
            pipe.flush()
            while (request := self._requests.get()) is not _ENOUGH:
                pickle.dump(request, pipe)
                pipe.flush()
        if request is not _ENOUGH:
            self._requests.put(request)

    def _keep_what_is_asked(self) -> None:
        """Remove the requests to the thread that has ended."""
        waiting = []
        with suppress(Empty):
            while True:
                waiting.append(self._requests.get_nowait())
        for request in waiting:
            if request is not _ENOUGH:
                self._requests.put(request)

    def _pass_back(self, pipe: IO[bytes], tell: Tell, watch: Watch) -> None:
        last: SessionReport | None = None
        while True:
            match pickle.load(pipe):
                case SessionReport() as first:
                    last = first
                case Changes() as changes if last is not None:
                    last = changes.applied_to(last)
                case BaseException() as failure:
                    raise failure
            if last is not None:
                watch.heard(patient=last.health.condition == "waiting")
                self._tell(last, tell)
                if last.health.condition == "ended":
                    watch.rest()

    def _tell(self, report: SessionReport, tell: Tell) -> None:
        """Report the state to the screens. During a catch-up only the health of the link is reported."""
        if self._deaths:
            report = replace(report, log=(*report.log, *self._deaths))
            if self._last is not None and report.health.condition == "waiting":
                report = replace(self._last, health=report.health, log=report.log)
        self._last, self._age_s = report, 0.0
        self._tell_last(tell)

    def _hear_link(self, tell: Tell, link: LinkStatistics) -> None:
        """Report the last state with the health of the link at this moment."""
        self._link = link
        self._tell_last(tell)

    def _tell_last(self, tell: Tell) -> None:
        """Report the last state with the newest health of the link, its backlog or its age."""
        with self._lock:
            report = self._last
            if report is None:
                return
            if self._link is not None:
                report = replace(report, health=renewed(report.health, self._link))
            sentence = self._behind.hear(report.health.behind_s)
            if sentence and self._observer is not None:
                self._observer.announce(sentence)
            if self._age_s and not report.health.behind:
                report = report.grown_old("ESTIMATOR", self._age_s)
            tell(report)

    def _tell_of_age(self, tell: Tell, age_s: float) -> None:
        self._age_s = age_s
        self._tell_last(tell)

    def _tell_of_death(self, tell: Tell) -> None:
        if self._last is not None:
            health = LinkHealth("waiting", f"{self._deaths[-1].capitalize()}.", self._last.health.figures)
            self._last = replace(self._last, health=health, log=(*self._last.log, self._deaths[-1]))
            self._age_s = 0.0
            self._tell_last(tell)
