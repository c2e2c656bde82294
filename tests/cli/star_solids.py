# SPDX-License-Identifier: Apache-2.0
"""Ten plain star-shaped solids: cube, box, tetrahedron, octahedron, sphere, cylinder, cone, L, T, plus.

`solids()` has them as a newcomer draws them, along the axes and with few faces; `solids(rng)` turns, moves and
stretches each at random. Nothing here comes from the program that is tested.
"""
import math

import plain_solids as plain


def blocks(cells):
    solid = plain.voxels("", "", cells, 0, [], 0.5)
    return solid.vertices, solid.faces


def octahedron():
    return ([[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]],
            [(i, j, 4) for i, j in ((0, 2), (2, 1), (1, 3), (3, 0))] + [(j, i, 5) for i, j in ((0, 2), (2, 1), (1, 3), (3, 0))])


def tetrahedron():
    return [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], [(0, 2, 1), (0, 1, 3), (1, 2, 3), (0, 3, 2)]


def of_revolution(solid):
    return solid.vertices, solid.faces


def solids(rng=None, detail=1):
    """Pairs of a name and (vertices, faces)."""
    row = [(x, 0, 0) for x in range(3)]
    made = {
        "cube": blocks([(0, 0, 0)]),
        "box": blocks([(x, y, 0) for x in range(4) for y in range(2)]),
        "tetrahedron": tetrahedron(),
        "octahedron": octahedron(),
        "sphere": of_revolution(plain.ellipsoid(12 * detail, 8 * detail, 1)),
        "cylinder": of_revolution(plain.cylinder(20 * detail, 2, 3)),
        "cone": of_revolution(plain.cone(20 * detail, 2, 2)),
        "L": blocks(row + [(0, 1, 0), (0, 2, 0)]),
        "T": blocks(row + [(1, 1, 0), (1, 2, 0)]),
        "plus": blocks([(1, 1, 0), (0, 1, 0), (2, 1, 0), (1, 0, 0), (1, 2, 0)]),
    }
    if rng is not None:
        for name, (vertices, faces) in made.items():
            turn, size = plain.random_turn(rng), [rng.uniform(0.5, 2) for _ in range(3)]
            move = [rng.uniform(-3, 3) for _ in range(3)]
            made[name] = [plain.add(plain.turn(turn, [s * x for s, x in zip(size, v)]), move) for v in vertices], faces
    return list(made.items())


def write(path, solid):
    vertices, faces = solid
    with open(path, "w", encoding="utf-8") as file:
        file.write(f"OFF\n{len(vertices)} {len(faces)} 0\n")
        file.writelines("%r %r %r\n" % tuple(map(float, v)) for v in vertices)
        file.writelines("3 %d %d %d\n" % tuple(f) for f in faces)
