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


def prism(outline, height):
    """Over a polygon that the origin sees all of, with fans about it as caps."""
    count = len(outline)
    vertices = [[0, 0, 0]] + [[x, y, 0] for x, y in outline] + [[0, 0, height]] + [[x, y, height] for x, y in outline]
    faces = []
    for i in range(count):
        a, b = 1 + i, 1 + (i + 1) % count
        c, d = a + count + 1, b + count + 1
        faces += [(0, b, a), (count + 1, c, d), (a, b, d), (a, d, c)]
    return vertices, faces


def random_ball(rng):
    """A name and a plain solid without holes, most often one that no point sees: a tree of cubes, a spiked
    prism, a comb, or a pile of rings; turned at random."""
    while True:
        kind = rng.choice(["cubes", "prism", "comb", "pile"])
        if kind == "cubes":
            cells, count = [(0, 0, 0)], rng.randint(3, 12)
            while len(cells) < count:
                cell = list(rng.choice(cells))
                cell[rng.randrange(3)] += rng.choice((-1, 1))
                near = sum(sum(abs(x - y) for x, y in zip(cell, other)) <= 1 for other in cells)
                corner = sum(max(abs(x - y) for x, y in zip(cell, other)) <= 1 for other in cells)
                if near == 1 and tuple(cell) not in cells and corner <= 3:
                    cells.append(tuple(cell))
            made = blocks(cells)
        elif kind == "prism":
            count = rng.randint(5, 14)
            radii = [rng.uniform(0.3, 2) for _ in range(count)]
            made = prism([[r * f(2 * math.pi * i / count) for f in (math.cos, math.sin)] for i, r in enumerate(radii)],
                         rng.choice((0.3, 1, 5)))
        elif kind == "comb":
            teeth = rng.randint(2, 6)
            made = blocks([(x, 0, 0) for x in range(2 * teeth - 1)] +
                          [(2 * x, y, 0) for x in range(teeth) for y in (1, 2)])
        else:
            sides, rings = rng.randint(3, 16), rng.randint(2, 6)
            widths = [rng.uniform(0.4, 2) for _ in range(rings)]
            made = plain.tube([[0, 0, z] for z in range(-1, rings + 1)], [0, *widths, 0], sides)
        matrix = plain.random_turn(rng)
        vertices = [plain.turn(matrix, v) for v in made[0]]
        if is_ball(vertices, made[1]):
            return kind, (vertices, made[1])


def is_ball(vertices, faces):
    """Euler's number of one closed surface, each edge in two faces, one fan about each vertex."""
    edges = {}
    for face in faces:
        for i in range(3):
            edges[face[i], face[(i + 1) % 3]] = edges.get((face[i], face[(i + 1) % 3]), 0) + 1
    used = {v for face in faces for v in face}
    if any(n != 1 or (v, u) not in edges for (u, v), n in edges.items()) or len(used) < len(vertices):
        return False
    after = {v: {} for v in used}
    for a, b, c in faces:
        after[a][b], after[b][c], after[c][a] = c, a, b
    for ring in after.values():
        first = at = next(iter(ring))
        length = 0
        while True:
            at, length = ring[at], length + 1
            if at == first:
                break
        if length < len(ring):
            return False
    return len(used) - len(edges) // 2 + len(faces) == 2


def write(path, solid):
    vertices, faces = solid
    with open(path, "w", encoding="utf-8") as file:
        file.write(f"OFF\n{len(vertices)} {len(faces)} 0\n")
        file.writelines("%r %r %r\n" % tuple(map(float, v)) for v in vertices)
        file.writelines("3 %d %d %d\n" % tuple(f) for f in faces)
