# SPDX-License-Identifier: Apache-2.0
"""Shape descriptors based on guards, signatures, and retrieval measures."""
from __future__ import annotations

import os
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Sequence, Union

import numpy as np
from numpy.typing import ArrayLike

from . import _arrays
from ._choice import choose, renamed
from ._fields import fill
from ._library import ffi, lib, text
from ._options import Options, takes
from ._session import Session
from ._told import Told
from ._types import Array, PathLike, Progress
from .errors import ArgumentError
from .guards import name_of
from .mesh import as_mesh

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from ._keywords import DescribeOptions

_OPTIONS = Options("starg_descriptor_options")
KINDS = {text(lib.starg_signature_name(kind)): kind for kind in range(lib.STARG_SIGNATURE_KINDS)}

#: Marks "no class" in `retrieval`.
NO_CLASS = 2**32 - 1

_HEAD = 4096  # bytes that identify a descriptor


@dataclass(frozen=True)
class Reconstruction:
    """Distances between the points of a descriptor and a model, relative to its diagonal."""

    points: int
    samples: int
    to_mean: float
    to_largest: float
    from_mean: float
    from_largest: float


@dataclass(frozen=True, eq=False)
class Descriptor:
    """A graph of guards with the distances from each to the boundary in all directions. The arrays
    are read-only views of the library's memory."""

    #: The model's path as given, or None.
    file: str | None
    model_vertices: int
    model_faces: int
    diagonal: float
    effort: int
    time_limited: bool
    #: Structured: `position` (k, 3), `volume`.
    guards: Array
    #: Structured: `first`, `second`, `area`, `gate` (m, 3).
    edges: Array
    #: (k, directions).
    distances: Array
    _handle: Any = field(repr=False)

    def __repr__(self) -> str:
        return f"Descriptor({len(self.guards)} guards, {len(self.edges)} edges)"

    @classmethod
    def _of(cls, handle: Any, file: PathLike | None = None) -> Descriptor:
        d = handle
        return fill(cls, d, _handle=d, file=text(d.file) if d.file else name_of(file),
                    guards=_arrays.records(d, d.guards, d.guard_count),
                    edges=_arrays.records(d, d.edges, d.edge_count),
                    distances=_arrays.view(d, d.distances, (d.guard_count, d.direction_count),
                                           np.float64))

    @classmethod
    def read(cls, path: PathLike) -> Descriptor:
        """Reads DESCRIPTOR.json.

        >>> import starguard
        >>> starguard.describe(starguard.sample("l-room", vertices=500)).write("room.json")
        >>> starguard.Descriptor.read("room.json")
        Descriptor(1 guards, 0 edges)
        """
        session = Session()
        return cls._of(session.make("starg_descriptor", lib.starg_descriptor_free,
                                    lib.starg_descriptor_read, session.context, _arrays.path(path),
                                    shared=True))

    @classmethod
    def from_bytes(cls, data: bytes, name: str = "memory") -> Descriptor:
        """Reads the bytes of a DESCRIPTOR.json; `name` is used in messages."""
        session = Session()
        return cls._of(session.make(
            "starg_descriptor", lib.starg_descriptor_free, lib.starg_descriptor_read_memory,
            session.context, ffi.from_buffer(data) if data else ffi.NULL, len(data),
            _arrays.path(name), shared=True))

    def write(self, path: PathLike, model_file: PathLike | None = None) -> None:
        """Writes DESCRIPTOR.json (docs/formats.md)."""
        session = Session()
        name = model_file if model_file is not None else self.file
        session.call(lib.starg_descriptor_write, session.context, self._handle,
                     _arrays.path(name) if name is not None else ffi.NULL, _arrays.path(path))

    def points(self) -> Array:
        """The boundary points sampled by the descriptor: (guards, directions, 3).

        >>> import starguard
        >>> room = starguard.sample("l-room", vertices=500)
        >>> starguard.describe(room, directions=100).points().shape
        (1, 100, 3)
        """
        session = Session()
        owner = session.make("double", lib.starg_descriptor_points_free, lib.starg_descriptor_points,
                             session.context, self._handle, shared=True)
        return _arrays.view(owner, owner, self.distances.shape + (3,), np.float64)

    def reconstruct(self, model: Any) -> Reconstruction:
        """Measures the distances between these points and a model."""
        mesh = as_mesh(model)
        session = Session()
        out = ffi.new("starg_reconstruction *")
        session.call(lib.starg_descriptor_reconstruct, session.context, self._handle, mesh._handle,
                     out)
        return fill(Reconstruction, out)

    def signature(self, kind: str = "star") -> Signature:
        """A signature computed from this descriptor: "star" or "paper"."""
        session = Session()
        return Signature._of(session.make(
            "starg_signature", lib.starg_signature_free, lib.starg_signature_of_descriptor,
            session.context, self._handle, choose("kind", kind, KINDS), shared=True))


