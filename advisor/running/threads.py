"""One thread for linear algebra in each process."""

import os


def pin_linear_algebra() -> None:
    """Let the libraries that are loaded from here on use one thread, unless the user asks for more.

    Matrices here are small: threads cost far more than they bring, and processes are the parallelism.
    """
    for library in ("OPENBLAS", "OMP", "MKL"):
        os.environ.setdefault(f"{library}_NUM_THREADS", "1")
