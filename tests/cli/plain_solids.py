# SPDX-License-Identifier: Apache-2.0
"""Plain solids whose curve skeletons are known, as a newcomer draws them: of revolution, bent tubes, voxels.

A `Solid` says what is known of its skeleton: the loops, the tips (where its ends belong), and for straight
round ones the axis. Nothing here comes from the program that is tested.
"""
import math
import random


class Tip:
    """Where an end belongs: on the segment from the centre of the last ball to the cap."""

    def __init__(self, ball, cap, radius):
        self.ball, self.cap, self.radius = ball, cap, radius


class Solid:
    """A closed mesh. `radius` is that of its largest ball, up to the polygon's corners."""

    def __init__(self, kind, name, vertices, faces, loops, tips, radius, axis=None, alike=False):
        self.kind, self.name, self.vertices, self.faces = kind, name, vertices, faces
        self.loops, self.tips, self.radius = loops, tips, radius
        self.axis = axis    # two points of the straight axis of a round one
        self.alike = alike  # are both tips of one shape?

    def ends(self):
        return len(self.tips)

    def write(self, path, vertices=None):
        with open(path, "w", encoding="utf-8") as file:
            file.write(f"OFF\n{len(self.vertices)} {len(self.faces)} 0\n")
            file.writelines("%r %r %r\n" % tuple(v) for v in vertices or self.vertices)
            file.writelines("3 %d %d %d\n" % tuple(f) for f in self.faces)


# ---- vectors ----

def add(a, b, scale=1.0):
    return [x + scale * y for x, y in zip(a, b)]


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def unit(a):
    return [x / math.sqrt(dot(a, a)) for x in a]


def random_turn(rng):
    """A rotation matrix."""
    u = unit([rng.gauss(0, 1) for _ in range(3)])
    w = unit(cross(u, [rng.gauss(0, 1) for _ in range(3)]))
    return [u, w, cross(u, w)]


def turn(matrix, v):
    return [dot(row, v) for row in matrix]


# ---- tubes ----

def tube(path, radii, sides, closed=False):
    """Rings of `sides` corners about the points of a path, carried along without twist; caps are fans about
    the first and the last point. A radius of 0 at an end makes a tip."""
    count = len(path)
    vertices, rings, normal = [], [], None
    for i, p in enumerate(path):
        before = path[(i - 1) % count] if closed or i > 0 else path[i]
        after = path[(i + 1) % count] if closed or i < count - 1 else path[i]
        along = unit(add(after, before, -1))
        if normal is None:
            normal = cross(along, [1.0, 0.0, 0.0] if abs(along[0]) < 0.9 else [0.0, 1.0, 0.0])
        normal = unit(add(normal, along, -dot(normal, along)))
        other = cross(along, normal)
        if radii[i] == 0:
            rings.append([len(vertices)])
            vertices.append(list(p))
            continue
        rings.append(range(len(vertices), len(vertices) + sides))
        for k in range(sides):
            angle = 2 * math.pi * k / sides
            vertices.append(add(add(p, normal, radii[i] * math.cos(angle)), other,
                                radii[i] * math.sin(angle)))
    faces = []
    for i in range(count if closed else count - 1):
        a, b = rings[i], rings[(i + 1) % count]
        for k in range(sides):
            j = (k + 1) % sides
            if len(a) > 1:
                faces.append((a[k], a[j], b[j] if len(b) > 1 else b[0]))
            if len(b) > 1:
                faces.append((a[k] if len(a) > 1 else a[0], b[j], b[k]))
    for ring, centre, flip in (() if closed else ((rings[0], path[0], True), (rings[-1], path[-1], False))):
        if len(ring) == 1:
            continue
        for k in range(sides):
            pair = (ring[k], ring[(k + 1) % sides])
            faces.append((len(vertices), *(reversed(pair) if flip else pair)))
        vertices.append(list(centre))
    return vertices, faces


def circle_radius(sides, radius):
    """Of the circle inside a regular polygon with corners at `radius`."""
    return radius * math.cos(math.pi / sides)


