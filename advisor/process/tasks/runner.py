"""Interface of all ways to do tasks: each task returns with its result or its error."""

from collections.abc import Callable, Iterator, Sequence
from functools import partial
from typing import Protocol, TypeVar

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
