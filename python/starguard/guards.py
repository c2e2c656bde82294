# SPDX-License-Identifier: Apache-2.0
"""Guarding: few points inside a solid that together see its whole boundary, with a proven bound."""
from __future__ import annotations

import multiprocessing
import os
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any, Iterable, Iterator

import numpy as np
from numpy.typing import ArrayLike

from . import _arrays, _others
from ._choice import choose
from ._fields import fill
from ._library import ffi, lib, text
from ._options import Options, takes
from ._session import Session
from ._told import Told
from ._types import Array, PathLike, Progress
from .solid import as_solid

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from ._keywords import GuardOptions
    from .mesh import Mesh

_OPTIONS = Options("starg_guard_options", old={
    "candidate_count": "count", "engine": "visibility", "face_rule": "faces"})
_CANDIDATES = {word: number for number, word in enumerate(_OPTIONS.fields["candidates"].words)
               if number != lib.STARG_CANDIDATES_GIVEN}


@dataclass(frozen=True, eq=False, repr=False)
class GuardLevel(Told):
    """The guards of one level of detail; they cover all that some candidate sees."""

    vertex_count: int
    face_count: int
    #: (n, 3), those kept from the coarser level first. No copy.
    positions: Array
    #: Number of guards kept.
    kept: int


@dataclass(frozen=True, eq=False)
class Guard:
    """One of the guards of a result."""

    #: (3,).
    position: Array
    #: Viewing direction and what is up there, (3,); None if it looks all around.
    direction: Array | None
    up: Array | None
    #: Number of faces that it sees.
    seen_faces: int
    #: Level of detail at which it was chosen; 0: the coarsest.
    level: int


@dataclass(frozen=True, eq=False)
class Tour:
    """A way from the first guard to the last one, past all others in their order; guards that stay are
    no part of it. Its segments meet no face, but for blocked legs, which are straight."""

    #: Of all segments.
    length: float
    #: (n, 3).
    points: Array
    #: Which of the points is each guard, ascending from 0.
    stops: Array
    #: Legs, from stop i to the next one, for which no free way was found.
    blocked: Array


