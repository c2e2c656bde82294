# SPDX-License-Identifier: Apache-2.0
"""A retrieval database: signatures of models in an SQLite file."""
from __future__ import annotations

import threading
from dataclasses import dataclass
from typing import Any, Iterable, Sequence

import numpy as np

from . import _arrays
from ._choice import choose, renamed, word_of
from ._library import ffi, lib, text
from ._session import Session
from ._types import Array, PathLike, Progress
from .descriptors import KINDS, NO_CLASS, Retrieval, Signature, _measure, distances, signature
from .errors import ArgumentError

_OUTCOMES = {"added": lib.STARG_DATABASE_ADDED, "known": lib.STARG_DATABASE_KNOWN,
             "refused": lib.STARG_DATABASE_REFUSED}


@dataclass(frozen=True)
class Added:
    """The outcome for one file."""

    file: str
    #: "added", "known" (the same content is stored) or "refused".
    outcome: str
    #: The name of the stored content, or the reason for refusal; else "".
    text: str


@dataclass(frozen=True)
class StoredModel:
    """A model of a database."""

    id: int
    path: str
    name: str
    #: SHA-256 of the file.
    hash: str
    vertices: int
    faces: int
    #: Distance to the query.
    distance: float
    #: If signatures were requested.
    signature: Signature | None


class Models(Sequence[StoredModel]):
    """Models of a database, sorted by file name or by distance."""

    def __init__(self, handle: Any) -> None:
        self._handle = handle
        self._items = [self._model(handle.items[i]) for i in range(handle.count)]

    def _model(self, m: Any) -> StoredModel:
        kept = Signature._of(m.signature, self._handle) if m.signature else None
        return StoredModel(m.id, text(m.path), text(m.name), text(m.hash), m.vertices, m.faces,
                           m.distance, kept)

    def __len__(self) -> int:
        return len(self._items)

    def __getitem__(self, key: Any) -> Any:
        return self._items[key]

    def __repr__(self) -> str:
        return f"Models({[m.name for m in self._items]})"

    def classes(self, file: PathLike | None = None) -> list[str | None]:
        """The class of each model: its file name up to the last '_', or from the lines "MODEL CLASS"
        of a file (None for models not listed)."""
        names, numbers = self._classes(file)
        return [None if n == NO_CLASS else names[n] for n in numbers]

    def _distances(self) -> Array:
        return distances([m.signature for m in self if m.signature is not None])

    def _classes(self, file: PathLike | None) -> tuple[list[str], Array]:
        session = Session()
        words = [] if file is None else [_arrays.path(file)]
        function = lib.starg_classes_read if words else lib.starg_classes_by_prefix
        c = session.make("starg_classes", lib.starg_classes_free, function, session.context, *words,
                         self._handle, shared=True)
        return ([text(c.names[i]) for i in range(c.count)],
                _arrays.copy(c.class_of, (c.model_count,), np.uint32))


