"""A simulator in a separate process, so that foreign code crashes or hangs only there."""

import importlib
import os
import signal
import sys
import tempfile
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import fields
from multiprocessing.connection import Connection
from typing import Any, NoReturn

import numpy as np

from advisor.process.children import spawning
from advisor.simulators.protocol import Condition, Increments, Inputs, Replay, Simulator
from advisor.words.problems import ConfigurationError, UnusableInputError

_GOODBYE_S = 1.0
"""Time that the process may take to end after its connection is closed, s."""
MOST_MEMORY_BYTES = 8 << 30
"""Largest address space of a simulator's process, bytes. Python with numerical libraries takes 2 GB of
addresses, JSBSim and FMUs with tables less than 1 GB more."""


class Isolated:
    """A simulator that is built and flown in another process.

    The parent imports no code of the simulator, and receives only numbers and text. The parent's start folder
    is last on the child's module path. Output that the child prints is discarded. The child and all its
    processes form a process group, which ends with the simulator. The child's memory is limited.

    Parameters
    ----------
    make : str
        ``module:name`` of the callable that builds the simulator.
    *arguments
        Arguments of ``make``, which must be picklable.
    speed_limit_s : float
        Largest wall time of one replay or linearisation.
    start_limit_s : float
        Largest wall time for building the simulator.

    Raises
    ------
    ConfigurationError
        The simulator cannot be built.
    UnusableInputError
        A method raises it if the simulator refuses, raises, crashes, returns no numbers, or takes too long.
    """

    def __init__(
        self,
        make: str,
        *arguments: Any,
        description: str,
        speed_limit_s: float = 20.0,
        start_limit_s: float = 60.0,
    ) -> None:
        self.description = description
        self.speed_limit_s = speed_limit_s
        self._start_limit_s = start_limit_s
        self._call = (make, arguments)
        self._folder = tempfile.TemporaryDirectory(prefix="advisor-simulator-", ignore_cleanup_errors=True)
        self._process: Any = None
        self._connection: Connection
        try:
            self.takes_increments, self.takes, self.notes = self._start()
        except UnusableInputError as error:
            self.close()
            raise ConfigurationError(str(error)) from None
        except BaseException:
            self.close()
            raise

    def replay(self, condition: Condition, inputs: Inputs, increments: Increments | None = None) -> Replay:
        """Trim at the condition, and fly the inputs as deviations from the trimmed controls."""
        columns, trim = self._ask("replay", condition, inputs, increments)
        return Replay(**{name: row and np.array(row) for name, row in columns.items()}, trim=trim)

    def linearise(self, condition: Condition) -> Mapping[str, float] | None:
        """Return dimensional short-period derivatives at the condition; None if the simulator has none."""
        derivatives: Mapping[str, float] | None = self._ask("linearise", condition)
        return derivatives

    def close(self) -> None:
        """End the process, and remove the simulator's temporary files."""
        self._end()
        self._folder.cleanup()

    def _start(self) -> tuple[bool, frozenset[str], tuple[str, ...]]:
        context = spawning()
        self._connection, theirs = context.Pipe()
        make, arguments = self._call
        process = context.Process(
            target=_serve, args=(theirs, self._folder.name, make, arguments), daemon=True
        )
        process.start()
        self._process = process
        theirs.close()
        takes_increments, takes, notes = self._answer("its start", self._start_limit_s)
        return bool(takes_increments), frozenset(map(str, takes)), tuple(map(str, notes))

    def _ask(self, method: str, *arguments: Any) -> Any:
        if self._process is None:
            self._start()
        try:
            self._connection.send((method, arguments))
        except (BrokenPipeError, ConnectionResetError):
            self._fallen(f"before a {method}")
        return self._answer(f"a {method}", self.speed_limit_s)

    def _answer(self, task: str, limit_s: float) -> Any:
        try:
            if not self._connection.poll(limit_s):
                self._end(at_once=True)
                raise UnusableInputError(
                    "simulator_slow",
                    f"{self.description} does not finish {task} within {limit_s:g} s.",
                    "Look in the simulator for an endless loop, or make its time step longer.",
                )
            kind, value = self._connection.recv()
        except (EOFError, ConnectionResetError):
            self._fallen(f"during {task}")
        except KeyboardInterrupt:
            self._end(at_once=True)
            raise
        if kind == "problem":
            raise value
        if kind == "raised":
            raise UnusableInputError(
                "simulator_failed",
                f"{self.description} fails in {task}: {value}.",
                "Run the simulator by itself with the same input, and fix what the simulator reports.",
            )
        return value

    def _fallen(self, when: str) -> NoReturn:
        self._process.join(_GOODBYE_S)
        code = self._process.exitcode or 0
        self._end(at_once=True)
        how = f"by signal {signal.Signals(-code).name}" if code < 0 else f"with exit code {code}"
        raise UnusableInputError(
            "simulator_crash",
            f"The process of {self.description} ended {when} {how}.",
            "The simulator's own code has failed: run the simulator by itself, or ask its maker.",
        ) from None

    def _end(self, at_once: bool = False) -> None:
        if self._process is None:
            return
        self._connection.close()
        if not at_once:
            self._process.join(_GOODBYE_S)
        _kill_group(self._process.pid)
        if self._process.is_alive():
            self._process.kill()
        self._process.join()
        self._process.close()
        self._process = None