def last_ball(profile):
    """(z, radius) of the last ball on the axis of a solid of revolution before the end of its profile, a list
    of (z, r): the last that touches the sides no later than the end."""
    low, cap = profile[0][0], profile[-1][0]

    def sides(z):
        return min(distance_to_segment((z, 0.0), a, b) for a, b in zip(profile, profile[1:]))

    outer = cap
    for i in range(199, 0, -1):
        inner = low + (cap - low) * i / 200
        if sides(inner) <= cap - inner:
            for _ in range(20):
                middle = 0.5 * (inner + outer)
                inner, outer = (middle, outer) if sides(middle) <= cap - middle else (inner, middle)
            return inner, sides(inner)
        outer = inner
    return cap, 0.0


def distance_to_segment(p, a, b):
    ab = [y - x for x, y in zip(a, b)]
    ap = [y - x for x, y in zip(a, p)]
    length = dot(ab, ab)
    t = min(max(dot(ap, ab) / length, 0.0), 1.0) if length > 0 else 0.0
    d = [x - t * y for x, y in zip(ap, ab)]
    return math.sqrt(dot(d, d))


def revolved(kind, name, profile, sides, alike, balls=None):
    """A solid of revolution about z; `balls` are the last balls if its profile does not give them."""
    share = math.cos(math.pi / sides)
    inner = [(z, share * r) for z, r in profile]
    if balls is None:
        top = last_ball(inner)
        mirrored = [(-z, r) for z, r in reversed(inner)]
        bottom = last_ball(mirrored)
        balls = ((-bottom[0], bottom[1]), top)
    tips = [Tip([0, 0, ball[0]], [0, 0, end[0]], max(ball[1], 0.0))
            for ball, end in zip(balls, (profile[0], profile[-1]))]
    vertices, faces = tube([[0.0, 0.0, z] for z, _ in profile], [r for _, r in profile], sides)
    radius = max(r for _, r in inner)
    return Solid(kind, name, vertices, faces, 0, tips, radius,
                 axis=([0, 0, profile[0][0]], [0, 0, profile[-1][0]]), alike=alike)


def cylinder(sides, rings, length):
    profile = [(length * i / (rings - 1), 1.0) for i in range(rings)]
    return revolved("cylinder", f"cylinder_{sides}_{rings}_{length:g}", profile, sides, True)


def cone(sides, rings, height, base=1.0, top=0.0):
    profile = [(height * i / (rings - 1), base + (top - base) * i / (rings - 1)) for i in range(rings)]
    return revolved("cone", f"cone_{sides}_{rings}_{height:g}_{top:g}", profile, sides, False)


def capsule(sides, rings, length):
    """Half balls of `rings` rings at both ends of a cylinder."""
    arc = [(-math.cos(math.pi / 2 * i / rings), math.sin(math.pi / 2 * i / rings)) for i in range(rings + 1)]
    middle = max(int(length), 1)
    profile = ([(z, r if i else 0.0) for i, (z, r) in enumerate(arc)] +
               [(length * i / middle, 1.0) for i in range(1, middle)] +
               [(length - z, r if i else 0.0) for i, (z, r) in reversed(list(enumerate(arc)))])
    share = math.cos(math.pi / sides)
    return revolved("capsule", f"capsule_{sides}_{rings}_{length:g}", profile, sides, True,
                    balls=((0.0, share), (length, share)))


def ellipsoid(sides, rings, ratio):
    """Longer by `ratio`; the balls at its ends have the radius of curvature there."""
    profile = [(-ratio * math.cos(math.pi * i / rings), math.sin(math.pi * i / rings)) for i in range(rings + 1)]
    profile[0], profile[-1] = (-ratio, 0.0), (ratio, 0.0)
    ball = ratio - 1 / ratio
    return revolved("ellipsoid", f"ellipsoid_{sides}_{rings}_{ratio:g}", profile, sides, True,
                    balls=((-ball, 1 / ratio), (ball, 1 / ratio)))


def vase(sides, rings, height, waves, depth):
    """Its radius waves between 1 - depth and 1 + depth."""
    profile = [(height * i / (rings - 1), 1 + depth * math.sin(2 * math.pi * waves * i / (rings - 1)))
               for i in range(rings)]
    return revolved("vase", f"vase_{sides}_{rings}_{height:g}_{waves:g}_{depth:g}", profile, sides,
                    False)


def bulge(sides, rings, length, size):
    """A cylinder with one thick place in its middle."""
    profile = [(length * i / (rings - 1),
                1 + (size - 1) * math.exp(-((i / (rings - 1) - 0.5) * length / 1.5) ** 2))
               for i in range(rings)]
    return revolved("bulge", f"bulge_{sides}_{rings}_{length:g}_{size:g}", profile, sides, True)


