# SPDX-License-Identifier: Apache-2.0
"""Plans of cameras in small random rooms against all choices of their candidates: visibility in whole numbers,
the fewest cameras, or the most area, by trying. Each mechanism alone, and each pair of them; verify passes all."""
import itertools
import json
import math
import os
import random
from concurrent.futures import ThreadPoolExecutor

from support import LONG, Case, main

UNIT = 64  # coordinates are whole multiples of 1 / UNIT
ROOMS = 50
NEAR_LIMIT = 1e-7  # no candidate is so near a limit that rounding could tell
MECHANISMS = ("keep", "within", "without", "tilt", "density", "require", "budget", "redundancy", "range", "cone")
PLANS = ([(0, 0), (8, 0), (8, 6), (0, 6)], [(0, 0), (9, 0), (9, 4), (4, 4), (4, 9), (0, 9)],
         [(0, 0), (9, 0), (9, 8), (6, 8), (6, 3), (3, 3), (3, 8), (0, 8)],
         [(3, 0), (6, 0), (6, 3), (9, 3), (9, 6), (6, 6), (6, 9), (3, 9), (3, 6), (0, 6), (0, 3), (3, 3)])
TRIANGLES = ([(0, 1, 2), (0, 2, 3)], [(0, 1, 2), (0, 2, 3), (0, 3, 4), (0, 4, 5)],
             [(0, 1, 4), (1, 2, 3), (1, 3, 4), (0, 4, 5), (0, 5, 7), (5, 6, 7)],
             [(0, 1, 2), (0, 2, 11), (11, 2, 5), (2, 3, 4), (2, 4, 5), (11, 5, 8), (5, 6, 7), (5, 7, 8), (11, 8, 10),
              (8, 9, 10)])


def cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def minus(a, b):
    return tuple(x - y for x, y in zip(a, b))


def volume(a, b, c, d):
    return dot(cross(minus(b, a), minus(c, a)), minus(d, a))


def sign(x):
    return (x > 0) - (x < 0)


def meets_flat(p, q, t):
    """Does the segment from p to before q, in the plane of t, meet it? Whole numbers: t in [0, 1) as fractions."""
    normal = cross(minus(t[1], t[0]), minus(t[2], t[0]))
    low, high = (0, 1), (1, 1)
    for i in range(3):
        side = cross(normal, minus(t[(i + 1) % 3], t[i]))  # inwards
        a, b = dot(side, minus(p, t[i])), dot(side, minus(q, t[i]))
        if a < 0 and b < 0:
            return False
        if a < 0 and (-a) * low[1] > low[0] * (b - a):
            low = (-a, b - a)
        if b < 0 and a * high[1] < high[0] * (a - b):
            high = (a, a - b)
    return low[0] * high[1] <= high[0] * low[1] and low[0] < low[1]


def blocks(p, q, t):
    """Does a triangle meet the segment from p to before q?"""
    a, b = sign(volume(*t, p)), sign(volume(*t, q))
    if a == 0 and b == 0:
        return meets_flat(p, q, t)
    if a == b or a == 0 or b == 0:  # p is on no face; what meets q alone does not block
        return False
    sides = {sign(volume(p, q, t[i], t[(i + 1) % 3])) for i in range(3)}
    return not {1, -1} <= sides


