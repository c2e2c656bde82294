#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Two families of meshes as people have them, and what `starguard repair` makes of them, as a table.

Voxel bodies of 8 to 500 cubes, meshed into large rectangles with T-junctions, half of them turned, scaled and moved:
volume and area are known. Pairs of convex solids (prisms, cylinders, spheres, boxes; coaxial, flush, touching, nested,
turned), likewise: the volume of the union follows from inclusion and exclusion, that of the intersection from cutting one
by the planes of the other, here and in floating point.

Usage: families.py [COUNT] (of each; 1000)
"""
import math
import os
import random
import resource
import subprocess
import sys
import tempfile

ULP = 2.0 ** -52
MOST_SECONDS = 60


class Case:
    """A mesh, and the volume and area (or None) that its repair must have."""

    def __init__(self, vertices, faces, volume, area, rng, turned):
        scale, shift = 1.0, (0, 0, 0)
        if turned:
            matrix = rotation(rng)
            scale = 10 ** rng.uniform(-3, 6)
            if rng.random() < 0.3:
                scale = max(scale, 1.0)
                shift = [1e7 * rng.uniform(-1, 1) for _ in range(3)]
            vertices = [tuple(scale * sum(matrix[k][i] * p[i] for i in range(3)) + shift[k] for k in range(3))
                        for p in vertices]
        self.vertices, self.faces = vertices, faces
        self.volume = volume * scale ** 3
        self.area = None if area is None else area * scale ** 2
        # what rounding of the coordinates may change
        step = ULP * max(abs(x) for p in vertices for x in p)
        self.loose = 60 * step * area_of(vertices, faces) + 1e-9 * self.volume
        self.area_loose = None if area is None else 400 * step * area * scale + 1e-9 * self.area

    def faults(self, vertices, faces):
        """What is wrong with a result."""
        out = []
        if abs(volume_of(vertices, faces) - self.volume) > self.loose:
            out.append(f"volume {volume_of(vertices, faces)!r}, {self.volume!r} expected")
        if self.area is not None and abs(area_of(vertices, faces) - self.area) > self.area_loose:
            out.append(f"area {area_of(vertices, faces)!r}, {self.area!r} expected")
        edges = {}
        for face in faces:
            for k in range(3):
                edge = face[k], face[(k + 1) % 3]
                edges[edge] = edges.get(edge, 0) + 1
        if any(count > 1 or (b, a) not in edges for (a, b), count in edges.items()):
            out.append("not closed and manifold")
        return out


def rotation(rng):
    q = [rng.gauss(0, 1) for _ in range(4)]
    length = math.sqrt(sum(x * x for x in q))
    w, x, y, z = (a / length for a in q)
    return [[1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]]


def minus(a, b):
    return [a[k] - b[k] for k in range(3)]


def dot(a, b):
    return sum(a[k] * b[k] for k in range(3))


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def unit(a):
    length = math.sqrt(dot(a, a))
    return [x / length for x in a]


def volume_of(vertices, faces):
    origin = vertices[faces[0][0]]
    return sum(dot(minus(vertices[a], origin), cross(minus(vertices[b], origin), minus(vertices[c], origin)))
               for a, b, c in faces) / 6


def area_of(vertices, faces):
    normals = (cross(minus(vertices[b], vertices[a]), minus(vertices[c], vertices[a])) for a, b, c in faces)
    return sum(math.sqrt(dot(n, n)) for n in normals) / 2


def write(path, vertices, faces):
    with open(path, "w", encoding="ascii") as file:
        file.write(f"OFF\n{len(vertices)} {len(faces)} 0\n")
        for p in vertices:
            file.write(" ".join(repr(float(x)) for x in p) + "\n")
        for face in faces:
            file.write("3 " + " ".join(map(str, face)) + "\n")


def read(path):
    with open(path, encoding="ascii") as file:
        words = file.read().split()
    count, faces = int(words[1]), int(words[2])
    numbers = list(map(float, words[4:4 + 3 * count]))
    corners = list(map(int, words[4 + 3 * count:]))
    return ([tuple(numbers[3 * i:3 * i + 3]) for i in range(count)],
            [tuple(corners[4 * i + 1:4 * i + 4]) for i in range(faces)])


# ---- voxel bodies ----

def grow(rng, count, edges):
    """Cubes that hang together by faces, some also by edges and corners."""
    near = [(a, b, c) for a in (-1, 0, 1) for b in (-1, 0, 1) for c in (-1, 0, 1) if (a, b, c) != (0, 0, 0)]
    beside = [d for d in near if sum(map(abs, d)) == 1]
    cells = [(0, 0, 0)]
    known = set(cells)
    while len(cells) < count:
        step = rng.choice(near if edges and rng.random() < 0.1 else beside)
        cell = tuple(x + d for x, d in zip(rng.choice(cells), step))
        if cell not in known:
            known.add(cell)
            cells.append(cell)
    return known


def take_rectangle(rng, squares):
    a, b = min(squares) if rng.random() < 0.5 else rng.choice(sorted(squares))
    width = height = 1
    while (a + width, b) in squares:
        width += 1
    while all((a + i, b + height) in squares for i in range(width)):
        height += 1
    squares -= {(a + i, b + j) for i in range(width) for j in range(height)}
    return [(a, b), (a + width, b), (a + width, b + height), (a, b + height)]


def voxels(rng, count, turned=False):
    cells = grow(rng, count, rng.random() < 0.4)
    number, faces, area = {}, [], 0
    for axis in range(3):
        u, v = (axis + 1) % 3, (axis + 2) % 3
        for side in (1, -1):
            slabs = {}
            for cell in cells:
                if tuple(x + side * (k == axis) for k, x in enumerate(cell)) not in cells:
                    slabs.setdefault(cell[axis] + (side > 0), set()).add((cell[u], cell[v]))
            for level, squares in sorted(slabs.items()):
                area += len(squares)
                while squares:
                    corners = []
                    for x, y in take_rectangle(rng, squares):
                        p = [level] * 3
                        p[u], p[v] = x, y
                        corners.append(number.setdefault(tuple(p), len(number)))
                    corners = corners if side > 0 else corners[::-1]
                    faces += [tuple(corners[:3]), (corners[0], corners[2], corners[3])]
    return Case(list(number), faces, count, area, rng, turned)


# ---- pairs of solids: vertices and polygons ----

def prism(sides, radius, height, low, phase):
    ring = [(radius * math.cos(phase + 2 * math.pi * i / sides), radius * math.sin(phase + 2 * math.pi * i / sides))
            for i in range(sides)]
    walls = [[i, (i + 1) % sides, sides + (i + 1) % sides, sides + i] for i in range(sides)]
    return ([(x, y, low) for x, y in ring] + [(x, y, low + height) for x, y in ring],
            [list(range(sides))[::-1], list(range(sides, 2 * sides))] + walls)


def sphere(sides, rings, radius, middle):
    points, polygons = [(0, 0, middle - radius)], []
    for j in range(1, rings):
        angle = math.pi * j / rings
        points += [(radius * math.sin(angle) * math.cos(2 * math.pi * i / sides),
                    radius * math.sin(angle) * math.sin(2 * math.pi * i / sides),
                    middle - radius * math.cos(angle)) for i in range(sides)]
    points.append((0, 0, middle + radius))
    top = len(points) - 1
    for i in range(sides):
        after = (i + 1) % sides
        polygons += [[0, 1 + after, 1 + i], [top, top - sides + i, top - sides + after]]
        for j in range(rings - 2):
            a, b = 1 + j * sides + i, 1 + j * sides + after
            polygons += [[a, b, b + sides], [a, b + sides, a + sides]]
    return points, polygons


def box(sides, low):
    return ([tuple(low[k] + sides[k] * (i >> k & 1) for k in range(3)) for i in range(8)],
            [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]])


def some_solid(rng):
    kind = rng.randrange(4)
    low = rng.choice([0, 0, 0, 0.5, 1, -0.5, rng.uniform(-1, 1)])
    phase = rng.choice([0, 0, rng.uniform(0, 1)])
    if kind == 0:
        return prism(rng.randint(3, 8), rng.choice([1, 0.5, 0.7, 2, 1]), rng.choice([1, 2, 0.5, 1]), low, phase)
    if kind == 1:
        return prism(rng.choice([12, 24, 32, 48, 64]), rng.choice([1, 0.5, 0.7, 2]), rng.choice([1, 2, 0.5]), low, phase)
    if kind == 2:
        return sphere(rng.choice([8, 12, 24]), rng.choice([4, 6, 12]), rng.choice([1, 0.5, 0.7, 2]), low)
    return box([rng.choice([1, 2, 0.5]) for _ in range(3)],
               (rng.choice([0, -0.5, -1, 1, rng.uniform(-1, 1)]), rng.choice([0, -0.5, -1]), low))


def place(points, rng):
    how = rng.choice(["coaxial", "coaxial", "shifted", "turned", "on top"])
    if how == "turned":
        matrix = rotation(rng)
        return [tuple(dot(matrix[k], p) for k in range(3)) for p in points]
    shift = {"coaxial": (0, 0, 0), "on top": (0, 0, rng.choice([1, 2, -1, 0.5])),
             "shifted": (rng.choice([0.5, 1, 2, 0.25]), rng.choice([0, 0, 0.5]), 0)}[how]
    return [tuple(p[k] + shift[k] for k in range(3)) for p in points]


def cut(polygons, normal, offset):
    """What of a convex solid, as polygons of points, lies behind a plane."""
    kept, rim, before = [], {}, False
    for polygon in polygons:
        heights = [dot(normal, p) - offset for p in polygon]
        heights = [0 if abs(h) < 1e-13 else h for h in heights]
        before = before or max(heights) > 0
        part = []
        for i, (p, h) in enumerate(zip(polygon, heights)):
            q, g = polygon[(i + 1) % len(polygon)], heights[(i + 1) % len(polygon)]
            if h <= 0:
                part.append(p)
            meeting = p if h == 0 else None
            if h * g < 0:
                meeting = tuple(p[k] + h / (h - g) * (q[k] - p[k]) for k in range(3))
                part.append(meeting)
            if meeting is not None:
                rim.setdefault(tuple(round(x * 1e11) for x in meeting), meeting)
        if len(part) > 2:
            kept.append(part)
    points = list(rim.values())
    if before and len(points) > 2:
        middle = [sum(p[k] for p in points) / len(points) for k in range(3)]
        across = unit(cross([1, 0, 0] if abs(normal[0]) < 0.7 else [0, 1, 0], normal))
        along = cross(normal, across)
        kept.append(sorted(points, key=lambda p: math.atan2(dot(minus(p, middle), along),
                                                            dot(minus(p, middle), across))))
    return kept


def common_volume(one, other):
    polygons = [[one[0][i] for i in polygon] for polygon in one[1]]
    for polygon in other[1]:
        a, b, c = (other[0][i] for i in polygon[:3])
        normal = unit(cross(minus(b, a), minus(c, a)))
        polygons = cut(polygons, normal, dot(normal, a))
        if not polygons:
            return 0
    origin = polygons[0][0]
    return abs(sum(dot(minus(p[0], origin), cross(minus(p[i], origin), minus(p[i + 1], origin)))
                   for p in polygons for i in range(1, len(p) - 1))) / 6


def triangles(polygons, base=0):
    return [(base + p[0], base + p[i], base + p[i + 1]) for p in polygons for i in range(1, len(p) - 1)]


def pair(rng):
    one = some_solid(rng)
    points, polygons = some_solid(rng) if rng.random() < 0.9 else one
    other = place(points, rng), polygons
    volume = (volume_of(one[0], triangles(one[1])) + volume_of(other[0], triangles(polygons))
              - common_volume(one, other))
    faces = triangles(one[1]) + triangles(polygons, len(one[0]))
    return Case(list(one[0]) + other[0], faces, volume, None, rng, rng.random() < 0.7)


# ---- table ----

def processor_time():
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime


def run(name, cases, options, folder):
    program = os.environ.get("STARGUARD", "build/starguard")
    count = right = grown = 0
    slowest = 0.0
    for case in cases:
        given, result = os.path.join(folder, "in.off"), os.path.join(folder, "out.off")
        write(given, case.vertices, case.faces)
        before = processor_time()
        done = subprocess.run([program, "repair", given, "-o", result, "--quiet", "--time-limit", str(MOST_SECONDS),
                               *options], capture_output=True, text=True, check=False)
        slowest = max(slowest, processor_time() - before)
        faults = [done.stderr.strip()]
        if done.returncode == 0:
            mesh = read(result)
            faults = case.faults(*mesh)
            grown += len(mesh[1]) / len(case.faces)
        if faults:
            print(f"{name} {count}: {'; '.join(faults)}", file=sys.stderr)
        count += 1
        right += not faults
    print(f"| {name} | {count} | {right} | {grown / count:.1f} | {slowest:.2f} s |")


def main():
    count = int(sys.argv[1]) if len(sys.argv) > 1 else 1000
    print("| family | meshes | right | faces, times as many | slowest |\n|---|--:|--:|--:|--:|")
    with tempfile.TemporaryDirectory() as folder:
        rngs = [random.Random(i) for i in range(count)]
        run("voxel bodies", (voxels(r, r.randint(8, 500), i % 2 == 1) for i, r in enumerate(rngs)), [], folder)
        run("unions of pairs", (pair(random.Random(i)) for i in range(count)), ["--union"], folder)


if __name__ == "__main__":
    main()
