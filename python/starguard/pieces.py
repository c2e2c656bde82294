# SPDX-License-Identifier: Apache-2.0
"""Star decomposition: few pieces, each entirely visible from its guard."""
from __future__ import annotations

import os
import tempfile
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any, Iterator

import numpy as np
from numpy.typing import ArrayLike

from . import _arrays, _others
from ._fields import fill
from ._library import ffi, lib, text
from ._options import Options, takes
from ._session import Session, logger
from ._types import Array, PathLike, Progress
from .errors import ArgumentError, MeshError
from .guards import name_of
from .mesh import Mesh
from .tetra import NO_NEIGHBOUR, TetMesh, TetraReport, as_shape

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from ._keywords import DecomposeOptions

OPTIONS = Options("starg_decompose_options")


@dataclass(frozen=True, eq=False)
class Decomposition:
    """A partitioned solid: a sequence of pieces, which are the rows of `pieces`. The arrays are
    read-only views of the library's memory."""

    #: The model's path as given, or None.
    file: str | None
    #: "strict" or "paper".
    mode: str
    #: Size of the model.
    model_vertices: int
    model_faces: int
    model_tetrahedra: int
    #: How the model was filled.
    tetra: TetraReport
    mesh: TetMesh
    #: The piece of each tetrahedron, (m,).
    labels: Array
    #: Structured: `guard` (k, 3), `radius`, `margin`, `tetrahedra`, `volume`, `star`, `spread`.
    pieces: Array
    #: Pieces that share faces, structured: `first`, `second`, `area`.
    contacts: Array
    #: Number of pieces proven star-shaped.
    strictly_star: int
    #: Fraction of the vertices visible from the guards of their pieces.
    visible_vertices: float
    flattest: float
    flattest_given: float
    #: Dihedral angles in degrees; -1: not told.
    smallest_angle: float
    median_angle: float
    smallest_angle_made: float
    time_limited: bool
    #: No fewer star-shaped pieces make up the model, however it is cut; 0: not sought.
    lower_bound: int
    #: As many pieces as `lower_bound`.
    optimal: bool
    #: With `balls`: images of the corners of each tetrahedron in the unit ball of its piece, (m, 4, 3).
    ball_corners: Array | None
    #: Largest over smallest singular value of these maps: at most, and on average by volume; and the
    #: share of the volume where it is above 10.
    ball_worst: float
    ball_mean: float
    ball_above_10: float
    #: The options of `decompose` that were used, and the seed; None where a file does not tell.
    options: dict[str, Any] | None
    seed: int | None
    _handle: Any = field(repr=False)

    def __repr__(self) -> str:
        return f"Decomposition({len(self)} pieces, {self.strictly_star} proven star-shaped)"

    def __len__(self) -> int:
        return len(self.pieces)

    def __getitem__(self, index: Any) -> Any:
        return self.pieces[index]

    def __iter__(self) -> Iterator[Any]:
        return iter(self.pieces)

    def __reduce__(self) -> tuple[Any, ...]:
        with tempfile.TemporaryDirectory(prefix="starguard-") as folder:
            files = os.path.join(folder, "pieces.vtk"), os.path.join(folder, "pieces.json")
            self.write(files[0], binary=True)
            self.write_report(files[1])
            contents = []
            for name in files:
                with open(name, "rb") as file:
                    contents.append(file.read())
        return _unpickled, (*contents, self.options)

    def _repr_html_(self) -> str:
        from .pictures import distinct_colors

        model, pieces = self._outside()
        facts = {"pieces": len(self), "proven star-shaped": self.strictly_star,
                 "lower bound": self.lower_bound or "not sought"}
        return _others.card(repr(self), model, facts, opacity=1.0,
                            face_colors=distinct_colors(len(self))[pieces])

    def _outside(self) -> tuple[Mesh, Array]:
        """The boundary of the solid, and the piece of each of its faces."""
        around = [(1, 2, 3), (0, 3, 2), (0, 1, 3), (0, 2, 1)]  # outward, opposite each corner
        faces, pieces = [], []
        for corner, others in enumerate(around):
            outer = self.mesh.neighbours[:, corner] == NO_NEIGHBOUR
            faces.append(self.mesh.tetrahedra[outer][:, others])
            pieces.append(self.labels[outer])
        return Mesh(self.mesh.vertices, np.concatenate(faces)), np.concatenate(pieces)

    def to_pyvista(self) -> Any:
        """A copy as `pyvista.UnstructuredGrid` with the piece of each cell as `piece`."""
        return _others.pyvista_tetrahedra(self.mesh.vertices, self.mesh.tetrahedra, {"piece": self.labels})

    def to_meshio(self) -> Any:
        """A copy as `meshio.Mesh` of tetrahedra with the piece of each as `piece`.

        >>> import starguard
        >>> pieces = starguard.decompose(starguard.sample("l-room", vertices=500), effort=10)
        >>> len(set(pieces.to_meshio().cell_data["piece"][0])) == len(pieces)
        True
        """
        return _others.meshio(self.mesh.vertices, "tetra", self.mesh.tetrahedra, {"piece": self.labels})

    @property
    def guards(self) -> Array:
        """The guard of each piece, (k, 3)."""
        return self.pieces["guard"]

    def surfaces(self) -> list[Mesh]:
        """The closed outward surface of each piece.

        >>> import starguard
        >>> room = starguard.sample("l-room", vertices=500)
        >>> [piece.check().usable for piece in starguard.decompose(room, time_limit=5).surfaces()]
        [True]
        """
        session = Session()
        out, numbers = ffi.new("starg_mesh **"), ffi.new("uint32_t **")
        try:
            session.call(lib.starg_decomposition_surfaces, session.context, self._handle, out, numbers)
        finally:
            handle = session.own(out[0], lib.starg_mesh_free) if out[0] else None
            owner = (session.own(numbers[0], lib.starg_tetmesh_map_free, shared=True)
                     if numbers[0] else None)
        whole = Mesh._of(handle)
        first = _arrays.view(owner, numbers[0], (len(self) + 1,), np.uint32)
        meshes = []
        for begin, end in zip(first[:-1], first[1:]):
            faces = whole.faces[begin:end]
            low, high = faces.min(), faces.max()
            meshes.append(Mesh(whole.vertices[low:high + 1], faces - low))
        return meshes

    @classmethod
    def read(cls, pieces: PathLike, report: PathLike) -> Decomposition:
        """Reads PIECES.vtk and PIECES.json (docs/formats.md).

        >>> import starguard
        >>> room = starguard.sample("l-room", vertices=500)
        >>> made = starguard.decompose(room, time_limit=5)
        >>> made.write("pieces.vtk"), made.write_report("pieces.json")
        (None, None)
        >>> starguard.Decomposition.read("pieces.vtk", "pieces.json")
        Decomposition(1 pieces, 1 proven star-shaped)
        """
        session = Session()
        return _of(session.make(
            "starg_decomposition", lib.starg_decomposition_free, lib.starg_decomposition_read,
            session.context, _arrays.path(pieces), _arrays.path(report), shared=True))

    @classmethod
    def from_bytes(cls, pieces: bytes, report: bytes) -> Decomposition:
        """Reads the bytes of both files."""
        session = Session()
        keep = [(ffi.from_buffer(data) if data else ffi.NULL, len(data), ffi.new("char[]", name))
                for data, name in ((pieces, b"pieces"), (report, b"report"))]
        files = [ffi.new("starg_file_bytes *", file) for file in keep]
        return _of(session.make(
            "starg_decomposition", lib.starg_decomposition_free,
            lib.starg_decomposition_read_memory, session.context, *files, shared=True))

    def write(self, path: PathLike, *, binary: bool = False) -> None:
        """Writes PIECES.vtk (docs/formats.md).

        >>> import starguard
        >>> pieces = starguard.decompose(starguard.sample("l-room", vertices=500), time_limit=5)
        >>> pieces.write("pieces.vtk")
        >>> pieces.write_report("pieces.json")
        """
        session = Session()
        session.call(lib.starg_decomposition_write, session.context, self._handle,
                     _arrays.path(path), binary)

    def write_report(self, path: PathLike, model_file: PathLike | None = None) -> None:
        """Writes PIECES.json with `model_file` as the model's path. Default: the file that the model
        was read from, if any."""
        session = Session()
        name = model_file if model_file is not None else self.file
        session.call(lib.starg_decomposition_write_report, session.context, self._handle,
                     _arrays.path(name) if name is not None else ffi.NULL, _arrays.path(path))

    def write_groups(self, path: PathLike) -> None:
        """Writes the surfaces of all pieces as OBJ, one group each."""
        session = Session()
        session.call(lib.starg_decomposition_write_groups, session.context, self._handle,
                     _arrays.path(path))


