# SPDX-License-Identifier: Apache-2.0
"""The kernel of a solid: the points that see all of it."""
from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from ._choice import word_of
from ._library import ffi, lib
from ._session import Session
from ._told import Told
from ._types import Array, Progress
from .mesh import as_mesh

_VERDICTS = {"interior": lib.STARG_KERNEL_INTERIOR, "empty": lib.STARG_KERNEL_EMPTY,
             "undecided": lib.STARG_KERNEL_UNDECIDED}


@dataclass(frozen=True, eq=False, repr=False)
class Kernel(Told):
    """The kernel of a solid and the verdict whether it is star-shaped."""

    #: "interior" (star-shaped: proven), "empty" (not star-shaped: proven) or "undecided".
    verdict: str
    #: Centre of the largest ball in the kernel, (3,), and its radius.
    guard: Array
    radius: float
    #: When empty: at most four faces such that no point is strictly on the inner side of all.
    witness: Array

    @property
    def star(self) -> bool | None:
        """The verdict as bool; None when undecided."""
        return {"interior": True, "empty": False}.get(self.verdict)


def kernel(model: Any, *, trust_closed: bool = False, threads: int | None = None,
           time_limit: float | None = None, progress: Progress | None = None) -> Kernel:
    """Computes the kernel of a closed, outward oriented mesh; both verdicts are exact proofs.

    >>> import starguard
    >>> room = starguard.kernel(starguard.sample("l-room", vertices=500))
    >>> room.star, room.verdict
    (True, 'interior')
    """
    mesh = as_mesh(model)
    session = Session(threads)
    options = ffi.new("starg_kernel_options *")
    lib.starg_kernel_options_default(options)
    options.trust_closed = trust_closed
    result = ffi.new("starg_kernel_result *")
    session.call(lib.starg_kernel, session.context, mesh._handle, options, result,
                 progress=progress, time_limit=time_limit)
    return Kernel(word_of(result.verdict, _VERDICTS), np.array(list(result.guard)), result.radius,
                  np.array(ffi.unpack(result.witness, result.witness_count), np.uint32))
