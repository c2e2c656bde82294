# SPDX-License-Identifier: Apache-2.0
"""Every point of the boundary: what `guard --target points` proves is held against rays to random points,
by floating point and all faces, without the library."""
import json
import os
import pathlib
import random
import sys
from fractions import Fraction

from support import LONG, Case, main

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "bench"))
import rooms  # noqa: E402

MARGIN = 1e-9  # rays that pass an edge so closely, relative to the model, are left out


def subtract(a, b):
    return tuple(x - y for x, y in zip(a, b))


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def read_off(text):
    words = text.split()[1:]
    count, faces = int(words[0]), int(words[1])
    numbers = words[3:]
    vertices = [tuple(map(float, numbers[3 * i:3 * i + 3])) for i in range(count)]
    rest = numbers[3 * count:]
    return vertices, [tuple(map(int, rest[4 * f + 1:4 * f + 4])) for f in range(faces)]


def blocked(p, q, triangle):
    """True, False, or None if it is a close call."""
    a, b, c = triangle
    way, u, v, start = subtract(q, p), subtract(b, a), subtract(c, a), subtract(p, a)
    across, along = cross(way, v), cross(start, u)
    volume = dot(u, across)
    if abs(volume) < 1e-14:
        return False
    x, y, at = dot(start, across) / volume, dot(way, along) / volume, dot(v, along) / volume
    if at < -MARGIN or at > 1 - 1e-7 or x < -1e-7 or y < -1e-7 or x + y > 1 + 1e-7:
        return False
    inside = x > 1e-7 and y > 1e-7 and x + y < 1 - 1e-7 and at > MARGIN
    return True if inside else None


def half_plane(p, a, b, face):
    """The side of the plane through p, a and b as c + d u + e v for the point (u, v) of a face."""
    normal = cross(subtract(a, p), subtract(b, p))
    origin, second, third = face
    return (dot(normal, subtract(origin, p)), dot(normal, subtract(second, origin)),
            dot(normal, subtract(third, origin)))


def divide(polygon, line):
    """The parts of a convex polygon on the positive and on the negative side."""
    parts = [], []
    values = [line[0] + line[1] * u + line[2] * v for u, v in polygon]
    for (x, f), (y, g) in zip(zip(polygon, values), zip(polygon[1:] + polygon[:1], values[1:] + values[:1])):
        if f >= 0:
            parts[0].append(x)
        if f <= 0:
            parts[1].append(x)
        if f * g < 0:
            at = f / (f - g)
            cut = tuple(c + at * (d - c) for c, d in zip(x, y))
            parts[0].append(cut)
            parts[1].append(cut)
    return parts


def doubled_area(polygon):
    return sum(a[0] * b[1] - a[1] * b[0] for a, b in zip(polygon, polygon[1:] + polygon[:1]))


def seen_share(p, face, others):
    """Exactly: the share of a face that p sees past other triangles. What a triangle hides of the face is
    cut by four planes, three through p and an edge of it, and its own; all cuts together are the
    arrangement of the shadows."""
    normal = cross(subtract(face[1], face[0]), subtract(face[2], face[0]))
    if dot(normal, subtract(p, face[0])) == 0:
        return 0
    left = [[(Fraction(0), Fraction(0)), (Fraction(1), Fraction(0)), (Fraction(0), Fraction(1))]]
    for a, b, c in others:
        side = dot(cross(subtract(b, a), subtract(c, a)), subtract(p, a))
        if side == 0:
            continue  # seen edge-on
        sign = -1 if side > 0 else 1
        lines = [half_plane(p, *edge, face) for edge in ((a, b), (b, c), (c, a))] + [half_plane(a, b, c, face)]
        lines = [tuple(sign * x for x in line) for line in lines]
        kept = []
        for piece in left:
            for line in lines:
                piece, outside = divide(piece, line)
                if len(outside) > 2:
                    kept.append(outside)
                if len(piece) < 3:
                    break
        left = kept
    return sum(map(doubled_area, left))


def starts_on(p, face):
    a, b, c = face
    if dot(cross(subtract(b, a), subtract(c, a)), subtract(p, a)) != 0:
        return False
    turns = [cross(subtract(y, x), subtract(p, x)) for x, y in ((a, b), (b, c), (c, a))]
    return all(dot(x, y) >= 0 for x in turns for y in turns)