def _certified(session: Session, path: PathLike, solid: Any, wanted: Any, **call: Any) -> Any:
    """Pieces, and the file that says why no fewer are possible than their bound says."""
    text, size = ffi.new("char **"), ffi.new("size_t *")
    out = ffi.new("starg_decomposition **")
    try:
        session.call(lib.starg_decompose_certified, session.context, solid, wanted, out, text, size,
                     **call)
    finally:  # an interrupted call may still have finished
        handle = session.own(out[0], lib.starg_decomposition_free, shared=True) if out[0] else None
        why = session.own(text[0], lib.starg_text_free, shared=True) if text[0] else None
    session.call(lib.starg_certificate_write, session.context, why, size[0], _arrays.path(path))
    return handle


def _unpickled(pieces: bytes, report: bytes, options: dict[str, Any] | None) -> Decomposition:
    """A decomposition from its pickle: the files do not tell all options."""
    return replace(Decomposition.from_bytes(pieces, report), options=options)


@takes(OPTIONS)
def decompose(model: Any, *, guards: ArrayLike | None = None,
              certificate: PathLike | None = None, threads: int | None = None,
              seed: int | None = None, time_limit: float | None = None,
              progress: Progress | None = None,
              **options: Unpack[DecomposeOptions]) -> Decomposition:
    """Cuts a solid into few star-shaped pieces, each entirely visible from its guard.

    The model is anything `as_mesh` accepts, or a TetMesh. A surface with holes is filled, with a
    notice, if the filled volume is near the surface or `fill` is true. `guards` (n, 3) are seeds, or
    points to try first. `effort` is "quick", "normal" or "best", a fixed amount of work (about 2, 5
    and 20 seconds where there is so much to try), which gives the same result everywhere, or a
    number of trials. With `time_limit` and no number of trials it continues until that time and
    returns its best result. With `prove=True`,
    `lower_bound` holds for all ways to cut a surface into star-shaped pieces, and `certificate` is a
    file to write that says why; `verify(model, pieces, file)` checks it.

    >>> import starguard
    >>> pieces = starguard.decompose(starguard.sample("l-room", vertices=500), time_limit=5)
    >>> pieces, pieces.guards.shape, bool(pieces.pieces["star"].all())
    (Decomposition(1 pieces, 1 proven star-shaped), (1, 3), True)
    """
    wanted = OPTIONS.make(options)
    shape = as_shape(model)
    session = Session(threads, seed)
    if guards is not None:
        places = _arrays.points(guards, "guards")
        points = _arrays.pointer("double[]", places)
        wanted.pointer.guards = points
        wanted.pointer.guard_count = len(places)
    function, handle = _subject(shape)
    if certificate is not None:
        if function != lib.starg_decompose:
            raise ArgumentError("a certificate says why a bound for pieces of a closed surface holds")
        made = _certified(session, certificate, handle, wanted.pointer, progress=progress,
                          time_limit=time_limit)
    else:
        made = session.make("starg_decomposition", lib.starg_decomposition_free, function,
                            session.context, handle, wanted.pointer, shared=True,
                            progress=progress, time_limit=time_limit)
    return _of(made, shape.file)


