# SPDX-License-Identifier: Apache-2.0
"""Maps and morphs between two surfaces."""
from __future__ import annotations

import threading
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Sequence

import numpy as np
from numpy.typing import ArrayLike

from . import _arrays
from ._choice import word_of
from ._fields import fill
from ._library import ffi, lib
from ._options import Options, takes
from ._session import Session
from ._told import Told
from ._types import Array, PathLike, Progress
from .errors import ArgumentError
from .mesh import Mesh, as_mesh

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from ._keywords import MorphOptions

_OPTIONS = Options("starg_morph_options")
_MAP_KINDS = {"same": lib.STARG_MAP_SAME, "sphere": lib.STARG_MAP_SPHERE, "given": lib.STARG_MAP_GIVEN}


@dataclass(frozen=True, eq=False, repr=False)
class SurfaceMap(Told):
    """The image of each vertex of A on B. The arrays are read-only views of the library's memory."""

    #: "same" (vertex i maps to vertex i), "sphere", or "given" (read from a file).
    kind: str
    target_vertices: int
    target_faces: int
    #: Per vertex of A a face of B, and barycentric coordinates in it, (n, 3).
    faces: Array
    coordinates: Array
    #: Number of satisfied landmarks.
    landmark_count: int
    #: 1 is best.
    mean_angle_distortion: float
    mean_area_distortion: float
    collapsed: int
    #: Pairs of vertices, of A and of B, that the map meets exactly, (k, 2).
    landmarks: Array
    #: Directions of A's and of B's vertices on the common sphere, which make the map a bijection of
    #: the whole surfaces; None if they are not known.
    directions: tuple[Array, Array] | None
    #: A.
    source: Mesh = field(repr=False)
    #: B.
    target: Mesh = field(repr=False)
    _handle: Any = field(repr=False)

    @classmethod
    def _of(cls, m: Any, source: Mesh, target: Mesh) -> SurfaceMap:
        directions = None
        if m.direction_count:
            directions = (
                _arrays.view(m, m.directions, (m.direction_count, 3), np.float64),
                _arrays.view(m, m.target_directions, (m.target_direction_count, 3), np.float64))
        return fill(cls, m, _handle=m, source=source, target=target, directions=directions,
                    landmarks=_arrays.view(m, m.pairs, (m.pair_count, 2), np.uint32), kind=word_of(m.kind, _MAP_KINDS),
                    faces=_arrays.view(m, m.faces, (m.vertex_count,), np.uint32),
                    coordinates=_arrays.view(m, m.coordinates, (m.vertex_count, 3), np.float64))

    def images(self) -> Array:
        """The images of A's vertices, (n, 3)."""
        rows = np.empty((len(self.faces), 3))
        lib.starg_map_positions(self._handle, self.target._handle, _arrays.pointer("double[]", rows))
        return rows

    def overlay(self) -> tuple[Mesh, Mesh]:
        """A and B, both with the faces of their overlay: every face lies in one of A and one of B.

        >>> import starguard
        >>> ball, star = (starguard.sample(name, vertices=500) for name in ("sphere", "star"))
        >>> first, second = starguard.map_surface(ball, star).overlay()
        >>> (first.faces == second.faces).all(), len(first.vertices) > 1000
        (True, True)
        """
        session = Session()
        if not self._handle.overlay.face_count:
            session.lends(self._handle)
            session.call(lib.starg_map_overlay, session.context, self.source._handle,
                         self.target._handle, self._handle)
        overlay = self._handle.overlay
        faces = _arrays.view(self._handle, overlay.faces, (overlay.face_count, 3), np.uint32)
        ends = []
        for end, mesh in enumerate((self.source, self.target)):
            rows = np.empty((overlay.vertex_count, 3))
            lib.starg_overlay_positions(ffi.addressof(self._handle, "overlay"), mesh._handle, end,
                                        _arrays.pointer("double[]", rows))
            ends.append(Mesh(rows, faces))
        return ends[0], ends[1]

    def write(self, path: PathLike) -> None:
        """Writes MAP.json (docs/formats.md)."""
        session = Session()
        session.call(lib.starg_map_write, session.context, self._handle, _arrays.path(path))

    @classmethod
    def read(cls, path: PathLike, a: Any, b: Any) -> SurfaceMap:
        """Reads MAP.json as a map from A to B and measures it."""
        first, second = as_mesh(a), as_mesh(b)
        session = Session()
        return cls._of(session.make("starg_map", lib.starg_map_free, lib.starg_map_read,
                                    session.context, _arrays.path(path), first._handle,
                                    second._handle, shared=True), first, second)


