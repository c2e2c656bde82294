# SPDX-License-Identifier: Apache-2.0
"""The curve skeleton of a solid: an interior graph along its centre with the same topology."""
from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from . import _arrays
from ._choice import choose
from ._fields import fill
from ._library import ffi, lib
from ._options import Options, takes
from ._session import Session
from ._types import Array, PathLike, Progress
from .solid import as_solid

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from ._keywords import SkeletonOptions

_OPTIONS = Options("starg_skeleton_options", old={"node_count": "nodes"})
_FORMATS = {"auto": lib.STARG_SKELETON_AUTO, "obj": lib.STARG_SKELETON_OBJ,
            "cg": lib.STARG_SKELETON_CG, "vtk": lib.STARG_SKELETON_VTK, "swc": lib.STARG_SKELETON_SWC}


@dataclass(frozen=True, eq=False)
class Skeleton:
    """A graph of points strictly inside a solid. The arrays are read-only views of the library's
    memory."""

    #: (n, 3).
    positions: Array
    #: Distance of each node from the surface, (n,); None if not in the file.
    radii: Array | None
    #: (m, 2) uint32.
    edges: Array
    #: The node of each of the solid's vertices; empty if read from a file.
    vertex_nodes: Array
    components: int
    loops: int
    #: Nodes with three or more edges; with one.
    joints: int
    ends: int
    cuts: int
    mends: int
    #: Whether components and loops are those of the solid.
    homotopic: bool
    _handle: Any = field(repr=False)

    def __repr__(self) -> str:
        return (f"Skeleton({len(self.positions)} nodes, {len(self.edges)} edges, "
                f"homotopic={self.homotopic})")

    @classmethod
    def _of(cls, s: Any) -> Skeleton:
        return fill(cls, s, _handle=s,
                    positions=_arrays.view(s, s.positions, (s.node_count, 3), np.float64),
                    radii=_arrays.view(s, s.radii, (s.node_count,), np.float64) if s.radii else None,
                    edges=_arrays.view(s, s.edges, (s.edge_count, 2), np.uint32),
                    vertex_nodes=_arrays.view(s, s.vertex_nodes, (s.vertex_count,), np.uint32))

    @classmethod
    def read(cls, path: PathLike) -> Skeleton:
        """Reads a file of `write`, recognized by content.

        >>> import starguard
        >>> torus = starguard.sample("torus", vertices=500)
        >>> starguard.skeleton(torus, nodes=50).write("torus.cg")
        >>> starguard.Skeleton.read("torus.cg").loops
        1
        """
        session = Session()
        return cls._of(session.make("starg_skeleton", lib.starg_skeleton_free,
                                    lib.starg_skeleton_read, session.context, _arrays.path(path),
                                    shared=True))

    @classmethod
    def from_bytes(cls, data: bytes, name: str = "memory") -> Skeleton:
        """Reads the bytes of such a file; `name` is used in messages."""
        session = Session()
        return cls._of(session.make(
            "starg_skeleton", lib.starg_skeleton_free, lib.starg_skeleton_read_memory,
            session.context, ffi.from_buffer(data) if data else ffi.NULL, len(data),
            _arrays.path(name), shared=True))

    def write(self, path: PathLike, *, format: str = "auto") -> None:
        """Writes the graph as "obj", "cg" or "vtk", by the file extension or by `format`.

        >>> import starguard
        >>> starguard.skeleton(starguard.sample("dog", vertices=500)).write("dog.cg")
        """
        session = Session()
        session.call(lib.starg_skeleton_write, session.context, self._handle, _arrays.path(path),
                     choose("format", format, _FORMATS))


@takes(_OPTIONS)
def skeleton(model: Any, *, threads: int | None = None, seed: int | None = None,
             time_limit: float | None = None, progress: Progress | None = None,
             **options: Unpack[SkeletonOptions]) -> Skeleton:
    """Computes the curve skeleton.

    >>> import starguard
    >>> s = starguard.skeleton(starguard.sample("torus", vertices=500), nodes=50)
    >>> s.loops, s.ends, s.homotopic
    (1, 0, True)
    """
    wanted = _OPTIONS.make(options)
    solid = as_solid(model)
    session = Session(threads, seed)
    return Skeleton._of(session.make(
        "starg_skeleton", lib.starg_skeleton_free, lib.starg_skeleton_create, session.context,
        solid._handle, wanted.pointer, shared=True, progress=progress, time_limit=time_limit))
