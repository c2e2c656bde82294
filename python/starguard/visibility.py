# SPDX-License-Identifier: Apache-2.0
"""Visibility from points inside a solid, as rows of bits."""
from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from . import _arrays, _others
from ._library import ffi, lib
from ._options import Options, takes
from ._session import Session
from ._types import Array, Progress
from .errors import ArgumentError
from .solid import as_solid

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from ._keywords import VisibleOptions

_OPTIONS = Options("starg_visibility_options", old={"face_rule": "faces"})


class Bits:
    """A packed bit matrix; `bits[i]` is row i as bools, `numpy.asarray(bits)` the whole matrix.

    >>> import starguard
    >>> bits = starguard.Bits.of([[True, False, True], [False, True, True]])
    >>> bits.shape, bits.indices(0), bits.counts()
    ((2, 3), array([0, 2]), array([2, 2]))
    """

    def __init__(self, handle: Any) -> None:
        self._handle = handle
        #: Rows and columns.
        self.shape: tuple[int, int] = (lib.starg_bits_rows(handle), lib.starg_bits_columns(handle))
        words = lib.starg_bits_words(handle)
        first = lib.starg_bits_row(handle, 0) if self.shape[0] > 0 else ffi.NULL
        #: (rows, words) uint64, read-only, without a copy: bit j of a row is bit j % 64 of word j // 64.
        self.words: Array = _arrays.view(handle, first, (self.shape[0], words), np.uint64)

    @classmethod
    def of(cls, matrix: ArrayLike) -> Bits:
        """Packs a matrix of bools."""
        given = _arrays.given(matrix, "a bit matrix").astype(bool, copy=False)
        if given.ndim != 2:
            raise ArgumentError(f"a bit matrix has two dimensions, not {given.ndim}")
        session = Session()
        handle = session.make("starg_bits", lib.starg_bits_free, lib.starg_bits_create,
                              session.context, *given.shape, brief=True)
        _fill(handle, np.packbits(given, axis=1, bitorder="little"))
        return cls(handle)

    def __repr__(self) -> str:
        return f"Bits({self.shape[0]} x {self.shape[1]})"

    def __len__(self) -> int:
        return self.shape[0]

    def __getitem__(self, key: Any) -> Any:
        """A row, or any NumPy index of rows and columns."""
        if isinstance(key, tuple):
            rows, columns = key
            if isinstance(rows, (int, np.integer)) and isinstance(columns, (int, np.integer)):
                return self._bit(int(rows), int(columns))
            return self[rows][..., columns]
        return self._unpack(self.words[key])

    def _bit(self, row: int, column: int) -> Any:
        if not (-self.shape[0] <= row < self.shape[0] and -self.shape[1] <= column < self.shape[1]):
            raise IndexError(f"({row}, {column}) is beyond {self.shape}")
        return np.bool_(lib.starg_bits_test(self._handle, row % self.shape[0], column % self.shape[1]))

    def _unpack(self, words: Array) -> Array:
        little = np.ascontiguousarray(words).astype("<u8", copy=False).view(np.uint8)
        return np.unpackbits(little, axis=-1, count=self.shape[1], bitorder="little").view(bool)

    def __array__(self, dtype: Any = None) -> Array:
        return self._unpack(self.words).astype(dtype or bool, copy=False)

    def indices(self, row: int) -> Array:
        """The columns of the ones of a row, ascending."""
        return np.flatnonzero(self[row])

    def to_scipy(self) -> Any:
        """A copy as `scipy.sparse.csr_matrix` of ones, a row for each row here.

        >>> import starguard
        >>> starguard.Bits.of([[True, False], [True, True]]).to_scipy().sum()  # doctest: +SKIP
        3
        """
        columns = [self.indices(row) for row in range(len(self))]
        ends = np.concatenate([[0], np.cumsum([len(one) for one in columns])]).astype(np.int64)
        ones = np.ones(int(ends[-1]), np.uint8)
        return _others.package("scipy.sparse").csr_matrix(
            (ones, np.concatenate([*columns, np.zeros(0, np.int64)]), ends), shape=self.shape)

    def counts(self) -> Array:
        """The number of ones in each row."""
        return np.array([lib.starg_bits_count(self._handle, i) for i in range(len(self))], np.int64)


