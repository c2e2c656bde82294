# SPDX-License-Identifier: Apache-2.0
"""The plain cases of ../shared/data/plain, with the answers of its README, and others of their kinds."""
import json
import os
import random
import unittest
from fractions import Fraction

from support import Case, main
from test_coordinates import boxes, off

PLAIN = os.path.join(os.environ.get("STARGUARD_SHARED", ""), "data", "plain")


@unittest.skipUnless(os.path.isdir(PLAIN), f"there is no folder '{PLAIN}'")
class Plain(Case):
    def plain(self, name):
        return os.path.join(PLAIN, name)

    def test_pieces(self):
        """As few pieces as there can be, at once, with the surface as it is."""
        for name, pieces in [("two_tetra_apart.off", 2), ("edge_contact_two_cubes.off", 2),
                             ("nesting_min.off", 2), ("vertex_touch.off", 2), ("pc_checker.off", 9),
                             ("concave_ngon_u.obj", 2), ("solids/frame.off", 2)]:
            model = self.plain(name)
            report = self.run_json("decompose", model, "-o", "p.vtk", "--report", "p.json")
            self.assertEqual((len(report["pieces"]), report["optimal"], report["surface"]),
                             (pieces, True, "kept"), name)
            self.assertLess(report["counted_work"], 1000000, name)
            self.run_text("verify", model, "p.json", "p.vtk")

    def test_volumes(self):
        for name, volume in [("edge_contact_two_cubes.off", 2), ("nesting_min.off", 2),
                             ("vertex_touch.off", 2), ("pc_checker.off", 9)]:
            found = self.run_json("check", self.plain(name))["volume"]
            self.assertAlmostEqual(found, volume, 12, name)

    def test_guards(self):
        for name, words, guards in [("lb_2070_m.off", ["--redundancy", "3"], 9),
                                    ("solids/cube.off", ["--redundancy", "2"], 2),
                                    ("edge_contact_two_cubes.off", [], 2), ("pc_checker.off", [], 9)]:
            result = self.run_json("guard", self.plain(name), "-o", "g.json", *words)
            self.assertEqual((len(result["guards"]), result["optimal_everywhere"]), (guards, True), name)
            self.run_text("verify", self.plain(name), "g.json")

    def test_forged(self):
        for names in [("areabound_model.off", "areabound_forged.json"),
                      ("pieces_false_vertices.off", "pieces_false_vertices.json",
                       "pieces_false_vertices.vtk"),
                      ("map_a.off", "map_b.off", "map_false_offsets.vtu")]:
            self.run_bytes("verify", *map(self.plain, names), status=4)

    def test_thin_wall(self):
        report = self.run_json("decompose", self.plain("pc_thinwall.off"), "-o", "p.vtk", "--effort", "1")
        self.assertEqual(report["surface"], "kept")
        self.assertLess(len(report["pieces"]), 20)

    def test_names(self):
        report = self.run_json("guard", self.plain("names_with_dots.obj"), "-o", "g.json", "--see",
                               "Floor.001")
        with open(self.path("g.json"), encoding="utf-8") as file:
            self.assertTrue(json.load(file)["scene"]["targets"])
        self.assertEqual(report["coverage"]["uncovered_faces"], [])

    def test_scenes(self):
        wall = self.run_json("visible", self.plain("two_boxes_share_wall.off"), "--outside", "--unseen")
        self.assertEqual(len(wall["unseen"]), 4)
        _, errors = self.run_text("guard", self.plain("leaky_room.off"), "--soup", "--from", "2,2,1.5",
                                  "-o", "g.json")
        self.assertIn("leak", errors)


