# SPDX-License-Identifier: Apache-2.0
"""Triangle surface meshes: files, checks, repair and simplification."""
from __future__ import annotations

import os
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Callable

import numpy as np
from numpy.typing import ArrayLike

from . import _arrays, _others
from ._choice import choose
from ._fields import fill
from ._library import ffi, lib, text
from ._options import Options, takes
from ._session import Session
from ._types import Array, PathLike, Progress
from .errors import ArgumentError

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from ._keywords import RepairOptions
    from .solid import Solid

#: Marks vertices without faces in a vertex map.
NO_VERTEX = 2**32 - 1

_REPAIR = Options("starg_repair_options", old={"max_rounds": "rounds"})
_FORMATS = {"auto": lib.STARG_MESH_AUTO, "off": lib.STARG_MESH_OFF, "obj": lib.STARG_MESH_OBJ,
            "ply": lib.STARG_MESH_PLY_BINARY, "ply-ascii": lib.STARG_MESH_PLY_ASCII,
            "stl": lib.STARG_MESH_STL_BINARY, "stl-ascii": lib.STARG_MESH_STL_ASCII, "vtp": lib.STARG_MESH_VTP}

_QUARTERS = int(ffi.cast("size_t", -2))  # STARG_QUARTERS


class Mesh:
    """An immutable triangle mesh: vertices and faces, counter-clockwise seen from outside.

    `vertices` has the shape (n, 3), `faces` the shape (m, 3) and any integer type. Both are copied
    once, into library memory; the attributes are read-only views of that memory. Every coordinate
    must be finite and below 1e100 in magnitude.

    >>> import starguard
    >>> mesh = starguard.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]],
    ...                       [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
    >>> mesh
    Mesh(4 vertices, 4 faces)
    >>> round(mesh.volume, 6)
    0.166667
    """

    def __init__(self, vertices: ArrayLike, faces: ArrayLike) -> None:
        rows = _arrays.reals(vertices, 3, "vertices")
        corners = _arrays.indices(faces, 3, "faces")
        session = Session()
        self._adopt(session.make(
            "starg_mesh", lib.starg_mesh_free, lib.starg_mesh_create, session.context,
            _arrays.pointer("double[]", rows), len(rows), _arrays.pointer("uint32_t[]", corners),
            len(corners), brief=True))

    def _adopt(self, handle: Any, file: PathLike | None = None, owner: Any = None) -> Mesh:
        self._handle: Any = handle
        self._owner: Any = handle if owner is None else owner
        self._solid: Callable[[], Solid | None] = lambda: None
        self.file: PathLike | None = file  #: its file, or None
        vertex_count = lib.starg_mesh_vertex_count(handle)
        face_count = lib.starg_mesh_face_count(handle)
        #: (n, 3) float64, read-only.
        self.vertices: Array = _arrays.view(self._owner, lib.starg_mesh_vertices(handle),
                                                 (vertex_count, 3), np.float64)
        #: (m, 3) uint32, read-only.
        self.faces: Array = _arrays.view(self._owner, lib.starg_mesh_faces(handle), (face_count, 3),
                                              np.uint32)
        return self

    @classmethod
    def _of(cls, handle: Any, file: PathLike | None = None, owner: Any = None) -> Mesh:
        """Wraps a handle, or an object that `owner` keeps alive."""
        return cls.__new__(cls)._adopt(handle, file, owner)

    def __repr__(self) -> str:
        return f"Mesh({len(self.vertices)} vertices, {len(self.faces)} faces)"

    def __reduce__(self) -> tuple[Any, ...]:
        return _unpickled, (np.array(self.vertices), np.array(self.faces), self.file)

    def _repr_html_(self) -> str:
        return _others.card(repr(self), self, {})

    # ---- files ----

    @classmethod
    def read(cls, path: PathLike) -> Mesh:
        """Reads OFF, OBJ, PLY or STL, recognized by content. "-" is standard input.

        >>> import starguard
        >>> starguard.sample("l-room", vertices=500).write("room.off")
        >>> starguard.Mesh.read("room.off")
        Mesh(506 vertices, 1008 faces)
        """
        session = Session()
        return cls._of(session.make("starg_mesh", lib.starg_mesh_free, lib.starg_mesh_read,
                                    session.context, _arrays.path(path)), path)

    @classmethod
    def from_bytes(cls, data: bytes, name: str = "memory") -> Mesh:
        """Reads the bytes of a mesh file; `name` is used in messages and as a format hint.

        >>> import starguard
        >>> starguard.Mesh.from_bytes(b"OFF 3 1 0  0 0 0  1 0 0  0 1 0  3 0 1 2")
        Mesh(3 vertices, 1 faces)
        """
        session = Session()
        return cls._of(session.make(
            "starg_mesh", lib.starg_mesh_free, lib.starg_mesh_read_memory, session.context,
            ffi.from_buffer(data) if data else ffi.NULL, len(data), _arrays.path(name)))

    def write(self, path: PathLike, *, format: str = "auto",
              face_colors: ArrayLike | None = None, origin: ArrayLike | None = None) -> None:
        """Writes OFF, OBJ, PLY, STL or VTP, by the file extension or by `format`: "off", "obj", "ply",
        "ply-ascii", "stl", "stl-ascii" or "vtp". `face_colors` is (m, 3), 0 to 255; PLY, OFF and VTP store it.
        `origin` is subtracted from all vertices, and stands in a comment of PLY, OBJ and STL; binary STL
        refuses what single precision would change.

        >>> import starguard
        >>> mesh = starguard.sample("l-room", vertices=500)
        >>> mesh.write("room.ply", face_colors=[[200, 30, 30]] * len(mesh.faces))
        """
        session = Session()
        options = ffi.new("starg_mesh_write_options *")
        lib.starg_mesh_write_options_default(options)
        options.format = choose("format", format, _FORMATS)
        colors = _arrays.colors(face_colors, len(self.faces), "face_colors")
        options.face_colors = colors
        if origin is not None:
            options.origin = _arrays.points(origin, "origin").reshape(-1).tolist()
        session.call(lib.starg_mesh_write, session.context, self._handle, _arrays.path(path), options)

    # ---- other packages; `as_mesh` is the way back ----

    def to_trimesh(self) -> Any:
        """A copy as `trimesh.Trimesh`, with the same vertices and faces in the same order."""
        return _others.trimesh(self.vertices, self.faces)

    def to_pyvista(self) -> Any:
        """A copy as `pyvista.PolyData`."""
        return _others.pyvista_surface(self.vertices, self.faces)

    def to_meshio(self) -> Any:
        """A copy as `meshio.Mesh` of triangles.

        >>> import starguard
        >>> starguard.sample("l-room", vertices=500).to_meshio().cells_dict["triangle"].shape
        (1008, 3)
        """
        return _others.meshio(self.vertices, "triangle", self.faces, {})

    # ---- measures ----

    @property
    def bounds(self) -> Array:
        """Lower and upper corner of the bounding box, shape (2, 3)."""
        corners = np.empty((2, 3))
        lib.starg_mesh_bounds(self._handle, ffi.from_buffer("double[3]", corners[0]),
                              ffi.from_buffer("double[3]", corners[1]))
        return corners

    def apart(self, other: Mesh) -> float:
        """The largest distance of a vertex of either surface from the other surface.

        >>> import starguard
        >>> room = starguard.sample("l-room", vertices=500)
        >>> room.apart(room)
        0.0
        """
        session = Session()
        largest = ffi.new("double *")
        session.call(lib.starg_mesh_apart, session.context, self._handle, other._handle, largest)
        return float(largest[0])

    @property
    def colors(self) -> Array | None:
        """Red, green and blue of the vertices, (n, 3) of uint8, if its file has them; a copy."""
        held = lib.starg_mesh_colors(self._handle)
        if held == ffi.NULL:
            return None
        count = lib.starg_mesh_vertex_count(self._handle)
        return np.frombuffer(ffi.buffer(held, 3 * count), dtype=np.uint8).reshape(count, 3).copy()

    @property
    def texture(self) -> Array | None:
        """Texture coordinates u, v of the corners, v upward, (m, 3, 2) of float32, if its file has them; a copy."""
        held = lib.starg_mesh_texture(self._handle)
        if held == ffi.NULL:
            return None
        count = lib.starg_mesh_face_count(self._handle)
        return np.frombuffer(ffi.buffer(held, 24 * count), dtype=np.float32).reshape(count, 3, 2).copy()

    @property
    def left_out(self) -> tuple[str, ...]:
        """What the file of the mesh has and the mesh has not: "colors", "texture"."""
        bits = lib.starg_mesh_left_out(self._handle)
        return tuple(name for name, bit in (("colors", lib.STARG_MESH_COLORS),
                                            ("texture", lib.STARG_MESH_TEXTURE)) if bits & bit)

    @property
    def origin(self) -> Array:
        """A round point near the middle; subtracting it from large coordinates rounds none. For `write`."""
        origin = np.empty(3)
        lib.starg_mesh_origin(self._handle, ffi.from_buffer("double[3]", origin))
        return origin

    @property
    def area(self) -> float:
        """Sum of the face areas."""
        return float(lib.starg_mesh_area(self._handle))

    @property
    def volume(self) -> float:
        """Signed volume: positive when faces point outward."""
        return float(lib.starg_mesh_volume(self._handle))

    @property
    def solid(self) -> Solid:
        """The solid that the mesh bounds, created on first use. Raises MeshError if there is none."""
        from .solid import Solid

        made = self._solid()
        if made is None:
            made = Solid(self)
            self._solid = lambda: made
        return made

    # ---- check, repair, simplify ----

    def check(self, *, progress: Progress | None = None) -> Check:
        """Tests whether the mesh bounds a solid, and lists its defects.

        >>> import starguard
        >>> check = starguard.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]]).check()
        >>> check.usable, check.findings["open edges"].count
        (False, 3)
        """
        session = Session()
        handle = session.make("starg_check", lib.starg_check_free, lib.starg_mesh_check,
                              session.context, self._handle, shared=True, progress=progress)
        return Check._of(handle, handle, len(self.faces))

    @takes(_REPAIR)
    def repair(self, *, progress: Progress | None = None,
               **options: Unpack[RepairOptions]) -> tuple[Mesh, RepairReport]:
        """Returns the repaired mesh and a report. Raises MeshError if the result is not usable.

        >>> import starguard
        >>> open_mesh = starguard.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]],
        ...                            [[0, 2, 1], [0, 1, 3], [0, 3, 2]])
        >>> mesh, report = open_mesh.repair()
        >>> mesh, report.holes_filled
        (Mesh(4 vertices, 4 faces), 1)
        """
        session = Session()
        wanted = _REPAIR.make(options)
        report = ffi.new("starg_repair_report *")
        out = ffi.new("starg_mesh **")
        try:
            session.call(lib.starg_mesh_repair, session.context, self._handle, wanted.pointer, out,
                         report, progress=progress)
        finally:
            handle = session.own(out[0], lib.starg_mesh_free) if out[0] else None
        return Mesh._of(handle), fill(RepairReport, report)

    def simplify(self, vertex_count: int, *, allow_intersections: bool = False,
                 threads: int | None = None, time_limit: float | None = None,
                 progress: Progress | None = None) -> tuple[Mesh, Array]:
        """Returns a mesh with fewer vertices and the same topology, and for each vertex of this mesh
        the one into which it was merged (or NO_VERTEX).

        >>> import starguard
        >>> mesh, vertex_map = starguard.sample("dog", vertices=1000).simplify(300)
        >>> len(mesh.vertices), vertex_map.max()
        (300, 299)
        """
        session = Session(threads)
        options = ffi.new("starg_simplify_options *")
        lib.starg_simplify_options_default(options)
        options.allow_intersections = allow_intersections
        vertex_map = np.empty(len(self.vertices), np.uint32)
        handle = session.make("starg_mesh", lib.starg_mesh_free, lib.starg_mesh_simplify,
                              session.context, self._handle, vertex_count, options,
                              _arrays.pointer("uint32_t[]", vertex_map), progress=progress,
                              time_limit=time_limit)
        return Mesh._of(handle), vertex_map

    def levels(self, coarsest: int = 5000, step: int | None = 10000, *,
               allow_intersections: bool = False, threads: int | None = None,
               time_limit: float | None = None, progress: Progress | None = None) -> list[Level]:
        """Levels of detail with about `coarsest`, `coarsest` + `step`, ... vertices; the last is a
        copy of the mesh. With step None, each level has a quarter of the vertices of the next finer
        one.

        >>> import starguard
        >>> [len(level.mesh.vertices) for level in starguard.sample("dog").levels(1000, 2000)]
        [1000, 3000, 5000]
        >>> [len(level.mesh.vertices) for level in starguard.sample("dog").levels(500, None)]
        [500, 1250, 5000]
        """
        if step is None:
            step = _QUARTERS
        session = Session(threads)
        options = ffi.new("starg_simplify_options *")
        lib.starg_simplify_options_default(options)
        options.allow_intersections = allow_intersections
        handle = session.make("starg_levels", lib.starg_levels_free, lib.starg_mesh_levels,
                              session.context, self._handle, coarsest, step, options, shared=True,
                              progress=progress, time_limit=time_limit)
        result = []
        for i in range(handle.count):
            level = handle.levels[i]
            mesh = Mesh._of(level.mesh, owner=handle)
            finer = lib.starg_mesh_vertex_count(handle.levels[i + 1].mesh) if level.vertex_map else 0
            result.append(Level(mesh, _arrays.view(handle, level.vertex_map, (finer,), np.uint32)
                                if level.vertex_map else None))
        return result


