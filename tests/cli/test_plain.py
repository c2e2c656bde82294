# SPDX-License-Identifier: Apache-2.0
"""The plain cases of ../shared/data/plain, with the answers of its README."""
import json
import os
import unittest

from support import Case, main

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


if __name__ == "__main__":
    main()
