"""Tasks one after another or in several processes. A process that dies loses only its own task."""

import multiprocessing
import os
import sys
import threading
import warnings
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, BrokenExecutor, Executor, Future, ProcessPoolExecutor, wait
from functools import partial
from multiprocessing import resource_tracker
from multiprocessing.connection import wait as wait_for
from typing import Protocol, TypeVar

from advisor.process.children import spawning
from advisor.process.tasks.threads import pin_linear_algebra

T = TypeVar("T")
R = TypeVar("R")


class Runner(Protocol):
    """Does all tasks, and yields each with its result, or with the error that ended it, as completed."""

    def __call__(self, work: Callable[[T], R], tasks: Sequence[T]) -> Iterator[tuple[T, R | Exception]]:
        """Do all tasks. The work, the tasks and the results can be pickled."""


def run_here(work: Callable[[T], R], tasks: Sequence[T]) -> Iterator[tuple[T, R | Exception]]:
    """Do one task after another in this process."""
    for task in tasks:
        result: R | Exception
        try:
            result = work(task)
        except Exception as error:
            result = error
        yield task, result


def results_in_order(
    run: Runner, work: Callable[[T], R], tasks: Sequence[T], tell: Callable[[int], None]
) -> list[R]:
    """Do all tasks and return their results in the order of the tasks, whatever the order of completion.

    Parameters
    ----------
    tell
        Called with the index of each task in ``tasks`` when the task is done.

    Raises
    ------
    Exception
        The first error that ended a task.
    """
    results: dict[int, R] = {}
    for (place, _), result in run(partial(_unnumbered, work), list(enumerate(tasks))):
        if isinstance(result, Exception):
            raise result
        results[place] = result
        tell(place)
    return [results[place] for place in range(len(tasks))]


def _unnumbered(work: Callable[[T], R], numbered: tuple[int, T]) -> R:
    return work(numbered[1])


def processes(workers: int) -> Executor:
    """Return new processes, which ignore signals and end together with this process."""
    context = spawning()
    _start_silent_tracker()
    return ProcessPoolExecutor(workers, mp_context=context, initializer=_begin_worker)


def run_in_processes(
    work: Callable[[T], R], tasks: Sequence[T], workers: int, executor: Callable[[int], Executor] = processes
) -> Iterator[tuple[T, R | Exception]]:
    """Do all tasks; yield each with its result, or with the error that ended it, in the order of completion.

    Parameters
    ----------
    work
        Function of a task. Function, tasks and results can be pickled.

    Notes
    -----
    When a worker dies, its task cannot be told from those of the others. So each task that was under way
    then is done again by a worker of its own; the task whose worker dies again has killed it.
    """
    waiting = list(reversed(tasks))
    while waiting:
        suspects: list[T] = []
        yield from _until_broken(work, waiting, workers, executor, suspects)
        for task in suspects:
            yield task, _alone(work, task, executor)


def _until_broken(
    work: Callable[[T], R],
    waiting: list[T],
    workers: int,
    executor: Callable[[int], Executor],
    suspects: list[T],
) -> Iterator[tuple[T, R | Exception]]:
    """Do tasks from the end of ``waiting`` until all are done or a worker has died."""
    # At most one task per worker runs, so that a dead worker makes few tasks suspect.
    under_way: dict[Future[R], T] = {}
    with executor(min(workers, len(waiting))) as pool:
        while under_way or (waiting and not suspects):
            while waiting and not suspects and len(under_way) < workers:
                task = waiting.pop()
                try:
                    under_way[pool.submit(work, task)] = task
                except BrokenExecutor:
                    suspects.append(task)
            done, _ = wait(under_way, return_when=FIRST_COMPLETED)
            for future in done:
                task, error = under_way.pop(future), future.exception()
                if isinstance(error, BrokenExecutor):
                    suspects.append(task)
                elif isinstance(error, Exception):
                    yield task, error
                else:
                    yield task, future.result()


def _alone(work: Callable[[T], R], task: T, executor: Callable[[int], Executor]) -> R | Exception:
    with executor(1) as pool:
        try:
            return pool.submit(work, task).result()
        except Exception as error:
            return error


def _start_silent_tracker() -> None:
    """Start the process that removes the semaphores of an interrupted run, without its warning."""
    # The tracker of `multiprocessing` takes the warning options of the interpreter that starts the tracker.
    options = list(sys.warnoptions)
    sys.warnoptions.append("ignore")
    try:
        resource_tracker.ensure_running()
    finally:
        sys.warnoptions[:] = options


def _begin_worker() -> None:
    from advisor.process.interrupt import ignore

    ignore()
    warnings.simplefilter("ignore")  # as in the parent: warnings are for those who develop
    pin_linear_algebra()
    parent = multiprocessing.parent_process()
    if parent is not None:
        threading.Thread(target=_end_with, args=(parent.sentinel,), daemon=True).start()


def _end_with(sentinel: int) -> None:
    wait_for([sentinel])
    os._exit(1)
