"""Child processes of this process, none of which imports a module from the current folder.

``python -m`` and the spawn method of `multiprocessing` put the current folder first on the path of modules. A
folder of logs may hold any file: a ``queue.py`` or ``socket.py`` there would replace Python's own module.
"""

import os
import sys
from multiprocessing.context import SpawnContext, SpawnProcess


class _Child(SpawnProcess):
    """Child process that ends on a signal that it cannot ignore.

    A pool whose worker has died calls ``terminate`` on the others and waits for them (Python 3.12 and later).
    Child processes of this program ignore SIGTERM, because their parent handles it.
    """

    def terminate(self) -> None:
        """End the child process immediately."""
        self.kill()


class _Spawning(SpawnContext):
    Process = _Child


def python_module(module: str) -> list[str]:
    """Return the command that runs a module of this program in a new process."""
    keep_current_folder_out()
    return [sys.executable, "-P", "-m", module]


def spawning() -> SpawnContext:
    """Return the `multiprocessing` context that starts new interpreters."""
    keep_current_folder_out()
    return _Spawning()


def keep_current_folder_out() -> None:
    """Prevent child processes from searching for modules in the current folder.

    `multiprocessing` passes neither an option nor a changed environment to its children, but children inherit
    this process's environment (Python, ``PYTHONSAFEPATH``).
    """
    os.environ["PYTHONSAFEPATH"] = "1"