@dataclass(frozen=True, eq=False)
class Guards:
    """A guarding result: a sequence of Guard, with arrays of all of them. Faces are indices into the
    model. The arrays are read-only views of the library's memory.

    >>> import starguard
    >>> guards = starguard.guard(starguard.sample("l-room", vertices=500))
    >>> [guard.seen_faces for guard in guards], guards[0].position.shape
    ([1008], (3,))
    """

    #: The model's path as given, or None.
    file: str | None
    vertex_count: int
    face_count: int
    #: (k, 3).
    positions: Array
    #: Viewing directions, (k, 3); None where guards look all around.
    directions: Array | None
    #: What is up there, (k, 3); None without a field of view.
    ups: Array | None
    #: Number of faces visible from each guard, (k,).
    seen_faces: Array
    #: Whether each guard was given to stay, (k,).
    kept: Array
    #: With needs of faces: number of those faces that as many guards see as they need.
    met_needs: int
    #: Level of detail at which each guard was chosen, (k,); 0: the coarsest.
    levels: Array
    #: With method "pilp": the levels before refinement, coarsest first.
    level_list: list[GuardLevel]
    #: Covered fraction of all faces, and of their area.
    coverage_faces: float
    coverage_area: float
    #: Number of faces that some candidate sees.
    coverable_faces: int
    #: With a baseline: number of faces that two guards see from places so far apart.
    baseline_faces: int
    #: With a redundancy above 1: number of faces that at least 1, 2, ... guards see.
    redundant_faces: Array
    #: Faces that no guard sees, ascending.
    uncovered: Array
    #: Of them: proven to be seen from nowhere where guards may stand; 0 in results that were read.
    unseen_count: int
    #: The same for vertices, only with target "vertices".
    coverage_vertices: float
    coverable_vertices: int
    uncovered_vertices: Array
    #: With `order`: the way through the guards, else None.
    tour: Tour | None
    #: Fractions of faces and of area covered by the first 1, 2, ... guards.
    curve_faces: Array
    curve_area: Array
    #: Numbers of guards that the search had, and the counted work, in about microseconds, after which
    #: it had found them.
    step_guards: Array
    step_work: Array
    candidate_count: int
    lines_tested: int
    #: Proven: no fewer candidates cover as much.
    lower_bound: int
    #: The number of guards equals that bound: no fewer of the candidates suffice.
    optimal: bool
    #: No fewer guards cover as much, wherever they stand; 0 if this was not sought.
    lower_bound_everywhere: int
    #: The number of guards equals that bound.
    optimal_everywhere: bool
    #: With max_guards: upper bound on the area fraction that so many guards cover.
    area_bound: float
    #: With max_guards and prove: the same wherever they stand; 0 if this was not sought.
    area_bound_everywhere: float
    time_limited: bool
    #: The options of `guard` that were used.
    options: dict[str, Any]
    #: The model that was guarded; None for a result that was read from a file.
    model: Mesh | None
    _handle: Any = field(repr=False)
    _owner: Any = field(repr=False)

    def __repr__(self) -> str:
        return (f"Guards({len(self)}, lower_bound={self.lower_bound}, "
                f"coverage_area={self.coverage_area:.6g})")

    def __len__(self) -> int:
        return len(self.positions)

    def __getitem__(self, index: Any) -> Any:
        """A guard, or a list of them."""
        if isinstance(index, slice):
            return [self[i] for i in range(*index.indices(len(self)))]
        return Guard(self.positions[index], None if self.directions is None else self.directions[index],
                     None if self.ups is None else self.ups[index], int(self.seen_faces[index]),
                     int(self.levels[index]))

    def __iter__(self) -> Iterator[Guard]:
        return (self[i] for i in range(len(self)))

    def __reduce__(self) -> tuple[Any, ...]:
        return _unpickled, (self._bytes(), self.model, self.lines_tested, self.options)

    def _bytes(self) -> bytes:
        """The contents of its file."""
        session = Session()
        data, size = ffi.new("char **"), ffi.new("size_t *")
        session.call(lib.starg_guards_write_memory, session.context, self._handle,
                     _arrays.path(self.file) if self.file is not None else ffi.NULL, data, size)
        try:
            return bytes(ffi.buffer(data[0], size[0]))
        finally:
            lib.starg_text_free(session.context, data[0])

    def _repr_html_(self) -> str:
        from .pictures import distinct_colors

        facts = {"guards": len(self), "lower bound": self.lower_bound,
                 "coverage": f"{self.coverage_area:.4%} of the area, {self.coverage_faces:.4%} of the faces"}
        return _others.card(repr(self), self.model, facts, points=self.positions, views=self,
                            point_colors=distinct_colors(len(self)) if len(self) > 0 else None)

    @staticmethod
    def _tour(keeper: Any, t: Any) -> Tour:
        return Tour(t.length, _arrays.view(keeper, t.points, (t.point_count, 3), np.float64),
                    _arrays.view(keeper, t.stops, (t.stop_count,), np.uint32),
                    _arrays.view(keeper, t.blocked, (t.blocked_count,), np.uint32))

    @classmethod
    def _of(cls, g: Any, file: PathLike | None = None, owner: Any = None,
            model: Mesh | None = None) -> Guards:
        """Wraps a handle, or an object that `owner` keeps alive."""
        keeper, count = g if owner is None else owner, g.count
        levels = [
            GuardLevel(v.vertex_count, v.face_count,
                       _arrays.view(keeper, v.positions, (v.count, 3), np.float64), v.kept)
            for v in (g.level_list[i] for i in range(g.level_count))]
        return fill(
            cls, g, _handle=g, _owner=keeper, model=model, file=text(g.file) if g.file else name_of(file), level_list=levels,
            positions=_arrays.view(keeper, g.positions, (count, 3), np.float64),
            directions=_arrays.view(keeper, g.directions, (count, 3), np.float64) if g.directions else None,
            ups=_arrays.view(keeper, g.ups, (count, 3), np.float64) if g.ups else None,
            seen_faces=_arrays.view(keeper, g.seen_faces, (count,), np.uintp),
            kept=_arrays.view(keeper, g.kept, (count,), np.bool_) if g.kept else np.zeros(count, bool),
            levels=_arrays.view(keeper, g.levels, (count,), np.intc),
            redundant_faces=_arrays.view(keeper, g.redundant_faces, (g.redundant_count,), np.uintp),
            uncovered=_arrays.view(keeper, g.uncovered, (g.uncovered_count,), np.uint32),
            uncovered_vertices=_arrays.view(keeper, g.uncovered_vertices, (g.uncovered_vertex_count,),
                                            np.uint32),
            tour=cls._tour(keeper, g.tour) if g.tour.point_count > 0 else None,
            step_guards=_arrays.view(keeper, g.step_guards, (g.step_count,), np.uintp),
            step_work=_arrays.view(keeper, g.step_work, (g.step_count,), np.uint64),
            curve_faces=_arrays.view(keeper, g.curve_faces, (count,), np.float64),
            curve_area=_arrays.view(keeper, g.curve_area, (count,), np.float64),
            options=_OPTIONS.read(ffi.addressof(g, "options")))

    @classmethod
    def read(cls, path: PathLike) -> Guards:
        """Reads GUARDS.json (docs/formats.md).

        >>> import starguard
        >>> room = starguard.sample("l-room", vertices=500)
        >>> starguard.guard(room).write("guards.json")
        >>> starguard.Guards.read("guards.json")
        Guards(1, lower_bound=1, coverage_area=1)
        """
        session = Session()
        return cls._of(session.make("starg_guards", lib.starg_guards_free, lib.starg_guards_read,
                                    session.context, _arrays.path(path), shared=True))

    @classmethod
    def from_bytes(cls, data: bytes, name: str = "memory") -> Guards:
        """Reads the bytes of a GUARDS.json; `name` is used in messages."""
        session = Session()
        return cls._of(session.make(
            "starg_guards", lib.starg_guards_free, lib.starg_guards_read_memory, session.context,
            ffi.from_buffer(data) if data else ffi.NULL, len(data), _arrays.path(name), shared=True))

    def write(self, path: PathLike, model_file: PathLike | None = None) -> None:
        """Writes GUARDS.json with `model_file` as the model's path. Default: the file that the model
        was read from, if any."""
        session = Session()
        name = model_file if model_file is not None else self.file
        session.call(lib.starg_guards_write, session.context, self._handle,
                     _arrays.path(name) if name is not None else ffi.NULL, _arrays.path(path))

    def write_poses(self, path: PathLike) -> None:
        """Writes poses for other programs, as CSV or JSON by the extension (docs/formats.md)."""
        session = Session()
        name = os.fsdecode(path)
        session.call(lib.starg_guards_write_poses, session.context, self._handle,
                     name.lower().endswith(".csv"), _arrays.path(path))


    def _write_tables(self, function: Any, path: PathLike, model: Any) -> None:
        session = Session()
        solid = as_solid(model if model is not None else self.model)
        groups = ffi.new("starg_face_groups *")
        file = solid.mesh.file
        named = file is not None and os.path.exists(file)
        if file is not None and named:
            session.call(lib.starg_face_groups_read, session.context, _arrays.path(file), groups)
        try:
            function(session, solid, groups if named else ffi.NULL, _arrays.path(path))
        finally:
            lib.starg_face_groups_free(session.context, groups)

    def _write_as(self, function: Any) -> Any:
        def write(session: Session, solid: Any, groups: Any, path: Any) -> None:
            session.call(function, session.context, solid._handle, self._handle, groups, path)
        return write

    def write_table(self, path: PathLike, model: Any = None) -> None:
        """Writes a row for each face as CSV: which guards see it (docs/formats.md). `model` is the scene
        that was guarded; default: the model."""
        self._write_tables(self._write_as(lib.starg_guards_write_table), path, model)

    def write_summary(self, path: PathLike, model: Any = None) -> None:
        """Writes a row for each guard and for each group of faces as CSV."""
        self._write_tables(self._write_as(lib.starg_guards_write_summary), path, model)

    def write_sheet(self, path: PathLike, model: Any = None, *, title: str | None = None) -> None:
        """Writes a sheet to be printed and handed over, one HTML file (docs/viewer.md): a plan, what is
        seen through each lens, tables. `model` is the scene that was guarded; default: the model."""
        def write(session: Session, solid: Any, groups: Any, name: Any) -> None:
            text = ffi.new("char[]", (title if title is not None else self.file or "starguard").encode())
            sheet = ffi.new("starg_sheet *")
            sheet.title, sheet.scene, sheet.guards, sheet.groups = text, solid._handle, self._handle, groups
            session.call(lib.starg_sheet_write, session.context, sheet, name)
        self._write_tables(write, path, model)

    def write_curve(self, path: PathLike) -> None:
        """Writes what 1, 2, ... guards see, as CSV or SVG by the extension. Only with `worth`."""
        session = Session()
        session.call(lib.starg_guards_write_curve, session.context, self._handle,
                     os.fsdecode(path).lower().endswith(".svg"), _arrays.path(path))

    def write_matrix(self, path: PathLike) -> None:
        """Writes the set cover of the candidates as text. Only with `worth`."""
        session = Session()
        session.call(lib.starg_guards_write_matrix, session.context, self._handle, _arrays.path(path))


