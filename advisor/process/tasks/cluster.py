"""Tasks on an existing Dask cluster, whose scheduler repeats the tasks of a worker that dies."""

import asyncio
import logging
import time
import warnings
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import BrokenExecutor, CancelledError, Future, as_completed
from contextlib import contextmanager
from importlib.util import find_spec
from typing import TYPE_CHECKING, Any, TypeVar
from urllib.parse import urlsplit

from advisor.words.problems import ConfigurationError

if TYPE_CHECKING:
    from distributed import Client

T = TypeVar("T")
R = TypeVar("R")
Versions = Mapping[str, str | None]

CONNECT_S = 5.0
"""Longest time, s, for a scheduler's answer, and for the start of the cluster's workers."""
_SAME = ("advisor", "python")
"""Packages whose version must be equal in every worker. With another version of these packages the results
differ or cannot be read."""
_ADVISOR = ("inflight-advisor", "advisor")
"""Names under which Dask may list the advisor. Since 2025 Dask lists the distribution's name, before the
module's.
"""
_TOLD = ("distributed", "numba", "numpy", "scipy")
"""Packages of which another version may change the last digits of a result."""


def run_on_cluster(
    work: Callable[[T], R], tasks: Sequence[T], address: str, tell: Callable[[str], None]
) -> Iterator[tuple[T, R | Exception]]:
    """Do all tasks; yield each with its result, or with the error that ended it, in the order of completion.

    Parameters
    ----------
    work
        Function of a task. Function, tasks and results can be pickled.
    address
        Address of the scheduler: ``tcp://host:port``.
    tell
        Called with a sentence where a difference of versions may change the last digits.

    Raises
    ------
    ConfigurationError
        Dask is not installed, no scheduler answers, the cluster has no worker or another advisor, or the
        connection is lost.

    Notes
    -----
    The scheduler gives the tasks of a dead worker to another: its task cannot be told from those that waited
    for the same worker. So a task whose workers died again and again is done once more alone at the end; the
    task whose workers die then, too, has killed them and ends with a ``BrokenExecutor``.
    """
    if not tasks:
        return
    with _connected(address) as client:
        versions = _versions_on(client)
        if not versions["workers"]:
            raise ConfigurationError(
                f"--scheduler: the cluster at {address} has no workers;"
                f" start some with 'dask worker {address}'."
            )
        workers = {worker: _named(there["packages"]) for worker, there in versions["workers"].items()}
        if caution := compare_versions(_named(versions["client"]["packages"]), workers):
            tell(caution)
        pool = client.get_executor(pure=False)
        try:
            futures = {pool.submit(_pinned, work, task): task for task in tasks}
            suspects = []
            for future in as_completed(futures):
                task, result = futures.pop(future), _outcome(future, address)
                if isinstance(result, BrokenExecutor):
                    suspects.append(task)
                else:
                    yield task, result
            for task in suspects:
                yield task, _outcome(pool.submit(_pinned, work, task), address)
        finally:
            pool.shutdown(wait=False)


def check_address(address: str) -> None:
    """Refuse an address without a scheduler's scheme, host and port, and a computer without Dask.

    Raises
    ------
    ConfigurationError
        The address cannot be used, or Dask is not installed.
    """
    if find_spec("distributed") is None or find_spec("threadpoolctl") is None:
        raise ConfigurationError("--scheduler needs Dask: pip install 'inflight-advisor[cluster]'.")
    try:
        parts = urlsplit(address)
        complete = parts.scheme in ("tcp", "tls") and bool(parts.hostname) and bool(parts.port)
    except ValueError:
        complete = False
    if not complete:
        raise ConfigurationError(f"--scheduler: {address} is no address; give one as tcp://host:8786.")


