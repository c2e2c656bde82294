# SPDX-License-Identifier: Apache-2.0
"""C structs as dataclasses."""
from __future__ import annotations

import dataclasses
from typing import Any, TypeVar

T = TypeVar("T")


def fill(kind: type[T], struct: Any, /, **given: Any) -> T:
    """A dataclass whose fields default to those of a C struct."""
    names = [field.name for field in dataclasses.fields(kind)]
    values = {name: getattr(struct, name) for name in names if name not in given}
    return kind(**values, **given)
