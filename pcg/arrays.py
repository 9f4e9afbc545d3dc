"""Names for NumPy arrays by the type of their elements; shapes stand beside each argument."""

import numpy as np
import numpy.typing as npt

BoolArray = npt.NDArray[np.bool_]
IntArray = npt.NDArray[np.int64]
FloatArray = npt.NDArray[np.float64]
Float32Array = npt.NDArray[np.float32]
Int16Array = npt.NDArray[np.int16]
Int32Array = npt.NDArray[np.int32]
ByteArray = npt.NDArray[np.uint8]
WordArray = npt.NDArray[np.uint64]
