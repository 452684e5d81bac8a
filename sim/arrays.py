"""Type of the arrays that the simulator exchanges."""

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]