def _subject(shape: Mesh | TetMesh) -> tuple[Any, Any]:
    """The function that cuts a shape, and its argument."""
    if isinstance(shape, TetMesh):
        return lib.starg_decompose_tetmesh, shape._handle
    try:
        return lib.starg_decompose, shape.solid._handle
    except MeshError as error:
        if len(error.elements) == 0:  # encloses nothing
            raise
        logger.info("%s; isosurface stuffing fills the region whose winding number exceeds 1/2 "
                    "and thereby closes holes", error)
        return lib.starg_decompose_open_mesh, shape._handle


def _of(d: Any, file: PathLike | None = None) -> Decomposition:
    mesh = TetMesh._of(d.mesh, owner=d)
    return fill(Decomposition, d, _handle=d, file=text(d.file) if d.file else name_of(file),
                mode=OPTIONS.word("mode", d.mode),
                options=OPTIONS.read(ffi.addressof(d, "options")) if d.options_known else None,
                seed=d.seed if d.options_known else None,
                tetra=TetraReport._of(d.tetra), mesh=mesh,
                labels=_arrays.view(d, d.labels, (len(mesh.tetrahedra),), np.int32),
                ball_corners=(_arrays.view(d, d.ball_corners, (len(mesh.tetrahedra), 4, 3),
                                           np.float64) if d.ball_corners else None),
                pieces=_arrays.records(d, d.pieces, d.piece_count),
                contacts=_arrays.records(d, d.contacts, d.contact_count))
