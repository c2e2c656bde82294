# SPDX-License-Identifier: Apache-2.0
"""Independent checks of results with separate, slow and simple algorithms."""
from __future__ import annotations

import os
from dataclasses import dataclass, field
from typing import Any, Sequence, Union

import numpy as np

from . import _arrays
from ._fields import fill
from ._library import ffi, lib, text
from ._session import Session
from ._told import Told
from ._types import Array, PathLike, Progress
from .errors import ArgumentError
from .guards import Guards
from .mesh import as_mesh
from .pieces import OPTIONS, Decomposition
from .solid import Scene
from .solidmaps import SolidMap
from .tetra import TetMesh, as_shape


@dataclass(frozen=True)
class Claim:
    """One claim that was checked."""

    text: str
    holds: bool


@dataclass(frozen=True, repr=False)
class Verdict(Told):
    """All claims of a result; true if every one holds."""

    passed: bool
    claims: list[Claim]
    #: What the results say and no claim answers for.
    not_checked: list[str] = field(default_factory=list)

    def __bool__(self) -> bool:
        return self.passed


@dataclass(frozen=True, eq=False, repr=False)
class PiecesMesh(Told):
    """Labelled tetrahedra as read from PIECES.vtk, without any guarantee."""

    vertices: Array
    tetrahedra: Array
    labels: Array
    _handle: Any = field(repr=False)
    _owner: Any = field(repr=False)

    @classmethod
    def _of(cls, p: Any, owner: Any = None) -> PiecesMesh:
        keeper = p if owner is None else owner
        return cls(_arrays.view(keeper, p.vertices, (p.vertex_count, 3), np.float64),
                   _arrays.view(keeper, p.tetrahedra, (p.count, 4), np.uint32),
                   _arrays.view(keeper, p.labels, (p.count,), np.int32), p, keeper)

    @classmethod
    def from_bytes(cls, data: bytes, name: str = "memory") -> PiecesMesh:
        """Reads the bytes of a PIECES.vtk, independently of `TetMesh.read`."""
        return cls._of(_read(data, name, "starg_pieces_mesh", lib.starg_pieces_mesh_free,
                             lib.starg_pieces_mesh_read_memory))


@dataclass(frozen=True, eq=False, repr=False)
class PiecesReport(Told):
    """The contents of PIECES.json."""

    mode: str
    tetrahedra: int
    #: Structured, as in a Decomposition.
    pieces: Array
    contacts: Array
    strictly_star: int
    visible_vertices: float
    #: Whether the boundary only approximates the model's surface; distances to it and back.
    approximated: bool
    distance: float
    distance_back: float
    #: 0 where it is not told.
    flattest: float
    #: Degrees; 0 where they are not told.
    smallest_angle: float
    median_angle: float
    smallest_angle_made: float
    #: 0 where it is not told.
    lower_bound: int
    optimal: bool
    _handle: Any = field(repr=False)
    _owner: Any = field(repr=False)

    @classmethod
    def _of(cls, r: Any, owner: Any = None) -> PiecesReport:
        keeper = r if owner is None else owner
        return fill(cls, r, _handle=r, _owner=keeper, mode=OPTIONS.word("mode", r.mode),
                    pieces=_arrays.records(keeper, r.pieces, r.piece_count),
                    contacts=_arrays.records(keeper, r.contacts, r.contact_count))

    @classmethod
    def from_bytes(cls, data: bytes, name: str = "memory") -> PiecesReport:
        """Reads the bytes of a PIECES.json."""
        return cls._of(_read(data, name, "starg_pieces_report", lib.starg_pieces_report_free,
                             lib.starg_pieces_report_read_memory))


