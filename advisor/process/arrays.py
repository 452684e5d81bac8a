"""Types of the arrays that every room passes on.

The types stand apart from flight data, so that compiled functions import nothing else of the package.
"""

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]
