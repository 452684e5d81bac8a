"""A campaign without a screen: a separate process estimates, and this process prints lines.

    python -m advisor.cli.narrator

If the estimating process dies, the next process reads the source from its beginning and makes equal lines.
Lines that were printed before are not printed again.
"""

import os
import pickle
import sys
import warnings
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from contextlib import closing, suppress
from dataclasses import replace
from functools import partial
from math import inf, nan
from threading import Thread
from time import monotonic, sleep
from typing import IO, TYPE_CHECKING

import click

from advisor.flight.signals.messages import Columns
from advisor.mavlink.link.health import LinkStatistics
from advisor.mavlink.link.observer import LinkObserver
from advisor.process.liveness import Beat, Watch
from advisor.session.behind import BehindTeller, backlog_s
from advisor.session.conducting import Source
from advisor.session.remote import ConductorTask, messages_to_parent, pause_s, said_of, send, start_child
from advisor.words.problems import UnusableInputError, speak_plainly

if TYPE_CHECKING:
    from advisor.campaign.campaign import Campaign

READ_S = 0.2
BEAT_S = 0.5
"""Shortest time between two beats of the process that estimates, s."""


def narrate(task: ConductorTask, say: Callable[[str], object], warn: Callable[[str], object]) -> None:
    """Conduct a campaign in another process, to the end of its source.

    Parameters
    ----------
    task
        Campaign and source. The source must be readable again from its beginning.

    Raises
    ------
    UnusableInputError
        The source can never be used, or has ended without a manoeuvre to judge.
    """
    said: Counter[str] = Counter()
    deaths = hangs = 0
    backlog = Backlog(warn)
    with LinkObserver(task.door, backlog.hear_link) as backlog.observer:
        while (ended := _narrate_once(task, say, said, warn, hangs, backlog))[0]:
            deaths += 1
            hangs += ended[1].ended_after_s is not None
            warn(f"the estimating process {said_of(*ended)}; it is started again")
            sleep(pause_s(deaths))
            if task.kept is not None:
                task = replace(task, by_hand=task.kept())


class Backlog:
    """Warns when the estimating process falls behind the link."""

    def __init__(self, warn: Callable[[str], object]) -> None:
        self._warn, self._teller = warn, BehindTeller()
        self.observer: LinkObserver | None = None
        self.read_to_s = nan
        """Host time of the newest record that was given to the campaign, seconds since 1970."""

    def hear_link(self, link: LinkStatistics) -> None:
        """Receive the health of the link from the link's process."""
        if sentence := self._teller.hear(backlog_s(link, self.read_to_s)):
            self._warn(f"{sentence}: the newest line above is that old" if "behind" in sentence else sentence)
            if self.observer is not None:
                self.observer.announce(sentence)


def _narrate_once(
    task: ConductorTask,
    say: Callable[[str], object],
    said: "Counter[str]",
    warn: Callable[[str], object],
    hangs: int,
    backlog: Backlog,
) -> tuple[int, Watch]:
    """Run one process from its start to its end; return its exit code and its watch."""
    repeated = said.copy()
    old: list[float] = []

    def grow_old(age_s: float) -> None:
        if not old:
            warn(f"ESTIMATOR NOT ANSWERING for {age_s:.0f} s: the lines above are old")
        old.append(age_s)

    with (
        start_child("advisor.cli.narrator", shows_errors=True) as process,
        Watch(process, grow_old, hangs) as watch,
    ):
        assert process.stdin is not None
        assert process.stdout is not None
        try:
            with suppress(BrokenPipeError):
                pickle.dump(task, process.stdin)
                process.stdin.flush()
            with suppress(EOFError, pickle.UnpicklingError):
                while True:
                    message = pickle.load(process.stdout)
                    if isinstance(message, BaseException):
                        raise message
                    watch.heard(patient=isinstance(message, Beat) and message.busy)
                    old.clear()
                    if isinstance(message, Beat):
                        backlog.read_to_s = message.read_to_s
                        continue
                    if repeated[message] > 0:
                        repeated[message] -= 1
                        continue
                    said[message] += 1
                    say(message)
            return process.wait(), watch
        finally:
            with suppress(BrokenPipeError):
                process.stdin.close()  # upon which the other process ends, if it lives still
            watch.hurry()
            process.wait()


def narrate_here(
    source: Source,
    campaign: "Campaign",
    say: Callable[[str], object],
    beat: Callable[[Beat], object] | None = None,
) -> None:
    """Conduct a campaign in this process, to the end of its source.

    Parameters
    ----------
    beat
        Function that is called after each wait for data, at most every ``BEAT_S``. With None, a backlog is
        printed.

    Raises
    ------
    UnusableInputError
        The source can never be used, or has ended without a manoeuvre to judge.
    """
    from advisor.report.text import follow
    from advisor.session.replay import LogPlayer

    of_log = isinstance(source, LogPlayer)
    with closing(source):
        follow(_batches(source, beat or _printing_backlog()), campaign, say, of_log=of_log)
    if campaign.problems:
        raise UnusableInputError.of(campaign.problems[:1])


def _printing_backlog() -> Callable[[Beat], None]:
    """Return a function that receives the state of the link and prints a backlog on standard error."""
    teller = BehindTeller()

    def listen(beat: Beat) -> None:
        if sentence := teller.hear(beat.behind_s):
            click.echo(sentence, err=True)

    return listen


def _batches(source: Source, beat: Callable[[Beat], object]) -> Iterator[Sequence[Columns]]:
    told_s = -inf
    while (columns := source.read(READ_S)) is not None:
        if monotonic() - told_s >= BEAT_S:
            told_s = monotonic()
            health = source.health()
            beat(Beat(health.condition == "waiting", health.behind_s, health.read_to_s))
        for notice in source.take_notices():
            click.echo(f"link: {notice}", err=True)
        yield columns


def _end_with(requests: IO[bytes]) -> None:
    """End the work when the other process has ended, because nobody reads the estimates any more."""
    requests.read()
    os._exit(0)


def main() -> None:
    """Conduct one campaign from its task to its end. An error that ends the campaign is the last message."""
    from advisor.campaign.campaign import Campaign

    speak_plainly()
    warnings.simplefilter("ignore")  # as in the parent: warnings are for those who develop
    with messages_to_parent() as messages:
        task: ConductorTask = pickle.load(sys.stdin.buffer)
        Thread(target=_end_with, args=(sys.stdin.buffer,), daemon=True).start()
        campaign = task.make_campaign(task.by_hand)
        assert isinstance(campaign, Campaign)
        tell = partial(send, messages)
        narrate_here(task.open_source(), campaign, tell, tell)


if __name__ == "__main__":
    main()
