# SPDX-License-Identifier: Apache-2.0
"""Solids: checked meshes with search structures."""
from __future__ import annotations

import weakref
from typing import Any, Sequence

import numpy as np
from numpy.typing import ArrayLike

from . import _arrays
from ._choice import choose
from ._library import ffi, lib
from ._session import Session
from ._types import Array, Progress
from .errors import ArgumentError
from .mesh import Check, Mesh, as_mesh


class Solid:
    """A solid bounded by a closed mesh; inward shells are reversed, with a notice (see `logger`).

    Functions that take a model create one if needed; create it once to use it often. Raises
    MeshError, with the elements, for a mesh that is open, not manifold or not oriented.

    >>> import starguard
    >>> solid = starguard.Solid(starguard.sample("l-room", vertices=500))
    >>> solid
    Solid(506 vertices, 1008 faces)
    >>> solid.contains([[0.5, 0.5, 0.5], [-1, 0, 0]])
    array([ True, False])
    """

    def __init__(self, model: Any, *, threads: int | None = None,
                 progress: Progress | None = None) -> None:
        given = as_mesh(model)
        session = Session(threads)
        self._handle: Any = session.make("starg_solid", lib.starg_solid_free, lib.starg_solid_create,
                                    session.context, given._handle, progress=progress)
        inner = lib.starg_solid_mesh(self._handle)
        #: The mesh, with every shell oriented outward.
        self.mesh: Mesh = Mesh._of(inner, given.file, owner=self._handle)
        self.mesh._solid = weakref.ref(self)  # a Mesh caches its solid

    def __reduce__(self) -> tuple[Any, ...]:
        return Solid, (self.mesh,)

    def __deepcopy__(self, memo: Any) -> Solid:
        return self  # it does not change

    def __repr__(self) -> str:
        return f"Solid({len(self.mesh.vertices)} vertices, {len(self.mesh.faces)} faces)"

    @property
    def check(self) -> Check:
        """The check of the mesh before shells were reversed."""
        return Check._of(self._handle, lib.starg_solid_check(self._handle), len(self.mesh.faces))

    def contains(self, points: ArrayLike) -> Array:
        """Whether each point is strictly inside; exact. Shape (n,), bool."""
        rows = _arrays.points(points, "points")
        return np.array([lib.starg_solid_contains(self._handle, ffi.from_buffer("double[3]", row))
                         for row in rows], bool)

    def distance(self, points: ArrayLike) -> Array:
        """Distance of each point from the surface.

        >>> import starguard
        >>> starguard.Solid(starguard.sample("l-room", vertices=500)).distance([0, 0, 0])
        array([0.])
        """
        rows = _arrays.points(points, "points")
        return np.array([lib.starg_solid_distance(self._handle, ffi.from_buffer("double[3]", row))
                         for row in rows], float)


_ORIENTATIONS = {"nested": lib.STARG_ORIENTATION_NESTED, "keep": lib.STARG_ORIENTATION_KEEP}


