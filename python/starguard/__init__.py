# SPDX-License-Identifier: Apache-2.0
"""starguard: fewest guards that see the whole boundary of a solid, and star-shaped pieces.

    >>> import starguard
    >>> room = starguard.sample("gallery", vertices=1000)
    >>> guards = starguard.guard(room)
    >>> starguard.verify(room, guards).passed
    True

A model is a Mesh, a file name, a pair (vertices, faces), or an object of trimesh, meshio or
PyVista. Arrays are NumPy arrays: vertices (n, 3) float64, faces (m, 3) of any integer type.
Returned arrays are read-only views of the library's memory, without a copy. Errors are exceptions derived
from `Error`. Slow calls take `threads`, `seed`, `time_limit` and `progress`; Ctrl-C interrupts them.
"""
try:
    import numpy as _numpy  # noqa: F401
except ImportError as _error:
    raise ImportError("starguard needs NumPy: pip install numpy, or Debian's python3-numpy") from _error
from ._library import version as __version__
from ._session import Defaults, defaults, logger
from ._types import Progress
from .covers import Cover, cover
from .databases import Added, Database, Models, StoredModel
from .descriptors import (NO_CLASS, Alignment, Descriptor, Reconstruction, Retrieval, Signature, align, current_version,
                          describe, directions, distances, is_descriptor, match, retrieval, signature,
                          signatures)
from .errors import (ArgumentError, CancelledError, Error, FormatError, MeshError, OutOfMemoryError,
                     RangeError, ReadError, SolverError, TimeLimitError, WriteError)
from .guards import Guard, Guards, GuardLevel, Tour, audit, candidate_points, guard, guard_many, points_from_bytes, read_points, unseen
from .kernels import Kernel, kernel
from .mesh import NO_VERTEX, Check, Finding, Level, Mesh, RepairReport, as_mesh
from .morphs import (FrameMeasures, Morph, SurfaceMap, animation_from_bytes, map_surface,
                     read_animation, read_landmarks, write_animation)
from .pictures import (distinct_colors, picture, write_chart, write_matrix_picture, write_picture,
                       write_picture_sheet)
from .pieces import Decomposition, decompose
from .catalogue import SampleInfo, sample, samples
from .skeletons import Skeleton, skeleton
from .solid import Scene, Solid
from .solidmaps import SolidMap, map_of_morph, map_solid
from .tetra import NO_NEIGHBOUR, TetMesh, TetraReport, is_tetrahedral, tetrahedralize
from .verification import (Certificate, Claim, MapFile, MorphReport, PiecesMesh, PiecesReport, Verdict,
                           read_result, verify, verify_map, verify_morph)
from .views import page_available, write_page, write_scene
from .visibility import Bits, cone_cosine, visible, visible_from_box

__all__ = [
    "Added", "Alignment", "ArgumentError", "Bits", "CancelledError", "Certificate", "Check", "Claim", "Cover", "Database",
    "Decomposition", "Defaults", "Descriptor", "Error", "Finding", "FormatError", "FrameMeasures",
    "Guard", "GuardLevel", "Guards", "Kernel", "Level", "MapFile", "Mesh", "MeshError", "Models", "Morph",
    "MorphReport", "NO_CLASS",
    "NO_NEIGHBOUR", "NO_VERTEX", "OutOfMemoryError", "PiecesMesh", "PiecesReport", "Progress",
    "RangeError", "ReadError", "Reconstruction", "RepairReport", "Retrieval", "SampleInfo",
    "Scene", "Signature", "Skeleton", "Solid", "SolidMap", "SolverError", "StoredModel", "SurfaceMap", "TetMesh",
    "TetraReport", "TimeLimitError", "Tour", "Verdict", "WriteError", "__version__", "animation_from_bytes",
    "align", "as_mesh", "audit",
    "candidate_points", "cone_cosine", "cover", "current_version", "decompose", "defaults",
    "describe", "directions", "distances", "distinct_colors", "guard", "guard_many", "is_descriptor",
    "is_tetrahedral", "kernel", "logger", "map_of_morph", "map_solid", "map_surface", "match", "page_available", "picture",
    "points_from_bytes", "read_animation", "read_landmarks", "read_points", "read_result", "retrieval", "sample", "samples", "signature",
    "signatures", "skeleton", "tetrahedralize", "unseen", "verify", "verify_map", "verify_morph", "visible", "visible_from_box",
    "write_animation", "write_chart", "write_matrix_picture", "write_page", "write_picture", "write_picture_sheet",
    "write_scene"]
