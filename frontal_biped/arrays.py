"""The array type used in signatures."""

import numpy as np
import numpy.typing as npt

FloatArray = npt.NDArray[np.float64]
"""A NumPy array of doubles; docstrings state its shape and units."""