def _serve(connection: Connection, folder: str, make: str, arguments: tuple[Any, ...]) -> None:
    """Build the simulator, and serve the parent's requests until the parent closes the connection."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    if os.name == "posix":
        os.setpgid(0, 0)
    _limit_memory()
    nowhere = os.open(os.devnull, os.O_RDWR)
    for descriptor in (0, 1, 2):
        os.dup2(nowhere, descriptor)
    tempfile.tempdir = folder
    sys.path.append(os.getcwd())

    def build() -> tuple[Simulator, tuple[bool, list[str], list[str]]]:
        module, name = make.split(":", 1)
        simulator = getattr(importlib.import_module(module), name)(*arguments)
        takes, notes = (sorted(map(str, getattr(simulator, name, ()))) for name in ("takes", "notes"))
        return simulator, (bool(simulator.takes_increments), takes, notes)

    kind, built = _outcome(build)
    if kind != "done":
        connection.send((kind, built))
        return
    simulator, abilities = built
    connection.send(("done", abilities))
    tasks = {
        "replay": lambda *given: _plain(simulator.replay(*given)),
        "linearise": lambda *given: _numbers(simulator.linearise(*given)),
    }
    while True:
        try:
            method, given = connection.recv()
        except (EOFError, OSError):
            break
        connection.send(_outcome(tasks[method], *given))
    simulator.close()


def _kill_group(leader: int) -> None:
    """End the simulator's process and all processes that it started."""
    if os.name == "posix":
        with suppress(OSError):  # nothing of it is left, or it died before it led a group
            os.killpg(leader, signal.SIGKILL)


def _limit_memory() -> None:
    """Limit the memory, so that only a too large simulator fails."""
    try:
        import resource
    except ImportError:  # Windows
        return
    hard = resource.getrlimit(resource.RLIMIT_AS)[1]
    most = MOST_MEMORY_BYTES if hard == resource.RLIM_INFINITY else min(hard, MOST_MEMORY_BYTES)
    with suppress(ValueError, OSError):
        resource.setrlimit(resource.RLIMIT_AS, (most, hard))


class _NoReplayError(Exception):
    """The simulator did not return a replay."""


def _outcome(task: Any, *given: Any) -> tuple[str, Any]:
    try:
        return "done", task(*given)
    except (UnusableInputError, ConfigurationError) as error:
        return "problem", error
    except _NoReplayError as error:
        return "raised", str(error)
    except (Exception, SystemExit) as error:
        # Exceptions of foreign code become text, because their classes do not exist in the parent.
        return "raised", " ".join(f"{type(error).__name__}: {error}".split())[:300].rstrip(".: ")


_OPTIONAL = ("a_x", "bank", "r", "p", "a_y", "beta")
"""Series of a replay that may be missing."""


def _plain(replay: Any) -> tuple[dict[str, list[float] | None], dict[str, float]]:
    """Return the checked series and trimmed controls of a replay as plain numbers."""
    return _columns(replay), _numbers(getattr(replay, "trim", None)) or {}


def _columns(replay: Any) -> dict[str, list[float] | None]:
    """Return the checked series of a replay as plain numbers."""
    rows: dict[str, list[float] | None] = {}
    for attribute in fields(Replay):
        if attribute.name == "trim":
            continue
        row = getattr(replay, attribute.name, None)
        if row is None and attribute.name not in _OPTIONAL:
            raise _NoReplayError(f"its replay has no {attribute.name}")
        rows[attribute.name] = None if row is None else _finite(row, attribute.name)
    lengths = {len(row) for row in rows.values() if row is not None}
    if len(lengths) != 1 or min(lengths) < 2:
        raise _NoReplayError(f"its replay's channels need equal lengths of at least 2, not {sorted(lengths)}")
    if not np.all(np.diff(np.array(rows["t"])) > 0.0):
        raise ValueError("the times t of its replay do not ascend")
    return rows


def _finite(row: Any, name: str) -> list[float]:
    values = np.asarray(row, dtype=float)
    if values.ndim != 1:
        raise _NoReplayError(f"its replay's {name} has {values.ndim} dimensions, not 1")
    if not np.all(np.isfinite(values)):
        raise _NoReplayError(
            f"its replay's {name} is not finite from sample {int(np.argmin(np.isfinite(values)))}"
        )
    return [float(value) for value in values]


def _numbers(derivatives: Mapping[str, float] | None) -> dict[str, float] | None:
    return None if derivatives is None else {str(name): float(v) for name, v in derivatives.items()}