@takes(_OPTIONS)
def describe(model: Any, *, threads: int | None = None, seed: int | None = None,
             time_limit: float | None = None, progress: Progress | None = None,
             **options: Unpack[DescribeOptions]) -> Descriptor:
    """Computes a descriptor from the guards of a fast star decomposition and what they see.

    >>> import starguard
    >>> d = starguard.describe(starguard.sample("l-room", vertices=500))
    >>> d.distances.shape, d.guards["position"].shape
    ((1, 256), (1, 3))
    """
    wanted = _OPTIONS.make(options)
    mesh = as_mesh(model)
    session = Session(threads, seed)
    return Descriptor._of(session.make(
        "starg_descriptor", lib.starg_descriptor_free, lib.starg_descriptor_create, session.context,
        mesh._handle, wanted.pointer, shared=True, progress=progress, time_limit=time_limit), mesh.file)


def directions(count: int = 256) -> Array:
    """The ray directions of the guards of a descriptor, (count, 3).

    >>> import numpy, starguard
    >>> bool(numpy.allclose(numpy.linalg.norm(starguard.directions(12), axis=1), 1))
    True
    """
    rows = np.empty((count, 3))
    for i, row in enumerate(rows):
        lib.starg_descriptor_direction(count, i, ffi.from_buffer("double[3]", row))
    return rows


# ---- signatures ----


@dataclass(frozen=True, eq=False, repr=False)
class Signature(Told):
    """A signature of a model: numbers of a kind ("d2", "shape-dna", "star" or "paper")."""

    kind: str
    version: int
    #: Read-only, without a copy.
    numbers: Array
    _handle: Any = field(repr=False)
    _owner: Any = field(repr=False)

    @classmethod
    def _of(cls, handle: Any, owner: Any = None) -> Signature:
        keeper = handle if owner is None else owner
        return cls(text(lib.starg_signature_name(handle.kind)), handle.version,
                   _arrays.view(keeper, handle.numbers, (handle.count,), np.float64), handle, keeper)

    @classmethod
    def restore(cls, kind: str, version: int, numbers: ArrayLike) -> Signature:
        """Restores a signature from stored numbers.

        >>> import starguard
        >>> a = starguard.signature(starguard.sample("star", vertices=500), "d2")
        >>> b = starguard.Signature.restore(a.kind, a.version, a.numbers)
        >>> starguard.match(a, b)
        0.0
        """
        array = _arrays.doubles(numbers, "numbers").ravel()
        session = Session()
        return cls._of(session.make(
            "starg_signature", lib.starg_signature_free, lib.starg_signature_restore, session.context,
            choose("kind", kind, KINDS), version, _arrays.pointer("double[]", array), len(array),
            shared=True, brief=True))

    def __reduce__(self) -> tuple[Any, ...]:
        return Signature.restore, (self.kind, self.version, np.array(self.numbers))