def _poses(given: ArrayLike, what: str) -> tuple[Any, list[Any]]:
    """The number of poses, and pointers to their places, directions and ups; these may be NULL."""
    width = (np.shape(given)[-1:] or (3,))[0]
    rows = _arrays.points(given, what, width if width in (6, 9) else 3)
    parts = [np.ascontiguousarray(rows[:, i:i + 3]) for i in range(0, rows.shape[1], 3)]
    pointers = [_arrays.pointer("double[]", part) for part in parts]
    return len(rows), pointers + [ffi.NULL] * (3 - len(pointers))


def audit(model: Any, poses: ArrayLike, *, threads: int | None = None, time_limit: float | None = None,
          progress: Progress | None = None, **options: Any) -> Guards:
    """What given guards see, without a search: poses of shape (n, 3), (n, 6) or (n, 9) as in `guard`, and
    the options of `visible`.

    >>> import starguard
    >>> room = starguard.sample("l-room", vertices=500)
    >>> seen = starguard.audit(room, [[0.5, 0.5, 0.5, 1, 0, 0]], fov=(90, 60))
    >>> len(seen), 0 < seen.coverage_area < 1
    (1, True)
    """
    from .visibility import _OPTIONS as views

    wanted = views.make(options)
    count, (places, directions, ups) = _poses(poses, "poses")
    given = ffi.new("starg_poses *")
    given.points, given.directions, given.ups, given.count = places, directions, ups, count
    solid = as_solid(model)
    session = Session(threads)
    handle = session.make("starg_guards", lib.starg_guards_free, lib.starg_guards_audit, session.context,
                          solid._handle, given, wanted.pointer, shared=True, progress=progress,
                          time_limit=time_limit)
    return Guards._of(handle, solid.mesh.file, model=solid.mesh)