def map_surface(a: Any, b: Any, landmarks: ArrayLike | PathLike | None = None, *, solid: bool = False,
                threads: int | None = None, seed: int | None = None,
                time_limit: float | None = None, progress: Progress | None = None) -> SurfaceMap:
    """Maps A onto B. `landmarks` are pairs of vertices (k, 2), of A and of B, or a file of them. With
    `solid`, of the solids inside: if both are star-shaped, points that are seen in the same direction from
    a point of each kernel correspond.

    >>> import starguard
    >>> a, b = (starguard.sample("dog", pose=pose, vertices=500) for pose in (0, 1))
    >>> poses = starguard.map_surface(a, b)
    >>> poses.kind, bool((poses.images() == b.vertices).all())
    ('same', True)
    """
    first, second = as_mesh(a), as_mesh(b)
    session = Session(threads, seed)
    options = ffi.new("starg_map_options *")
    lib.starg_map_options_default(options)
    options.solid = solid
    if landmarks is not None:
        is_file = isinstance(landmarks, (str, bytes)) or hasattr(landmarks, "__fspath__")
        pairs = (read_landmarks(landmarks, first, second) if is_file  # type: ignore[arg-type]
                 else _arrays.indices(landmarks, 2, "landmarks"))  # type: ignore[arg-type]
        pointer = _arrays.pointer("uint32_t[]", pairs)
        options.landmarks = pointer
        options.landmark_count = len(pairs)
    return SurfaceMap._of(session.make(
        "starg_map", lib.starg_map_free, lib.starg_map_create, session.context, first._handle,
        second._handle, options, shared=True, progress=progress, time_limit=time_limit), first,
        second)


def read_landmarks(path: PathLike, a: Any, b: Any) -> Array:
    """Reads landmarks, one pair per line: two vertex indices or six coordinates. Shape (k, 2).

    >>> import pathlib, starguard
    >>> a, b = (starguard.sample("dog", pose=pose, vertices=500) for pose in (0, 1))
    >>> _ = pathlib.Path("marks.txt").write_text("0 0\\n17 17\\n")
    >>> starguard.read_landmarks("marks.txt", a, b).tolist()
    [[0, 0], [17, 17]]
    """
    first, second = as_mesh(a), as_mesh(b)
    session = Session()
    out, number = ffi.new("uint32_t **"), ffi.new("size_t *")
    try:
        session.call(lib.starg_landmarks_read, session.context, _arrays.path(path), first._handle,
                     second._handle, out, number)
    finally:
        owner = session.own(out[0], lib.starg_landmarks_free, shared=True) if out[0] else None
    return _arrays.view(owner, out[0], (number[0], 2), np.uint32)


@dataclass(frozen=True)
class FrameMeasures:
    """Quality of a frame."""

    #: Pairs of intersecting faces.
    intersections: int
    #: Flipped faces.
    inverted: int
    #: Faces with less than a millionth of their area at the ends.
    collapsed: int
    volume: float
    area: float
    #: Relative to linear interpolation of the ends.
    volume_drift: float
    area_drift: float


@takes(_OPTIONS)
class Morph:
    """A morph from A to another shape with the same faces, for evaluation at any time. Threads may
    share it; they use it one at a time.

    `target` gives the images of A's vertices: a SurfaceMap, positions (n, 3), or a model B, onto
    which A is then mapped.

    >>> import starguard
    >>> a, b = (starguard.sample("dog", pose=pose, vertices=500) for pose in (0, 1))
    >>> morph = starguard.Morph(a, b)
    >>> morph.frame(0.5)
    Mesh(500 vertices, 996 faces)
    >>> morph.measure(0.5).intersections
    0
    """

    def __init__(self, a: Any, target: Any, *, threads: int | None = None, seed: int | None = None,
                 time_limit: float | None = None, progress: Progress | None = None,
                 **options: Unpack[MorphOptions]) -> None:
        wanted = _OPTIONS.make(options)
        self.mesh: Mesh = as_mesh(a)  #: A
        images = self._images(target, threads=threads, seed=seed, progress=progress)
        self._session = Session(threads, seed)
        self._lock = threading.Lock()
        self._handle = self._session.make(
            "starg_morph", lib.starg_morph_free, lib.starg_morph_create, self._session.context,
            self.mesh._handle, _arrays.pointer("double[]", images), wanted.pointer, progress=progress,
            time_limit=time_limit)
        m, count = self._handle, lib.starg_morph_guard_count(self._handle)
        #: Guards of A and their counterparts, (k, 3) each; empty for methods other than star and
        #: spherical. Read-only, without a copy.
        self.guards: tuple[Array, Array] = (
            _arrays.view(m, lib.starg_morph_guards(m, 0), (count, 3), np.float64),
            _arrays.view(m, lib.starg_morph_guards(m, 1), (count, 3), np.float64))
        pieces = lib.starg_morph_pieces(m)
        #: The guard of each face of A, or None.
        self.pieces: Array | None = (
            _arrays.view(m, pieces, (len(self.mesh.faces),), np.uint32) if pieces else None)
        #: Number of faces that no candidate sees from their inner side at both ends.
        self.unguarded: int = lib.starg_morph_unguarded(m)

    def __copy__(self) -> Morph:
        return self  # it does not change

    def __deepcopy__(self, memo: Any) -> Morph:
        return self

    def __reduce__(self) -> tuple[Any, ...]:
        raise TypeError("a morph cannot be pickled; pickle its mesh and the positions at times, or make it again")

    def _images(self, target: Any, **options: Any) -> Array:
        if isinstance(target, (np.ndarray, list)):
            images = _arrays.reals(target, 3, "target")
        elif isinstance(target, SurfaceMap):
            images = target.images()
        else:
            images = map_surface(self.mesh, target, **options).images()
        if len(images) != len(self.mesh.vertices):
            raise ArgumentError(f"A has {len(self.mesh.vertices)} vertices, but there are "
                                f"{len(images)} images of them")
        return images

    def positions(self, t: float) -> Array:
        """The positions of A's vertices at time t in [0, 1]: A itself at 0, the images at 1."""
        rows = np.empty((len(self.mesh.vertices), 3))
        with self._lock:
            self._session.call(lib.starg_morph_frame, self._handle, float(t),
                               _arrays.pointer("double[]", rows))
        return rows

    def frame(self, t: float) -> Mesh:
        """The shape at time t in [0, 1]."""
        return Mesh(self.positions(t), self.mesh.faces)

    def measure(self, t: float, positions: ArrayLike | None = None) -> FrameMeasures:
        """Quality of the shape at time t; `positions` (n, 3) replace those of `positions(t)`."""
        rows = self.positions(t) if positions is None else _arrays.reals(positions, 3, "positions")
        if len(rows) != len(self.mesh.vertices):
            raise ArgumentError(f"A has {len(self.mesh.vertices)} vertices, not {len(rows)}")
        out = ffi.new("starg_frame_measures *")
        with self._lock:
            self._session.call(lib.starg_morph_measure, self._handle, float(t),
                               _arrays.pointer("double[]", rows), out)
        return fill(FrameMeasures, out)

    def write_animation(self, path: PathLike, frames: int = 21, seconds: float = 2.0) -> None:
        """Writes an animated .glb of the morph.

        >>> import starguard
        >>> a, b = (starguard.sample("dog", pose=pose, vertices=500) for pose in (0, 1))
        >>> starguard.Morph(a, b, method="linear").write_animation("dog.glb", frames=5)
        """
        moments = np.linspace(0, 1, frames)
        write_animation(path, self.mesh, [self.positions(t) for t in moments], seconds)