def torus(sides, around, radius):
    path = [[radius * math.cos(2 * math.pi * i / around), radius * math.sin(2 * math.pi * i / around), 0.0]
            for i in range(around)]
    vertices, faces = tube(path, [1.0] * around, sides, closed=True)
    return Solid("torus", f"torus_{sides}_{around}_{radius:g}", vertices, faces, 1, [],
                 circle_radius(sides, 1.0))


def bent(kind, name, path, radius, sides):
    """A tube of one radius along a path; its caps are flat."""
    vertices, faces = tube(path, [radius] * len(path), sides)
    inner = circle_radius(sides, radius)
    tips = [Tip(add(a, unit(add(b, a, -1)), inner), a, inner)
            for a, b in ((path[0], path[1]), (path[-1], path[-2]))]
    return Solid(kind, name, vertices, faces, 0, tips, inner, alike=True)


def arc(angle):
    """A small tube along an arc; those of two angles have the same faces."""
    return bent("bend", f"arc_{angle:g}", [(4 * math.sin(angle * i / 9) / angle, 4 * math.cos(angle * i / 9) / angle, 0)
                                           for i in range(10)], 0.5, 6)


def bend(sides, rings, radius, angle):
    """A tube along an arc between straight pieces."""
    straight = 4.0
    path = [[-straight + straight * i / 4, 0.0, 0.0] for i in range(4)]
    path += [[radius * math.sin(angle * i / rings), radius * (1 - math.cos(angle * i / rings)), 0.0]
             for i in range(rings + 1)]
    along = [math.cos(angle), math.sin(angle), 0.0]
    path += [add(path[3 + rings + 1], along, straight * i / 4) for i in range(1, 5)]
    return bent("bend", f"bend_{sides}_{rings}_{radius:g}_{angle:g}", path, 1.0, sides)


def helix(sides, rings, turns, radius, pitch):
    path = [[radius * math.cos(2 * math.pi * turns * i / rings), radius * math.sin(2 * math.pi * turns * i / rings),
             pitch * turns * i / rings] for i in range(rings + 1)]
    return bent("helix", f"helix_{sides}_{rings}_{turns:g}_{radius:g}_{pitch:g}", path, 0.4, sides)


# ---- voxels ----

# The corners of each face of a cube, counter-clockwise seen from outside, by its direction.
SIDES = {(1, 0, 0): ((1, 0, 0), (1, 1, 0), (1, 1, 1), (1, 0, 1)), (-1, 0, 0): ((0, 0, 0), (0, 0, 1), (0, 1, 1), (0, 1, 0)),
         (0, 1, 0): ((0, 1, 0), (0, 1, 1), (1, 1, 1), (1, 1, 0)), (0, -1, 0): ((0, 0, 0), (1, 0, 0), (1, 0, 1), (0, 0, 1)),
         (0, 0, 1): ((0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)), (0, 0, -1): ((0, 0, 0), (0, 1, 0), (1, 1, 0), (1, 0, 0))}


def voxels(kind, name, cells, loops, tips, radius, alike=False):
    cells = set(cells)
    numbers, faces = {}, []
    for cell in sorted(cells):
        for side, corners in SIDES.items():
            if tuple(add(cell, side)) in cells:
                continue
            ring = [numbers.setdefault(tuple(a + b for a, b in zip(cell, c)), len(numbers)) for c in corners]
            faces += [(ring[0], ring[1], ring[2]), (ring[0], ring[2], ring[3])]
    vertices = [[float(x) for x in v] for v in numbers]
    return Solid(kind, name, vertices, faces, loops, tips, radius, alike=alike)


def thick(path, thickness):
    """The cells of bars along axis-parallel segments between nodes of a lattice."""
    cells = set()
    for a, b in path:
        low = [min(x, y) for x, y in zip(a, b)]
        high = [max(x, y) + thickness for x, y in zip(a, b)]
        cells |= {(x, y, z) for x in range(low[0], high[0]) for y in range(low[1], high[1])
                  for z in range(low[2], high[2])}
    return cells