class Scene(Solid):
    """A model with obstacles, its outside, or any triangles; takes a solid's place in `guard`,
    `visible` and `verify`.

    `obstacles` are models that stand in the way: closed ones are solid. With orientation="keep"
    the faces of the model count as they are turned. Guards of an `outside` keep the distances of
    `standoff` (least, most). A `soup` is any triangles, seen from their fronts. `within` is a box
    (lower and upper corner) for guards; `start` a point, with the size of cubes `cell`, from which
    they can be reached. With `over` (faces, height) they stand straight above one of these faces,
    along `up` (by default y), with `mount` (faces, distance) no farther from one of them than that.
    `weights` has a number for each face: how often its area counts; in its place `see` are the faces to be
    seen, or `ignore` those that need not be. Each of `zones` tells whether guards
    may stand in it, and is a box or a closed model. Faces of `clear` block no view. `needs` are faces with
    the number of guards that must see them, and a density of pixels (0: as others). Faces are numbers, or names
    that the model's file has for them (groups, objects, materials; * and ? stand for others), one or a list.

    >>> import starguard
    >>> part = starguard.Scene(starguard.sample("torus", vertices=500), outside=True, standoff=(1, 4))
    >>> guards = starguard.guard(part, count=300)
    >>> starguard.verify(part, guards).passed
    True
    """

    def __init__(self, model: Any, *, obstacles: Sequence[Any] = (), orientation: str = "nested",
                 outside: bool = False, soup: bool = False,
                 standoff: tuple[float, float] | None = None, within: ArrayLike | None = None,
                 start: ArrayLike | None = None, cell: float | None = None,
                 over: tuple[ArrayLike, float] | None = None, up: ArrayLike | None = None,
                 mount: tuple[ArrayLike, float] | None = None, see: ArrayLike | None = None,
                 ignore: ArrayLike | None = None,
                 zones: Sequence[tuple[bool, Any]] = (), clear: ArrayLike | None = None,
                 needs: Sequence[tuple[int, int, float]] = (),
                 weights: ArrayLike | None = None, threads: int | None = None,
                 progress: Progress | None = None) -> None:
        #: What is to be seen, and what stands in the way.
        self.model: Mesh = as_mesh(model)
        self.obstacles: list[Mesh] = [as_mesh(obstacle) for obstacle in obstacles]
        session = Session(threads)
        options = ffi.new("starg_space_options *")
        lib.starg_space_options_default(options)
        options.orientation = choose("orientation", orientation, _ORIENTATIONS)
        options.outside, options.soup = outside, soup
        if standoff is not None:
            options.standoff_least, options.standoff_most = standoff
        if within is not None:
            options.within = _arrays.points(within, "within", 6)[0].tolist()
        if (start is None) != (cell is None):
            raise ArgumentError("start and cell belong together")
        if start is not None:
            options.cell = cell
            setattr(options, "from", _arrays.points(start, "start")[0].tolist())
        lists: list[Any] = []  # alive until the call is over
        for name, bound, distance in ("over", over, "height"), ("mount", mount, "mount_distance"):
            if bound is not None:
                faces = self._faces(session, bound[0], name)
                lists.append(faces)
                setattr(options, name, _arrays.pointer("uint32_t[]", faces))
                setattr(options, name + "_count", len(faces))
                setattr(options, distance, bound[1])
        if clear is not None:
            faces = self._faces(session, clear, "clear")
            lists.append(faces)
            options.clear, options.clear_count = _arrays.pointer("uint32_t[]", faces), len(faces)
        given = ffi.new("starg_zone[]", max(len(zones), 1))
        for zone, (admits, what) in zip(given, zones):
            zone.excludes = not admits
            if isinstance(what, Mesh) or not np.shape(what) == (6,):
                lists.append(as_mesh(what))
                zone.mesh = lists[-1]._handle
            else:
                zone.box = _arrays.points(what, "zones", 6)[0].tolist()
        options.zones, options.zone_count = given, len(zones)
        if up is not None:
            options.up = _arrays.points(up, "up")[0].tolist()
        self._handle = session.make("starg_solid", lib.starg_solid_free, lib.starg_space_create,
                                    session.context, self.model._handle, self._pointers(),
                                    len(self.obstacles), options, progress=progress)
        if sum(given is not None for given in (see, ignore, weights)) > 1:
            raise ArgumentError("see, ignore and weights exclude each other; weights say it all")
        if see is not None:
            weights = np.isin(np.arange(len(self.model.faces)), self._faces(session, see, "see")).astype(float)
        if ignore is not None:
            weights = 1.0 - np.isin(np.arange(len(self.model.faces)), self._faces(session, ignore, "ignore"))
        if weights is not None:
            self._weigh(session, weights)
        if needs:
            wanted = ffi.new("starg_face_need[]", [{"face": f, "times": t, "density": d} for f, t, d in needs])
            session.call(lib.starg_space_require, self._handle, wanted, len(needs))
        #: All that blocks the view: the faces of the model first.
        self.mesh = Mesh._of(lib.starg_solid_mesh(self._handle), self.model.file,
                             owner=self._handle)

    def _pointers(self) -> Any:
        return ffi.new("starg_mesh *[]", [o._handle for o in self.obstacles] or [ffi.NULL])

    def _faces(self, session: Session, chosen: ArrayLike, what: str) -> Array:
        """Numbers of faces, ascending, from numbers or names."""
        names = [chosen] if isinstance(chosen, str) else chosen
        if not (isinstance(names, (list, tuple)) and names and all(isinstance(name, str) for name in names)):
            faces = np.unique(_arrays.given(chosen, what))
            if len(faces) > 0 and not 0 <= faces[0] <= faces[-1] < len(self.model.faces):
                raise ArgumentError(f"{what}: the model has the faces 0 to {len(self.model.faces) - 1}")
            return faces.astype(np.uint32)
        if self.model.file is None:
            raise ArgumentError(f"{what} has names, which are those of a model's file, and this model has none; "
                                "read it by Mesh.read, or give numbers of faces")
        found = np.zeros(len(self.model.faces), bool)
        values = ffi.new("double **")
        for name in names:
            session.call(lib.starg_faces_named, session.context, _arrays.path(self.model.file), name.encode(),
                         len(found), values)
            found |= np.frombuffer(ffi.buffer(values[0], 8 * len(found))) != 0
            lib.starg_weights_free(session.context, values[0])
        return np.flatnonzero(found).astype(np.uint32)

    def _weigh(self, session: Session, weights: ArrayLike) -> None:
        faces = len(self.model.faces)
        numbers = _arrays.doubles(weights, "weights")
        if numbers.shape != (faces,):
            raise ArgumentError(f"weights must have the shape ({faces},), not {numbers.shape}")
        session.call(lib.starg_space_weigh, self._handle, _arrays.pointer("double[]", numbers))

    def __reduce__(self) -> tuple[Any, ...]:
        raise TypeError("a scene cannot be pickled; pickle its model and obstacles, and make the scene of them again")

    def __copy__(self) -> Scene:
        return self

    def __repr__(self) -> str:
        return f"Scene({len(self.model.faces)} faces, {len(self.obstacles)} obstacles)"

    @property
    def leak(self) -> Array:
        """A way from `start` of a soup to the outside of the model, or through a gap hardly wider
        than a cube; a warning tells of it, too. Shape (n, 3), with n = 0 if no leak was found."""
        count = ffi.new("size_t *")
        points = lib.starg_space_leak(self._handle, count)
        return _arrays.view(self._handle, points, (count[0], 3), np.float64) if points else np.empty((0, 3))

    def admits(self, points: ArrayLike) -> Array:
        """Whether a guard may stand at each point. Shape (n,), bool."""
        rows = _arrays.points(points, "points")
        return np.array([lib.starg_space_admits(self._handle, ffi.from_buffer("double[3]", row))
                         for row in rows], bool)


def as_solid(model: Any) -> Solid:
    """The solid of anything `as_mesh` accepts."""
    return model if isinstance(model, Solid) else as_mesh(model).solid
