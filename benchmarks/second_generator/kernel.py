"""One decorator for everything that runs once a time step."""

from typing import Any

from numpy.typing import NDArray

import advisor.process.compiled as compiled

Floats = NDArray[Any]  # of 64-bit floats; NumPy's own annotations are not that exact

kernel = compiled.kernel()