def _certified(session: Session, path: PathLike, solid: Any, wanted: Any, **call: Any) -> Any:
    """Guards, and the file that says why their bound holds."""
    text, size = ffi.new("char **"), ffi.new("size_t *")
    out = ffi.new("starg_guards **")
    try:
        session.call(lib.starg_guard_certified, session.context, solid, wanted, out, text, size, **call)
    finally:  # an interrupted call may still have finished
        handle = session.own(out[0], lib.starg_guards_free, shared=True) if out[0] else None
        why = session.own(text[0], lib.starg_text_free, shared=True) if text[0] else None
    session.call(lib.starg_certificate_write, session.context, why, size[0], _arrays.path(path))
    return handle


@takes(_OPTIONS)
def guard(model: Any, *, candidates: str | ArrayLike | None = None,
          keep: ArrayLike | None = None, worth: bool = False,
          certificate: PathLike | None = None, threads: int | None = None,
          seed: int | None = None, time_limit: float | None = None,
          progress: Progress | None = None, **options: Unpack[GuardOptions]) -> Guards:
    """Places few guards that together see the whole boundary.

    `candidates` selects candidate positions: on the curve "skeleton" (default), on the "medial"
    axis, on a lattice in the "interior", or points of shape (n, 3), (n, 6) with the direction in
    which a camera looks, or (n, 9) with what is up for it. Faces that no candidate sees
    are listed in `uncovered` and are not an error. With `prove=True`, `certificate` is a file to write
    that says why `lower_bound_everywhere` holds; `verify(model, guards, file)` checks it. Guards of `keep`,
    poses like those of candidates, stay and come first; the bounds are of the others. With `worth`, the
    result can write its curve and its matrix.

    >>> import starguard
    >>> guards = starguard.guard(starguard.sample("l-room", vertices=500))
    >>> len(guards), guards.lower_bound, guards.optimal, guards.positions.shape
    (1, 1, True, (1, 3))
    """
    wanted = _OPTIONS.make(options)
    session = Session(threads, seed)
    if isinstance(candidates, str):
        wanted.pointer.candidates = choose("candidates", candidates, _CANDIDATES)
    elif candidates is not None:
        width = (np.shape(candidates)[-1:] or (3,))[0]
        given = _arrays.points(candidates, "candidates", width if width in (6, 9) else 3)
        places, looks, ups = (np.ascontiguousarray(given[:, i:i + 3]) for i in (0, 3, 6))
        points, directions, above = (_arrays.pointer("double[]", part) for part in (places, looks, ups))
        if width >= 6:
            wanted.pointer.directions = directions
        if width == 9:
            wanted.pointer.ups = above
        wanted.pointer.candidates = lib.STARG_CANDIDATES_GIVEN
        wanted.pointer.points = points
        wanted.pointer.point_count = len(places)
    wanted.pointer.worth = worth
    if keep is not None:
        wanted.pointer.keep_count, stay = _poses(keep, "keep")
        wanted.pointer.keep, wanted.pointer.keep_directions, wanted.pointer.keep_ups = stay
    solid = as_solid(model)
    if certificate is not None:
        handle = _certified(session, certificate, solid._handle, wanted.pointer, progress=progress,
                            time_limit=time_limit)
    else:
        handle = session.make("starg_guards", lib.starg_guards_free, lib.starg_guard,
                              session.context, solid._handle, wanted.pointer, shared=True,
                              progress=progress, time_limit=time_limit)
    return Guards._of(handle, solid.mesh.file, model=solid.mesh)