class Room:
    """A floor plan with walls, and perhaps a crate; candidates that look somewhere."""

    def __init__(self, seed):
        self.rng = random.Random(seed)
        kind = self.rng.randrange(len(PLANS))
        stretch = [self.rng.randrange(40, 90) for _ in range(2)]
        self.plan = [(x * stretch[0], y * stretch[1]) for x, y in PLANS[kind]]
        self.height, self.crate = self.rng.randrange(150, 250), None
        self.vertices, self.faces = [], []
        self.prism(self.plan, TRIANGLES[kind], 0, self.height, False)
        if seed % 3:
            x, y = (self.rng.randrange(20, 60) * 2 for _ in range(2))
            corners = [(x, y), (x + 41, y), (x + 41, y + 37), (x, y + 37)]
            if all(self.holds((a, 50, b)) for a, b in corners):
                self.prism(corners, TRIANGLES[0], 11, 97, True)
                self.crate = (x, 11, y, x + 41, 97, y + 37)
        self.candidates = []
        self.rows = {}

    def prism(self, plan, triangles, low, high, inward):
        n, base = len(plan), len(self.vertices)
        self.vertices += [(x, h, y) for h in (low, high) for x, y in plan]
        faces = [(a, b, c) for a, b, c in triangles] + [(c + n, b + n, a + n) for a, b, c in triangles]
        for i in range(n):
            j = (i + 1) % n
            faces += [(j, i, j + n), (i, i + n, j + n)]
        self.faces += [tuple(base + c for c in (f[::-1] if inward else f)) for f in faces]

    def corners(self, face):
        return [self.vertices[c] for c in self.faces[face]]

    def holds(self, p):
        inside = False
        for (a, b), (c, d) in zip(self.plan, self.plan[1:] + self.plan[:1]):
            if (b > p[2]) != (d > p[2]) and p[0] < a + (c - a) * (p[2] - b) / (d - b):
                inside = not inside
        if self.crate and all(self.crate[k] <= p[k] <= self.crate[k + 3] for k in range(3)):
            return False
        return inside and 0 < p[1] < self.height

    def draw(self, count):
        width, depth = max(x for x, _ in self.plan), max(y for _, y in self.plan)
        while len(self.candidates) < count:
            p = (self.rng.randrange(1, width), self.rng.randrange(1, self.height), self.rng.randrange(1, depth))
            on_wall = any(p[0] == x for x, _ in self.plan) or any(p[2] == y for _, y in self.plan)
            if self.holds(p) and not on_wall:
                self.candidates.append((p, tuple(self.rng.randrange(-9, 10) + 0.5 for _ in range(3))))

    def free(self, p):
        """The faces that p sees, whatever its sensor: corners in sight, and from the front."""
        if p not in self.rows:
            seen = [not any(blocks(p, v, self.corners(f)) for f in range(len(self.faces))) for v in self.vertices]
            self.rows[p] = [f for f, face in enumerate(self.faces)
                            if all(seen[c] for c in face) and volume(*self.corners(f), p) < 0]
        return self.rows[p]

    def obj(self):
        lines = ["v " + " ".join(repr(x / UNIT) for x in p) for p in self.vertices]
        return "\n".join(lines + ["f " + " ".join(str(c + 1) for c in f) for f in self.faces]) + "\n"

    def area(self, face):
        a, b, c = self.corners(face)
        n = cross(minus(b, a), minus(c, a))
        return math.sqrt(dot(n, n)) / 2 / UNIT ** 2


class TooNear(Exception):
    """A limit that rounding could tell either way."""


def within(value, limit):
    if abs(value - limit) < NEAR_LIMIT * (1 + abs(limit)):
        raise TooNear
    return value <= limit


