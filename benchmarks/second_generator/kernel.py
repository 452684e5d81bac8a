"""One decorator for everything that runs once a time step."""

from collections.abc import Callable
from typing import Any, TypeVar, cast

import numba
from numpy.typing import NDArray

Floats = NDArray[Any]  # of 64-bit floats; NumPy's own annotations are not that exact

Function = TypeVar("Function", bound=Callable[..., Any])


def kernel(function: Function) -> Function:
    """Compile with numba, keep the machine code on disk, and keep the function's own annotations."""
    return cast("Function", numba.njit(cache=True)(function))