@dataclass(frozen=True, eq=False, repr=False)
class Certificate(Told):
    """Why `lower_bound_everywhere` of guards or `lower_bound` of pieces holds, as
    `guard(prove=True, certificate=FILE)` and `decompose` write it."""

    _handle: Any = field(repr=False)
    _owner: Any = field(repr=False)

    @classmethod
    def from_bytes(cls, data: bytes, name: str = "memory") -> Certificate:
        """Reads the bytes of a certificate (docs/formats.md)."""
        session = Session()
        handle = session.make("starg_certificate", lib.starg_certificate_free,
                              lib.starg_certificate_read_memory, session.context,
                              ffi.from_buffer(data) if data else ffi.NULL, len(data),
                              _arrays.path(name))
        return cls(handle, handle)


def _read(data: bytes, name: str, kind: str, free: Any, function: Any) -> Any:
    session = Session()
    return session.make(kind, free, function, session.context,
                        ffi.from_buffer(data) if data else ffi.NULL, len(data), _arrays.path(name),
                        shared=True)


@dataclass(frozen=True, eq=False, repr=False)
class MapFile(Told):
    """MAP.json as read for `verify_map`, without any guarantee."""

    _handle: Any = field(repr=False)
    _owner: Any = field(repr=False)


@dataclass(frozen=True, eq=False, repr=False)
class MorphReport(Told):
    """The morph.json of `starguard morph --report` as read for `verify_morph`."""

    _handle: Any = field(repr=False)
    _owner: Any = field(repr=False)


Result = Union[Guards, Certificate, Decomposition, PiecesMesh, PiecesReport]


def read_result(path: PathLike) -> (Guards | Certificate | PiecesMesh | PiecesReport | MapFile
                                    | MorphReport | SolidMap):
    """Reads GUARDS.json, a certificate, PIECES.vtk, PIECES.json, MAP.json, MAP.vtu or morph.json,
    recognized by content.

    >>> import starguard
    >>> pieces = starguard.decompose(starguard.sample("l-room", vertices=500), time_limit=5)
    >>> pieces.write_report("pieces.json")
    >>> starguard.read_result("pieces.json").strictly_star
    1
    """
    session = Session()
    result = session.make("starg_result", lib.starg_result_free, lib.starg_result_read,
                          session.context, _arrays.path(path), shared=True)
    if result.guards:
        return Guards._of(result.guards, owner=result)
    if result.certificate:
        return Certificate(result.certificate, result)
    if result.solid_map:
        return SolidMap._of(result.solid_map, result)
    if result.pieces:
        return PiecesMesh._of(result.pieces, result)
    if result.map:
        return MapFile(result.map, result)
    if result.morph:
        return MorphReport(result.morph, result)
    return PiecesReport._of(result.report, result)


def verify_map(a: Any, b: Any, given: MapFile | SolidMap | PathLike, *, threads: int | None = None,
               progress: Progress | None = None) -> Verdict:
    """Checks a map from A to B, exactly. MAP.json: it is a bijection of the surfaces, and meets its
    landmarks. A SolidMap or a MAP.vtu: it maps the solids one to one; B may be None, then the surface of
    the images is compared with nothing.

    >>> import starguard
    >>> ball, star = (starguard.sample(name, vertices=500) for name in ("sphere", "star"))
    >>> starguard.map_surface(ball, star).write("ball_star.json")
    >>> starguard.verify_map(ball, star, "ball_star.json").passed
    True
    >>> a, b = (starguard.sample("dog", pose=pose, vertices=500) for pose in (0, 1))
    >>> starguard.verify_map(a, a, starguard.map_solid(a, b)).passed
    False
    """
    found = given if isinstance(given, (MapFile, SolidMap)) else read_result(given)
    if not isinstance(found, (MapFile, SolidMap)):
        raise ArgumentError("this is no map of two models")
    if b is None and isinstance(found, MapFile):
        raise ArgumentError("a map of surfaces needs B")
    target = ffi.NULL if b is None else as_mesh(b)._handle
    function = lib.starg_verify_map if isinstance(found, MapFile) else lib.starg_verify_solid_map
    claims: list[Claim] = []
    rest: list[str] = []
    _judge(Session(threads), function, as_mesh(a), target, found._handle, claims=claims, rest=rest,
           progress=progress)
    return Verdict(all(claim.holds for claim in claims), claims, rest)