class Task:
    """A room, and what is asked of it: options, and the same in numbers."""

    def __init__(self, room, mechanisms, rng):
        self.room, self.mechanisms, self.words = room, mechanisms, []
        self.numbers = {}
        for name in mechanisms:
            getattr(self, "ask_" + name)(rng)
        if ("tilt" in mechanisms or "density" in mechanisms) and "cone" not in mechanisms:
            self.numbers["fov"] = (150, 140)
            self.words += ["--fov", "150,140"]

    def ask_keep(self, rng):
        self.kept = rng.sample(range(len(self.room.candidates)), 2)
        self.words += ["--keep", "stay.txt"]

    def box(self, rng):
        p, _ = self.room.candidates[rng.randrange(len(self.room.candidates))]
        return [x - rng.randrange(60, 200) + 0.5 for x in p] + [x + rng.randrange(60, 200) + 0.5 for x in p]

    def ask_zones(self, rng, name, count):
        self.numbers[name] = [self.box(rng) for _ in range(count)]
        for box in self.numbers[name]:
            self.words += ["--" + name, ",".join(repr(x / UNIT) for x in box)]

    def ask_within(self, rng):
        self.ask_zones(rng, "within", 3)

    def ask_without(self, rng):
        self.ask_zones(rng, "without", 1)

    def ask_tilt(self, rng):
        low = rng.uniform(-60, -20)
        self.numbers["tilt"] = (low, low + 80)
        self.words += ["--tilt", f"{low!r},{low + 80!r}"]

    def ask_density(self, rng):
        self.numbers["density"] = rng.uniform(10, 35)
        self.words += ["--resolution", "1000,800", "--density", repr(self.numbers["density"])]

    def ask_require(self, rng):
        faces = sorted(rng.sample(range(len(self.room.faces)), 4))
        self.numbers["require"] = {f: 2 for f in faces}
        self.words += ["--require", ",".join(map(str, faces)) + "=2"]

    def ask_budget(self, rng):
        self.numbers["budget"] = rng.randrange(1, 4)
        self.words += ["--max-guards", str(self.numbers["budget"])]

    def ask_redundancy(self, rng):
        self.numbers["redundancy"] = rng.choice((2, 3))
        self.words += ["--redundancy", str(self.numbers["redundancy"])]

    def ask_range(self, rng):
        self.numbers["range"] = rng.uniform(5, 12)
        self.words += ["--range", repr(self.numbers["range"])]

    def ask_cone(self, rng):
        self.numbers["cone"] = rng.uniform(130, 175)
        self.words += ["--cone", repr(self.numbers["cone"])]

    def usable(self, place, ahead):
        """May a candidate stand there, and look that way?"""
        zones = [[all(b[k] <= place[k] <= b[k + 3] for k in range(3)) for b in self.numbers.get(name, [])]
                 for name in ("within", "without")]
        if "tilt" in self.numbers:
            angle = math.degrees(math.asin(ahead[1] / math.hypot(*ahead)))
            low, high = self.numbers["tilt"]
            if within(angle, low) or not within(angle, high):
                return False
        return (not zones[0] or any(zones[0])) and not any(zones[1])

    def senses(self, place, ahead, corner):
        line, numbers = [x / UNIT for x in minus(corner, place)], self.numbers
        length = math.hypot(*ahead)
        ahead = [x / length for x in ahead]
        depth = dot(line, ahead)
        good = True
        if "range" in numbers:
            good = within(math.hypot(*line), numbers["range"]) and good
        if "cone" in numbers:
            good = within(math.cos(math.radians(numbers["cone"] / 2)) * math.hypot(*line), depth) and good
        if "fov" in numbers:
            side = cross(ahead, (0, 1, 0))
            side = [x / math.hypot(*side) for x in side]
            above = cross(side, ahead)
            across, up = (math.tan(math.radians(a / 2)) for a in numbers["fov"])
            good = within(abs(dot(line, side)), depth * across) and good
            good = within(abs(dot(line, above)), depth * up) and good
        if "density" in numbers:
            good = within(depth, 1000 / (2 * math.tan(math.radians(numbers["fov"][0] / 2))) / numbers["density"]) and good
        return good

    def row(self, pose):
        place, ahead = pose
        return {f for f in self.room.free(place) if all(self.senses(place, ahead, c) for c in self.room.corners(f))}

    def solve(self):
        """Rows of candidates that may be chosen, what each face still needs of them, and its area."""
        kept = getattr(self, "kept", [])
        stay = [self.row(self.room.candidates[i]) for i in kept]
        self.given = [pose for i, pose in enumerate(self.room.candidates) if i not in kept]
        self.chosen = [pose for pose in self.given if self.usable(*pose)]
        rows = [self.row(pose) for pose in self.chosen]
        needs = []
        for f in range(len(self.room.faces)):
            wanted = self.numbers.get("require", {}).get(f, self.numbers.get("redundancy", 1))
            wanted = max(0, wanted - sum(f in row for row in stay))
            needs.append(min(wanted, sum(f in row for row in rows)))
        return rows, needs


def fewest(rows, needs, most):
    """The least number of rows that meet the needs: deeper and deeper; each face by all that see it."""
    def search(left, budget, allowed):
        open_faces = [f for f, n in enumerate(left) if n > 0]
        if not open_faces:
            return True
        if budget == 0 or max(left) > budget:
            return False
        face = min(open_faces, key=lambda f: sum(f in rows[i] for i in allowed))
        others = list(allowed)
        for i in [i for i in allowed if face in rows[i]]:
            others.remove(i)
            if search([n - (f in rows[i]) for f, n in enumerate(left)], budget - 1, others):
                return True
        return False
    return next((k for k in range(most + 1) if search(list(needs), k, list(range(len(rows))))), None)