def _unpickled(vertices: Array, faces: Array, file: PathLike | None) -> Mesh:
    mesh = Mesh(vertices, faces)
    mesh.file = file
    return mesh


def as_mesh(model: Any) -> Mesh:
    """Converts to a Mesh: a Mesh or Solid, a file name, a pair (vertices, faces), an object with
    `vertices` and `faces` (trimesh), or with `points` and triangles (meshio, PyVista).

    >>> import starguard
    >>> class Like:
    ...     vertices = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]
    ...     faces = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]
    >>> starguard.as_mesh(Like())
    Mesh(4 vertices, 4 faces)
    """
    from .solid import Solid

    if isinstance(model, Mesh):
        return model
    if isinstance(model, Solid):
        return model.mesh
    if isinstance(model, (str, bytes, os.PathLike)):
        return Mesh.read(model)
    if isinstance(model, tuple) and len(model) == 2:
        return Mesh(*model)
    if hasattr(model, "vertices") and hasattr(model, "faces"):
        return Mesh(model.vertices, model.faces)
    if hasattr(model, "points") and hasattr(model, "get_cells_type"):  # meshio
        return Mesh(model.points, model.get_cells_type("triangle"))
    if hasattr(model, "points") and hasattr(model, "faces"):  # PyVista: 3 i j k, 3 i j k, ...
        faces = _arrays.given(model.faces, "faces")
        if faces.ndim == 1:
            if faces.size % 4 != 0 or np.any(faces[::4] != 3):
                raise ArgumentError("the model has faces other than triangles; triangulate it first")
            faces = faces.reshape(-1, 4)[:, 1:]
        return Mesh(model.points, faces)
    raise ArgumentError(f"a {type(model).__name__} is not a mesh; give a starguard.Mesh, a file name, a "
                        "pair (vertices, faces), or an object with vertices and faces")


