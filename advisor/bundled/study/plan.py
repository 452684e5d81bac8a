"""A study: independent tasks, and the report that their results make together."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Generic, Protocol, TypeVar

from advisor.bundled.study.figure import Curve


class StudyTask(Protocol):
    """Some campaigns of a study, with everything that decides their result, including the seed."""

    @property
    def campaigns(self) -> int:
        """Number of campaigns in the task."""


T = TypeVar("T", bound=StudyTask)
R = TypeVar("R")


@dataclass(frozen=True, slots=True)
class StudyReport:
    """Result of a study."""

    lines: list[str]
    """Lines of text for people."""
    document: dict[str, object]
    """Numbers for programs."""
    curves: tuple[Curve, ...] = ()
    """Figure 5, where the study has one."""


@dataclass(frozen=True, slots=True)
class Study(Generic[T, R]):
    """Tasks, the work on one of them, and the report of all."""

    tasks: Sequence[T]
    work: Callable[[T], R]
    """Function of a module, so that other processes know it."""
    report: Callable[[Sequence[R]], StudyReport]
    """Function that is called with the results in the order of the tasks."""