@contextmanager
def _connected(address: str) -> "Iterator[Client]":
    from distributed import Client

    for name in ("distributed", "distributed.client"):  # what users need to know is told in one sentence
        logging.getLogger(name).setLevel(logging.CRITICAL + 1)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # differing versions are told by this module
            asyncio.run(asyncio.wait_for(_answer(address), CONNECT_S))
            client = Client(address, timeout=CONNECT_S, set_as_default=False)
    except (OSError, ValueError) as error:
        raise ConfigurationError(
            f"--scheduler: no Dask scheduler answers at {address} ({_cause(error)}). Start one with"
            " 'dask scheduler', or correct the address."
        ) from None
    with client:
        yield client


def _versions_on(client: "Client") -> dict[str, Any]:
    """Return the packages' versions in client and workers, which have ``CONNECT_S`` to answer first."""
    end = time.monotonic() + CONNECT_S
    while True:
        # Dask tells Python's version unasked, and none where it is asked for a package of that name.
        versions: dict[str, Any] = client.get_versions(packages=[*_ADVISOR, *_TOLD])
        if versions["workers"] or time.monotonic() > end:
            return versions
        time.sleep(0.1)


async def _answer(address: str) -> None:
    """Connect to the scheduler once. The Dask client itself would wait for ever at a silent port."""
    from distributed.comm import connect
    from distributed.security import Security

    comm = await connect(address, timeout=CONNECT_S, **Security().get_connection_args("client"))
    await comm.close()


def _cause(error: BaseException) -> str:
    """Return the innermost reason of an error, in a few words."""
    while error.__cause__ is not None and type(error.__cause__) is not asyncio.CancelledError:
        error = error.__cause__
    if isinstance(error, TimeoutError):
        return f"nothing within {CONNECT_S:.0f} s"
    return str(error).splitlines()[0] if str(error) else type(error).__name__


def _named(packages: Versions) -> Versions:
    return {**packages, "advisor": next(filter(None, map(packages.get, _ADVISOR)), None)}


def compare_versions(here: Versions, workers: Mapping[str, Versions]) -> str:
    """Compare the package versions in the workers with those of this computer.

    Parameters
    ----------
    here
        Version of each package; None for a missing package.

    Returns
    -------
    str
        A caution in one sentence; empty if all versions are equal.

    Raises
    ------
    ConfigurationError
        A worker has no advisor, another advisor, or another Python.
    """
    differing: dict[str, str] = {}
    for worker, there in workers.items():
        for name in (*_SAME, *_TOLD):
            mine, other = _version(here, name), _version(there, name)
            if mine != other or (other is None and name in _SAME):
                difference = f"{name} {other} on {worker}, {mine} here" if other else f"no {name} on {worker}"
                differing.setdefault(name, difference)
    refused = [difference for name, difference in differing.items() if name in _SAME]
    if refused:
        raise ConfigurationError(
            f"--scheduler: workers need this advisor and this Python, but there is {'; '.join(refused)}. "
            "Install this computer's versions on the workers."
        )
    return f"Results may differ in the last digits: {'; '.join(differing.values())}." if differing else ""


def _version(versions: Versions, name: str) -> str | None:
    """Return the version of a package. The version of Python lacks its last part, which changes no result."""
    version = versions.get(name)
    return ".".join(version.split(".")[:2]) if version and name == "python" else version


def _outcome(future: "Future[R]", address: str) -> R | Exception:
    from distributed import KilledWorker

    try:
        return future.result()
    except CancelledError:
        raise ConfigurationError(
            f"--scheduler: the connection to {address} is lost."
            " Repeat the command when the scheduler is back."
        ) from None
    except KilledWorker as error:
        return BrokenExecutor(str(error))
    except Exception as error:
        return error


def _pinned(work: Callable[[T], R], task: T) -> R:
    """Do a task in a worker, with one thread for linear algebra, because the workers are the parallelism."""
    import scipy.linalg  # noqa: F401  # brings the libraries that are limited next
    from threadpoolctl import threadpool_limits

    threadpool_limits(1)
    return work(task)