@dataclass(frozen=True)
class Level:
    """One level of detail."""

    mesh: Mesh
    #: For each vertex of the next finer level its vertex in this one, or NO_VERTEX; None for the
    #: finest.
    vertex_map: Array | None


@dataclass(frozen=True)
class Finding:
    """Elements of a mesh with one kind of finding."""

    count: int
    #: What `first` counts: "vertex", "face" or "edge" (pairs of vertices).
    element: str
    #: The first of them; edges, and pairs of faces, are rows of two.
    first: Array


_PAIRS = (lib.STARG_FINDING_SELF_INTERSECTION, lib.STARG_FINDING_SELF_CONTACT)
_ELEMENTS = {lib.STARG_ELEMENT_VERTEX: "vertex", lib.STARG_ELEMENT_FACE: "face",
             lib.STARG_ELEMENT_EDGE: "edge"}


@dataclass(frozen=True, eq=False)
class Check:
    """The result of a check; docs/formats.md explains the kinds of findings."""

    vertices: int
    faces: int
    edges: int
    components: int
    cavities: int
    closed: bool
    manifold: bool
    oriented: bool
    embedded: bool
    #: Closed, oriented, of positive volume, and manifold but where parts touch: the boundary of a solid.
    usable: bool
    #: Sum over components; -1 unless closed and manifold.
    genus: int
    area: float
    volume: float
    diagonal: float
    shortest_edge: float
    #: The steps of which all coordinates are multiples, for x, y and z.
    grid: tuple[float, float, float]
    #: Edges are hardly longer than these steps, far from the origin: finer parts were lost.
    coarse: bool
    #: By name, only nonempty kinds.
    findings: dict[str, Finding]
    #: Per face: 0, or 1 + the first kind of finding that marks it. No copy.
    face_marks: Array

    @classmethod
    def _of(cls, owner: Any, check: Any, face_count: int) -> Check:
        findings = {}
        for kind in range(lib.STARG_FINDING_KINDS):
            finding = check.findings[kind]
            if finding.count == 0:
                continue
            first = np.array(ffi.unpack(finding.first, finding.shown), np.int64)
            if kind in _PAIRS or finding.element == lib.STARG_ELEMENT_EDGE:
                first = first.reshape(-1, 2)
            findings[text(lib.starg_finding_name(kind))] = Finding(
                finding.count, _ELEMENTS[finding.element], first)
        return fill(cls, check, findings=findings, grid=tuple(check.grid),
                    face_marks=_arrays.view(owner, check.face_marks, (face_count,), np.uint8))


@dataclass(frozen=True)
class RepairReport:
    """Changes made by a repair."""

    vertices_merged: int
    vertices_dropped: int
    vertices_split: int
    vertices_moved: int
    vertices_added: int
    faces_dropped: int
    faces_turned: int
    faces_added: int
    holes_filled: int
    #: Faces cut into parts where others touch them.
    faces_divided: int
    components_dropped: int
    intersections_before: int
    intersections_after: int
    #: With ``union``: faces of which only parts are left, and how often faces were cut.
    faces_cut: int
    union_rounds: int
    largest_move: float
    #: Largest distance between things that were joined.
    conforming: float
    #: Whether the surface was closed once what touches was joined; then the volume that its parts
    #: enclose, and that afterwards.
    closed_before: bool
    enclosed_before: float
    enclosed_after: float
    #: Open sheets that were closed, and keep their sides for want of a proof.
    sheets_kept: int
    #: With ``union``: largest distance of a new vertex from the exact intersection.
    rounding: float
    #: It was a solid, and intersects itself as often as before.
    in_vain: bool
