# SPDX-License-Identifier: Apache-2.0
"""Scenes: obstacles, shells as given, outsides, soups, targets; and what is wrong with them."""
import json
import os
import random
import re
import struct

from support import OPEN, TETRAHEDRON, Case, main


def box(low, high, n=1, inward=False):
    """Vertices and faces of a box with n x n squares a side."""
    vertices, faces = {}, []
    for axis in range(3):
        for side in range(2):
            u, v = (axis + 1) % 3, (axis + 2) % 3

            def corner(a, b):
                p = [0.0, 0.0, 0.0]
                p[axis] = (low, high)[side][axis]
                p[u] = low[u] + (high[u] - low[u]) * a / n
                p[v] = low[v] + (high[v] - low[v]) * b / n
                return vertices.setdefault(tuple(p), len(vertices))

            for i in range(n):
                for j in range(n):
                    q = [corner(i, j), corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1)]
                    if (side == 0) != inward:
                        q.reverse()
                    faces += [(q[0], q[1], q[2]), (q[0], q[2], q[3])]
    return list(vertices), faces


def off(*parts):
    vertices, faces = [], []
    for own_vertices, own_faces in parts:
        first = len(vertices)
        vertices += own_vertices
        faces += [tuple(first + i for i in face) for face in own_faces]
    lines = ["OFF", f"{len(vertices)} {len(faces)} 0"]
    lines += [" ".join(map(repr, p)) for p in vertices]
    lines += ["3 " + " ".join(map(str, face)) for face in faces]
    return "\n".join(lines) + "\n"


ROOM = box((0, 0, 0), (8, 6, 3), 4)
CRATE = (3, 2, 0), (5, 4, 1.5)  # on the floor


