"""Types of the arrays that all packages of the advisor exchange.

The types have their own module, so that compiled functions import nothing else of the package.
"""

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]
