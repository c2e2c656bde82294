# SPDX-License-Identifier: Apache-2.0
"""Set cover on bit rows: the fewest rows whose union contains every column, with a proven bound."""
from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from . import _arrays
from ._choice import choose, give
from ._fields import fill
from ._library import ffi, lib
from ._session import Session
from ._told import Told
from ._types import Array, Progress
from .errors import ArgumentError
from .visibility import Bits

_METHODS = {"greedy": lib.STARG_COVER_GREEDY, "ilp": lib.STARG_COVER_ILP, "lp": lib.STARG_COVER_LP,
            "local": lib.STARG_COVER_LOCAL}


@dataclass(frozen=True, eq=False, repr=False)
class Cover(Told):
    """A cover and its proven bounds."""

    #: The chosen rows, largest gain first. No copy.
    rows: Array
    weight: int
    #: No choice of as many rows covers more than this.
    weight_bound: int
    #: No fewer rows cover as much.
    lower_bound: int
    optimal: bool
    target_reached: bool
    time_limited: bool
    nodes: int
    #: Prices of the columns if requested, else None. No copy.
    prices: Array | None
    _handle: Any = field(repr=False)


def cover(matrix: Bits | ArrayLike, *, method: str | None = None, weights: ArrayLike | None = None,
          target: int | None = None, redundancy: int | None = None, max_rows: int | None = None,
          given: ArrayLike | None = None, max_nodes: int | None = None, prices: bool = False,
          threads: int | None = None, time_limit: float | None = None,
          progress: Progress | None = None) -> Cover:
    """Finds the fewest rows that contain every column of any row.

    `method` is "ilp", "lp" or "greedy". `weights` (whole numbers) are column weights, `target` is
    the weight to cover; every column is covered `redundancy` times if possible; `max_rows` maximizes
    the weight of that many rows; the rows `given` are always in the cover.

    >>> import starguard
    >>> found = starguard.cover([[1, 1, 0, 0], [0, 1, 1, 0], [0, 0, 1, 1]])
    >>> found.rows, found.lower_bound, found.optimal
    (array([0, 2], dtype=uint32), 2, True)
    """
    bits = matrix if isinstance(matrix, Bits) else Bits.of(matrix)
    session = Session(threads)
    problem = ffi.new("starg_cover_problem *")
    lib.starg_cover_problem_default(problem)
    problem.rows = bits._handle
    if weights is not None:
        whole = _arrays.given(weights, "weights")
        if whole.shape != (bits.shape[1],) or whole.dtype.kind not in "iu" or np.any(whole < 0):
            raise ArgumentError(f"weights must be {bits.shape[1]} whole numbers, none negative")
        weights_pointer = _arrays.pointer("uint64_t[]", np.ascontiguousarray(whole, np.uint64))
        problem.weights = weights_pointer
    if given is not None:
        rows = np.ravel(_arrays.whole_numbers(given, "given"))
        given_pointer = _arrays.pointer("uint32_t[]", rows)
        problem.given = given_pointer
        problem.given_count = len(rows)
    give(problem, target=target, redundancy=redundancy, max_rows=max_rows)
    options = ffi.new("starg_cover_options *")
    lib.starg_cover_options_default(options)
    if method is not None:
        options.method = choose("method", method, _METHODS)
    give(options, max_nodes=max_nodes, prices=prices)
    handle = session.make("starg_cover", lib.starg_cover_free, lib.starg_cover_solve, session.context,
                          problem, options, progress=progress, time_limit=time_limit)
    return fill(Cover, handle, _handle=handle,
                rows=_arrays.view(handle, handle.rows, (handle.count,), np.uint32),
                prices=_arrays.view(handle, handle.prices, (bits.shape[1],), np.float64)
                if handle.prices else None)
