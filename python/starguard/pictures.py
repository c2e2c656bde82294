# SPDX-License-Identifier: Apache-2.0
"""Pictures of meshes with points, of matrices and of curves."""
from __future__ import annotations

from typing import TYPE_CHECKING, Any, Mapping, Sequence

import numpy as np
from numpy.typing import ArrayLike

from . import _arrays
from ._choice import give
from ._library import ffi, lib
from ._session import Session
from ._types import Array, PathLike, Progress
from .errors import ArgumentError
from .mesh import as_mesh

if TYPE_CHECKING:
    from .guards import Guards


def _options(keep: list[Any], face_count: int, size: tuple[int, int] | None,
             azimuth: float | None, elevation: float | None, up: int | None,
             opacity: float | None, face_colors: ArrayLike | None, points: ArrayLike | None,
             point_colors: ArrayLike | None, point_radius: float | None,
             point_numbers: bool = False, views: Guards | None = None) -> Any:
    """starg_picture_options; `keep` holds objects that must live as long."""
    options = ffi.new("starg_picture_options *")
    lib.starg_picture_options_default(options)
    if size is not None:
        options.width, options.height = size
    give(options, azimuth=azimuth, elevation=elevation, up=up, opacity=opacity,
         point_radius=point_radius)
    options.point_numbers = point_numbers
    if views is not None:
        keep.append(views)
        options.views = views._handle
    keep.append(_arrays.colors(face_colors, face_count, "face_colors"))
    options.face_colors = keep[-1]
    if points is not None:
        rows = _arrays.points(points, "points")
        keep.append(_arrays.pointer("double[]", rows))
        options.points, options.point_count = keep[-1], len(rows)
        keep.append(_arrays.colors(point_colors, len(rows), "point_colors"))
        options.point_colors = keep[-1]
    return options


def write_picture(path: PathLike, model: Any, *, size: tuple[int, int] | None = None,
                  azimuth: float | None = None, elevation: float | None = None,
                  up: int | None = None, opacity: float | None = None,
                  face_colors: ArrayLike | None = None, points: ArrayLike | None = None,
                  point_colors: ArrayLike | None = None, point_radius: float | None = None,
                  point_numbers: bool = False, views: Guards | None = None,
                  progress: Progress | None = None) -> None:
    """Draws a translucent mesh, with points as balls, as a PNG. Angles are in degrees, `up`
    is the axis that points up, `point_radius` a fraction of the diagonal; `point_numbers`
    writes the points' numbers beside them; `views` are guards that look one way, which it shows.

    >>> import starguard
    >>> room = starguard.sample("l-room", vertices=500)
    >>> starguard.write_picture("room.png", room, points=starguard.guard(room).positions,
    ...                         size=(320, 240))
    """
    mesh = as_mesh(model)
    session = Session()
    keep: list[Any] = []
    options = _options(keep, len(mesh.faces), size, azimuth, elevation, up, opacity, face_colors,
                       points, point_colors, point_radius, point_numbers, views)
    session.call(lib.starg_picture_write, session.context, mesh._handle, options,
                 _arrays.path(path), progress=progress)


def picture(model: Any, *, size: tuple[int, int] | None = None, azimuth: float | None = None,
            elevation: float | None = None, up: int | None = None, opacity: float | None = None,
            face_colors: ArrayLike | None = None, points: ArrayLike | None = None,
            point_colors: ArrayLike | None = None, point_radius: float | None = None,
            point_numbers: bool = False, views: Guards | None = None,
            progress: Progress | None = None) -> bytes:
    """The same picture as PNG bytes, for example for a notebook.

    >>> import starguard
    >>> starguard.picture(starguard.sample("star", vertices=500), size=(160, 120))[1:4]
    b'PNG'
    """
    mesh = as_mesh(model)
    session = Session()
    keep: list[Any] = []
    options = _options(keep, len(mesh.faces), size, azimuth, elevation, up, opacity, face_colors,
                       points, point_colors, point_radius, point_numbers, views)
    out, length = ffi.new("uint8_t **"), ffi.new("size_t *")
    try:
        session.call(lib.starg_picture_encode, session.context, mesh._handle, options, out, length,
                     progress=progress)
        return bytes(ffi.buffer(out[0], length[0]))
    finally:
        if out[0]:
            lib.starg_picture_bytes_free(session.context, out[0])


