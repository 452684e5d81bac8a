"""Type of the arrays that the simulator's modules exchange."""

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]