def _guard_one(work: tuple[Any, dict[str, Any]]) -> Guards:
    model, options = work
    return guard(model, **options)


def guard_many(models: Iterable[Any], *, processes: int | None = None, **options: Any) -> list[Guards]:
    """`guard` of each model, in their order, with the same options, on as many `processes` as there are cores (None),
    one thread each. Models are such as `multiprocessing` can send: file names, Mesh, arrays. The first that
    fails ends it with its error. A script that calls this needs `if __name__ == "__main__":` around the call, since
    each process imports it.

    >>> import starguard
    >>> len(starguard.guard_many([starguard.sample("l-room", vertices=500)] * 2, processes=1))
    2
    """
    works = [(model, {"threads": 1, **options}) for model in models]
    if processes == 1:
        return [_guard_one(work) for work in works]
    with multiprocessing.get_context("spawn").Pool(processes) as pool:
        return pool.map(_guard_one, works, chunksize=1)


def _unpickled(data: bytes, model: Mesh | None, lines_tested: int, options: dict[str, Any]) -> Guards:
    """The file's contents, and what it does not tell."""
    return replace(Guards.from_bytes(data, "pickle"), model=model, lines_tested=lines_tested, options=options)


def unseen(model: Any, *, clearance: float = 0.0, work: int = 30_000_000, threads: int | None = None,
           time_limit: float | None = None, progress: Progress | None = None) -> Array:
    """For each face: 0 if some point of the free space sees it, 1 if none does, proven, 2 if neither is
    known, 3 if it need not be seen. `work` is a budget, about a microsecond each.

    >>> import starguard
    >>> room = starguard.sample("l-room", vertices=500)
    >>> int(starguard.unseen(room).max())
    0
    """
    solid = as_solid(model)
    session = Session(threads)
    out = ffi.new("uint8_t **")
    session.call(lib.starg_unseen, session.context, solid._handle, ffi.NULL, clearance, work, out,
                 progress=progress, time_limit=time_limit)
    faces = lib.starg_space_model_faces(solid._handle)
    try:
        return np.frombuffer(ffi.buffer(out[0], faces), np.uint8).copy()
    finally:
        lib.starg_unseen_free(session.context, out[0])


