# SPDX-License-Identifier: Apache-2.0
"""Maps between solids: one set of tetrahedra, positive in both."""
from __future__ import annotations

import os
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from . import _arrays, _others
from ._fields import fill
from ._library import ffi, lib
from ._options import Options, takes
from ._session import Session
from ._told import Told
from ._types import Array, PathLike, Progress
from .errors import ArgumentError
from .mesh import as_mesh
from .morphs import Morph, SurfaceMap, map_surface

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from ._keywords import SolidMapOptions

_OPTIONS = Options("starg_solid_map_options")
_SHAPES = {"ball": lib.STARG_SOLID_BALL, "cube": lib.STARG_SOLID_CUBE}


@dataclass(frozen=True, eq=False, repr=False)
class SolidMap(Told):
    """A piecewise linear map from a solid A to a solid B. Arrays are read-only views of the library's
    memory."""

    #: Corners of tetrahedra in A and in B, (n, 3) each.
    vertices: Array
    images: Array
    #: (m, 4), and the piece of each.
    tetrahedra: Array
    labels: Array
    #: A guard of each piece in A and in B, (p, 3) each.
    guards: Array
    guard_images: Array
    #: Largest over smallest singular value: the largest, the mean by volume, the share above 10.
    worst: float
    mean: float
    above_10: float
    #: Where A's surface folds in B: vertices of the surface that are only near to B in A's faces, and
    #: the distance of the farthest, in diagonals.
    strayed: int
    farthest: float
    #: Does it tell how far its end is from B: `distance` from the image's surface to B's at most, and back, and
    #: by how much B has more volume?
    compared: bool
    distance: float
    distance_back: float
    missing: float
    #: Of a morph: times between 0 and 1, and where the corners are then, (k, n, 3).
    times: Array
    keys: Array
    _handle: Any = field(repr=False)
    _owner: Any = field(repr=False)

    @classmethod
    def _of(cls, m: Any, owner: Any = None) -> SolidMap:
        keeper = m if owner is None else owner

        def points(pointer: Any, *shape: int) -> Array:
            return _arrays.view(keeper, pointer, (*shape, 3), np.float64)

        return fill(cls, m, _handle=m, _owner=keeper, vertices=points(m.vertices, m.vertex_count),
                    images=points(m.images, m.vertex_count),
                    tetrahedra=_arrays.view(keeper, m.tetrahedra, (m.count, 4), np.uint32),
                    labels=_arrays.view(keeper, m.labels, (m.count,), np.int32),
                    guards=points(m.guards, m.piece_count),
                    guard_images=points(m.guard_images, m.piece_count),
                    times=_arrays.view(keeper, m.times, (m.key_count,), np.float64),
                    keys=points(m.keys, m.key_count, m.vertex_count))

    @classmethod
    def from_bytes(cls, data: bytes, name: str = "memory") -> SolidMap:
        """Reads the bytes of a MAP.vtu, without checking that it is a map (`verify`)."""
        session = Session()
        return cls._of(session.make("starg_solid_map", lib.starg_solid_map_free,
                                    lib.starg_solid_map_read_memory, session.context,
                                    ffi.from_buffer(data) if data else ffi.NULL, len(data),
                                    _arrays.path(name), shared=True))

    @classmethod
    def read(cls, path: PathLike) -> SolidMap:
        """Reads a MAP.vtu, without checking that it is a map (`verify`)."""
        with open(path, "rb") as file:
            return cls.from_bytes(file.read(), os.fsdecode(path))

    def to_pyvista(self) -> Any:
        """A copy of A as `pyvista.UnstructuredGrid`, with the piece of each cell as `piece` and the places in B as
        `image`."""
        grid = _others.pyvista_tetrahedra(self.vertices, self.tetrahedra, {"piece": self.labels})
        grid.point_data["image"] = np.array(self.images)
        return grid

    def to_meshio(self) -> Any:
        """A copy of A as `meshio.Mesh`, with the piece of each tetrahedron as `piece` and the places in B as
        `image`."""
        mesh = _others.meshio(self.vertices, "tetra", self.tetrahedra, {"piece": self.labels})
        mesh.point_data["image"] = np.array(self.images)
        return mesh

    def write(self, path: PathLike) -> None:
        """Writes MAP.vtu (docs/formats.md)."""
        session = Session()
        session.call(lib.starg_solid_map_write, session.context, self._handle, _arrays.path(path))

    def carry(self, points: ArrayLike, values: ArrayLike | None = None, *,
              back: bool = False) -> tuple[Array, Array]:
        """Carries points (n, 3) of A to B, or with `back` of B to A, and values there: (n,) numbers or
        labels, which stay, or (n, 3) vectors, which are transformed by the Jacobian."""
        rows = _arrays.reals(points, 3, "points")
        samples = ffi.new("starg_samples *")
        pointer = _arrays.pointer("double[]", rows)
        samples.count, samples.points = len(rows), pointer
        given = np.empty((len(rows), 0)) if values is None else _arrays.doubles(values, "values")
        table = np.ascontiguousarray(given.reshape(len(rows), -1) if len(rows) else given)
        if len(given) != len(rows) or table.shape[1] not in (0, 1, 3):
            raise ArgumentError(f"{len(rows)} points need as many values, numbers or vectors")
        numbers = _arrays.pointer("double[]", table)
        samples.width, samples.values = table.shape[1], numbers
        session = Session()
        out = session.make("starg_samples", lib.starg_samples_free, lib.starg_solid_map_carry,
                           session.context, self._handle, samples, back, shared=True)
        return (_arrays.view(out, out.points, (out.count, 3), np.float64),
                _arrays.view(out, out.values, given.shape if values is not None else (out.count, 0),
                             np.float64))


