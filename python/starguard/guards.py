"""The main job: few points inside a solid that together see its whole boundary, and a bound."""
from __future__ import annotations

import os
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from . import _arrays
from ._choice import choose, give, word_of
from ._fields import fill
from ._library import ffi, lib, text
from ._session import Session
from ._types import Array, PathLike, Progress
from .solid import as_solid
from .visibility import ENGINES, FACE_RULES, TARGETS, set_view

_METHODS = {"pilp": lib.STARG_GUARD_PILP, "ilp": lib.STARG_GUARD_ILP,
            "greedy": lib.STARG_GUARD_GREEDY}
_CANDIDATES = {"skeleton": lib.STARG_CANDIDATES_SKELETON, "medial": lib.STARG_CANDIDATES_MEDIAL,
               "interior": lib.STARG_CANDIDATES_INTERIOR}
_ALL_CANDIDATES = {**_CANDIDATES, "given": lib.STARG_CANDIDATES_GIVEN}


@dataclass(frozen=True, eq=False)
class GuardLevel:
    """The guards of one level of detail, which see all of it that some candidate sees."""

    vertex_count: int
    face_count: int
    #: (n, 3), those kept from the coarser level first. No copy.
    positions: Array
    #: How many were kept.
    kept: int


@dataclass(frozen=True, eq=False)
class Guards:
    """A set of guards and what is known about it. Faces are indices into the model. The arrays are
    read-only views of the library's memory."""

    #: The model's path as given; None if there is none.
    file: str | None
    vertex_count: int
    face_count: int
    #: (k, 3).
    positions: Array
    #: (k, 3), where each looks; None without a cone of view.
    directions: Array | None
    #: Faces that each guard sees, (k,).
    seen_faces: Array
    #: Level of detail that asked for the guard, (k,); 0: the coarsest.
    levels: Array
    #: With method "pilp", before refinement; the coarsest first.
    level_list: list[GuardLevel]
    #: Seen fraction of all faces, and of their area.
    coverage_faces: float
    coverage_area: float
    #: Faces that some candidate sees.
    coverable_faces: int
    #: Faces that no guard sees, ascending.
    uncovered: Array
    #: The same of vertices, only with target "vertices".
    coverage_vertices: float
    coverable_vertices: int
    uncovered_vertices: Array
    #: Seen fraction of all faces, and of their area, by the first 1, 2, ... guards.
    curve_faces: Array
    curve_area: Array
    candidate_count: int
    lines_tested: int
    #: No fewer candidates see as much: proven.
    lower_bound: int
    #: As many guards as that bound: no fewer of the candidates do.
    optimal: bool
    #: No fewer guards see as much, wherever they stand; 0 where this was not sought.
    lower_bound_everywhere: int
    #: As many guards as that bound.
    optimal_everywhere: bool
    #: With max_guards: no choice of so many sees a larger fraction of all area.
    area_bound: float
    time_limited: bool
    #: The options of `guard` that were in force.
    options: dict[str, Any]
    _handle: Any = field(repr=False)
    _owner: Any = field(repr=False)

    def __repr__(self) -> str:
        return (f"Guards({len(self)}, lower_bound={self.lower_bound}, "
                f"coverage_area={self.coverage_area:.6g})")

    def __len__(self) -> int:
        return len(self.positions)

    @classmethod
    def _of(cls, g: Any, file: PathLike | None = None, owner: Any = None) -> Guards:
        """Of a handle; or of what another object owns, which is kept then."""
        keeper, count = g if owner is None else owner, g.count
        levels = [
            GuardLevel(v.vertex_count, v.face_count,
                       _arrays.view(keeper, v.positions, (v.count, 3), np.float64), v.kept)
            for v in (g.level_list[i] for i in range(g.level_count))]
        return fill(
            cls, g, _handle=g, _owner=keeper, file=text(g.file) if g.file else name_of(file), level_list=levels,
            positions=_arrays.view(keeper, g.positions, (count, 3), np.float64),
            directions=_arrays.view(keeper, g.directions, (count, 3), np.float64) if g.directions else None,
            seen_faces=_arrays.view(keeper, g.seen_faces, (count,), np.uintp),
            levels=_arrays.view(keeper, g.levels, (count,), np.intc),
            uncovered=_arrays.view(keeper, g.uncovered, (g.uncovered_count,), np.uint32),
            uncovered_vertices=_arrays.view(keeper, g.uncovered_vertices, (g.uncovered_vertex_count,),
                                            np.uint32),
            curve_faces=_arrays.view(keeper, g.curve_faces, (count,), np.float64),
            curve_area=_arrays.view(keeper, g.curve_area, (count,), np.float64),
            options=_options_dict(g.options))

    @classmethod
    def read(cls, path: PathLike) -> Guards:
        """Reads GUARDS.json (docs/formats.md).

        >>> import starguard
        >>> room = starguard.sample("l-room", vertex_count=500)
        >>> starguard.guard(room).write("guards.json")
        >>> starguard.Guards.read("guards.json")
        Guards(1, lower_bound=1, coverage_area=1)
        """
        session = Session()
        return cls._of(session.make("starg_guards", lib.starg_guards_free, lib.starg_guards_read,
                                    session.context, _arrays.path(path), shared=True))

    @classmethod
    def from_bytes(cls, data: bytes, name: str = "memory") -> Guards:
        """Reads the bytes of a GUARDS.json; `name` stands in messages."""
        session = Session()
        return cls._of(session.make(
            "starg_guards", lib.starg_guards_free, lib.starg_guards_read_memory, session.context,
            ffi.from_buffer(data) if data else ffi.NULL, len(data), _arrays.path(name), shared=True))

    def write(self, path: PathLike, model_file: PathLike | None = None) -> None:
        """Writes GUARDS.json. `model_file` stands in it as the model's path; without it the one
        that the model was read from, if any."""
        session = Session()
        name = model_file if model_file is not None else self.file
        session.call(lib.starg_guards_write, session.context, self._handle,
                     _arrays.path(name) if name is not None else ffi.NULL, _arrays.path(path))


