# SPDX-License-Identifier: Apache-2.0
"""Which poses belong to the same animal? Distances that do not depend on the pose tell.

    python3 poses.py
"""
import numpy as np

import starguard

names = [(animal, pose) for animal in ("horse", "cat", "bird") for pose in (0, 1)]
shapes = [starguard.sample(animal, pose=pose, vertices=500) for animal, pose in names]
matrix = starguard.distances([starguard.signature(shape, "star") for shape in shapes])
np.fill_diagonal(matrix, np.inf)
for (animal, pose), row in zip(names, matrix):
    nearest = names[int(row.argmin())]
    print(f"{animal} {pose}: nearest is {nearest[0]} {nearest[1]} at {row.min():.3f}")
np.fill_diagonal(matrix, 0)
measures, _ = starguard.retrieval(matrix, [animal for animal, _ in names])
print(f"nearest neighbour right: {measures.nearest_neighbour:.0%}")
starguard.write_matrix_picture("poses.png", matrix)
