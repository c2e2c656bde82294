# SPDX-License-Identifier: Apache-2.0
"""Interactive pages for browsers, and exports for other programs."""
from __future__ import annotations

from typing import Any, Mapping, Sequence

import numpy as np
from numpy.typing import ArrayLike

from . import _arrays
from ._choice import choose
from ._library import ffi, lib
from ._session import Session
from ._types import PathLike, Progress
from .errors import ArgumentError
from .guards import Guards
from .mesh import Mesh, as_mesh
from .pieces import Decomposition
from .skeletons import Skeleton
from .solid import Scene
from .verification import Certificate, PiecesMesh, PiecesReport, pieces_mesh_of, pieces_report_of
from .visibility import Bits, visible

_FORMATS = {"auto": lib.STARG_SCENE_AUTO, "glb": lib.STARG_SCENE_GLB, "vtu": lib.STARG_SCENE_VTU,
            "ply": lib.STARG_SCENE_PLY, "obj": lib.STARG_SCENE_OBJ,
            "3mf": lib.STARG_SCENE_3MF}


def _joined(meshes: Sequence[Mesh]) -> Mesh:
    """All in one."""
    first = np.cumsum([0, *(len(mesh.vertices) for mesh in meshes)])
    return Mesh(np.vstack([mesh.vertices for mesh in meshes]),
                np.vstack([mesh.faces + offset for mesh, offset in zip(meshes, first)]))


def _seen(mesh: Any, guards: Guards) -> Bits:
    """What each guard sees with the options of the result."""
    if isinstance(mesh, Scene):
        session = Session()
        return Bits(session.make("starg_bits", lib.starg_bits_free, lib.starg_guards_see, session.context,
                                 mesh._handle, guards._handle))
    names = ("faces", "range", "near", "incidence", "cone", "fov", "up")
    return visible(mesh, guards.positions, directions=guards.directions,
                   **{name: guards.options[name] for name in names})


def _fill(target: Any, model: Any, guards: Guards | None,
          pieces: Decomposition | PiecesMesh | None, report: PiecesReport | None,
          skeleton: Skeleton | None) -> list[Any]:
    """Fills the parts common to pages and scenes; the returned objects must live as long."""
    keep: list[Any] = []
    if model is not None:
        mesh = as_mesh(model.model if isinstance(model, Scene) else model)
        keep.append(mesh)
        target.model = mesh._handle
    if isinstance(model, Scene) and model.obstacles:
        keep.append(_joined(model.obstacles))
        target.obstacles = keep[-1]._handle
    if guards is not None:
        target.guards = guards._handle
        if model is not None:
            keep.append(_seen(model if isinstance(model, Scene) else mesh, guards))
            target.seen = keep[-1]._handle
    if isinstance(pieces, Decomposition):
        keep += [pieces_mesh_of(pieces), pieces_report_of(pieces)]
        target.pieces, target.report = keep[-2:]
    elif pieces is not None:
        target.pieces = pieces._handle
    if report is not None:
        target.report = report._handle
    if skeleton is not None:
        target.skeleton = skeleton._handle
    return keep


def write_scene(path: PathLike, model: Any = None, *, guards: Guards | None = None,
                pieces: Decomposition | PiecesMesh | None = None, report: PiecesReport | None = None,
                skeleton: Skeleton | None = None, format: str = "auto") -> None:
    """Writes a model and results to one file, by the file extension or by `format`: "glb" (Blender,
    browsers), "vtu" (ParaView), "ply" (MeshLab), "obj" or "3mf" (printers) (docs/formats.md).

    >>> import starguard
    >>> room = starguard.sample("l-room", vertices=500)
    >>> starguard.write_scene("room.glb", room, guards=starguard.guard(room),
    ...                       pieces=starguard.decompose(room, time_limit=5))
    """
    session = Session()
    scene = ffi.new("starg_scene *")
    keep = _fill(scene, model, guards, pieces, report, skeleton)
    session.call(lib.starg_scene_write, session.context, scene, _arrays.path(path),
                 choose("format", format, _FORMATS))
    del keep


def page_available() -> bool:
    """Whether the library was built with the viewer. Without it, no page can be written.

    >>> import starguard
    >>> starguard.page_available() in (True, False)
    True
    """
    return bool(lib.starg_page_available())


def write_page(path: PathLike, model: Any = None, *, title: str | None = None,
               guards: Guards | None = None, pieces: Decomposition | PiecesMesh | None = None,
               report: PiecesReport | None = None, skeleton: Skeleton | None = None,
               certificate: Certificate | None = None, frames: Sequence[Any] = (),
               shapes: Mapping[str, bytes] | None = None, distances: ArrayLike | None = None,
               progress: Progress | None = None) -> None:
    """Writes one self-contained HTML page of results (docs/viewer.md). `frames` are the shapes of a
    morph; `shapes` are names with thumbnails (PNG, or b""), and `distances` their matrix.
    `certificate` is that of the guards.

    >>> import starguard
    >>> room = starguard.sample("l-room", vertices=500)
    >>> if starguard.page_available():
    ...     starguard.write_page("room.html", room, guards=starguard.guard(room))
    """
    session = Session()
    page = ffi.new("starg_page *")
    keep = _fill(page, model, guards, pieces, report, skeleton)
    if certificate is not None:
        keep.append(session.make("starg_certificate_outline",
                                 lib.starg_certificate_outline_free,
                                 lib.starg_certificate_outline_create, session.context,
                                 certificate._handle, shared=True))
        page.proof = keep[-1]
    if title is not None:
        keep.append(ffi.new("char[]", title.encode()))
        page.title = keep[-1]
    meshes = [as_mesh(frame) for frame in frames]
    keep += [meshes, ffi.new("starg_mesh *[]", [mesh._handle for mesh in meshes])]
    page.frames, page.frame_count = keep[-1], len(meshes)
    keep.append(_fill_shapes(page, shapes or {}, distances))
    session.call(lib.starg_page_write, session.context, page, _arrays.path(path), progress=progress)
    del keep


def _fill_shapes(page: Any, shapes: Mapping[str, bytes], distances: ArrayLike | None) -> list[Any]:
    """Fills the shape table; the returned objects must live as long."""
    matrix = _arrays.doubles(np.empty((0, 0)) if distances is None else distances, "distances")
    if matrix.shape != (len(shapes), len(shapes)):
        raise ArgumentError(f"distances of {len(shapes)} shapes must have the shape ({len(shapes)}, "
                            f"{len(shapes)}), not {matrix.shape}")
    if not shapes:
        return []
    keep: list[Any] = [ffi.new("starg_page_shape[]", len(shapes)), _arrays.pointer("double[]", matrix)]
    page.shapes, page.distances = keep
    page.shape_count = len(shapes)
    for shape, (name, png) in zip(keep[0], shapes.items()):
        keep += [ffi.new("char[]", name.encode()), ffi.from_buffer(png) if png else ffi.NULL]
        shape.name, shape.png = keep[-2:]
        shape.png_size = len(png)
    return keep
