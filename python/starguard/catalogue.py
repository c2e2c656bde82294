"""Procedural solids to try things with."""
from __future__ import annotations

from dataclasses import dataclass

from ._choice import give
from ._library import ffi, lib, text
from ._session import Session
from ._types import Progress
from .mesh import Mesh


@dataclass(frozen=True)
class SampleInfo:
    """One entry of the catalogue."""

    name: str
    description: str
    #: 1 for rigid solids; poses of one sample have the same faces.
    poses: int


def samples() -> list[SampleInfo]:
    """The catalogue.

    >>> import starguard
    >>> [entry.name for entry in starguard.samples()][:3]
    ['horse', 'dog', 'cat']
    """
    entries = [lib.starg_sample_at(i) for i in range(lib.starg_sample_count())]
    return [SampleInfo(text(e.name), text(e.description), e.poses) for e in entries]


def sample(name: str, *, pose: int | None = None, vertex_count: int | None = None,
           progress: Progress | None = None) -> Mesh:
    """Makes the sample of that name: a closed, outward, embedded mesh of about 5,000 vertices.

    >>> import starguard
    >>> starguard.sample("dog", pose=2, vertex_count=1000)
    Mesh(1000 vertices, 1996 faces)
    """
    session = Session()
    options = ffi.new("starg_sample_options *")
    lib.starg_sample_options_default(options)
    give(options, pose=pose, vertex_count=vertex_count)
    return Mesh._of(session.make("starg_mesh", lib.starg_mesh_free, lib.starg_sample_create,
                                 session.context, name.encode(), options, progress=progress))