def signature(model: Any, kind: str = "star", *, threads: int | None = None,
              seed: int | None = None, time_limit: float | None = None,
              progress: Progress | None = None) -> Signature:
    """Computes a signature, invariant to translation, rotation, scaling and reflection.

    >>> import starguard
    >>> starguard.signature(starguard.sample("star", vertices=500), "shape-dna").numbers.shape
    (50,)
    """
    number = choose("kind", kind, KINDS)
    mesh = as_mesh(model)
    session = Session(threads, seed)
    return Signature._of(session.make(
        "starg_signature", lib.starg_signature_free, lib.starg_signature_create, session.context,
        mesh._handle, number, shared=True, progress=progress,
        time_limit=time_limit))


def signatures(model: Any, *, threads: int | None = None, seed: int | None = None,
               time_limit: float | None = None,
               progress: Progress | None = None) -> dict[str, Signature]:
    """Computes signatures of all kinds with a single descriptor.

    >>> import starguard
    >>> sorted(starguard.signatures(starguard.sample("l-room", vertices=500)))
    ['d2', 'paper', 'shape-dna', 'star']
    """
    mesh = as_mesh(model)
    session = Session(threads, seed)
    out = ffi.new(f"starg_signature *[{lib.STARG_SIGNATURE_KINDS}]")
    try:
        session.call(lib.starg_signature_create_all, session.context, mesh._handle, out,
                     progress=progress, time_limit=time_limit)
    finally:
        handles = [session.own(s, lib.starg_signature_free, shared=True) for s in out if s]
    made = [Signature._of(handle) for handle in handles]
    return {s.kind: s for s in made}


def current_version(kind: str) -> int:
    """The current version of a signature kind.

    >>> import starguard
    >>> starguard.current_version("d2")
    2
    """
    return int(lib.starg_signature_version(choose("kind", kind, KINDS)))


Comparable = Union[Signature, Descriptor, Any]


def _signature_of(thing: Comparable, kind: str, options: dict[str, Any]) -> Signature:
    if isinstance(thing, Signature):
        return thing
    if isinstance(thing, (str, bytes, os.PathLike)) and is_descriptor(thing):
        thing = Descriptor.read(thing)
    if not isinstance(thing, Descriptor):
        return signature(thing, kind, **options)
    if not lib.starg_signature_needs_descriptor(choose("kind", kind, KINDS)):
        raise ArgumentError(f"a descriptor does not tell '{kind}', which needs the model itself")
    return thing.signature(kind)


def is_descriptor(path: PathLike) -> bool:
    """Does the content of a file say that it is a descriptor? No model begins like that.

    >>> import starguard
    >>> starguard.sample("star", vertices=500).write("star.off")
    >>> starguard.is_descriptor("star.off")
    False
    """
    try:
        with open(path, "rb") as file:
            head = file.read(_HEAD)
    except OSError:
        return False
    return bool(lib.starg_descriptor_recognized(ffi.from_buffer(head) if head else ffi.NULL, len(head)))


def match(a: Comparable, b: Comparable, distance: str = "star", *, threads: int | None = None,
          seed: int | None = None, time_limit: float | None = None,
          progress: Progress | None = None, kind: str | None = None) -> float:
    """Computes the distance between two shapes, 0 or more. Each is a model, a Descriptor, a
    Signature, or a file of a model or a descriptor. `distance` is "star" (independent of pose),
    "paper", "shape-dna" or "d2"; its old name `kind` works for one more version.

    >>> import starguard
    >>> star, room = (starguard.sample(name, vertices=500) for name in ("star", "l-room"))
    >>> starguard.match(star, star, "d2"), starguard.match(star, room, "d2") > 0.1
    (0.0, True)
    """
    options = {"threads": threads, "seed": seed, "time_limit": time_limit, "progress": progress}
    wanted = renamed("distance", distance, "kind", kind)
    first, second = _signature_of(a, wanted, options), _signature_of(b, wanted, options)
    session = Session()
    out = ffi.new("double *")
    session.call(lib.starg_signature_distance, session.context, first._handle, second._handle, out,
                 brief=True)
    return float(out[0])


@dataclass(frozen=True)
class Alignment:
    """How B lies to A, which distances do not tell: `scale`, a length in B by that in A; `hand`, "same",
    "mirrored" or "undecided"; and how far B is from A and from A's mirror image, by the diagonal of A."""
    scale: float
    hand: str
    same: float
    mirrored: float