class Database:
    """An open database and context manager. Several processes may open the same file. Threads may
    share a Database; they use it one at a time.

    >>> import starguard
    >>> for name in ("l-room", "star"):
    ...     for size in (500, 700):
    ...         starguard.sample(name, vertices=size).write(f"{name}_{size}.off")
    >>> with starguard.Database.create("shapes.db") as shapes:
    ...     added = shapes.add(["l-room_500.off", "star_500.off", "no.off"])
    ...     nearest = shapes.query("star_700.off", 1)
    >>> [a.outcome for a in added], nearest
    (['added', 'added', 'refused'], Models(['star_500.off']))
    """

    def __init__(self, path: PathLike, *, threads: int | None = None, seed: int | None = None) -> None:
        self._session = Session(threads, seed)
        self._lock = threading.Lock()
        self.path: PathLike = path  #: of the file
        self._handle = self._session.make(
            "starg_database", lib.starg_database_close, lib.starg_database_open,
            self._session.context, _arrays.path(path))

    @classmethod
    def create(cls, path: PathLike, *, threads: int | None = None,
               seed: int | None = None) -> Database:
        """Creates an empty database and opens it. Existing files are never overwritten."""
        session = Session()
        session.call(lib.starg_database_create, session.context, _arrays.path(path))
        return cls(path, threads=threads, seed=seed)

    def __reduce__(self) -> tuple[Any, ...]:
        return Database, (self.path,)  # the file is opened once more

    def close(self) -> None:
        """Closes the file; models already read remain valid."""
        with self._lock:
            if self._handle is not None:
                ffi.release(self._handle)
            self._handle = None

    def __enter__(self) -> Database:
        return self

    def __exit__(self, *reason: Any) -> None:
        self.close()

    def __repr__(self) -> str:
        return f"Database({self.path!r}{', closed' if self._handle is None else ''})"

    def _open(self) -> Any:
        if self._handle is None:
            raise ArgumentError("the database is closed")
        return self._handle

    def _models(self, function: Any, *arguments: Any, progress: Progress | None = None) -> Models:
        with self._lock:
            return Models(self._session.make(
                "starg_database_models", lib.starg_database_models_free, function, self._open(),
                *arguments, shared=True, progress=progress))

    def add(self, files: Iterable[PathLike], *, progress: Progress | None = None) -> list[Added]:
        """Stores models with their signatures under the given paths. Unusable files do not stop the
        others."""
        names = [_arrays.path(file) for file in files]
        words = [ffi.new("char[]", name) for name in names]
        if not words:
            return []
        with self._lock:
            report = self._session.make(
                "starg_database_report", lib.starg_database_report_free, lib.starg_database_add,
                self._open(), ffi.new("char *[]", words), len(words), shared=True, progress=progress)
        results = [report.results[i] for i in range(report.count)]
        return [Added(text(word), word_of(r.outcome, _OUTCOMES), text(r.text))
                for word, r in zip(words, results)]

    def remove(self, words: Iterable[PathLike]) -> None:
        """Removes models, all or none; each word is a stored path, a file name, or "id:N"."""
        names = [ffi.new("char[]", _arrays.path(word)) for word in words]
        if names:
            with self._lock:
                self._session.call(lib.starg_database_remove, self._open(),
                                   ffi.new("char *[]", names), len(names))

    def models(self) -> Models:
        """All models by file name."""
        return self._models(lib.starg_database_list)

    def signatures(self, kind: str = "shape-dna") -> Models:
        """All models with signatures of one kind: "star", "paper", "shape-dna" or "d2"."""
        return self._models(lib.starg_database_signatures, choose("kind", kind, KINDS))

    def query(self, wanted: Any, count: int = 10, distance: str = "shape-dna", *,
              progress: Progress | None = None, kind: str | None = None) -> Models:
        """The models nearest to a model or a Signature, nearest first, by the distance "star", "paper",
        "shape-dna" or "d2" (`kind`: its old name)."""
        distance = renamed("distance", distance, "kind", kind)
        asked = wanted if isinstance(wanted, Signature) else signature(wanted, distance, progress=progress)
        return self._models(lib.starg_database_query, asked._handle, count)

    def distances(self, distance: str = "shape-dna", *, kind: str | None = None) -> Array:
        """The matrix of one distance ("star", "paper", "shape-dna" or "d2"), in the order of
        `models()` (`kind`: the old name)."""
        return self.signatures(renamed("distance", distance, "kind", kind))._distances()

    def evaluate(self, classes: PathLike | None = None,
                 distance: str = "shape-dna", *,
                 kind: str | None = None) -> tuple[Retrieval, dict[str, Retrieval]]:
        """Retrieval measures of a distance ("star", "paper", "shape-dna" or "d2"; `kind` is the old
        name), overall and by class. The class is the file name up to the last '_', or
        given by the lines "MODEL CLASS" of a file."""
        models = self.signatures(renamed("distance", distance, "kind", kind))
        names, numbers = models._classes(classes)
        return _measure(models._distances(), numbers, names)
