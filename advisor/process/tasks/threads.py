"""One thread for linear algebra in each process."""

import os


def pin_linear_algebra() -> None:
    """Let libraries that are loaded later use one thread, unless the user asks for more.

    Matrices here are small, so that threads cost far more than they gain. The processes are the parallelism.
    """
    for library in ("OPENBLAS", "OMP", "MKL"):
        os.environ.setdefault(f"{library}_NUM_THREADS", "1")
