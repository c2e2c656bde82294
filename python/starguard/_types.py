# SPDX-License-Identifier: Apache-2.0
"""Types that signatures share."""
from __future__ import annotations

import os
from typing import Any, Callable, Optional, Union

from numpy.typing import NDArray

#: A NumPy array; its contents are documented beside it.
Array = NDArray[Any]

PathLike = Union[str, bytes, "os.PathLike[str]", "os.PathLike[bytes]"]

#: Receives the name of a stage and its completed fraction; return False to cancel the call, "enough" to
#: end a search, which returns its best result. True: a bar on standard error.
Progress = Union[bool, Callable[[str, float], Union[None, bool, str]]]