class Kinds(Case):
    """Boxes in other numbers, sizes and contacts."""

    UNIT = (1, 1, 1)

    def boxes(self, *given):
        """Of (lower corner, sides), or with True behind for a hollow, turned by 3-4-5 about z and scaled."""
        vertices, faces = boxes(*[(*box, False)[:3] for box in given])
        return self.write("m.off", off([(3 * x - 4 * y, 4 * x + 3 * y, 5 * z) for x, y, z in vertices], faces))

    def test_contacts(self):
        """Cubes in a row along a diagonal, in a ring of edges, and at corners: a piece and a guard for each."""
        for corners in ([(i, i, 0) for i in range(3)], [(0, 0, 0), (1, 1, 0), (2, 0, 0), (1, -1, 0)],
                        [(i, i, i) for i in range(3)], [(2 * i, 0, 0) for i in range(5)]):
            model = self.boxes(*[(c, self.UNIT) for c in corners])
            report = self.run_json("decompose", model, "-o", "p.vtk", "--report", "p.json")
            self.assertEqual((len(report["pieces"]), report["optimal"], report["surface"]),
                             (len(corners), True, "kept"))
            guards = self.run_json("guard", model, "-o", "g.json", "--redundancy", "2")
            self.assertEqual((len(guards["guards"]), guards["optimal_everywhere"]), (2 * len(corners), True))
            self.run_text("verify", model, "p.json", "p.vtk")
            self.run_text("verify", model, "g.json")

    def test_nested(self):
        """A hollow that is apart, and ones that touch in a face, an edge and a corner, drawn either way."""
        for lower in ((1, 1, 1), (1, 1, 0), (1, 0, 0), (0, 0, 0)):
            for hollow in (False, True):
                model = self.boxes(((0, 0, 0), (4, 4, 4)), (lower, self.UNIT, hollow))
                self.assertAlmostEqual(self.run_json("check", model)["volume"], 63 * 125, 9, (lower, hollow))
                self.run_text("guard", model, "-o", "g.json")
                self.run_text("verify", model, "g.json")

    def test_overlapping(self):
        """Cubes that share an eighth, a half, all, or a wall: pieces fill what they enclose, report or not."""
        for shift in ((.5, .5, .5), (.5, 0, 0), (0, 0, 0), (1, 0, 0)):
            model = self.boxes(((0, 0, 0), self.UNIT), (shift, self.UNIT))
            self.run_text("decompose", model, "-o", "p.vtk", "--report", "p.json", "--quiet")
            self.run_text("verify", model, "p.vtk", "p.json")
            self.run_text("verify", model, "p.vtk")
        model = self.boxes(((0, 0, 0), self.UNIT))
        self.run_text("decompose", model, "-o", "one.vtk", "--quiet")
        two = self.boxes(((0, 0, 0), self.UNIT), ((.5, .5, .5), self.UNIT))
        out, _ = self.run_text("verify", two, "one.vtk", status=4)
        self.assertIn("inside the model are in no piece", out)

    def test_flat(self):
        """Tetrahedra as flat as rounding makes them: which way they face is the exact sign of their volume."""
        rng, signs = random.Random(55), set()
        for number in range(36):
            step = (.1, .25)[number % 2]
            a, b, c = ([rng.randrange(64) + step * rng.randrange(9) for _ in range(3)]
                       for _ in range(3))
            d = [a[k] / 2 + b[k] / 4 + c[k] / 4 for k in range(3)]
            u, v, w = ([Fraction(x) - Fraction(y) for x, y in zip(p, a)] for p in (b, c, d))
            volume = sum(u[i] * (v[i - 2] * w[i - 1] - v[i - 1] * w[i - 2]) for i in range(3))
            sign = (volume > 0) - (volume < 0)
            faces = [(0, 2, 1), (0, 1, 3), (1, 2, 3), (2, 0, 3)]
            self.write("m.off", off([a, b, c, d], faces))
            found = json.loads(self.run_bytes("check", "m.off", "--json", status=None)[0])
            turned = found["findings"].get("inward_components", {"count": 0})["count"]
            self.assertEqual((found["usable"], turned), (sign != 0, int(sign < 0)), number)
            signs.add(sign)
        self.assertEqual(signs, {-1, 0, 1})

    def test_walls(self):
        """Three boxes in a row: four triangles for each wall; a small one on a large one: its two."""
        model = self.boxes(*[((i, 0, 0), self.UNIT) for i in range(3)])
        self.assertEqual(len(self.run_json("visible", model, "--outside", "--unseen")["unseen"]), 8)
        model = self.boxes(((0, 0, 0), (3, 3, 1)), ((1, 1, 1), self.UNIT))
        self.assertEqual(len(self.run_json("visible", model, "--outside", "--unseen")["unseen"]), 2)

    def test_units(self):
        """A range in metres, a model in millimetres."""
        model = self.boxes(((0, 0, 0), (6000, 5000, 3000)))
        for words in (["--range", "6"], ["--range", "6", "--fov", "90,60"], ["--range", "0.5", "--method", "greedy"],
                      ["--range", "6", "--outside", "--standoff", "100,500"]):
            _, errors = self.run_text("guard", model, "-o", "g.json", *words, status=2)
            self.assertIn("another unit", errors)


if __name__ == "__main__":
    main()
