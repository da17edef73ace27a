"""Names for the kinds of arrays."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Counts = NDArray[np.int64]
Stamps = NDArray[np.uint64]
Flags = NDArray[np.bool_]
AnyArray = NDArray[Any]