def _options_dict(options: Any) -> dict[str, Any]:
    view = options.visibility
    names = ("candidate_count", "coverage", "max_guards", "redundancy", "clearance", "max_nodes",
             "coarsest", "step", "significance", "refine", "refine_lines", "prove", "prove_work")
    return {"method": word_of(options.method, _METHODS),
            "candidates": word_of(options.candidates, _ALL_CANDIDATES),
            **{name: getattr(options, name) for name in names},
            "engine": word_of(view.engine, ENGINES), "target": word_of(view.target, TARGETS),
            "face_rule": word_of(view.face_rule, FACE_RULES), "range": view.range, "cone": view.cone}


def guard(model: Any, *, method: str | None = None, candidates: str | ArrayLike | None = None,
          candidate_count: int | None = None, coverage: float | None = None,
          max_guards: int | None = None, redundancy: int | None = None,
          clearance: float | None = None, engine: str | None = None, target: str | None = None,
          face_rule: str | None = None, range: float | None = None, cone: float | None = None,
          max_nodes: int | None = None, coarsest: int | None = None, step: int | None = None,
          significance: float | None = None, refine: bool | None = None,
          refine_lines: int | None = None, prove: bool | None = None,
          prove_work: int | None = None, threads: int | None = None, seed: int | None = None,
          time_limit: float | None = None, progress: Progress | None = None) -> Guards:
    """Places guards that together see the whole boundary, as few as can be found.

    `method` "pilp" (default) goes from coarse to fine and then refines; "ilp" finds the fewest of
    the candidates and proves it; "greedy" is fastest. `candidates` tells where guards may stand:
    "skeleton" (default), "medial", "interior", or points of shape (n, 3). `coverage` below 1 asks
    for a fraction of the area only, `max_guards` for the most area that so many see, `redundancy`
    for faces seen by so many, `clearance` for a distance from the walls, `range` and `cone` for
    guards like cameras. `prove` looks for fewer guards at every point of the solid, and for how few could
    do, wherever they stand (`lower_bound_everywhere`). The rest is in include/starguard/guard.h. Faces that nothing can see are no
    error: they are listed in `uncovered`.

    >>> import starguard
    >>> guards = starguard.guard(starguard.sample("l-room", vertex_count=500))
    >>> len(guards), guards.lower_bound, guards.optimal, guards.positions.shape
    (1, 1, True, (1, 3))
    """
    solid = as_solid(model)
    session = Session(threads, seed)
    options = ffi.new("starg_guard_options *")
    lib.starg_guard_options_default(options)
    if method is not None:
        options.method = choose("method", method, _METHODS)
    if isinstance(candidates, str):
        options.candidates = choose("candidates", candidates, _CANDIDATES)
    elif candidates is not None:
        places = _arrays.points(candidates, "candidates")
        pointer = _arrays.pointer("double[]", places)
        options.candidates = lib.STARG_CANDIDATES_GIVEN
        options.points = pointer
        options.point_count = len(places)
    give(options, candidate_count=candidate_count, coverage=coverage, max_guards=max_guards,
         redundancy=redundancy, clearance=clearance, max_nodes=max_nodes, coarsest=coarsest,
         step=step, significance=significance, refine=refine, refine_lines=refine_lines,
         prove=prove, prove_work=prove_work)
    set_view(options.visibility, engine=engine, target=target, face_rule=face_rule,
             range=range, cone=cone)
    handle = session.make("starg_guards", lib.starg_guards_free, lib.starg_guard, session.context,
                          solid._handle, options, shared=True, progress=progress,
                          time_limit=time_limit)
    return Guards._of(handle, solid.mesh.file)