@takes(_OPTIONS)
def map_solid(a: Any, target: Any, *, overlay: bool = True, threads: int | None = None, seed: int | None = None,
              time_limit: float | None = None, progress: Progress | None = None,
              **options: Unpack[SolidMapOptions]) -> SolidMap:
    """Maps the solid A to another: `target` is a model B, a SurfaceMap, images of A's vertices (n, 3),
    "ball" or "cube". Needs TetGen, unless both solids are star-shaped. Both surfaces are divided by their
    overlay, so that the map ends at B itself; without `overlay`, or at images, it ends at B in A's faces.

    >>> import starguard
    >>> a, b = (starguard.sample("dog", pose=pose, vertices=500) for pose in (0, 1))
    >>> starguard.verify_map(a, b, starguard.map_solid(a, b)).passed
    True
    >>> a, b = (starguard.sample("sphere", vertices=vertices) for vertices in (500, 800))
    >>> starguard.verify_map(a, b, starguard.map_solid(a, b)).passed
    True
    >>> starguard.map_solid(a, b, overlay=False).distance > 0
    True
    """
    wanted = _OPTIONS.make(options)
    mesh = as_mesh(a)
    session = Session(threads, seed)
    if isinstance(target, str) and target in _SHAPES:
        return SolidMap._of(session.make(
            "starg_solid_map", lib.starg_solid_map_free, lib.starg_solid_map_to, session.context,
            mesh._handle, _SHAPES[target], wanted.pointer, shared=True, progress=progress,
            time_limit=time_limit))
    images_given = isinstance(target, (np.ndarray, list))
    if overlay and not images_given:
        surface = target if isinstance(target, SurfaceMap) else map_surface(mesh, target, solid=True)
        surface.overlay()
        return SolidMap._of(session.make(
            "starg_solid_map", lib.starg_solid_map_free, lib.starg_solid_map_overlay,
            session.context, surface.source._handle, surface.target._handle, surface._handle,
            wanted.pointer, shared=True, progress=progress, time_limit=time_limit))
    if images_given:
        images = _arrays.reals(target, 3, "target")
    else:
        surface = target if isinstance(target, SurfaceMap) else map_surface(mesh, target)
        images = surface.images()
    if len(images) != len(mesh.vertices):
        raise ArgumentError(f"A has {len(mesh.vertices)} vertices, but there are {len(images)} images")
    made = session.make(
        "starg_solid_map", lib.starg_solid_map_free, lib.starg_solid_map_create, session.context,
        mesh._handle, _arrays.pointer("double[]", images), wanted.pointer, shared=True,
        progress=progress, time_limit=time_limit)
    if not images_given:
        session.call(lib.starg_solid_map_compare, session.context, surface.target._handle, made)
    return SolidMap._of(made)


def map_of_morph(morph: Morph) -> SolidMap:
    """The map of a morph of method "solid", with its keys.

    >>> import starguard
    >>> a, b = (starguard.sample("dog", pose=pose, vertices=500) for pose in (0, 1))
    >>> path = starguard.map_of_morph(starguard.Morph(a, b, method="solid"))
    >>> bool((0 < path.times).all() and (path.times < 1).all())
    True
    """
    with morph._lock:
        return SolidMap._of(morph._session.make("starg_solid_map", lib.starg_solid_map_free,
                                                lib.starg_morph_solid_map, morph._handle,
                                                shared=True))