def verify_morph(a: Any, b: Any, frames: Sequence[Any], report: MorphReport | PathLike | None = None,
                 *, threads: int | None = None, progress: Progress | None = None) -> Verdict:
    """Checks the frames of a morph (meshes or files): the first is A, the last is B, or B with the
    faces of A; and what a `report` says of each.

    >>> import starguard
    >>> a, b = (starguard.sample("dog", pose=pose, vertices=500) for pose in (0, 1))
    >>> morph = starguard.Morph(a, b, method="linear")
    >>> starguard.verify_morph(a, b, [morph.frame(t) for t in (0, 0.5, 1)]).passed
    True
    """
    first, second = as_mesh(a), as_mesh(b)
    meshes = [as_mesh(frame) for frame in frames]
    told = report if report is None or isinstance(report, MorphReport) else read_result(report)
    if told is not None and not isinstance(told, MorphReport):
        raise ArgumentError("this is no report of a morph")
    session = Session(threads)
    claims: list[Claim] = []
    rest: list[str] = []
    _judge(session, lib.starg_verify_morph, first, second._handle,
           ffi.new("starg_mesh *[]", [mesh._handle for mesh in meshes]), len(meshes),
           told._handle if told is not None else ffi.NULL, claims=claims, rest=rest,
           progress=progress)
    return Verdict(all(claim.holds for claim in claims), claims, rest)


def verify(model: Any, *results: Result | PathLike, threads: int | None = None,
           seed: int | None = None, progress: Progress | None = None) -> Verdict:
    """Checks the claims of results about a model with independent algorithms. A result is an object
    from `guard` or `decompose`, or a file name; a PIECES.vtk and its PIECES.json are checked
    together, and a certificate with what is before it.

    >>> import starguard
    >>> room = starguard.sample("l-room", vertices=500)
    >>> verdict = starguard.verify(room, starguard.guard(room), starguard.decompose(room, time_limit=5))
    >>> verdict.passed, all(claim.holds for claim in verdict.claims)
    (True, True)
    """
    scene = model if isinstance(model, Scene) else None
    shape = as_shape(model if scene is None else scene.model)
    given = [read_result(r) if isinstance(r, (str, bytes, os.PathLike)) else r for r in results]
    if not given:
        raise ArgumentError("give a result to verify")
    if any(isinstance(result, (MapFile, MorphReport, SolidMap)) for result in given):
        raise ArgumentError("maps and morphs are of two models: see verify_map and verify_morph")
    session = Session(threads, seed)
    claims: list[Claim] = []
    rest: list[str] = []
    for before, result in zip([None, *given], given):
        if isinstance(result, Certificate) and isinstance(before, (Certificate, type(None))):
            raise ArgumentError("a certificate belongs behind its guards or pieces")
    for result, behind in zip(given, [*given[1:], None]):
        if isinstance(result, Guards):
            surface = shape.surface()[0] if isinstance(shape, TetMesh) else shape
            evidence = ffi.new("starg_guards_evidence *")
            pointers = scene._pointers() if scene is not None else ffi.NULL
            if scene is not None:
                evidence.obstacles, evidence.obstacle_count = pointers, len(scene.obstacles)
            if isinstance(behind, Certificate):
                evidence.certificate = behind._handle
            _judge(session, lib.starg_verify_guards_with, surface, evidence, result._handle,
                   claims=claims, rest=rest, progress=progress)
    for mesh, report, why in _decompositions(given):
        if isinstance(shape, TetMesh):
            if why != ffi.NULL:
                raise ArgumentError("a certificate is of a surface, not of tetrahedra")
            _judge(session, lib.starg_verify_pieces_of_tetmesh, shape, mesh, report, claims=claims,
                   rest=rest, progress=progress)
        else:
            _judge(session, lib.starg_verify_pieces_with, shape, why, mesh, report, claims=claims,
                   rest=rest, progress=progress)
    return Verdict(all(claim.holds for claim in claims), claims, rest)


