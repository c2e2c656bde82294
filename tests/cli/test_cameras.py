# SPDX-License-Identifier: Apache-2.0
"""Cameras as planners place them: audits, cameras that stay, zones, tilt, density, needs, clear faces."""
import csv
import json
import math

from support import Case, main
from test_scenes import box, off

ROOM = [(0, 0, 0), (8, 0, 0), (8, 0, 6), (0, 0, 6), (0, 3, 0), (8, 3, 0), (8, 3, 6), (0, 3, 6)]
GROUPS = {"floor": ["1 2 3 4"], "ceiling": ["5 8 7 6"], "door": ["1 5 6 2"],
          "walls": ["2 6 7 3", "3 7 8 4", "4 8 5 1"]}
CAMERA = ("--fov", "90,60", "--range", "6")
SEARCH = ("--effort", "quick", "--count", "40", "--quiet")


def room(scale):
    lines = ["v " + " ".join(repr(float(x * scale)) for x in p) for p in ROOM]
    for name, faces in GROUPS.items():
        lines += ["g " + name] + ["f " + face for face in faces]
    return "\n".join(lines) + "\n"


class Cameras(Case):
    def setUp(self):
        super().setUp()
        self.write("room.obj", room(1))
        self.write("stay.txt", "0.5 2.8 0.5 1 -0.5 1\n7.5 2.8 5.5 -1 -0.5 -1\n")

    def guard(self, *words, model="room.obj"):
        self.run_text("guard", model, *words, "-o", "g.json", *SEARCH)
        self.run_text("verify", model, "g.json")
        return json.loads(self.read("g.json"))

    def rows(self, name):
        return list(csv.DictReader(self.read(name).decode().splitlines()))

    def refuted(self, result, claim, model="room.obj"):
        self.write("bad.json", json.dumps(result))
        out, _ = self.run_text("verify", model, "bad.json", status=4)
        self.assertIn(claim, out)

    def test_audit(self):
        """What given cameras see, by tables that add up."""
        told = self.run_json("visible", "room.obj", "--poses", "stay.txt", *CAMERA, "--resolution", "1920,1080",
                             "--table", "t.csv", "--summary", "s.csv")
        faces, summary = self.rows("t.csv"), self.rows("s.csv")
        self.assertEqual(len(faces), 12)
        self.assertEqual({row["group"] for row in faces}, set(GROUPS))
        area = sum(float(row["area"]) for row in faces)
        self.assertAlmostEqual(area, 180)
        seen = sum(float(row["area"]) * float(row["share"]) for row in faces)
        self.assertAlmostEqual(seen / area, told["coverage"]["area"])
        whole = summary[-1]
        self.assertEqual(whole["kind"], "all")
        self.assertAlmostEqual(float(whole["by_1"]), told["coverage"]["area"])
        cameras = [row for row in summary if row["kind"] == "camera"]
        both = sum(float(row["area"]) for row in cameras) - float(whole["by_1"]) * area
        self.assertAlmostEqual(both, float(whole["by_2"]) * area)
        for row in cameras:  # a corner of the room is nearer than its diagonal
            self.assertGreater(float(row["density"]), 960 / 11)

    def test_poses_of_every_kind(self):
        """CSV, JSON, GUARDS.json and GLB tell the same cameras."""
        self.run_text("guard", "room.obj", *CAMERA, "-o", "g.json", "--poses", "p.csv", *SEARCH)
        self.run_text("guard", "room.obj", *CAMERA, "-o", "g.json", "--poses", "p.json", *SEARCH)
        self.run_text("export", "g.json", "-o", "g.glb")
        count = len(json.loads(self.read("g.json"))["guards"])
        for name in "g.json", "p.csv", "p.json", "g.glb":
            told = self.run_json("visible", "room.obj", "--poses", name, *CAMERA)
            self.assertEqual(len(told["points"]), count, name)
            self.assertGreater(told["coverage"]["area"], 0.999, name)
        self.write("bad.csv", "x,y,z\n1,2,three\n")
        _, err = self.run_text("visible", "room.obj", "--poses", "bad.csv", status=2)
        self.assertIn("line 2", err)

    def test_keep(self):
        """Cameras that stay come first and unchanged; of all of a plan none is added."""
        plan = self.guard(*CAMERA)
        full = self.guard(*CAMERA, "--keep", "stay.txt")
        self.assertEqual([g["kept"] for g in full["guards"]][:3], [True, True, False])
        self.assertEqual(full["guards"][0]["position"], [0.5, 2.8, 0.5])
        self.assertEqual(full["guards"][1]["direction"], [-1, -0.5, -1])
        self.assertLessEqual(full["lower_bound"], len(full["guards"]) - 2)
        self.write("plan.json", json.dumps(plan))
        same = self.guard(*CAMERA, "--keep", "plan.json")
        self.assertEqual(len(same["guards"]), len(plan["guards"]))
        self.assertEqual(same["lower_bound"], 0)
        limited = self.guard(*CAMERA, "--keep", "stay.txt", "--max-guards", "1")
        self.assertEqual(len(limited["guards"]), 3)
        twice = self.guard(*CAMERA, "--keep", "plan.json", "--redundancy", "2")
        self.assertEqual(twice["coverage"]["redundant_faces"], [12, 12])
        full["guards"][2]["kept"] = True
        self.refuted(full, "guards stay, and come first")

    def test_keep_refused(self):
        self.write("out.txt", "99 1 1 1 0 0\n")
        self.write("empty.txt", "")
        self.write("places.txt", "1 1 1\n")
        for words, status, says in ((("out.txt", *CAMERA), 2, "not strictly inside"),
                                    (("empty.txt", *CAMERA), 2, "no points"),
                                    (("places.txt", *CAMERA), 1, "no directions"),
                                    (("places.txt", "--target", "points"), 1, "keep")):
            _, err = self.run_text("guard", "room.obj", "-o", "g.json", "--keep", *words, status=status)
            self.assertIn(says, err)
            self.assertNotIn("g.json", self.names())

    def test_zones(self):
        """Guards stand in the union of the one kind and out of the other, boxes and meshes."""
        self.write("lane.off", off(box((3, -1, -1), (5, 4, 7))))
        result = self.guard(*CAMERA, "--without", "lane.off", "--within", "0,0,0,8,1,6",
                            "--within", "8,3,6,0,2,0")
        for guard in result["guards"]:
            x, y, _ = guard["position"]
            self.assertFalse(3 <= x <= 5)
            self.assertTrue(y <= 1 or y >= 2)
        result["guards"][0]["position"] = [4, 1.5, 3]
        self.refuted(result, "FAILED guards stand in zones")
        for words, status, says in ((("--within", "0,0,0,1,1"), 2, "there is no file"),
                                    (("--within", "0,0,0,0,1,1"), 1, "without an inside"),
                                    (("--within", "50,0,0,60,1,1"), 2, "wider limits"),
                                    (("--without", "-1,-1,-1,9,4,7"), 2, "wider limits")):
            _, err = self.run_text("guard", "room.obj", *words, "-o", "h.json", status=status)
            self.assertIn(says, err)

    def test_tilt(self):
        result = self.guard(*CAMERA, "--tilt", "-45,-10")
        for guard in result["guards"]:
            d = guard["direction"]
            self.assertTrue(-45.00001 <= math.degrees(math.asin(d[1] / math.hypot(*d))) <= -9.99999)
        result["guards"][0]["direction"] = [1, 1, 0]
        self.refuted(result, "degrees above the horizon")
        self.usage_error("guard", "room.obj", "-o", "h.json", *CAMERA, "--tilt", "10,-10", says="from 10 to -10")
        self.usage_error("guard", "room.obj", "-o", "h.json", "--tilt", "-10,10", says="one direction")

    def test_density(self):
        """The same plan for a room in metres and in millimetres; no camera counts beyond its depth."""
        words = ("--fov", "90,60", "--resolution", "1920,1080", "--density", "recognise")
        metres = self.guard(*words)
        self.write("mm.obj", room(1000))
        millimetres = self.guard(*words, "--unit", "mm", model="mm.obj")
        self.assertAlmostEqual(len(metres["guards"]), len(millimetres["guards"]), delta=1)
        self.assertEqual(metres["options"]["density"], "recognise")
        metres["options"]["density"] = "identify"
        self.refuted(metres, "FAILED")
        self.usage_error("guard", "room.obj", "-o", "h.json", "--density", "5", says="resolution")

    def test_require(self):
        """Doors by two with more pixels than the rest."""
        words = ("--fov", "90,60", "--resolution", "1920,1080", "--density", "detect")
        result = self.guard(*words, "--require", "door=2,observe")
        self.assertEqual(result["coverage"]["met_needs"], 2)
        self.assertEqual(result["scene"]["needs"], [[4, 2, "observe"], [5, 2, "observe"]])
        result["scene"]["needs"] = [[4, 9, "observe"], [5, 9, "observe"]]
        self.refuted(result, "FAILED")
        for word, says in (("door=0", "K from 1"), ("door", "FACES=K"), ("door=2,much", "a density")):
            self.usage_error("guard", "room.obj", "-o", "h.json", *words, "--require", word, says=says)

    def test_clear(self):
        """A pane is seen through; it hides half the room if it is not said to be clear."""
        vertices, faces = box((0, 0, 0), (8, 3, 6))
        pane = box((3.9, 0.001, 0.001), (4.1, 2.999, 5.999), inward=True)
        lines = ["v " + " ".join(map(repr, map(float, p))) for p in vertices + pane[0]]
        lines += ["g room"] + ["f " + " ".join(str(i + 1) for i in f) for f in faces]
        lines += ["g pane"] + ["f " + " ".join(str(i + 9) for i in f) for f in pane[1]]
        self.write("pane.obj", "\n".join(lines) + "\n")
        clear = self.guard("--clear", "pane", model="pane.obj")
        self.assertEqual(len(clear["guards"]), 1)
        self.assertEqual(clear["scene"]["clear"], list(range(12, 24)))
        for engine in "grid", "bvh", "sweep", "contours":
            told = self.run_json("visible", "pane.obj", "--from", "1,1.5,3", "--clear", "pane", "--engine", engine)
            self.assertEqual(told["points"][0]["count"], 12)
        del clear["scene"]["clear"]
        self.refuted(clear, "FAILED", "pane.obj")

    def test_with_points_and_patches(self):
        """Each works and verifies, or is refused with what to leave out."""
        asked = {"--keep": "stay.txt", "--clear": "door", "--require": "door=2", "--redundancy": "2", "--curve": "c.csv",
                 "--matrix": "m.txt"}
        beside = {"--keep": ["--keep", "stay.txt"], "--curve": ["--curve", "c.csv"]}
        for sensor in ([], CAMERA):
            for option, value in asked.items():
                self.usage_error("guard", "room.obj", "--target", "points", *sensor, option, value, "-o", "h.json",
                                 says="leave out")
                self.run_text("guard", "room.obj", "--patch", "1", *sensor, option, value, *SEARCH, "-o", "g.json")
                self.run_text("verify", "room.obj", "g.json", *beside.get(option, []))
        self.run_text("guard", "room.obj", "--target", "points", *CAMERA, "-o", "g.json", "--table", "t.csv",
                      "--summary", "s.csv", *SEARCH)
        groups = [float(row["share"]) for row in self.rows("s.csv") if row["kind"] == "group"]
        self.assertTrue(groups and min(groups) > 0.9, groups)  # in parts: all but those that two cameras share
        out, _ = self.run_text("verify", "room.obj", "g.json", "--table", "t.csv")
        self.assertIn("not checked: the tables", out)

    def test_share(self):
        """From a point inside, all faces make up the whole sphere."""
        told = self.run_json("visible", "room.obj", "--from", "1,1,1", "--from", "7,2,5", "--share")
        self.assertAlmostEqual(sum(face["solid_angle"] for face in told["shares"]), 4 * math.pi)
        self.assertEqual({face["share"] for face in told["shares"]}, {1})

    def test_curve_and_matrix(self):
        self.sample("gallery", 500, "gallery.off")
        self.run_text("guard", "gallery.off", "-o", "g.json", "--curve", "c.csv", "--matrix", "m.txt", *SEARCH)
        curve = [(float(row["coverage"]), float(row["bound"])) for row in self.rows("c.csv")]
        self.assertEqual(len(curve), len(json.loads(self.read("g.json"))["guards"]))
        self.assertEqual(curve, sorted(curve))
        self.assertTrue(all(found <= bound + 1e-12 for found, bound in curve))
        self.assertAlmostEqual(curve[-1][0], 1)
        numbers = list(map(int, self.read("m.txt").split()))
        elements, sets = numbers[:2]
        at = 2
        for element in range(elements):
            self.assertEqual(numbers[at], element)
            held = numbers[at + 2:at + 2 + numbers[at + 1]]
            self.assertTrue(held and max(held) < sets)
            at += 2 + numbers[at + 1]
        self.assertEqual(at, len(numbers))
        self.run_text("guard", "gallery.off", "-o", "g.json", "--curve", "c.svg", *SEARCH)
        self.assertIn(b"<svg", self.read("c.svg"))


if __name__ == "__main__":
    main()
