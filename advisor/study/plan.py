"""A study: tasks that do not know of one another, and the report that their results make together."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Generic, Protocol, TypeVar

from advisor.study.figure import Curve


class Task(Protocol):
    """Some campaigns of a study, with everything that decides their result: the seed, too."""

    @property
    def campaigns(self) -> int:
        """How many campaigns the task flies."""


T = TypeVar("T", bound=Task)
R = TypeVar("R")


@dataclass(frozen=True, slots=True)
class Report:
    """What a study says."""

    lines: list[str]
    """To read."""
    document: dict[str, object]
    """To compute with."""
    curves: tuple[Curve, ...] = ()
    """Figure 5, where the study has one."""


@dataclass(frozen=True, slots=True)
class Study(Generic[T, R]):
    """Tasks, the work on one of them, and the report of all."""

    tasks: Sequence[T]
    work: Callable[[T], R]
    """A function of a module, so that other processes know it."""
    report: Callable[[Sequence[R]], Report]
    """Called with the results in the order of the tasks."""
