# SPDX-License-Identifier: Apache-2.0
"""Procedural sample solids."""
from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from ._choice import near
from ._library import lib, text
from ._options import Options, takes
from ._session import Session
from ._types import Progress
from .errors import ArgumentError
from .mesh import Mesh

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from ._keywords import SampleOptions

_OPTIONS = Options("starg_sample_options", old={"vertex_count": "vertices"})


@dataclass(frozen=True)
class SampleInfo:
    """One entry of the catalogue."""

    name: str
    description: str
    #: 1 for rigid solids; all poses of an animal have the same faces, those of a family are its members.
    poses: int


def samples() -> list[SampleInfo]:
    """The catalogue.

    >>> import starguard
    >>> [entry.name for entry in starguard.samples()][:3]
    ['horse', 'dog', 'cat']
    """
    entries = [lib.starg_sample_at(i) for i in range(lib.starg_sample_count())]
    return [SampleInfo(text(e.name), text(e.description), e.poses) for e in entries]


@takes(_OPTIONS)
def sample(name: str, *, progress: Progress | None = None, **options: Unpack[SampleOptions]) -> Mesh:
    """Generates a sample: a closed, outward oriented, embedded mesh, or a scene ("office", "level",
    "statue").

    >>> import starguard
    >>> starguard.sample("dog", pose=2, vertices=1000)
    Mesh(1000 vertices, 1996 faces)
    """
    session = Session()
    wanted = _OPTIONS.make(options)
    names = [entry.name for entry in samples()]
    if name not in names:
        raise ArgumentError(f"there is no sample {name!r}{near(str(name), names)}; `samples()` lists them")
    return Mesh._of(session.make("starg_mesh", lib.starg_mesh_free, lib.starg_sample_create,
                                 session.context, name.encode(), wanted.pointer, progress=progress))
