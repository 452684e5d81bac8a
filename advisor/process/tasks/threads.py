"""One thread for linear algebra in each process."""

import os


def pin_linear_algebra() -> None:
    """Let libraries that are loaded later use one thread, unless the user requests more.

    The matrices are small, so that threads cost far more time than they save. Parallel work is done by the
    processes instead of threads.
    """
    for library in ("OPENBLAS", "OMP", "MKL"):
        os.environ.setdefault(f"{library}_NUM_THREADS", "1")