class Points(Case):
    def unseen_share(self, model, guards, count, weights=None):
        """Of random points of faces, how many no guard sees, close calls left out."""
        vertices, faces = read_off(self.read(model).decode())
        triangles = [tuple(vertices[i] for i in face) for face in faces]
        dice, unseen = random.Random(5), 0
        for _ in range(count):
            own = dice.choices(range(len(faces)), weights)[0]
            a, b, c = triangles[own]
            x, y = sorted((dice.random(), dice.random()))
            q = tuple(x * i + (y - x) * j + (1 - y) * k for i, j, k in zip(a, b, c))
            normal = cross(subtract(b, a), subtract(c, a))
            verdicts = []
            for p in guards:
                if dot(normal, subtract(p, a)) >= 0:
                    continue
                met = [blocked(p, q, t) for i, t in enumerate(triangles) if i != own]
                verdicts.append("blocked" if True in met else "close" if None in met else "seen")
            unseen += not any(word in ("seen", "close") for word in verdicts)
        return unseen / count

    def check(self, model, fewest=None):
        self.run_text("guard", model, "-o", "points.json", "--target", "points", "--effort", "quick")
        result = json.loads(self.read("points.json"))
        points = result["coverage"]["points"]
        self.assertEqual((points["seen"], points["open"], points["complete"]), (1, 0, True))
        guards = [guard["position"] for guard in result["guards"]]
        self.assertEqual(self.unseen_share(model, guards, 150), 0)
        self.assertGreater(self.unseen_share(model, guards[1:], 150), 0)  # the check can fail
        self.run_text("verify", model, "points.json")
        if fewest is not None:
            self.assertEqual(len(guards), fewest)

    def test_sample(self):
        self.check(self.sample("star", 500))

    def test_pillar(self):
        """A pillar throws its shadow into the middle of walls whose corners are seen."""
        vertices, faces = [], []
        for low, high in (((0, 0, 0), (9, 7, 3)), ((4, 3, 1), (5, 4, 2))):
            first = len(vertices)
            vertices += [tuple((high if i >> k & 1 else low)[k] for k in range(3)) for i in range(8)]
            for a, b, c, d in ((0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)):
                corner = [first + i for i in ((a, b, c, d) if first == 0 else (d, c, b, a))]
                faces += [(corner[0], corner[1], corner[2]), (corner[0], corner[2], corner[3])]
        self.write("pillar.off", f"OFF\n{len(vertices)} {len(faces)} 0\n"
                   + "".join("%d %d %d\n" % v for v in vertices) + "".join("3 %d %d %d\n" % f for f in faces))
        self.write("given.txt", "2 3.4 1.6\n")
        self.run_text("guard", "pillar.off", "-o", "given.json", "--candidates", "given.txt", "--target", "points")
        points = json.loads(self.read("given.json"))["coverage"]["points"]
        self.assertFalse(points["complete"])
        area = [self.area([vertices[i] for i in face]) for face in faces]
        unseen = self.unseen_share("pillar.off", [(2, 3.4, 1.6)], 6000, area)
        self.assertAlmostEqual(points["seen"], 1 - unseen, delta=0.02)
        self.assertLess(points["seen"] + points["open"], 1 + 1e-9)
        self.run_text("verify", "pillar.off", "given.json")
        self.check("pillar.off", fewest=2)  # at opposite corners

    @staticmethod
    def area(corner):
        normal = cross(subtract(corner[1], corner[0]), subtract(corner[2], corner[0]))
        return dot(normal, normal) ** 0.5

    def test_shadows(self):
        """A hall with columns, and guards of faces by their corners as the candidates."""
        self.run_text("sample", "gallery", "--vertices", "500", "-o", "hall.off")
        self.run_text("guard", "hall.off", "-o", "faces.json", "--effort", "quick")
        found = json.loads(self.read("faces.json"))
        self.assertEqual(found["coverage"]["faces"], 1)
        guards = [guard["position"] for guard in found["guards"]]
        self.write("given.txt", "".join("%.17g %.17g %.17g\n" % tuple(p) for p in guards))
        self.run_text("guard", "hall.off", "-o", "given.json", "--candidates", "given.txt", "--target", "points",
                      "--method", "ilp")
        result = json.loads(self.read("given.json"))
        points = result["coverage"]["points"]
        guards = [guard["position"] for guard in result["guards"]]
        unseen = self.unseen_share("hall.off", guards, 80)
        self.assertEqual(points["complete"], points["seen"] == 1)
        if unseen > 0:
            self.assertFalse(points["complete"])
        self.run_text("verify", "hall.off", "given.json")

    def write_l_room(self):
        """Twelve walls, floor and ceiling; faces look out."""
        plan = [(0, 0), (9, 0), (9, 4), (4, 4), (4, 9), (0, 9)]
        vertices = [(x, y, z) for z in (0, 3) for x, y in plan]
        flat = [(0, 1, 2), (0, 2, 3), (0, 3, 4), (0, 4, 5)]
        faces = [(c, b, a) for a, b, c in flat] + [tuple(i + 6 for i in face) for face in flat]
        for i in range(6):
            j = (i + 1) % 6
            faces += [(i, j, j + 6), (i, j + 6, i + 6)]
        self.write("l.off", f"OFF\n12 {len(faces)} 0\n" + "".join("%d %d %d\n" % v for v in vertices)
                   + "".join("3 %d %d %d\n" % f for f in faces))

    def points_of(self, *words):
        self.run_text("guard", "l.off", "-o", "l.json", "--target", "points", *words)
        self.run_text("verify", "l.off", "l.json")
        found = json.loads(self.read("l.json"))
        return len(found["guards"]), found["coverage"]

    def test_soups(self):
        """Faces count from either side where that is asked for; else there is nothing to be seen inside."""
        self.write_l_room()
        soup = ("--soup", "--from", "1,1,1", "--cell", "0.4")
        guards, coverage = self.points_of(*soup, "--two-sided")
        self.assertEqual((guards, coverage["points"]["complete"]), (1, True))
        self.assertEqual(self.points_of()[0], 1)
        _, errors = self.run_text("guard", "l.off", "-o", "no.json", "--target", "points", *soup, status=2)
        self.assertIn("two-sided", errors)

    def test_some_faces(self):
        self.write_l_room()
        self.write("some.txt", "4\n5\n6\n7\n")
        guards, coverage = self.points_of("--see", "some.txt")
        self.assertEqual((guards, coverage["coverable_faces"], coverage["points"]["seen"]), (1, 4, 1))

    def test_visible(self):
        """Of what one point sees, corners of faces tell less than parts, and parts less than points."""
        self.write_l_room()
        seen = {}
        for name, words in {"faces": (), "parts": ("--patch", "0.3"), "points": ("--target", "points")}.items():
            report = self.run_json("visible", "l.off", "--from", "8,1,1.5", *words)
            seen[name] = report["points"][0]["area"]
        self.assertLess(seen["faces"], seen["parts"])
        self.assertLess(seen["parts"], seen["points"])
        self.assertEqual(report["coverage"]["points"]["seen"], seen["points"])
        vertices, faces = read_off(self.read("l.off").decode())
        area = [self.area([vertices[i] for i in face]) for face in faces]
        unseen = self.unseen_share("l.off", [(8, 1, 1.5)], 6000, area)
        self.assertAlmostEqual(seen["points"], 1 - unseen, delta=0.02)

    def test_arrangement(self):
        """What bisection proves seen is seen, and most of what is, against the exact arrangement of all shadows."""
        dice = random.Random(58)
        checked, missed = 0, []
        while checked < (1000 if LONG else 60):
            count = dice.randint(2, 9)
            size = dice.choice((2, 4, 9, 1000))
            corners = [[tuple(Fraction(dice.randint(0, size)) for _ in range(3)) for _ in range(3)]
                       for _ in range(count)]
            corners = [face for face in corners if any(cross(subtract(face[1], face[0]), subtract(face[2], face[0])))]
            place = tuple(Fraction(dice.randint(1, 4 * size), 4) for _ in range(3))
            if len(corners) < 2 or any(starts_on(place, face) for face in corners):
                continue
            self.write("soup.off", f"OFF\n{3 * len(corners)} {len(corners)} 0\n"
                       + "".join("%d %d %d\n" % x for face in corners for x in face)
                       + "".join(f"3 {3 * f} {3 * f + 1} {3 * f + 2}\n" for f in range(len(corners))))
            report = self.run_json("visible", "soup.off", "--soup", "--two-sided", "--target", "points", "--from",
                                   ",".join(str(float(x)) for x in place))
            areas = [self.area(face) for face in corners]
            shares = [seen_share(place, face, corners[:f] + corners[f + 1:]) for f, face in enumerate(corners)]
            exact = sum(area * share for area, share in zip(areas, shares)) / sum(areas)
            points = report["coverage"]["points"]
            self.assertLessEqual(points["seen"], exact + 1e-12, (place, corners))
            self.assertGreaterEqual(points["seen"] + points["open"], exact - 1e-12, (place, corners))
            self.assertAlmostEqual(points["seen"] + points["open"], 1, delta=1e-9)  # hidden, or at a shadow's edge
            missed.append(exact - points["seen"])
            checked += len(corners)
        self.assertLess(max(missed), 0.1)
        self.assertLess(sum(missed) / len(missed), 0.02)

    def test_many_in_a_room(self):
        """Guards that see two steps far: slits between what they see are closed by tighter limits."""
        self.write_l_room()
        guards, coverage = self.points_of("--range", "2.5")
        self.assertTrue(coverage["points"]["complete"])
        self.assertGreater(guards, 6)

    def test_tighter_rounds(self):
        """Rounds after the first ask for more than the room does; a bound for all places holds for their
        candidates as well."""
        plan, boxes = rooms.ROOMS["two rooms, a door"]
        rooms.write(pathlib.Path(self.folder, "rooms.obj"), rooms.room(plan, boxes))
        self.run_text("guard", "rooms.obj", *rooms.SENSOR, "--target", "points", "-o", "g.json")
        result = json.loads(self.read("g.json"))
        self.assertTrue(result["coverage"]["points"]["complete"])
        self.assertGreaterEqual(result["lower_bound"], result["lower_bound_everywhere"])
        self.run_text("verify", "rooms.obj", "g.json")

    def test_unit(self):
        self.run_text("sample", "eight", "--vertices", "500", "-o", "eight.off")
        _, errors = self.run_text("guard", "eight.off", "-o", "e.json", "--target", "points", "--range", "1e-5",
                                  status=2)
        self.assertIn("another unit", errors)


if __name__ == "__main__":
    main()
