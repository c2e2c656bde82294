# SPDX-License-Identifier: Apache-2.0
"""Types that signatures share."""
from __future__ import annotations

import os
from typing import Any, Callable, Optional, Union

from numpy.typing import NDArray

#: A NumPy array; what it holds stands beside it.
Array = NDArray[Any]

PathLike = Union[str, bytes, "os.PathLike[str]", "os.PathLike[bytes]"]

#: Takes the name of a stage and its done fraction; returning False cancels the call.
Progress = Callable[[str, float], Optional[bool]]