def write_animation(path: PathLike, model: Any, frames: Sequence[ArrayLike],
                    seconds: float = 2.0) -> None:
    """Writes an animated .glb of a mesh: frames of shape (n, 3), in equal steps.

    >>> import starguard
    >>> star = starguard.sample("star", vertices=500)
    >>> starguard.write_animation("grow.glb", star, [star.vertices, 2 * star.vertices])
    """
    mesh = as_mesh(model)
    rows = [_arrays.reals(frame, 3, "frames") for frame in frames]
    for row in rows:
        if len(row) != len(mesh.vertices):
            raise ArgumentError(f"the mesh has {len(mesh.vertices)} vertices, a frame {len(row)}")
    pointers = [_arrays.pointer("double[]", row) for row in rows]
    session = Session()
    session.call(lib.starg_animation_write, session.context, mesh._handle,
                 ffi.new("double *[]", pointers), len(rows), float(seconds), _arrays.path(path))


def read_animation(path: PathLike) -> list[Mesh]:
    """Reads the frames of such a file: meshes with the same faces.

    >>> import starguard
    >>> star = starguard.sample("star", vertices=500)
    >>> starguard.write_animation("grow.glb", star, [star.vertices, 2 * star.vertices])
    >>> len(starguard.read_animation("grow.glb"))
    2
    """
    session = Session()
    return _read_animation(session, lib.starg_animation_read, _arrays.path(path))


def animation_from_bytes(data: bytes, name: str = "memory") -> list[Mesh]:
    """The same from the bytes of such a file; `name` is used in messages.

    >>> import pathlib, starguard
    >>> star = starguard.sample("star", vertices=500)
    >>> starguard.write_animation("grow.glb", star, [star.vertices, 2 * star.vertices])
    >>> len(starguard.animation_from_bytes(pathlib.Path("grow.glb").read_bytes()))
    2
    """
    session = Session()
    return _read_animation(session, lib.starg_animation_read_memory,
                           ffi.from_buffer(data) if data else ffi.NULL, len(data),
                           _arrays.path(name))


def _read_animation(session: Session, function: Any, *arguments: Any) -> list[Mesh]:
    out, number = ffi.new("starg_mesh ***"), ffi.new("size_t *")
    try:
        session.call(function, session.context, *arguments, out, number)
        return [_copy(out[0][i]) for i in range(number[0])]
    finally:
        if out[0]:
            lib.starg_animation_free(session.context, out[0], number[0])


def _copy(mesh: Any) -> Mesh:
    vertex_count, face_count = lib.starg_mesh_vertex_count(mesh), lib.starg_mesh_face_count(mesh)
    return Mesh(_arrays.view(None, lib.starg_mesh_vertices(mesh), (vertex_count, 3), np.float64),
                _arrays.view(None, lib.starg_mesh_faces(mesh), (face_count, 3), np.uint32))
