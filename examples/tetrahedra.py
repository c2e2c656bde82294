# SPDX-License-Identifier: Apache-2.0
"""Star-shaped pieces, as tetrahedra for a simulation.

    python3 tetrahedra.py [MODEL]

Writes pieces.vtk, and pieces.vtu if meshio is installed.
"""
import sys

import numpy as np

import starguard

solid = starguard.Mesh.read(sys.argv[1]) if len(sys.argv) > 1 else starguard.sample("gallery", vertices=500)
pieces = starguard.decompose(solid, effort=50)
corners = pieces.mesh.vertices[pieces.mesh.tetrahedra]  # (m, 4, 3)
edges = corners[:, 1:] - corners[:, :1]
volumes = np.linalg.det(edges) / 6
for number, piece in enumerate(pieces):
    inside = pieces.labels == number
    print(f"piece {number}: guard {piece['guard'].round(2)}, {inside.sum()} tetrahedra, "
          f"volume {volumes[inside].sum():.4g}")
print(f"{len(pieces)} pieces, {pieces.strictly_star} proven star-shaped; all tetrahedra positive: "
      f"{bool((volumes > 0).all())}; volume {volumes.sum():.6g} of {solid.volume:.6g}")
pieces.write("pieces.vtk")
try:
    pieces.to_meshio().write("pieces.vtu")
except ImportError as error:
    print(error)