def lattice_tubes(kind, name, segments, thickness):
    """Bars along the edges of a graph on a lattice. Nodes are corners of cubes of `thickness`, so far apart
    that its topology is the graph's; tips are nodes of one edge."""
    nodes = {}
    for a, b in segments:
        nodes.setdefault(a, []).append(b)
        nodes.setdefault(b, []).append(a)
    tips = []
    half = thickness / 2
    for a, others in nodes.items():
        if len(others) == 1:
            centre = [x + half for x in a]
            along = unit([float(x - y) for x, y in zip(a, others[0])])
            tips.append(Tip(centre, add(centre, along, half), half))
    return voxels(kind, name, thick(segments, thickness), len(segments) - len(nodes) + 1, tips, half,
                  alike=len(tips) == 2)


ORIGIN = (0, 0, 0)


def bar(length, thickness):
    return lattice_tubes("bar", f"bar_{length}_{thickness}", [(ORIGIN, (length - thickness, 0, 0))], thickness)


def arms(kind, lengths, thickness):
    """Bars from one point; `lengths` are the tips."""
    return lattice_tubes(kind, f"{kind}_{'_'.join(str(max(map(abs, v))) for v in lengths)}_{thickness}",
                         [(ORIGIN, v) for v in lengths], thickness)


def frame(width, height, thickness):
    a, b = width - thickness, height - thickness
    ring = [(0, 0, 0), (a, 0, 0), (a, b, 0), (0, b, 0)]
    return lattice_tubes("frame", f"frame_{width}_{height}_{thickness}",
                         [(ring[i], ring[(i + 1) % 4]) for i in range(4)], thickness)


def branching(seed, nodes, extra, thickness, gap):
    """A random tree on a lattice with `extra` edges that close loops; no two nodes in line are joined twice."""
    rng = random.Random(seed)
    step = gap + thickness
    places, segments = [ORIGIN], set()
    steps = [(1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1)]
    while len(places) < nodes:
        a = rng.choice(places)
        b = tuple(x + y for x, y in zip(a, rng.choice(steps)))
        if b not in places:
            places.append(b)
            segments.add((a, b))
    closing = [(a, tuple(x + y for x, y in zip(a, s))) for a in places for s in steps[::2]]
    closing = [(a, b) for a, b in closing if b in places and (a, b) not in segments and (b, a) not in segments]
    segments |= set(rng.sample(closing, min(extra, len(closing))))
    scaled = sorted((tuple(step * x for x in a), tuple(step * x for x in b)) for a, b in segments)
    return lattice_tubes("branching", f"branching_{seed}_{nodes}_{extra}_{thickness}", scaled, thickness)


# ---- families ----

def bases():
    """The solids that make up the family of `make check`, each for its three copies."""
    solids = [cylinder(s, r, l) for s, r, l in
              ((6, 2, 8), (6, 11, 10), (8, 3, 8), (8, 21, 10), (10, 5, 9), (12, 2, 10), (12, 3, 8), (12, 11, 6),
               (16, 2, 8), (16, 5, 10), (16, 21, 10), (20, 7, 12), (24, 3, 9), (24, 11, 8), (32, 2, 8),
               (32, 11, 10), (32, 21, 20), (48, 5, 8), (64, 2, 10), (64, 11, 10))]
    solids += [cone(s, r, h, 1.0, t) for s, r, h, t in
               ((6, 3, 6, 0), (8, 6, 6, 0), (12, 2, 5, 0), (16, 11, 8, 0), (32, 6, 6, 0), (64, 4, 5, 0),
                (12, 5, 8, 0.5), (32, 8, 10, 0.4))]
    solids += [capsule(s, r, l) for s, r, l in ((6, 3, 8), (8, 4, 8), (12, 4, 6), (16, 6, 8), (32, 8, 8), (64, 8, 10))]
    solids += [ellipsoid(s, r, a) for s, r, a in ((8, 8, 4), (12, 10, 3), (16, 12, 5), (24, 16, 3), (32, 20, 4))]
    solids += [vase(s, r, h, w, d) for s, r, h, w, d in
               ((8, 11, 10, 1, 0.3), (12, 15, 10, 1.5, 0.3), (16, 21, 12, 1, 0.4), (32, 21, 10, 1, 0.3), (24, 13, 8, 0.75, 0.2))]
    solids += [torus(s, a, r) for s, a, r in ((6, 12, 3), (8, 16, 3), (12, 24, 4), (16, 32, 3), (32, 64, 4))]
    solids += [bar(l, t) for l, t in ((12, 1), (5, 1), (10, 2), (12, 2), (15, 3))]
    solids += [arms("L", [(7, 0, 0), (0, 5, 0)], 1), arms("L", [(12, 0, 0), (0, 10, 0)], 2),
               arms("L", [(18, 0, 0), (0, 15, 0)], 3)]
    solids += [arms("T", [(6, 0, 0), (-6, 0, 0), (0, 5, 0)], 1), arms("T", [(10, 0, 0), (-12, 0, 0), (0, 12, 0)], 2),
               arms("T", [(15, 0, 0), (-15, 0, 0), (0, 15, 0)], 3)]
    solids += [arms("plus", [(8, 0, 0), (-8, 0, 0), (0, 8, 0), (0, -8, 0)], 1),
               arms("plus", [(10, 0, 0), (-12, 0, 0), (0, 8, 0), (0, -14, 0)], 2)]
    six = [(1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1)]
    solids += [arms("six", [tuple(n * x for x in v) for v in six], t) for n, t in ((7, 1), (12, 2))]
    solids += [frame(w, h, t) for w, h, t in ((4, 4, 1), (8, 6, 1), (9, 9, 2), (12, 15, 3))]
    solids += [helix(12, 80, 2, 2, 2.5), helix(16, 120, 3, 2, 2), helix(8, 60, 1.5, 3, 3)]
    solids += [bend(12, 8, 3.0, math.pi / 2), bend(16, 16, 2.5, math.pi)]
    solids += [bulge(16, 21, 12, 1.6), bulge(24, 15, 10, 2.0)]
    solids += [branching(1, 6, 0, 1, 4), branching(2, 8, 2, 1, 5)]
    return solids


