# SPDX-License-Identifier: Apache-2.0
"""Exceptions, one per status of the library."""
from __future__ import annotations

import re

import numpy as np

from ._library import ffi, lib, text
from ._types import Array

_ELEMENTS = ("none", "vertex", "face", "edge", "line", "byte", "guard", "candidate", "tetrahedron")


class Error(Exception):
    """A call of the library failed. `str(error)` says what, where, and what to do.

    >>> import starguard
    >>> try:
    ...     starguard.Solid(starguard.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]]))
    ... except starguard.MeshError as error:
    ...     print(error.stage, error.element, error.elements[0])
    solid edge [0 1]
    """

    #: The part of the library that failed, a lower-case name.
    stage: str
    #: What `elements` counts: "vertex", "face", "edge", "line" (of a text file, from 1), "byte",
    #: "guard", "candidate", "tetrahedron", or "none".
    element: str
    #: Indices of the first affected elements, at most eight numbers; edges are rows of two.
    elements: Array

    def __init__(self, message: str, stage: str = "", element: str = "none",
                 elements: Array | None = None) -> None:
        super().__init__(message)
        self.stage = stage
        self.element = element
        self.elements = np.empty(0, np.int64) if elements is None else elements


class ArgumentError(Error, ValueError):
    """A parameter is out of its stated range, or an array has the wrong shape."""


class OutOfMemoryError(Error, MemoryError):
    """Out of memory."""


class ReadError(Error, OSError):
    """A file is missing, unreadable or a directory."""


class WriteError(Error, OSError):
    """An output cannot be written."""


class FormatError(Error, ValueError):
    """A file does not follow its format."""


class MeshError(Error, ValueError):
    """A mesh is not usable for the call: open, not manifold, empty."""


class RangeError(Error, ValueError):
    """A coordinate is not finite or not below 1e100 in magnitude."""


class SolverError(Error, RuntimeError):
    """A solver failed without a usable result."""


class TimeLimitError(Error, TimeoutError):
    """The time limit was reached without a result."""


class CancelledError(Error, RuntimeError):
    """The progress callback returned False."""


_CLASSES: dict[int, type[Error]] = {
    lib.STARG_ERROR_ARGUMENT: ArgumentError,
    lib.STARG_ERROR_MEMORY: OutOfMemoryError,
    lib.STARG_ERROR_READ: ReadError,
    lib.STARG_ERROR_WRITE: WriteError,
    lib.STARG_ERROR_FORMAT: FormatError,
    lib.STARG_ERROR_MESH: MeshError,
    lib.STARG_ERROR_RANGE: RangeError,
    lib.STARG_ERROR_SOLVER: SolverError,
    lib.STARG_ERROR_TIME: TimeLimitError,
    lib.STARG_ERROR_CANCELLED: CancelledError,
}


#: What messages call by its command, and how it is called here.
_CALLS = {"check": "Mesh.check()", "repair": "Mesh.repair()", "guard": "guard()", "visible": "visible()",
          "map": "map_surface()", "verify": "verify()", "sample": "sample()", "decompose": "decompose()",
          "db list": "Database.models()", "db create": "Database.create()"}
_FLAGS = "soup outside two-sided prove overlay fill union no-refine"
_KEYWORDS = {"--from": "start=", "--leak FILE": "Scene.leak"}


def in_python(message: str) -> str:
    """Commands and options of the command line as calls and keyword arguments."""
    def call(match: re.Match[str]) -> str:
        if match[1].endswith("--soup"):
            return "`Scene(model, soup=True)`"
        name = match[1] if match[1] in _CALLS else match[1].split()[0]
        rest = match[1][len(name):].replace(" ", "")
        made = _CALLS.get(name, name + "()")
        return f"`{made[:-1]}{keyword(rest)})`" if rest else f"`{made}`"

    def keyword(option: str) -> str:
        found = re.match(r"--([a-z][a-z-]*)(.*)", option)
        if found is None:
            return option
        name, value = found[1], "=True" if found[1] in _FLAGS.split() else "=..." if found[2] else ""
        if name.startswith("no-"):
            name, value = name[3:], "=False"
        return name.replace("-", "_") + value

    for option, name in _KEYWORDS.items():
        message = re.sub(rf"(?<![\w'-]){option}\b", name, message)
    message = re.sub(r"'starguard ([^']*)'", call, message)
    return re.sub(r"(?<![\w'])--[a-z][a-z-]*\b", lambda match: keyword(match[0]), message)


def of_status(status: int, context: object) -> Error:
    """The exception for a failed call on a context (NULL: creation failed)."""
    kind = _CLASSES.get(status, Error)
    phrase = text(lib.starg_status_string(status))
    detail = lib.starg_context_error(context) if context else None
    if detail is None or detail.status != status:
        return kind(phrase)
    element = _ELEMENTS[detail.element]
    indices = np.array(ffi.unpack(detail.indices, detail.index_count), np.uint64).astype(np.int64)
    return kind(in_python(text(detail.message)) or phrase, text(detail.stage), element,
                indices.reshape(-1, 2) if element == "edge" else indices)