def name_of(file: PathLike | None) -> str | None:
    """A file name as text."""
    return None if file is None else os.fsdecode(file)


def candidate_points(model: Any, source: str = "skeleton", count: int = 1000, *,
                     clearance: float = 0.0, threads: int | None = None, seed: int | None = None,
                     time_limit: float | None = None, progress: Progress | None = None) -> Array:
    """Points where guards may stand, of shape (n, 3): "skeleton", "medial" or "interior".

    >>> import starguard
    >>> room = starguard.sample("l-room", vertex_count=500)
    >>> starguard.candidate_points(room, "interior", 50).shape[1]
    3
    """
    solid = as_solid(model)
    session = Session(threads, seed)
    out, number = ffi.new("double **"), ffi.new("size_t *")
    try:
        session.call(lib.starg_candidate_points, session.context, solid._handle,
                     choose("source", source, _CANDIDATES), count, float(clearance), out, number,
                     progress=progress, time_limit=time_limit)
    finally:
        owner = session.own(out[0], lib.starg_points_free, shared=True) if out[0] else None
    return _arrays.view(owner, out[0], (number[0], 3), np.float64)


def read_points(path: PathLike) -> Array:
    """Reads points: text of three numbers a line, the nodes of a skeleton (OBJ, CG, VTK), or the positions
    of a GUARDS.json.

    >>> import pathlib, starguard
    >>> _ = pathlib.Path("places.txt").write_text("1.5 1.7 2 # hall\\n4 1.7 2\\n")
    >>> starguard.read_points("places.txt")
    array([[1.5, 1.7, 2. ],
           [4. , 1.7, 2. ]])
    """
    session = Session()
    return _read_points(session, lib.starg_points_read, _arrays.path(path))


def points_from_bytes(data: bytes, name: str = "memory") -> Array:
    """The same from the bytes of such a file; `name` stands in messages.

    >>> import starguard
    >>> starguard.points_from_bytes(b"1 2 3")
    array([[1., 2., 3.]])
    """
    session = Session()
    return _read_points(session, lib.starg_points_read_memory,
                        ffi.from_buffer(data) if data else ffi.NULL, len(data), _arrays.path(name))


def _read_points(session: Session, function: Any, *arguments: Any) -> Array:
    out, number = ffi.new("double **"), ffi.new("size_t *")
    try:
        session.call(function, session.context, *arguments, out, number)
    finally:
        owner = session.own(out[0], lib.starg_points_free, shared=True) if out[0] else None
    return _arrays.view(owner, out[0], (number[0], 3), np.float64)