def weight(chosen, needs, areas):
    return sum(area for f, (n, area) in enumerate(zip(needs, areas)) if n > 0 and sum(f in row for row in chosen) >= n)


class Exhaustive(Case):
    def check(self, number, mechanisms):
        name = f"{number}-{'-'.join(mechanisms)}"
        rng = random.Random(name)
        room = self.rooms[number]
        for _ in range(300):
            task = Task(room, mechanisms, rng)
            try:
                rows, needs = task.solve()
            except TooNear:
                continue
            if task.chosen and (any(needs) or "keep" in mechanisms):
                break
        else:
            self.fail(f"{name}: nothing is seen")
        os.mkdir(self.path(name))
        for file, poses in ("places.txt", task.given), ("stay.txt", [room.candidates[i] for i in getattr(task, "kept", [])]):
            self.write(f"{name}/{file}", "".join(" ".join(repr(x / UNIT) for x in p) + " " + " ".join(map(repr, d)) + "\n"
                                                 for p, d in poses))
        words = [f"{name}/stay.txt" if word == "stay.txt" else word for word in task.words]
        self.run_text("guard", f"room{number}.obj", "--candidates", f"{name}/places.txt", "--method", "ilp", "--patch", "off",
                      *words, "-o", f"{name}/g.json", "--quiet", "--threads", "1")
        keep = ["--keep", f"{name}/stay.txt"] if "keep" in mechanisms else []
        self.run_text("verify", f"room{number}.obj", f"{name}/g.json", *keep, "--threads", "1")
        result = json.loads(self.read(f"{name}/g.json"))
        added = [guard for guard in result["guards"] if not guard.get("kept")]
        self.assertEqual(len(result["guards"]) - len(added), len(getattr(task, "kept", [])), name)
        places = [tuple(x / UNIT for x in p) for p, _ in task.chosen]
        chosen = [rows[places.index(tuple(guard["position"]))] for guard in added]
        for guard in added:
            if "direction" in guard:
                self.assertEqual(tuple(guard["direction"]), task.chosen[places.index(tuple(guard["position"]))][1], name)
        areas = [room.area(f) for f in range(len(room.faces))]
        if "budget" in mechanisms:
            most = max(weight(some, needs, areas) for some in
                       itertools.combinations(rows, min(task.numbers["budget"], len(rows))))
            self.assertAlmostEqual(weight(chosen, needs, areas) / sum(areas), most / sum(areas), places=6, msg=name)
            self.assertLessEqual(len(added), task.numbers["budget"], name)
        else:
            self.assertEqual(weight(chosen, needs, areas), weight(rows, needs, areas), name)
            self.assertEqual(len(added), fewest(rows, needs, len(added)), name)
            self.assertTrue(result["optimal"], name)

    def test_all_pairs(self):
        self.rooms = []
        for number in range(ROOMS):
            self.rooms.append(Room(number))
            self.rooms[-1].draw(10 + number * 2 % 21)
            self.write(f"room{number}.obj", self.rooms[-1].obj())
        asked = [(name,) for name in MECHANISMS] + [pair for pair in itertools.combinations(MECHANISMS, 2)
                                                    if pair != ("density", "cone")]  # which needs a field of view
        asked += [("keep", "within", "tilt", "density", "require"), ("keep", "without", "redundancy", "range", "cone")]
        each = ROOMS if LONG else 2
        jobs = [((7 * k + ROOMS * i // each) % ROOMS, mechanisms) for k, mechanisms in enumerate(asked) for i in range(each)]
        with ThreadPoolExecutor(2) as pool:
            list(pool.map(lambda job: self.check(*job), jobs))
        self.assertEqual({number for number, _ in jobs}, set(range(ROOMS)))
        self.assertTrue(any(room.crate for room in self.rooms))


if __name__ == "__main__":
    main()