def write_picture_sheet(path: PathLike, models: Sequence[Sequence[Any]], *,
                        size: tuple[int, int] | None = None, azimuth: float | None = None,
                        elevation: float | None = None, up: int | None = None,
                        opacity: float | None = None, names: Sequence[str] | None = None,
                        progress: Progress | None = None) -> None:
    """Draws rows of meshes side by side into one PNG; `size` is that of one mesh, `names` are of rows.

    >>> import starguard
    >>> poses = [starguard.sample("dog", pose=pose, vertices=500) for pose in range(3)]
    >>> starguard.write_picture_sheet("dogs.png", [poses], size=(200, 150))
    """
    meshes = [[as_mesh(model) for model in row] for row in models]
    columns = len(meshes[0]) if meshes else 0
    if any(len(row) != columns for row in meshes):
        raise ArgumentError("all rows of a sheet must have the same length")
    if names is not None and len(names) != len(meshes):
        raise ArgumentError(f"{len(names)} names for {len(meshes)} rows")
    texts = [ffi.new("char[]", name.encode()) for name in names or ()]
    session = Session()
    options = _options([], 0, size, azimuth, elevation, up, opacity, None, None, None, None)
    kept = ffi.new("char *[]", texts) if texts else ffi.NULL
    options.row_names = kept
    handles = ffi.new("starg_mesh *[]", [mesh._handle for row in meshes for mesh in row])
    session.call(lib.starg_picture_sheet_write, session.context, handles, len(meshes), columns,
                 options, _arrays.path(path), progress=progress)


def write_matrix_picture(path: PathLike, values: ArrayLike, *,
                         names: Sequence[str] | None = None) -> None:
    """Draws a square distance matrix as a PNG, grey by rank, with the names of up to 120 rows.

    >>> import starguard
    >>> starguard.write_matrix_picture("matrix.png", [[0, 1], [1, 0]], names=["ball", "box"])
    """
    matrix = _arrays.doubles(values, "values")
    if matrix.ndim != 2 or matrix.shape[0] != matrix.shape[1]:
        raise ArgumentError(f"the matrix must be square, not {matrix.shape}")
    if names is not None and len(names) != len(matrix):
        raise ArgumentError(f"{len(names)} names for {len(matrix)} rows")
    texts = [ffi.new("char[]", name.encode()) for name in names or ()]
    session = Session()
    session.call(lib.starg_matrix_picture_write, session.context,
                 _arrays.pointer("double[]", matrix), len(matrix),
                 ffi.new("char *[]", texts) if texts else ffi.NULL, _arrays.path(path))


def write_chart(path: PathLike, curves: Mapping[str, tuple[ArrayLike, ArrayLike]], x_label: str,
                y_label: str, *, strong: str | None = None) -> None:
    """Draws named curves (x, y) in the unit square as an SVG; `strong` ones are emphasized.

    >>> import starguard
    >>> starguard.write_chart("c.svg", {"by chance": ([0, 1], [0, 1])}, "recall", "precision")
    """
    session = Session()
    drawn = ffi.new("starg_curve[]", len(curves))
    keep: list[Any] = []
    for curve, (name, (x, y)) in zip(drawn, curves.items()):
        columns = [_arrays.doubles(values, f"the curve '{name}'").ravel() for values in (x, y)]
        if len(columns[0]) != len(columns[1]):
            raise ArgumentError(f"the curve '{name}' has {len(columns[0])} x and {len(columns[1])} y")
        keep += [ffi.new("char[]", name.encode()), *(_arrays.pointer("double[]", c) for c in columns)]
        curve.name, curve.x, curve.y = keep[-3:]
        curve.count, curve.strong = len(columns[0]), name == strong
    session.call(lib.starg_chart_write, session.context, drawn, len(curves), x_label.encode(),
                 y_label.encode(), _arrays.path(path))


def distinct_colors(count: int) -> Array:
    """Distinct colours, (count, 3) uint8, as used for guards and pieces.

    >>> import starguard
    >>> starguard.distinct_colors(5).shape
    (5, 3)
    """
    colors = np.empty((count, 3), np.uint8)
    for i, color in enumerate(colors):
        lib.starg_distinct_color(i, ffi.from_buffer("uint8_t[3]", color))
    return colors