def align(a: Any, b: Any, *, seed: int | None = None, progress: Progress | None = None) -> Alignment:
    """Moves and scales model A onto B, and its mirror image.

    >>> import starguard
    >>> tower = starguard.sample("polycube", pose=1, vertices=500)
    >>> starguard.align(tower, (2 * tower.vertices * (-1, 1, 1), tower.faces[:, ::-1])).hand
    'mirrored'
    """
    first, second = as_mesh(a), as_mesh(b)
    session = Session(seed=seed)
    out = ffi.new("starg_alignment *")
    session.call(lib.starg_alignment_measure, session.context, first._handle, second._handle, out,
                 progress=progress)
    return Alignment(out.scale, ffi.string(lib.starg_hand_name(out.hand)).decode(), out.same, out.mirrored)


def distances(signatures: Sequence[Signature], *, threads: int | None = None,
              progress: Progress | None = None) -> Array:
    """The symmetric distance matrix of signatures of one kind.

    >>> import starguard
    >>> rooms = [starguard.sample("l-room", vertices=n) for n in (500, 700)]
    >>> models = rooms + [starguard.sample("star", vertices=500)]
    >>> m = starguard.distances([starguard.signature(model, "d2") for model in models])
    >>> m.shape, bool(m[0, 1] < m[0, 2])
    ((3, 3), True)
    """
    session = Session(threads)
    matrix = np.zeros((len(signatures), len(signatures)))
    handles = ffi.new("starg_signature *[]", [s._handle for s in signatures])
    session.call(lib.starg_signature_distances, session.context, handles, len(signatures),
                 _arrays.pointer("double[]", matrix), progress=progress)
    return matrix


# ---- retrieval ----


@dataclass(frozen=True, eq=False, repr=False)
class Retrieval(Told):
    """Retrieval measures averaged over queries, each in [0, 1]; 1 is perfect."""

    models: int
    queries: int
    nearest_neighbour: float
    first_tier: float
    second_tier: float
    e_measure: float
    dcg: float
    #: Interpolated precision at recall 1/20, 2/20, ..., 1.
    precision: Array


def retrieval(distances: ArrayLike, classes: Sequence[Any]) -> tuple[Retrieval, dict[Any, Retrieval]]:
    """Retrieval measures of a distance matrix (n, n), overall and by class. Models with class None
    are neither queries nor ranked.

    >>> import starguard
    >>> d = [[0, 1, 5, 6], [1, 0, 7, 8], [5, 7, 0, 2], [6, 8, 2, 0]]
    >>> overall, by_class = starguard.retrieval(d, ["dog", "dog", "cat", "cat"])
    >>> overall.first_tier, sorted(by_class)
    (1.0, ['cat', 'dog'])
    """
    matrix = _arrays.doubles(distances, "distances")
    if matrix.ndim != 2 or matrix.shape != (len(classes), len(classes)):
        raise ArgumentError(f"distances of {len(classes)} models must have the shape ({len(classes)}, "
                            f"{len(classes)}), not {matrix.shape}")
    names = sorted({c for c in classes if c is not None})
    numbers = np.array([NO_CLASS if c is None else names.index(c) for c in classes], np.uint32)
    return _measure(matrix, numbers, names)


def _measure(matrix: Array, numbers: Array,
             names: Sequence[Any]) -> tuple[Retrieval, dict[Any, Retrieval]]:
    session = Session()
    by_class = ffi.new("starg_retrieval[]", max(len(names), 1))
    overall = ffi.new("starg_retrieval *")
    session.call(lib.starg_retrieval_measure, session.context, _arrays.pointer("double[]", matrix),
                 _arrays.pointer("uint32_t[]", numbers), len(matrix), len(names), by_class, overall)
    return _retrieval_of(overall), {name: _retrieval_of(by_class[i]) for i, name in enumerate(names)}


def _retrieval_of(r: Any) -> Retrieval:
    return fill(Retrieval, r, precision=np.array(list(r.precision)))