class Scenes(Case):
    def setUp(self):
        super().setUp()
        self.write("room.off", off(ROOM))
        self.write("crate.off", off(box(*CRATE, 2)))

    def guards(self, *words):
        fewer = [] if {"--count", "--candidates"} & set(words) else ["--count", "60"]
        self.run_text("guard", *words, *fewer, "-o", "g.json", "--quiet")
        with open(self.path("g.json"), encoding="utf-8") as file:
            return json.load(file)

    def in_crate(self, result):
        return [g["position"] for g in result["guards"]
                if all(a <= x <= b for a, x, b in zip(CRATE[0], g["position"], CRATE[1]))]

    def verified(self, model):
        self.run_text("verify", model, "g.json")

    def refuses_place(self, model, result, place, claim):
        """`verify` refutes the claim if the first guard stands at the place."""
        result["guards"][0]["position"] = place
        self.write("g.json", json.dumps(result))
        out, _ = self.run_text("verify", model, "g.json", status=4)
        self.assertIn(f"FAILED {claim}", out)

    def test_obstacle(self):
        """No guard stands in a crate that is an obstacle, and the crate hides what is behind it."""
        result = self.guards("room.off", "--obstacles", "crate.off")
        self.assertEqual(self.in_crate(result), [])
        self.assertEqual(result["model"]["faces"], len(ROOM[1]))
        self.assertEqual(result["scene"]["obstacles"][0]["file"], "crate.off")
        self.verified("room.off")
        alone = self.guards("room.off")
        self.assertNotIn("scene", alone)
        self.assertLess(len(alone["guards"]), len(result["guards"]))

    def test_orientation(self):
        """The same crate as a shell of the room that faces the free space."""
        self.write("both.off", off(ROOM, box(*CRATE, 2, inward=True)))
        result = self.guards("both.off", "--orientation", "keep")
        self.assertEqual(self.in_crate(result), [])
        self.verified("both.off")

    def test_orientation_inside_out(self):
        """All of it turned: faces whose fronts are towards the free space, as in games."""
        self.write("both.off", off(box((0, 0, 0), (8, 6, 3), 4, inward=True), box(*CRATE, 2)))
        self.assertEqual(self.in_crate(self.guards("both.off", "--orientation", "keep")), [])
        self.verified("both.off")

    def test_warning(self):
        """Under the rule of unions a guard may stand in a crate that goes through the floor; then there is a
        warning. One that stands on the floor is a hollow."""
        self.write("both.off", off(ROOM, box((3, 2, -0.5), CRATE[1], 2)))
        self.write("there.txt", "4 3 0.7\n1 1 1\n")
        _, err = self.run_text("guard", "both.off", "-o", "g.json", "--candidates", "there.txt")
        self.assertIn("within more than one shell", err)
        inside = self.in_crate(json.loads(self.read("g.json")))
        self.assertEqual(len(inside), 1)

    def test_sheet(self):
        """An open obstacle blocks the view from both sides."""
        self.write("wall.off", "OFF\n4 2 0\n4 -1 -1\n4 7 -1\n4 7 4\n4 -1 4\n3 0 1 2\n3 0 2 3\n")
        result = self.guards("room.off", "--obstacles", "wall.off")
        self.assertEqual(len(result["guards"]), 2)
        sides = sorted(g["position"][0] < 4 for g in result["guards"])
        self.assertEqual(sides, [False, True])
        self.verified("room.off")

    def test_outside(self):
        result = self.guards("crate.off", "--outside", "--standoff", "0.5,2")
        for guard in result["guards"]:
            gap = [max(a - x, 0, x - b) for a, x, b in zip(CRATE[0], guard["position"], CRATE[1])]
            distance = sum(x * x for x in gap) ** 0.5
            self.assertTrue(0.5 <= distance * (1 + 1e-9) and distance <= 2 * (1 + 1e-9))
        self.assertEqual(result["coverage"]["uncovered_faces"], [])
        self.verified("crate.off")
        for gap in 0.4, 2.1:
            self.refuses_place("crate.off", result, [CRATE[1][0] + gap, *CRATE[1][1:]],
                               "guards keep their distances")

    def test_within(self):
        result = self.guards("room.off", "--within", "1,1,1,7,5,2")
        self.verified("room.off")
        for place in [0.9, 3, 1.5], [4, 3, 2.1]:
            self.refuses_place("room.off", result, place, "guards keep their distances")

    def test_outside_with_ground(self):
        """What stands on the ground is not seen from below it."""
        self.write("ground.off", off(box((-9, -9, -1), (19, 19, 0))))
        result = self.guards("crate.off", "--outside", "--standoff", "0.5,2", "--obstacles",
                             "ground.off")
        self.assertEqual(len(result["coverage"]["uncovered_faces"]), 8)
        self.verified("crate.off")

    def test_soup(self):
        """A room of single faces, one of which is missing, with its fronts inside."""
        vertices, faces = box((0, 0, 0), (8, 6, 3), 4, inward=True)
        self.write("soup.off", off((vertices, faces[1:])))
        self.run_text("guard", "soup.off", "-o", "g.json", status=2)
        self.guards("soup.off", "--soup", "--within", "0.1,0.1,0.1,7.9,5.9,2.9")
        self.verified("soup.off")
        result = self.guards("soup.off", "--soup", "--obstacles", "crate.off", "--from", "1,1,1",
                             "--cell", "0.25")
        self.assertEqual(self.in_crate(result), [])
        self.assertEqual(result["scene"]["from"], [1, 1, 1])
        self.verified("soup.off")

    def test_soups_without_limits(self):
        """A sheet, a box, an open one, boxes apart, a plate: all is seen, and no bound is above the guards."""
        sheet = [(0, 0, 0), (1, 0, 0), (0, 1, 0)], [(0, 1, 2)]
        tray = box((0, 0, 0), (1, 1, 1))
        stairs = box((0, 0, 0), (3, 1, 1)), box((0, 2, 0), (1, 3, 1))
        for parts, fewest in [((sheet,), 1), ((box((0, 0, 0), (1, 1, 1)),), 2), (((tray[0], tray[1][:-2]),), 2),
                              ((box((0, 0, 0), (1, 1, 1)), box((3, 0, 0), (4, 1, 1))), 2), (stairs, 2),
                              ((box((0, 0, 0), (10, 10, 1e-3)),), 2)]:
            self.write("soup.off", off(*parts))
            for words in [(), ("--prove", "--prove-work", "300000")]:
                result = self.guards("soup.off", "--soup", "--effort", "quick", *words)
                self.assertEqual(result["coverage"]["uncovered_faces"], [])
                self.assertGreaterEqual(len(result["guards"]), fewest)
                self.assertLessEqual(result.get("lower_bound_everywhere") or 0, len(result["guards"]))
                low, high = result["scene"]["within"][:3], result["scene"]["within"][3:]
                for guard in result["guards"]:
                    self.assertTrue(all(a <= x <= b for a, x, b in zip(low, guard["position"], high)))
                self.verified("soup.off")

    def test_reach(self):
        """Guards behind a wall, in a locked room or on the roof have not been reached."""
        vertices, faces = box((0, 0, 0), (8, 6, 3), 4, inward=True)
        wall = [(4, 0, 0), (4, 6, 0), (4, 6, 3), (4, 0, 3)], [(0, 1, 2), (0, 2, 3)]
        closet = box((1, 1, 0), (2, 2, 2), 2)
        self.write("level.off", off((vertices, faces), wall, closet))
        result = self.guards("level.off", "--soup", "--two-sided", "--from", "0.6,0.6,1", "--cell",
                             "0.3")
        self.assertIn("ok     guards can be reached", self.run_text("verify", "--verbose", "level.off", "g.json")[0])
        for place in [6, 3, 1], [1.5, 1.5, 1], [3, 3, 3.2]:
            self.refuses_place("level.off", result, place, "guards can be reached")

    def test_targets(self):
        """What need not be seen costs no guards, and counts for nothing."""
        self.write("far.txt", "# both ends\n0 1 2 3\n40 41\n")
        seen = self.guards("room.off", "--obstacles", "crate.off", "--see", "far.txt")
        self.assertEqual([face for face, weight in seen["scene"]["targets"]], [0, 1, 2, 3, 40, 41])
        self.assertEqual(seen["coverage"]["faces"], 1)
        self.verified("room.off")
        rest = self.guards("room.off", "--ignore", "far.txt")
        self.assertEqual(len(rest["scene"]["targets"]), len(ROOM[1]) - 6)
        self.verified("room.off")

    def test_weights(self):
        """A share of the weighted area is a share of what matters."""
        self.write("w.txt", "\n".join("9" if f < 32 else "1" for f in range(len(ROOM[1]))))
        self.guards("room.off", "--weights", "w.txt", "--coverage", "0.5")
        self.verified("room.off")

    def test_poses(self):
        """Given cameras look where they were told, and their results are candidates again."""
        cameras = ["1 1 1.5 1 1 0", "7 5 1.5 -1 -1 0", "7 1 1.5 0 1 0", "1 5 1.5 1 0 0"]
        self.write("cameras.txt", "\n".join(cameras))
        result = self.guards("room.off", "--candidates", "cameras.txt", "--cone", "90")
        for guard in result["guards"]:
            line = " ".join(f"{x:g}" for x in guard["position"] + guard["direction"])
            self.assertIn(line, cameras)
        self.verified("room.off")
        self.write("again.json", self.read("g.json"))
        again = self.guards("room.off", "--candidates", "again.json", "--cone", "90")
        self.assertEqual(again["guards"], result["guards"])
        self.write("bad.txt", "1 1 1.5 0 0 0\n")
        _, err = self.run_text("guard", "room.off", "-o", "bad.json", "--candidates", "bad.txt",
                               status=2)
        self.assertIn("line 1", err)

    def test_rectangular_views(self):
        """Rectangular views, with what is up; poses for other programs; results are candidates."""
        result = self.guards("room.off", "--fov", "90,60", "--up", "0,0,1", "--incidence", "80",
                             "--near", "0.1", "--range", "9", "--poses", "p.csv")
        self.assertEqual(result["options"]["fov"], [90, 60])
        self.assertEqual({tuple(g["up"]) for g in result["guards"]}, {(0, 0, 1)})
        self.verified("room.off")
        lines = self.read("p.csv").decode().splitlines()
        self.assertEqual(len(lines), 1 + len(result["guards"]))
        for line, guard in zip(lines[1:], result["guards"]):
            _, x, y, z, qx, qy, qz, qw, *_ = map(float, line.split(","))
            self.assertEqual([x, y, z], guard["position"])
            ahead = (-2 * (qx * qz + qy * qw), -2 * (qy * qz - qx * qw), 2 * (qx * qx + qy * qy) - 1)
            for found, expected in zip(ahead, guard["direction"]):
                self.assertAlmostEqual(found, expected, 9)
        self.write("again.json", self.read("g.json"))
        self.guards("room.off", "--fov", "90,60", "--incidence", "80", "--near", "0.1",
                    "--range", "9", "--candidates", "again.json", "--poses", "p.json")
        self.assertEqual(json.loads(self.read("p.json"))["fov"], [90, 60])

    def test_roll(self):
        """A camera on its side sees what is high, not what is wide."""
        seen = []
        for up in ("0 0 1", "0 1 0"):
            self.write("c.txt", f"0.5 3 1.5 1 0 0 {up}\n")
            seen.append(self.guards("room.off", "--fov", "120,30", "--candidates", "c.txt"))
        faces = [set(range(len(ROOM[1]))) - set(r["coverage"]["uncovered_faces"]) for r in seen]
        self.assertTrue(faces[0] - faces[1] and faces[1] - faces[0])
        self.verified("room.off")

    def test_baseline(self):
        result = self.guards("crate.off", "--outside", "--standoff", "0.5,2", "--redundancy", "2",
                             "--baseline", "30", "--incidence", "75")
        self.assertEqual(result["coverage"]["baseline_faces"], len(box(*CRATE, 2)[1]))
        self.verified("crate.off")
        result["coverage"]["baseline_faces"] -= 1
        self.write("g.json", json.dumps(result))
        self.run_text("verify", "crate.off", "g.json", status=4)

    def test_two_sided(self):
        """A sheet is seen from either side only where that is asked for."""
        self.write("wall.off", "OFF\n4 2 0\n0 0 0\n4 0 0\n4 4 0\n0 4 0\n3 0 1 2\n3 0 2 3\n")
        behind = ["wall.off", "--soup", "--within", "0,0,-3,4,4,-1"]
        _, errors = self.run_bytes("guard", *behind, "-o", "g.json", status=2)
        self.assertIn(b"no candidate sees any target", errors)
        self.assertIn(b"two-sided", errors)
        result = self.guards(*behind, "--two-sided")
        self.assertEqual(result["coverage"]["uncovered_faces"], [])
        self.verified("wall.off")

    def test_unseen(self):
        """A box in a closed box is proven unseen from outside of both, and seen from between them."""
        self.write("nest.off", off(box((0, 0, 0), (4, 4, 4), 2), box((1, 1, 1), (3, 3, 3))))
        outer = len(box((0, 0, 0), (4, 4, 4), 2)[1])
        around = ["nest.off", "--soup", "--within", "-2,-2,-2,6,6,6", "--cell", "0.25", "--unseen",
                  "--work", "2000000"]
        found = self.run_json("visible", *around, "--from", "-1,1,1")
        self.assertEqual(found["unseen"], list(range(outer, outer + 12)))
        self.assertEqual(found["undecided"], [])
        found = self.run_json("visible", *around, "--from", "0.5,0.5,0.5")
        self.assertEqual(found["unseen"], list(range(outer)))
        ground = off(box((-9, -9, -1), (19, 19, 0)))
        self.write("ground.off", ground)
        found = self.run_json("visible", "crate.off", "--outside", "--standoff", "0.1,2", "--obstacles",
                              "ground.off", "--unseen", "--work", "50000")
        self.assertEqual(len(found["unseen"]) + len(found["undecided"]), 8)
        self.sample("statue", 500)
        found = self.run_json("visible", "statue.off", "--outside", "--unseen", "--work", "1")
        self.assertEqual(found["undecided"], [])  # where the figure stands in its plinth
        self.assertGreater(len(found["unseen"]), 20)

    def test_covered_faces(self):
        """The wall between two boxes is unseen, though its corners are seen; a cavity is not outside."""
        self.write("pair.off", off(box((0, 0, 0), (2, 10, 10)), box((2, 0, 0), (4, 10, 10))))
        found = self.run_json("visible", "pair.off", "--outside", "--unseen")
        lines = self.read("pair.off").splitlines()
        across = [float(line.split()[0]) for line in lines[2:18]]
        wall = [f for f, line in enumerate(lines[18:]) if {across[int(v)] for v in line.split()[1:]} == {2}]
        self.assertEqual((found["unseen"], found["undecided"], len(wall)), (wall, [], 4))
        self.write("hollow.off", off(box((0, 0, 0), (4, 4, 4)), box((1, 1, 1), (3, 3, 3))))
        found = self.run_json("visible", "hollow.off", "--outside", "--unseen")
        self.assertEqual((found["unseen"], found["undecided"]), (list(range(12, 24)), []))
        result = self.guards("hollow.off", "--outside", "--standoff", "0.1,3")
        self.assertEqual(result["coverage"]["uncovered_faces"], list(range(12, 24)))
        self.verified("hollow.off")

    def test_export(self):
        """Cameras with the right field of view; results of scenes can be shown."""
        self.guards("room.off", "--obstacles", "crate.off", "--fov", "90,60", "--patch", "off")
        self.run_text("export", "g.json", "-o", "g.glb")
        with open(self.path("g.glb"), "rb") as file:
            data = file.read()
        scene = json.loads(data[20:20 + int.from_bytes(data[12:16], "little")])
        self.assertEqual(len(scene["cameras"]), sum("camera" in node for node in scene["nodes"]))
        lens = scene["cameras"][0]["perspective"]
        self.assertAlmostEqual(lens["yfov"], 1.0471975511965976, 9)
        self.assertAlmostEqual(lens["aspectRatio"], 3 ** 0.5, 9)

    def test_visible(self):
        """`visible` takes scenes as well; what is behind the crate is hidden by it."""
        plain = self.run_json("visible", "room.off", "--from", "1,3,0.5")
        behind = self.run_json("visible", "room.off", "--from", "1,3,0.5", "--obstacles", "crate.off")
        self.assertLess(behind["points"][0]["count"], plain["points"][0]["count"])
        self.assertTrue(set(behind["points"][0]["faces"]) <= set(plain["points"][0]["faces"]))
        outside = self.run_json("visible", "crate.off", "--outside", "--from", "-10,3,0.5")
        self.assertEqual(outside["points"][0]["count"], 8)

    def test_forged(self):
        """A guard in the crate, and another crate, do not pass."""
        result = self.guards("room.off", "--obstacles", "crate.off")
        self.refuses_place("room.off", result, [4, 3, 0.7], "all 2 guards are strictly inside")
        self.write("crate.off", off(box(*CRATE, 1)))
        _, err = self.run_text("verify", "room.off", "g.json", status=1)
        self.assertIn("obstacle 0", err)

    def test_over(self):
        """Guards stand above the floor, no higher than they may; not above the crate or elsewhere."""
        floor = [f for f, face in enumerate(ROOM[1]) if all(ROOM[0][v][2] == 0 for v in face)]
        self.write("floor.txt", "\n".join(map(str, floor)))
        words = ["room.off", "--over", "floor.txt", "--height", "0.5", "--up", "0,0,1"]
        result = self.guards(*words)
        self.assertEqual(result["scene"]["over"], floor)
        self.assertTrue(all(0 < g["position"][2] <= 0.5 for g in result["guards"]))
        self.verified("room.off")
        listed = ",".join(map(str, floor[:3])) + f",{floor[3]}-{floor[3]}"
        self.guards("room.off", "--over", listed, "--height", "0.5", "--up", "0,0,1")
        self.verified("room.off")
        place = [*result["guards"][0]["position"][:2], 0.6]
        self.refuses_place("room.off", result, place, "guards stand over")

    def test_mount(self):
        """Cameras hang below the ceiling at their clearance, and nowhere else."""
        ceiling = [f for f, face in enumerate(ROOM[1]) if all(ROOM[0][v][2] == 3 for v in face)]
        self.write("ceiling.txt", " ".join(map(str, ceiling)))
        result = self.guards("room.off", "--obstacles", "crate.off", "--mount", "ceiling.txt",
                             "--clearance", "0.2", "--fov", "100,80", "--coverage", "0.8")
        self.assertEqual(result["scene"]["mount"], ceiling)
        for guard in result["guards"]:
            self.assertAlmostEqual(guard["position"][2], 2.8, 3)
        self.verified("room.off")
        place = [*result["guards"][0]["position"][:2], 2]
        self.refuses_place("room.off", result, place, "guards stand over")

    def test_names(self):
        """Faces by what the model's own file calls them: groups, materials, properties."""
        vertices, faces = ROOM
        lines = [f"v {x} {y} {z}" for x, y, z in vertices]
        for f, face in enumerate(faces):
            lines += [f"g {'floor' if f < 32 else 'rest'} all", f"usemtl paint{f % 2}"]
            lines.append("f " + " ".join(str(v + 1) for v in face))
        self.write("room.obj", "\n".join(lines) + "\n")
        targets = lambda result: [face for face, _ in result["scene"]["targets"]]
        self.assertEqual(targets(self.guards("room.obj", "--see", "floor")), list(range(32)))
        self.verified("room.obj")
        even = targets(self.guards("room.obj", "--ignore", "paint1"))
        self.assertEqual(even, list(range(0, len(faces), 2)))
        _, err = self.run_text("guard", "room.obj", "-o", "n.json", "--see", "ceiling", status=1)
        for name in ("ceiling", "floor", "paint0"):
            self.assertIn(name, err)
        self.assertNotIn("n.json", self.names())

    def test_leak(self):
        """Two rooms of a soup: what is reached leaks through narrow gaps and out of the box, and the way shows it."""
        def rooms(gap, door, floor):
            """Of 4 by 6 by 3 each, with openings of these widths in the wall between and to the outside, and a
            floor up to this x."""
            corners, quads = [], []
            def add(*quad):
                quads.append("4 " + " ".join(str(len(corners) + i) for i in range(4)))
                corners.extend(quad)
            for z in (0, 3):
                end = 8 if z > 0 else floor
                add((0, 0, z), (end, 0, z), (end, 6, z), (0, 6, z))
            for y in (0, 6):
                add((0, y, 0), (8, y, 0), (8, y, 3), (0, y, 3))
            for x, width in ((0, 0), (4, gap), (8, door)):
                for a, b in ((0, 3 - width / 2), (3 + width / 2, 6)):
                    add((x, a, 0), (x, b, 0), (x, b, 3), (x, a, 3))
            lines = [" ".join(map(str, c)) for c in corners] + quads
            return f"OFF\n{len(corners)} {len(quads)} 0\n" + "\n".join(lines) + "\n"
        cell = 0.01 * (64 + 36 + 9) ** 0.5
        for gap, door, floor, says in [
                (6, 0, 8, None), (1, 0, 8, None), (0, 0, 8, None), (0, 1, 8, None),
                (6, 1, 8, "outside of the model, at"), (1, 1, 8, "outside of the model, at"),
                (1, 0, 4, "outside of the model, at"), (0.25, 0, 8, "leaks through a gap"),
                (0.25, 1, 8, "outside of the model, through a gap"),
                (6, 0.25, 8, "outside of the model, through a gap")]:
            self.write("rooms.off", rooms(gap, door, floor))
            words = ["rooms.off", "--soup", "--two-sided", "--from", "1.1,1,1", "--leak", "way.obj", "-o", "g.json",
                     "--no-refine", "--count", "30"]
            log = [line["message"] for line in self.run_json("guard", *words)["log"] if line["level"] == "warning"]
            self.assertEqual(len(log), says is not None, log)
            self.assertEqual("way.obj" in self.names(), says is not None)
            if says is None:
                continue
            self.assertIn(says, log[0])
            place = [float(x) for x in re.search(r" at \((.*?)\)", log[0])[1].split(",")]
            wall, width = (4, gap) if gap < 1 or floor < 8 else (8, door)
            self.assertLess(abs(place[0] - wall), 2 * cell)
            self.assertLess(abs(place[1] - 3), width / 2)
            self.assertTrue(0 < place[2] < 3)
            lines = [line.split() for line in self.read("way.obj").decode().splitlines()]
            way = [[float(x) for x in line[1:]] for line in lines if line[0] == "v"]
            self.assertEqual(way[0], [1.1, 1, 1])
            self.assertEqual([line[1:] for line in lines if line[0] == "l"],
                             [[str(i), str(i + 1)] for i in range(1, len(way))])
            self.assertEqual(way[-1][0] > 8 or way[-1][2] < 0, "outside" in says) # by the openings only
            for x, width in ((4, gap), (8, door)):
                for (p, q) in zip(way, way[1:]):
                    if (p[0] < x) != (q[0] < x):
                        self.assertLess(abs(p[1] - 3), width / 2)
            os.remove(os.path.join(self.folder, "way.obj"))
            shut = self.run_json("guard", *words, "--within", "0,0,0,8,6,3") # a box that ends where the model does
            self.assertEqual("outside" in str(shut["log"]), False)
            self.assertEqual("way.obj" in self.names(), gap < 1)
            if gap < 1:
                os.remove(os.path.join(self.folder, "way.obj"))
            wide = self.run_json("guard", *words, "--within", "0,0,-1,9,6,3") # one that goes on there
            self.assertEqual("outside" in str(wide["log"]), "outside" in says)
            os.remove(os.path.join(self.folder, "way.obj"))
        self.usage_error("guard", "room.off", "--leak", "way.obj", "-o", "n.json", says="--soup --from")
        self.usage_error("guard", "rooms.off", "--soup", "--from", "1,1,1", "--leak", "w.txt", "-o", "n.json", says=".vtk")

    def test_advice(self):
        """A refused mesh is told of what helps, and of nothing else."""
        chance = random.Random(1)
        loose = "".join("%g %g %g\n" % tuple(chance.random() for _ in range(3)) for _ in range(90))
        self.write("loose.off", f"OFF\n90 30 0\n{loose}" + "".join(f"3 {i} {i + 1} {i + 2}\n" for i in range(0, 90, 3)))
        self.write("open.off", OPEN)
        self.write("mid.txt", "4 3 1.5\n")
        triple = TETRAHEDRON.replace("4 4 6", "5 7 6").replace("0 0 1\n", "0 0 1\n0 0 -1\n")
        self.write("triple.off", triple + "3 0 1 4\n3 0 4 2\n3 1 2 4\n")
        self.write("flat.off", "OFF\n3 2 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n3 0 2 1\n")
        for model, says, never in [("loose.off", "--soup", "try 'starguard repair'"), ("open.off", "repair", "--soup"),
                                   ("triple.off", "repair", "--soup"), ("flat.off", "--soup", "repair")]:
            for words in ["guard", model, "-o", "n.json"], ["check", model]:
                _, err = self.run_text(*words, status=2)
                self.assertIn(says, err)
                self.assertNotIn(never, err)
        self.run_text("guard", "loose.off", "--soup", "--two-sided", "-o", "n.json", "--no-refine", "--count", "50",
                      "--patch", "off")
        for model, holes in [("loose.off", True), ("triple.off", False)]:
            _, err = self.run_text("decompose", model, "-o", "p.vtk", status=2)
            self.assertIn("of its diagonal away", err)
            self.assertEqual("its holes are too large" in err, holes, err)
        _, err = self.run_text("guard", "room.off", "--soup", "--range", "0.5", "-o", "n.json", "--candidates", "mid.txt",
                               status=2)
        self.assertIn("try a larger range, or faces that are seen from either side (two-sided), or other candidates\n", err)
        self.write("out.txt", "9 9 9\n1 1 1\n")
        for words, says in [([], ": not inside\n"), (["--clearance", "0.1"], ": not inside, or nearer")]:
            _, err = self.run_text("guard", "room.off", "--candidates", "out.txt", "-o", "n.json", *words)
            self.assertIn(says, err)

    def test_many_names(self):
        """Lists, patterns and repeated options are unions; names may have dots, slashes, spaces and commas."""
        vertices, faces = box((0, 0, 0), (8, 6, 3))
        given = ["Floor.001", "IfcSlab/Ceiling", "Wall, north", "wall_e", "0-3", "a*b=2"]
        lines = [f"v {x} {y} {z}" for x, y, z in vertices]
        for f, face in enumerate(faces):
            if f % 2 == 0:
                lines.append(f"o {given[f // 2]}")
            lines.append("f " + " ".join(str(v + 1) for v in face))
        self.write("named.obj", "\n".join(lines) + "\n")
        self.write("wall_e", "11")
        for words, names in [
                (["--see", "Floor.001"], [0]), (["--see", "IfcSlab/Ceiling"], [1]), (["--see", "Wall, north"], [2]),
                (["--see", "Floor.001,a*b=2"], [0, 5]), (["--see", "Floor.001, Ifc*"], [0, 1]),
                (["--see", "[Ww]all*", "--see", "Wall*"], None), (["--see", "?all*"], [2, 3]),
                (["--see", "*o*"], [0, 2]), (["--see", "0?3"], [4]), (["--see", "0-3"], [0, 1]),
                (["--see", "0-1,Wall*"], [0, 2]), (["--see", "Floor.001", "--see", "0?3", "--see", "2-3"], [0, 1, 4]),
                (["--ignore", "*all*", "--ignore", "Floor.001"], [1, 4, 5])]:
            if names is None:
                self.usage_error("guard", "named.obj", "-o", "n.json", *words, says="is called '[Ww]all*'")
                continue
            targets = [face for face, _ in self.guards("named.obj", *words)["scene"]["targets"]]
            self.assertEqual(targets, [f for n in names for f in (2 * n, 2 * n + 1)], words)
        wall = self.guards("named.obj", "--see", "wall_e")["scene"]["targets"]
        self.assertEqual([face for face, _ in wall], [11]) # the file
        _, err = self.run_text("guard", "named.obj", "-o", "n.json", "--see", "Floor.002", status=2)
        self.assertIn("there are Floor.001, IfcSlab/Ceiling, Wall, north, wall_e, 0-3", err)
        mounted = self.guards("named.obj", "--mount", "Floor.001", "--mount", "0-3", "--clearance", "0.1")
        self.assertEqual(mounted["scene"]["mount"], [0, 1, 2, 3])

    def test_obstacles_in_exports(self):
        """Scenes show what stands in the way, as a part of its own."""
        self.guards("room.off", "--obstacles", "crate.off")
        crate = box(*CRATE, 2)
        for name in ("g.vtu", "g.glb"):
            self.run_text("export", "g.json", "-o", name)
        vtu = self.read("g.vtu")
        self.assertEqual(self.appended(vtu, b"part", "B").count(5), len(crate[1]))
        points = self.appended(vtu, b"Points")
        self.assertEqual(points[-3 * len(crate[0]):], tuple(x for p in crate[0] for x in p))
        glb = self.read("g.glb")
        head = json.loads(glb[20:20 + int.from_bytes(glb[12:16], "little")])
        node = next(node for node in head["nodes"] if node["name"] == "obstacles")
        indices = head["meshes"][node["mesh"]]["primitives"][0]["indices"]
        self.assertEqual(head["accessors"][indices]["count"], 3 * len(crate[1]))

    def test_properties(self):
        """Weights are a property of the faces of a PLY file, also where these are polygons."""
        vertices, faces = box((0, 0, 0), (8, 6, 3))
        quads = [(a, b, c, faces[f + 1][2]) for f, (a, b, c) in enumerate(faces) if f % 2 == 0]
        head = ["ply", "format ascii 1.0", f"element vertex {len(vertices)}", "property double x",
                "property double y", "property double z", f"element face {len(quads)}",
                "property float care", "property list uchar int vertex_indices",
                "property int kind", "end_header"]
        rows = [f"{x} {y} {z}" for x, y, z in vertices]
        rows += [f"{q} 4 {' '.join(map(str, quad))} {q % 3}" for q, quad in enumerate(quads)]
        self.write("room.ply", "\n".join(head + rows) + "\n")
        found = self.guards("room.ply", "--weights", "care")["scene"]["targets"]
        self.assertEqual(found, [[2 * q + i, q / 5] for q in range(1, 6) for i in range(2)])
        self.verified("room.ply")
        targets = lambda pairs: [face for face, _ in pairs]
        kinds = self.guards("room.ply", "--see", "kind=2")["scene"]["targets"]
        self.assertEqual([face for face, _ in kinds], [4, 5, 10, 11])
        _, err = self.run_text("guard", "room.ply", "-o", "n.json", "--see", "kind=x", status=1)
        self.assertIn("not a number", err)
        several = targets(self.guards("room.ply", "--see", "kind=2,care")["scene"]["targets"])
        self.assertEqual(several, list(range(2, 12)))
        self.assertEqual(targets(self.guards("room.ply", "--see", "k*")["scene"]["targets"]), [2, 3, 4, 5, 8, 9, 10, 11])

    def test_views_in_exports(self):
        """Cones and pyramids of cameras are in VTU and PLY files, from the guard outwards."""
        for words, sides in ((["--cone", "80"], 24), (["--fov", "90,60"], 4)):
            result = self.guards("room.off", *words, "--range", "9", "--coverage", "0.7", "--patch", "off")
            count = len(result["guards"])
            for name in ("g.vtu", "g.ply"):
                self.run_text("export", "g.json", "-o", name)
            head = self.read("g.ply").split(b"end_header")[0].decode().split("\n")
            faces = next(line for line in head if line.startswith("element face"))
            self.assertEqual(int(faces.split()[2]), len(ROOM[1]) + count * (72 + sides))
            vtu = self.read("g.vtu")
            cells = int(vtu.split(b'NumberOfCells="')[1].split(b'"')[0])
            self.assertEqual(cells, len(ROOM[1]) + count + count * sides)
            points = self.appended(vtu, b"Points")
            corners = [points[3 * i:3 * i + 3] for i in range(len(points) // 3)]
            views = corners[len(ROOM[0]) + count:]
            self.assertEqual(len(views), count * (sides + 1))
            for g, guard in enumerate(result["guards"]):
                apex, *rim = views[g * (sides + 1):(g + 1) * (sides + 1)]
                self.assertEqual(list(apex), guard["position"])
                for corner in rim:
                    way = [a - b for a, b in zip(corner, apex)]
                    ahead = sum(a * b for a, b in zip(way, guard["direction"]))
                    self.assertGreater(ahead, 0)
                    self.assertAlmostEqual(sum(a * a for a in way) ** 0.5, 0.8, 6)

    def appended(self, vtu, name, kind="d"):
        """The numbers of an appended array."""
        place = int(vtu.split(b'Name="' + name + b'"')[1].split(b'offset="')[1].split(b'"')[0])
        data = vtu[vtu.index(b"_", vtu.index(b"<AppendedData")) + 1 + place:]
        size, = struct.unpack("<Q", data[:8])
        return struct.unpack(f"<{size // struct.calcsize(kind)}{kind}", data[8:8 + size])

    def test_bad_questions(self):
        for words, says in [
                (["room.off", "--unseen", "--box", "0,0,0,1,1,1"], "leave out --box"),
                (["room.off", "--from", "1,1,1", "--within", "0,0,0,1,1,1"], "add --unseen"),
        ]:
            _, err = self.run_text("visible", *words, status=1)
            self.assertIn(says, err)

    def test_bad_input(self):
        self.write("far.off", off(box((20, 0, 0), (21, 1, 1))))
        self.write("short.txt", "1 2 3\n")
        self.write("negative.txt", "1 " * (len(ROOM[1]) - 1) + "-1\n")
        self.write("nothing.txt", "0 " * len(ROOM[1]))
        self.write("beyond.txt", "0 99999\n")
        self.write("along.txt", "1 1 1  0 0 1  0 0 2\n")
        self.write("zero.txt", "1 1 1  0 0 0  0 0 1\n")
        self.write("mixed.txt", "1 1 1  0 0 1\n1 1 1  0 0 1  0 1 0\n")
        for words, status, says in [
                (["room.off", "--obstacles", "far.off"], 1, "obstacle 0"),
                (["crate.off", "--outside"], 1, "--standoff"),
                (["crate.off", "--outside", "--standoff", "2,1"], 1, "from 2 to 1"),
                (["crate.off", "--outside", "--standoff", "2"], 1, "MIN,MAX"),
                (["room.off", "--standoff", "5,6"], 2, "no candidate"),
                (["room.off", "--cell", "1"], 1, "--from"),
                (["room.off", "--soup", "--from", "1,1,0", "--cell", "0.1"], 1, "a face meets"),
                (["room.off", "--soup", "--from", "50,1,1"], 1, "from (0, 0, 0) to (8, 6, 3)"),
                (["room.off", "--soup", "--from", "1,1,1", "--cell", "1e-5"], 1, "2^30"),
                (["room.off", "--obstacles", "crate.off", "--from", "4,3,0.7", "--cell", "0.2"], 1,
                 "within matter"),
                (["room.off", "--soup", "--outside", "--standoff", "1,2"], 1, "soup"),
                (["room.off", "--weights", "short.txt"], 2, "3 weights"),
                (["room.off", "--weights", "negative.txt"], 2, "-1"),
                (["room.off", "--weights", "nothing.txt"], 1, "nothing is to be seen"),
                (["room.off", "--see", "beyond.txt"], 2, "99999"),
                (["room.off", "--see", "short.txt", "--ignore", "short.txt"], 1, "exclude"),
                (["room.off", "--see", "missing.txt"], 2, "missing.txt"),
                (["room.off", "--orientation", "keeep"], 1, "did you mean 'keep'"),
                (["room.off", "--two-sided"], 1, "only a soup"),
                (["room.off", "--over", "0-3"], 1, "--height"),
                (["room.off", "--height", "1"], 1, "--over"),
                (["room.off", "--over", "0-9999", "--height", "1"], 1, "0 to 191"),
                (["room.off", "--over", "3-1", "--height", "1"], 1, "no list of faces"),
                (["room.off", "--mount", "0"], 1, "--clearance"),
                (["room.off", "--mount", "ceiling", "--clearance", "0.1"], 1, "'ceiling'"),
                (["room.off", "--mount", "0", "--clearance", "50"], 2, "no candidate"),
                (["room.off", "--fov", "200,60"], 1, "--fov takes H,V"),
                (["room.off", "--fov", "90"], 1, "--fov takes H,V"),
                (["room.off", "--fov", "90,0"], 1, "--fov takes H,V"),
                (["room.off", "--fov", "90,60", "--cone", "90", "--count", "5"], 1, "exclude each other"),
                (["room.off", "--up", "1,2"], 1, "--up takes X,Y,Z"),
                (["room.off", "--incidence", "95"], 1, "at most 90"),
                (["room.off", "--incidence", "60", "--target", "vertices"], 1, "incidence"),
                (["room.off", "--near", "3", "--range", "2"], 1, "below the range"),
                (["room.off", "--baseline", "20"], 1, "redundancy of 2"),
                (["room.off", "--poses", "p.txt"], 1, "ends in .csv or .json"),
                (["room.off", "--fov", "90,60", "--candidates", "along.txt"], 2, "along the direction"),
                (["room.off", "--fov", "90,60", "--candidates", "zero.txt"], 2, "which is none"),
                (["room.off", "--fov", "90,60", "--candidates", "mixed.txt"], 2, "line 2"),
        ]:
            with self.subTest(words):
                _, err = self.run_text("guard", *words, "-o", "bad.json", status=status)
                self.assertIn(says, err)
                self.assertNotIn("bad.json", self.names())


if __name__ == "__main__":
    main()