def name_of(file: PathLike | None) -> str | None:
    """A file name as text."""
    return None if file is None else os.fsdecode(file)


def candidate_points(model: Any, source: str = "skeleton", count: int = 1000, *,
                     clearance: float = 0.0, threads: int | None = None, seed: int | None = None,
                     time_limit: float | None = None, progress: Progress | None = None) -> Array:
    """Candidate points of shape (n, 3): "skeleton", "medial" or "interior".

    >>> import starguard
    >>> room = starguard.sample("l-room", vertices=500)
    >>> starguard.candidate_points(room, "interior", 50).shape[1]
    3
    """
    kind = choose("source", source, _CANDIDATES)
    solid = as_solid(model)
    session = Session(threads, seed)
    out, number = ffi.new("double **"), ffi.new("size_t *")
    try:
        session.call(lib.starg_candidate_points, session.context, solid._handle,
                     kind, count, float(clearance), out, number,
                     progress=progress, time_limit=time_limit)
    finally:
        owner = session.own(out[0], lib.starg_points_free, shared=True) if out[0] else None
    return _arrays.view(owner, out[0], (number[0], 3), np.float64)


def read_points(path: PathLike) -> Array:
    """Reads points, shape (n, 3): text with three numbers per line, the nodes of a skeleton (OBJ, CG,
    VTK), or the guards of a GUARDS.json. With viewing directions, six numbers per line: (n, 6); with
    what is up there, nine: (n, 9).

    >>> import pathlib, starguard
    >>> _ = pathlib.Path("places.txt").write_text("1.5 1.7 2 # hall\\n4 1.7 2\\n")
    >>> starguard.read_points("places.txt")
    array([[1.5, 1.7, 2. ],
           [4. , 1.7, 2. ]])
    """
    session = Session()
    return _read_points(session, lib.starg_poses_read, _arrays.path(path))


def points_from_bytes(data: bytes, name: str = "memory") -> Array:
    """The same from the bytes of such a file; `name` is used in messages.

    >>> import starguard
    >>> starguard.points_from_bytes(b"1 2 3")
    array([[1., 2., 3.]])
    """
    session = Session()
    return _read_points(session, lib.starg_poses_read_memory,
                        ffi.from_buffer(data) if data else ffi.NULL, len(data), _arrays.path(name))


def _read_points(session: Session, function: Any, *arguments: Any) -> Array:
    poses = ffi.new("starg_poses *")
    try:
        session.call(function, session.context, *arguments, poses)
        blocks = [np.frombuffer(ffi.buffer(block, 24 * poses.count)).reshape(-1, 3)
                  for block in (poses.points, poses.directions, poses.ups) if block]
        return np.hstack(blocks[:3 if len(blocks) == 3 and blocks[2].any() else 2])
    finally:
        lib.starg_poses_free(session.context, poses)