def random_base(rng):
    """One of other proportions."""
    sides, rings = rng.choice((5, 6, 7, 8, 9, 10, 12, 16, 20, 24, 30, 32, 40, 48, 64)), rng.randint(2, 21)
    kind = rng.randrange(14)
    if kind == 0:
        return cylinder(sides, rings, round(rng.uniform(4, 25), 2))
    if kind == 1:
        return cone(sides, rings, round(rng.uniform(3, 12), 2), 1.0, rng.choice((0, 0, 0.2, 0.5, 0.7)))
    if kind == 2:
        return capsule(sides, rng.randint(3, 9), round(rng.uniform(4, 15), 2))
    if kind == 3:
        return ellipsoid(sides, rng.randint(6, 24), round(rng.uniform(2.5, 6), 2))
    if kind == 4:
        return vase(sides, rng.randint(9, 30), round(rng.uniform(7, 14), 2), rng.choice((0.5, 0.75, 1, 1.5)),
                    round(rng.uniform(0.1, 0.4), 2))
    if kind == 5:
        return torus(sides, rng.randint(10, 60), round(rng.uniform(2.5, 6), 2))
    if kind == 6:
        thickness = rng.randint(1, 3)
        return bar(thickness * rng.randint(4, 15), thickness)
    if kind == 7:
        thickness, count = rng.randint(1, 3), rng.randint(2, 6)
        directions = rng.sample([(1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1)], count)
        if count == 2 and dot(directions[0], directions[1]) != 0:
            directions[1] = tuple(cross(directions[0], (1, 1, 1)))
            directions[1] = (0, 0, 1) if directions[0][2] == 0 else (1, 0, 0)
        return arms(("L", "T", "plus", "five", "six")[count - 2],
                    [tuple(thickness * rng.randint(4, 8) * x for x in v) for v in directions], thickness)
    if kind == 8:
        thickness = rng.randint(1, 3)
        return frame(thickness * rng.randint(4, 8), thickness * rng.randint(4, 8), thickness)
    if kind == 9:
        return helix(rng.choice((6, 8, 12, 16)), rng.randint(60, 160), rng.choice((1, 1.5, 2, 3)),
                     round(rng.uniform(1.5, 3), 2), round(rng.uniform(1.5, 3), 2))
    if kind == 10:
        return bend(sides, rng.randint(6, 20), round(rng.uniform(2, 5), 2), round(rng.uniform(0.5, 3), 2))
    if kind == 11:
        return bulge(sides, rng.randint(11, 25), round(rng.uniform(8, 14), 2), round(rng.uniform(1.2, 2.5), 2))
    return branching(rng.randrange(1 << 30), rng.randint(3, 10), rng.randint(0, 3), rng.randint(1, 2), rng.randint(4, 6))
