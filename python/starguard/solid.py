# SPDX-License-Identifier: Apache-2.0
"""Solids: checked meshes with search structures."""
from __future__ import annotations

import weakref
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from . import _arrays
from ._library import ffi, lib
from ._session import Session
from ._types import Array, Progress
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


def as_solid(model: Any) -> Solid:
    """The solid of anything `as_mesh` accepts."""
    return model if isinstance(model, Solid) else as_mesh(model).solid