def _fill(handle: Any, packed: Array) -> None:
    """Sets the bits of a new matrix that is not shared yet."""
    bytes_per_row = 8 * lib.starg_bits_words(handle)
    rows = np.zeros((len(packed), bytes_per_row), np.uint8)
    rows[:, :packed.shape[1]] = packed
    words = rows.view("<u8").astype(np.uint64, copy=False)
    if words.size > 0:
        ffi.memmove(ffi.cast("uint64_t *", lib.starg_bits_row(handle, 0)), words, words.nbytes)


@takes(_OPTIONS)
def visible(model: Any, points: ArrayLike, *, directions: ArrayLike | None = None,
            threads: int | None = None, time_limit: float | None = None,
            progress: Progress | None = None, **options: Unpack[VisibleOptions]) -> Bits:
    """Computes exactly which faces (or, with target="vertices", vertices) each point sees.

    A point that is not inside sees nothing. A `cone` or a `fov` needs `directions`, one per point.

    >>> import starguard
    >>> room = starguard.sample("l-room", vertices=500)
    >>> seen = starguard.visible(room, [[0.5, 0.5, 0.5], [-1, 0, 0]])
    >>> seen.shape, bool(seen[1].any())
    ((2, 1008), False)
    """
    wanted = _OPTIONS.make(options)
    rows = _arrays.points(points, "points")
    solid = as_solid(model)
    session = Session(threads)
    if directions is not None:
        looks = _arrays.points(directions, "directions")
        if len(looks) != len(rows):
            raise ArgumentError(f"there are {len(rows)} points and {len(looks)} directions")
        pointer = _arrays.pointer("double[]", looks)
        wanted.pointer.directions = pointer
    elif wanted.pointer.cone < 360 or wanted.pointer.fov[0] > 0:
        raise ArgumentError("a cone or a field of view needs directions, one per point")
    return Bits(session.make("starg_bits", lib.starg_bits_free, lib.starg_visibility, session.context,
                             solid._handle, _arrays.pointer("double[]", rows), len(rows),
                             wanted.pointer, progress=progress, time_limit=time_limit))


def visible_from_box(model: Any, boxes: ArrayLike, *, target: str | None = None,
                     range: float | None = None, threads: int | None = None,
                     time_limit: float | None = None, progress: Progress | None = None) -> Bits:
    """Computes which faces (or vertices) are potentially visible from each box in a solid.

    A box is given by its lower and upper corner, six numbers. All other faces are proven hidden from
    every interior point of the box; smaller boxes give tighter results.

    >>> import starguard
    >>> room = starguard.sample("l-room", vertices=500)
    >>> box = starguard.visible_from_box(room, [[0.4, 0.4, 0.4, 0.6, 0.6, 0.6]])
    >>> point = starguard.visible(room, [[0.5, 0.5, 0.5]])
    >>> bool((point[0] <= box[0]).all())
    True
    """
    wanted = _OPTIONS.make({"target": target, "range": range})
    rows = _arrays.points(boxes, "boxes", 6)
    solid = as_solid(model)
    session = Session(threads)
    return Bits(session.make("starg_bits", lib.starg_bits_free, lib.starg_visibility_region,
                             session.context, solid._handle, _arrays.pointer("double[]", rows),
                             len(rows), wanted.pointer, progress=progress, time_limit=time_limit))


def cone_cosine(degrees: float) -> float:
    """The cosine of half an opening angle, as used for cones.

    >>> import starguard
    >>> round(starguard.cone_cosine(90), 6)
    0.707107
    """
    return float(lib.starg_cone_cosine(degrees))
