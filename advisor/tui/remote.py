"""A conductor in a process of its own, so that no estimate keeps the screens' interpreter busy."""

import pickle
import sys
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from queue import SimpleQueue
from subprocess import DEVNULL, PIPE, Popen
from threading import Thread
from typing import IO

from advisor.by_hand import NOTHING, ByHand
from advisor.tui.campaign_like import CampaignLike
from advisor.tui.changes import Changes
from advisor.tui.conducting import Report, Tell
from advisor.tui.hand import HandDecision
from advisor.tui.source import Order, Source, Tempo

Request = tuple[str, tuple[object, ...]]
"""Name of a method of `Conducting`, and its arguments."""


@dataclass(frozen=True, slots=True)
class Task:
    """What to conduct; used in the other process, so all of it must be picklable."""

    open_source: Callable[[], Source]
    make_campaign: Callable[[ByHand], CampaignLike]
    by_hand: ByHand = NOTHING
    """What was decided by hand before."""


class RemoteConductor:
    """A `Conducting` that passes on what it is asked, and passes back what it is told.

    Parameters
    ----------
    task : Task
        Given to the process that ``run`` starts.
    """

    def __init__(self, task: Task) -> None:
        self._task = task
        self._requests: SimpleQueue[Request] = SimpleQueue()

    def run(self, tell: Tell) -> None:
        """Start the process and hear it until it ends.

        Raises
        ------
        UnusableInputError
            When the input can never serve; and whatever else broke the other side off.
        RuntimeError
            When the process was ended from outside.
        """
        command = [sys.executable, "-m", "advisor.tui.worker"]
        with Popen(command, stdin=PIPE, stdout=PIPE, stderr=DEVNULL) as process:
            assert process.stdin is not None
            assert process.stdout is not None
            Thread(target=self._pass_on, args=(process.stdin,), daemon=True).start()
            with suppress(EOFError):
                _pass_back(process.stdout, tell)
        if process.returncode:
            raise RuntimeError(f"The estimating process ended with exit code {process.returncode}.")

    def stop(self) -> None:
        """End ``run`` at the next opportunity."""
        self._requests.put(("stop", ()))

    def decide(self, decision: HandDecision) -> None:
        """Exclude, include, note, mark, begin or end a marked manoeuvre."""
        self._requests.put(("decide", (decision,)))

    def order(self, order: Order) -> None:
        """Do what a crew wants of the link."""
        self._requests.put(("order", (order,)))

    def jump(self, number: int) -> None:
        """Play on, or from the beginning, to just before a manoeuvre."""
        self._requests.put(("jump", (number,)))

    def play(self, tempo: Tempo) -> None:
        """Hold a replay, let it go on, faster or slower."""
        self._requests.put(("play", (tempo,)))

    def step(self) -> None:
        """Play the next tenth of a second of a held replay."""
        self._requests.put(("step", ()))

    def _pass_on(self, pipe: IO[bytes]) -> None:
        """Hand over the task, then every request; a process that has ended needs none."""
        with suppress(BrokenPipeError, ValueError):
            pickle.dump(self._task, pipe)
            while True:
                pipe.flush()
                pickle.dump(self._requests.get(), pipe)


def _pass_back(pipe: IO[bytes], tell: Tell) -> None:
    last: Report | None = None
    while True:
        match pickle.load(pipe):
            case Report() as first:
                last = first
            case Changes() as changes if last is not None:
                last = changes.applied_to(last)
            case BaseException() as failure:
                raise failure
        if last is not None:
            tell(last)
