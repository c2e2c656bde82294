# SPDX-License-Identifier: Apache-2.0
"""Conversion of arrays, copied only if types differ."""
from __future__ import annotations

import os
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ._library import ffi
from ._types import Array, PathLike
from .errors import ArgumentError

_MOST_INDEX = 2**32 - 1


def given(value: ArrayLike, what: str) -> Array:
    """What was given, as an array. NumPy would drop masks and imaginary parts without a word."""
    if isinstance(value, np.ma.MaskedArray) and np.any(value.mask):
        raise TypeError(f"{what} has hidden entries: give an array without a mask")
    try:
        array = np.asarray(value)
    except ValueError as error:
        raise ArgumentError(f"{what} must be numbers: {error}") from error
    if array.dtype.kind == "c":
        raise TypeError(f"{what} must be real, not complex")
    return array


def doubles(value: ArrayLike, what: str) -> Array:
    """Doubles of any shape, C-contiguous; those are passed without a copy."""
    return np.ascontiguousarray(given(value, what), dtype=np.float64)


def reals(value: ArrayLike, columns: int, what: str) -> Array:
    """Rows of `columns` doubles; C-contiguous float64 is passed without a copy."""
    array = given(value, what)
    try:
        array = np.ascontiguousarray(array, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise ArgumentError(f"{what} must be numbers of shape (n, {columns}): {error}") from error
    if array.size == 0:
        array = array.reshape(0, columns)
    if array.ndim != 2 or array.shape[1] != columns:
        raise ArgumentError(f"{what} must have the shape (n, {columns}), not {np.shape(value)}")
    return array


def points(value: ArrayLike, what: str, columns: int = 3) -> Array:
    """Rows of three doubles (six for boxes); a single point becomes one row."""
    array = given(value, what)
    return reals(array.reshape(1, columns) if array.shape == (columns,) else array, columns, what)


def indices(value: ArrayLike, columns: int, what: str) -> Array:
    """Rows of `columns` uint32. Contiguous uint32 and nonnegative int32 (same bits) are passed
    without a copy; other integers are copied."""
    array = given(value, what)
    if array.size == 0:
        return np.empty((0, columns), np.uint32)
    if array.ndim != 2 or array.shape[1] != columns:
        raise ArgumentError(f"{what} must have the shape (m, {columns}), not {array.shape}")
    return whole_numbers(array, what)


def whole_numbers(value: ArrayLike, what: str) -> Array:
    """uint32 of any shape, of whole numbers of any integer type."""
    array = given(value, what)
    if array.size == 0:
        return np.empty(array.shape, np.uint32)
    if array.dtype.kind not in "iu":
        raise ArgumentError(f"{what} must be integers, not {array.dtype}")
    if array.dtype == np.uint32:
        return np.ascontiguousarray(array)
    low, high = int(array.min()), int(array.max())
    if low < 0 or high > _MOST_INDEX:
        raise ArgumentError(f"{what} must be between 0 and {_MOST_INDEX}, not "
                            f"{low if low < 0 else high}")
    if array.dtype == np.int32:
        return np.ascontiguousarray(array).view(np.uint32)
    return np.ascontiguousarray(array, dtype=np.uint32)


def colors(value: ArrayLike | None, count: int, what: str) -> Any:
    """A pointer to count x 3 bytes, or NULL; the array lives as long as the pointer."""
    if value is None:
        return ffi.NULL
    array = given(value, what)
    if array.shape != (count, 3) or array.dtype.kind not in "iu" or (
            array.size > 0 and not 0 <= int(array.min()) <= int(array.max()) <= 255):
        raise ArgumentError(f"{what} must be whole numbers from 0 to 255 of the shape ({count}, 3)")
    return pointer("uint8_t[]", np.ascontiguousarray(array, dtype=np.uint8))


def pointer(kind: str, array: Array) -> Any:
    """A C array that shares the memory of `array` and keeps it alive."""
    return ffi.from_buffer(kind, array) if array.size > 0 else ffi.NULL


class _Memory:
    """Library memory for NumPy; arrays keep it alive, and it keeps its owner alive."""

    def __init__(self, owner: Any, address: int, shape: tuple[int, ...], dtype: np.dtype[Any]) -> None:
        self.owner = owner
        self.__array_interface__ = {"version": 3, "shape": shape, "data": (address, True),
                                    "typestr": dtype.str, "descr": dtype.descr}


def view(owner: Any, block: Any, shape: tuple[int, ...], dtype: Any) -> Array:
    """A read-only view of library memory that `owner` keeps alive."""
    kind = np.dtype(dtype)
    if block == ffi.NULL or 0 in shape:
        empty = np.empty(shape if 0 in shape else (0,) + shape[1:], kind)
        empty.flags.writeable = False
        return empty
    array = np.asarray(_Memory(owner, int(ffi.cast("uintptr_t", block)), shape, np.dtype(f"V{kind.itemsize}")
                               if kind.names else kind))
    return array.view(kind) if kind.names else array


def copy(block: Any, shape: tuple[int, ...], dtype: Any) -> Array:
    """A copy of library memory."""
    return np.array(view(None, block, shape, dtype))


_NAMES = {"double": "f8", "size_t": f"u{ffi.sizeof('size_t')}", "uint32_t": "u4", "int32_t": "i4",
          "int": "i4", "unsigned": "u4", "uint64_t": "u8", "int64_t": "i8", "bool": "?"}


def record(kind: str) -> np.dtype[Any]:
    """The NumPy type of a C struct of numbers."""
    names, formats, offsets = [], [], []
    for name, field in ffi.typeof(kind).fields.items():
        names.append(name)
        formats.append((_NAMES[field.type.item.name], (field.type.length,))
                       if field.type.kind == "array" else _NAMES[field.type.name])
        offsets.append(field.offset)
    return np.dtype({"names": names, "formats": formats, "offsets": offsets,
                     "itemsize": ffi.sizeof(kind)})


def records(owner: Any, block: Any, count: int) -> Array:
    """A read-only structured view of `count` structs of the library."""
    return view(owner, block, (count,), record(ffi.typeof(block).item.name))


def path(value: PathLike) -> bytes:
    """A file name as bytes for the library."""
    name = os.fsencode(value)
    if b"\0" in name:
        raise ArgumentError("a file name must not contain a zero byte")
    return name