def _judge(session: Session, function: Any, shape: Any, *arguments: Any, claims: list[Claim],
           rest: list[str], progress: Progress | None) -> None:
    """Adds what a verdict checked to `claims`, and what it did not to `rest`."""
    verdict = session.make("starg_verdict", lib.starg_verdict_free, function, session.context,
                           shape._handle, *arguments, shared=True, progress=progress)
    claims += [Claim(text(c.text), c.holds) for c in (verdict.claims[i] for i in range(verdict.count))]
    rest += [text(verdict.not_checked[i].text) for i in range(verdict.not_checked_count)]


def _decompositions(results: list[Any]) -> list[tuple[Any, Any, Any]]:
    """Tetrahedra with their reports and certificates: Decompositions, and files."""
    meshes = [r for r in results if isinstance(r, PiecesMesh)]
    reports = [r for r in results if isinstance(r, PiecesReport)]
    if len(meshes) > 1 or len(reports) > 1:
        raise ArgumentError("these files belong to several decompositions; verify them separately")
    if reports and not meshes:
        raise ArgumentError("a PIECES.json has no tetrahedra; add its PIECES.vtk")
    found, why = [], ffi.NULL
    for result, behind in zip(results, [*results[1:], None]):
        certificate = behind._handle if isinstance(behind, Certificate) else ffi.NULL
        if isinstance(result, Decomposition):
            found.append((pieces_mesh_of(result), pieces_report_of(result), certificate))
        elif isinstance(result, (PiecesMesh, PiecesReport)) and certificate != ffi.NULL:
            why = certificate
    if why != ffi.NULL and not reports:
        raise ArgumentError("a certificate is of the bound in a PIECES.json, which is missing")
    if meshes:
        found.append((meshes[0]._handle, reports[0]._handle if reports else ffi.NULL, why))
    return found


def pieces_mesh_of(d: Decomposition) -> Any:
    """The tetrahedra of a decomposition for the verifier, with the same arrays."""
    mesh = ffi.new("starg_pieces_mesh *")
    mesh.vertex_count = len(d.mesh.vertices)
    mesh.count = len(d.labels)
    mesh.vertices = ffi.cast("double *", lib.starg_tetmesh_vertices(d.mesh._handle))
    mesh.tetrahedra = ffi.cast("uint32_t *", lib.starg_tetmesh_tetrahedra(d.mesh._handle))
    mesh.labels = d._handle.labels
    mesh.corners = d._handle.ball_corners
    return mesh


def pieces_report_of(d: Decomposition) -> Any:
    """The report of a decomposition for the verifier."""
    own = d._handle
    report = ffi.new("starg_pieces_report *")
    report.mode = own.mode
    for name in ("model_vertices", "model_faces", "model_tetrahedra"):
        setattr(report, name, getattr(own, name))
    report.tetrahedra = len(d.labels)
    report.piece_count, report.pieces = own.piece_count, own.pieces
    report.contact_count, report.contacts = own.contact_count, own.contacts
    report.strictly_star = own.strictly_star
    report.visible_vertices = own.visible_vertices
    report.approximated = not own.tetra.surface_kept
    report.distance = own.tetra.to_surface + own.tetra.step
    report.distance_back = own.tetra.from_surface + own.tetra.step
    report.flattest = own.flattest
    for name in ("smallest_angle", "median_angle", "smallest_angle_made"):
        setattr(report, name, max(getattr(own, name), 0))
    report.lower_bound, report.optimal = own.lower_bound, own.optimal
    report.balls = own.balls != lib.STARG_BALLS_NONE
    for key in ("ball_worst", "ball_mean", "ball_above_10"):
        setattr(report, key, getattr(own, key))
    return report
