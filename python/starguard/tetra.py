# SPDX-License-Identifier: Apache-2.0
"""Tetrahedral meshes: checked, positively oriented, with neighbours."""
from __future__ import annotations

import os
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from . import _arrays, _others
from ._fields import fill
from ._library import ffi, lib
from ._options import Options, takes
from ._session import Session
from ._types import Array, PathLike, Progress
from .errors import ArgumentError, MeshError
from .mesh import Mesh, as_mesh

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from ._keywords import TetraOptions

#: Marks the missing neighbour across a boundary face.
NO_NEIGHBOUR = 2**32 - 1

_OPTIONS = Options("starg_tetra_options")
_HEAD = 1 << 16  # bytes that identify a file


@dataclass(frozen=True)
class TetraReport:
    """How tetrahedra were generated."""

    #: "tetgen" or "stuffing".
    generator: str
    #: The boundary is the solid's surface, face by face.
    surface_kept: bool
    #: Lattice spacing; 0 without a lattice.
    spacing: float
    #: Largest sampled distances from the boundary to the surface and back, to within `step`.
    to_surface: float
    from_surface: float
    step: float

    @classmethod
    def _of(cls, report: Any) -> TetraReport:
        return fill(cls, report, generator=_OPTIONS.word("generator", report.generator))


class TetMesh:
    """An immutable conforming tetrahedral mesh: `vertices` (n, 3), `tetrahedra` (m, 4).

    Negative tetrahedra are reoriented, with a notice. `regions` are labels, which are only stored.
    The attributes are read-only views of the library's memory.

    >>> import starguard
    >>> tets = starguard.TetMesh([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], [[0, 1, 2, 3]])
    >>> tets, tets.surface()[0]
    (TetMesh(4 vertices, 1 tetrahedra), Mesh(4 vertices, 4 faces))
    """

    def __init__(self, vertices: ArrayLike, tetrahedra: ArrayLike,
                 regions: ArrayLike | None = None) -> None:
        rows = _arrays.reals(vertices, 3, "vertices")
        corners = _arrays.indices(tetrahedra, 4, "tetrahedra")
        labels = None
        if regions is not None:
            labels = np.ascontiguousarray(_arrays.given(regions, "regions"), dtype=np.int32)
            if labels.shape != (len(corners),):
                raise ArgumentError(f"regions must have the shape ({len(corners)},), not {labels.shape}")
        session = Session()
        self._adopt(session.make(
            "starg_tetmesh", lib.starg_tetmesh_free, lib.starg_tetmesh_create, session.context,
            _arrays.pointer("double[]", rows), len(rows), _arrays.pointer("uint32_t[]", corners),
            len(corners), ffi.NULL if labels is None else _arrays.pointer("int32_t[]", labels)))

    def _adopt(self, handle: Any, file: PathLike | None = None, report: TetraReport | None = None,
               owner: Any = None) -> TetMesh:
        self._handle: Any = handle
        self._owner = owner = handle if owner is None else owner
        self.file: PathLike | None = file  #: its file, or None
        self.report: TetraReport | None = report  #: how `tetrahedralize` generated it, or None
        count, vertex_count = lib.starg_tetmesh_count(handle), lib.starg_tetmesh_vertex_count(handle)
        #: (n, 3) float64, read-only.
        self.vertices: Array = _arrays.view(owner, lib.starg_tetmesh_vertices(handle),
                                                 (vertex_count, 3), np.float64)
        #: (m, 4) uint32, read-only; det(b - a, c - a, d - a) > 0.
        self.tetrahedra: Array = _arrays.view(owner, lib.starg_tetmesh_tetrahedra(handle),
                                                   (count, 4), np.uint32)
        #: (m, 4) uint32, read-only: across the face opposite each vertex, or NO_NEIGHBOUR.
        self.neighbours: Array = _arrays.view(owner, lib.starg_tetmesh_neighbours(handle),
                                                   (count, 4), np.uint32)
        regions = lib.starg_tetmesh_regions(handle)
        #: (m,) int32, read-only, or None.
        self.regions: Array | None = (_arrays.view(owner, regions, (count,), np.int32)
                                           if regions else None)
        return self

    @classmethod
    def _of(cls, handle: Any, file: PathLike | None = None, report: TetraReport | None = None,
            owner: Any = None) -> TetMesh:
        """Wraps a handle, or an object that `owner` keeps alive."""
        return cls.__new__(cls)._adopt(handle, file, report, owner)

    def __repr__(self) -> str:
        return f"TetMesh({len(self.vertices)} vertices, {len(self.tetrahedra)} tetrahedra)"

    def __reduce__(self) -> tuple[Any, ...]:
        regions = None if self.regions is None else np.array(self.regions)
        return TetMesh, (np.array(self.vertices), np.array(self.tetrahedra), regions)

    @classmethod
    def read(cls, path: PathLike) -> TetMesh:
        """Reads MEDIT, legacy VTK, Gmsh or TetGen files, recognized by content.

        >>> import starguard
        >>> cube = [[x, y, z] for z in (0, 1) for y in (0, 1) for x in (0, 1)]
        >>> starguard.TetMesh(cube, [[0, 1, 3, 7]]).write("one.vtk")
        >>> starguard.TetMesh.read("one.vtk")
        TetMesh(8 vertices, 1 tetrahedra)
        """
        session = Session()
        return cls._of(session.make("starg_tetmesh", lib.starg_tetmesh_free, lib.starg_tetmesh_read,
                                    session.context, _arrays.path(path)), path)

    @classmethod
    def from_bytes(cls, data: bytes, name: str = "memory") -> TetMesh:
        """Reads the bytes of such a file (not TetGen's pair of files)."""
        session = Session()
        return cls._of(session.make(
            "starg_tetmesh", lib.starg_tetmesh_free, lib.starg_tetmesh_read_memory, session.context,
            ffi.from_buffer(data) if data else ffi.NULL, len(data), _arrays.path(name)))

    def write(self, path: PathLike, *, binary: bool = False, labels: ArrayLike | None = None,
              name: str = "piece") -> None:
        """Writes a legacy VTK unstructured grid; `labels`, one per tetrahedron, are called `name`."""
        session = Session()
        options = ffi.new("starg_tetmesh_write_options *")
        lib.starg_tetmesh_write_options_default(options)
        word = ffi.new("char[]", _arrays.path(name))
        options.binary = binary
        options.name = word
        if labels is not None:
            numbers = np.ascontiguousarray(_arrays.given(labels, "labels"), dtype=np.int32)
            if numbers.shape != (len(self.tetrahedra),):
                raise ArgumentError(f"labels must have the shape ({len(self.tetrahedra)},), not "
                                    f"{numbers.shape}")
            pointer = _arrays.pointer("int32_t[]", numbers)
            options.labels = pointer
        session.call(lib.starg_tetmesh_write, session.context, self._handle, _arrays.path(path),
                     options)

    def to_pyvista(self) -> Any:
        """A copy as `pyvista.UnstructuredGrid`; cell data `region`, if there are regions."""
        return _others.pyvista_tetrahedra(self.vertices, self.tetrahedra, self._data())

    def to_meshio(self) -> Any:
        """A copy as `meshio.Mesh` of tetrahedra; cell data `region`, if there are regions."""
        return _others.meshio(self.vertices, "tetra", self.tetrahedra, self._data())

    def _data(self) -> dict[str, Array]:
        return {} if self.regions is None else {"region": self.regions}

    @property
    def volume(self) -> float:
        """Sum of the volumes."""
        return float(lib.starg_tetmesh_volume(self._handle))

    @property
    def turned(self) -> int:
        """Number of reoriented tetrahedra."""
        return int(lib.starg_tetmesh_turned(self._handle))

    def surface(self) -> tuple[Mesh, Array]:
        """The outward oriented boundary, and the index in this mesh of each of its vertices."""
        session = Session()
        out, numbers = ffi.new("starg_mesh **"), ffi.new("uint32_t **")
        try:
            session.call(lib.starg_tetmesh_surface, session.context, self._handle, out, numbers)
        finally:
            handle = session.own(out[0], lib.starg_mesh_free) if out[0] else None
            owner = (session.own(numbers[0], lib.starg_tetmesh_map_free, shared=True)
                     if numbers[0] else None)
        mesh = Mesh._of(handle)
        return mesh, _arrays.view(owner, numbers[0], (len(mesh.vertices),), np.uint32)


@takes(_OPTIONS)
def tetrahedralize(model: Any, *, threads: int | None = None, time_limit: float | None = None,
                   progress: Progress | None = None, **options: Unpack[TetraOptions]) -> TetMesh:
    """Fills a solid, or a mesh with holes, with tetrahedra.

    >>> import starguard
    >>> tets = starguard.tetrahedralize(starguard.sample("l-room", vertices=500),
    ...                                 generator="stuffing")
    >>> tets.report.generator, tets.report.surface_kept
    ('stuffing', False)
    """
    wanted = _OPTIONS.make(options)
    mesh = as_mesh(model)
    session = Session(threads)
    report = ffi.new("starg_tetra_report *")
    function, handle = lib.starg_tetmesh_from_solid, None
    try:
        handle = mesh.solid._handle
    except MeshError:  # holes: filled by winding number
        if wanted.pointer.generator == lib.STARG_TETRA_TETGEN:
            raise
        function, handle = lib.starg_tetmesh_from_open_mesh, mesh._handle
    made = session.make("starg_tetmesh", lib.starg_tetmesh_free, function, session.context, handle,
                        wanted.pointer, report, progress=progress, time_limit=time_limit)
    return TetMesh._of(made, report=TetraReport._of(report))


def is_tetrahedral(path: PathLike) -> bool:
    """Whether a file contains tetrahedra, by its content (TetGen: by its name).

    >>> import starguard
    >>> starguard.sample("l-room", vertices=500).write("room.off")
    >>> starguard.is_tetrahedral("room.off")
    False
    """
    with open(path, "rb") as file:
        head = file.read(_HEAD)
    return bool(lib.starg_tetmesh_recognized(ffi.from_buffer(head) if head else ffi.NULL, len(head),
                                             _arrays.path(path)))


def as_shape(model: Any) -> Mesh | TetMesh:
    """A TetMesh, or a Mesh of anything `as_mesh` accepts; files are recognized by content."""
    if isinstance(model, TetMesh):
        return model
    if isinstance(model, (str, bytes, os.PathLike)) and os.path.isfile(model) and is_tetrahedral(model):
        return TetMesh.read(model)
    return as_mesh(model)
