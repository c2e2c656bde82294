# SPDX-License-Identifier: Apache-2.0
"""map and morph: the contract, and wrong use of both."""
import json
import os
import shutil
import struct
import unittest

import support
from plain_solids import arc
from support import Case, OPEN, TETRAHEDRON


class Morph(Case):
    def setUp(self):
        super().setUp()
        for pose in "01":
            self.sample("cat", 500, f"cat{pose}.off", "--pose", pose)
        self.sample("sphere", 500, "ball.off")

    def write_bends(self):
        for name, angle in ("a.off", 0.5), ("b.off", 2.5):
            arc(angle).write(self.path(name))

    def vertices(self, name):
        words = self.read(name).decode().split()
        count = int(words[1])
        return count, [float(w) for w in words[4:4 + 3 * count]], words[4 + 3 * count:]

    @unittest.skipUnless(shutil.which("tetgen"), "the program tetgen is not installed")
    def test_solid(self):
        """Maps of solids verify, carry points both ways, and are refuted when they are changed."""
        self.write_bends()
        report = self.run_json("map", "--solid", "a.off", "b.off", "-o", "map.vtu")
        self.assertLess(report["distortion"]["mean"], 2)
        self.run_text("verify", "a.off", "b.off", "map.vtu")
        self.run_text("verify", "a.off", "b.off", "map.vtu", "a.off", status=2)
        self.run_text("verify", "a.off", "a.off", "map.vtu", status=4)
        corner = "%r %r %r" % tuple(self.vertices("a.off")[1][:3])
        image = self.vertices("b.off")[1][:3]
        self.write("points.txt", corner + "\n")
        same = "map", "--solid", "a.off", "b.off", "--map", "map.vtu"
        self.run_text(*same, "--points", "points.txt", "--carried", "there.txt")
        self.assertEqual([float(w) for w in self.read("there.txt").split()], image)
        self.run_text(*same, "--points", "there.txt", "--back", "--carried", "back.txt")
        self.assertEqual([float(w) for w in self.read("back.txt").split()],
                         [float(w) for w in corner.split()])
        self.write("field.txt", corner + " 7\n")
        self.run_text(*same, "--apply", "field.txt", "--carried", "field_b.txt")
        self.assertEqual(float(self.read("field_b.txt").split()[3]), 7)
        self.write("field.txt", corner + " 7\n" + corner + "\n")
        self.run_text(*same, "--apply", "field.txt", "--carried", "none.txt", status=2)
        self.write("points.txt", "1e6 0 0\n")
        self.run_text(*same, "--points", "points.txt", "--carried", "none.txt", status=2)
        self.assertNotIn("none.txt", self.names())
        text = self.read("map.vtu").decode()
        start = text.index(">", text.index('Name="image"')) + 2
        self.write("forged.vtu", text[:start] + "9" + text[text.index(" ", start):])
        self.run_text("verify", "a.off", "b.off", "forged.vtu", status=4)
        self.write("cut.vtu", text[:start])
        self.run_text("verify", "a.off", "b.off", "cut.vtu", status=2)
        report = self.run_json("morph", "a.off", "b.off", "--frames", "3", "-o", "out", "--method",
                               "solid", "--certificate", "path.vtu")
        self.assertEqual(report["solid"]["inverted"], 0)
        self.run_text("verify", "a.off", "b.off", "path.vtu")

    def test_solid_usage(self):
        both = "map", "--solid", "cat0.off", "cat1.off"
        self.usage_error(*both, says="no output")
        self.usage_error(*both, "-o", "m.vtu", "--points", "p.txt", says="--carried")
        self.usage_error(*both, "-o", "m.vtu", "--back", says="--back needs")
        self.usage_error(*both, "-o", "m.vtu", "--to", "ball", says="A only")
        self.usage_error("map", "--solid", "cat0.off", "-o", "m.vtu", "--to", "ball", "--overlay",
                         says="leave out --to")
        self.usage_error("map", "cat0.off", "cat1.off", "-o", "m.json", "--to", "ball", says="--solid")
        self.usage_error("map", "cat0.off", "-o", "m.json", says="two models")
        self.usage_error("morph", "cat0.off", "cat1.off", "--frames", "2", "-o", "out",
                         "--certificate", "p.vtu", says="only method solid")

    def test_frames(self):
        for method in "star", "arap", "linear", "spherical":
            report = self.run_json("morph", "cat0.off", "cat1.off", "--frames", "3", "-o", method,
                                   "--method", method)
            self.assertEqual(sorted(os.listdir(self.path(method))),
                             [f"frame_{i:04d}.off" for i in range(3)])
            self.assertEqual([frame["t"] for frame in report["frames"]], [0, 0.5, 1])
            self.assertEqual(self.read(f"{method}/frame_0000.off"), self.read("cat0.off"))
            self.assertEqual(self.read(f"{method}/frame_0002.off"), self.read("cat1.off"))
            self.assertEqual(len(report["guards"]), len(report["counterparts"]))
            self.assertEqual(len(report["guards"]) > 0, method in ("star", "spherical"))

    def test_former_frames(self):
        """Frames that a longer morph left in the folder are named."""
        command = "morph", "cat0.off", "cat1.off", "-o", "used", "--method", "linear", "--frames"
        for frames, left in ("3", False), ("3", False), ("2", True):
            warned = self.run_text(*command, frames)[1]
            self.assertEqual("frame_0002.off and what follows are of an earlier morph" in warned, left)

    def test_guards(self):
        """Both files verify, and no fewer guards see both shapes than one alone."""
        for target, last in ("cat1.off", "cat1.off"), ("ball.off", "out/frame_0001.off"):
            report = self.run_json("morph", "cat0.off", target, "--frames", "2", "-o", "out",
                                   "--guards")
            results = [json.loads(self.read(f"out/guards_{end}.json")) for end in "ab"]
            for key, result in zip(("guards", "counterparts"), results):
                self.assertEqual([g["position"] for g in result["guards"]], report[key])
            self.assertEqual(results[1]["model"]["file"], last)
            self.run_text("verify", "cat0.off", "out/guards_a.json")
            self.run_text("verify", last, "out/guards_b.json")
            self.assertEqual(len(report["separate"]), 2)
        report = self.run_json("morph", "cat0.off", "cat1.off", "--frames", "2", "-o", "plain")
        self.assertNotIn("separate", report)
        self.assertNotIn("guards_a.json", os.listdir(self.path("plain")))

    @unittest.skipUnless(shutil.which("tetgen"), "the program tetgen is not installed")
    def test_pieces(self):
        """The same pieces of both solids, and both files verify."""
        self.write_bends()
        report = self.run_json("morph", "a.off", "b.off", "--frames", "2", "-o", "out", "--pieces")
        told = [json.loads(self.read(f"out/pieces_{end}.json")) for end in "ab"]
        for end, model in zip("ab", ("a.off", "b.off")):
            self.run_text("verify", model, f"out/pieces_{end}.vtk", f"out/pieces_{end}.json")
        self.assertEqual([t["strictly_star"] for t in told], report["pieces"]["strictly_star"])
        self.assertEqual([len(t["pieces"]) for t in told], 2 * [report["pieces"]["count"]])
        labels = [self.read(f"out/pieces_{end}.vtk").split(b"LOOKUP_TABLE")[1] for end in "ab"]
        self.assertEqual(*labels)
        lines = self.read("a.off").decode().split("\n")
        lines[2] = "9 9 9"
        self.write("crossed.off", "\n".join(lines))
        _, err = self.run_text("morph", "a.off", "crossed.off", "--frames", "2", "-o", "none",
                               "--pieces", status=2)
        self.assertIn("B in A's connectivity meets itself", err)

    def test_map(self):
        self.write("marks.txt", "# two\n3 5\n100 200\n")
        report = self.run_json("map", "cat0.off", "ball.off", "--landmarks", "marks.txt", "-o",
                               "map.json")
        self.assertEqual(report["landmarks"], 2)
        self.assertEqual(report["kind"], "sphere")
        file = json.loads(self.read("map.json"))
        self.assertEqual({key: report[key] for key in file}, file)
        points = file["points"]
        count, source, faces = self.vertices("cat0.off")
        self.assertEqual(len(points), count)
        self.run_text("morph", "cat0.off", "ball.off", "--map", "map.json", "--frames", "2", "-o",
                      "out", "--method", "arap")
        last, target = self.vertices("out/frame_0001.off"), self.vertices("ball.off")
        self.assertEqual(last[2], faces)
        for a, b in (3, 5), (100, 200):
            self.assertEqual(last[1][3 * a:3 * a + 3], target[1][3 * b:3 * b + 3])

    def verdict(self, *words, status=0):
        """The claims that do not hold, by result."""
        out, _ = self.run_text("verify", "cat0.off", *words, "--json", status=status)
        return [[c["claim"] for c in r["claims"] if not c["holds"]]
                for r in json.loads(out)["results"]]

    def test_overlay(self):
        """Both ends are the models, and everything verifies; what is spoilt does not."""
        self.write("marks.txt", "3 5\n100 200\n321 411\n")
        report = self.run_json("map", "cat0.off", "ball.off", "--landmarks", "marks.txt", "--overlay",
                               "-o", "map.json")
        self.assertGreater(len(report["overlay_points"]), 1000)
        report = self.run_json("map", "cat0.off", "ball.off", "--landmarks", "marks.txt", "-o",
                               "plain.json", "--picture", "map.png")
        self.assertNotIn("overlay_points", report)
        self.assertTrue(self.read("map.png").startswith(b"\x89PNG"))
        self.assertEqual(self.verdict("ball.off", "plain.json"), [[]])
        report = self.run_json("morph", "cat0.off", "ball.off", "--map", "map.json", "--overlay",
                               "--report", "--frames", "3", "-o", "out", "--method", "linear")
        self.assertEqual([report["frames"][i]["intersections"] for i in (0, -1)], [0, 0])
        told = json.loads(self.read("out/morph.json"))
        self.assertEqual({key: report[key] for key in told}, told)
        self.assertEqual(self.verdict("ball.off", "map.json", "out"), [[], []])
        self.run_text("view", "out", "-o", "page.html")
        self.assertIn(b"cat0.off to ball.off", self.read("page.html"))
        self.usage_error("view", "map.json", "-o", "other.html", says="--picture")
        # without a report only the ends
        os.rename(self.path("out/morph.json"), self.path("kept.json"))
        _, err = self.run_text("verify", "cat0.off", "ball.off", "out")
        self.assertIn("no morph.json", err)
        told["frames"][1]["intersections"] += 1
        told["frames"][2]["volume"] *= 1.0001
        self.write("out/morph.json", json.dumps(told))
        failed = self.verdict("ball.off", "out", status=4)[0]
        self.assertTrue(any("crossings" in text and "frame 1" in text for text in failed))
        self.assertTrue(any("volume" in text for text in failed))
        self.assertTrue(self.verdict("cat0.off", "out", status=4)[0])
        file = json.loads(self.read("map.json"))
        for key, at in ("overlay_points", 5), ("directions", 0), ("overlay_faces", 1):
            spoilt = json.loads(self.read("map.json"))
            spoilt[key][0][at] = 1 - spoilt[key][0][at]
            self.write("spoilt.json", json.dumps(spoilt))
            failed = (self.run_text("verify", "cat0.off", "ball.off", "spoilt.json", status=2)
                      if key == "overlay_faces" and spoilt[key][0][at] < 0
                      else self.verdict("ball.off", "spoilt.json", status=4)[0])
            self.assertTrue(failed)
        # without what lies between vertices there is no overlay, and not all is checked
        for key in "directions", "target_directions", "overlay_points", "overlay_faces":
            del file[key]
        self.write("points.json", json.dumps(file))
        out, _ = self.run_text("verify", "cat0.off", "ball.off", "points.json")
        self.assertIn("not checked: where the map takes what lies between", out)
        _, err = self.run_text("morph", "cat0.off", "ball.off", "--map", "points.json", "--overlay",
                               "--frames", "2", "-o", "none", status=2)
        self.assertIn("directions", err)
        self.assertNotIn("none", os.listdir(self.path(".")))

    def test_verified_poses(self):
        self.run_text("map", "cat0.off", "cat1.off", "-o", "map.json")
        self.run_text("morph", "cat0.off", "cat1.off", "--frames", "3", "-o", "out", "--report",
                      "--method", "linear", "--overlay")
        self.assertEqual(self.read("out/frame_0002.off"), self.read("cat1.off"))
        self.assertEqual(self.verdict("cat1.off", "map.json", "out"), [[], []])
        _, err = self.run_text("verify", "cat0.off", "map.json", status=1)
        self.assertIn("two models", err)
        _, err = self.run_text("verify", "cat0.off", "cat1.off", "out/morph.json", status=1)
        self.assertIn("folder", err)
        os.mkdir(self.path("empty"))
        _, err = self.run_text("verify", "cat0.off", "cat1.off", "empty", status=2)
        self.assertIn("frame_0000.off", err)

    def test_animation_and_picture(self):
        self.run_text("morph", "cat0.off", "cat1.off", "--frames", "4", "-o", "out", "--glb",
                      "cat.glb", "--picture", "cat.png")
        self.assertTrue(self.read("cat.png").startswith(b"\x89PNG"))
        data = self.read("cat.glb")
        magic, version, length, size, kind = struct.unpack("<4sIII4s", data[:20])
        self.assertEqual((magic, version, length, kind), (b"glTF", 2, len(data), b"JSON"))
        scene = json.loads(data[20:20 + size])
        binary, kind = struct.unpack("<I4s", data[20 + size:28 + size])
        self.assertEqual((binary, kind), (len(data) - 28 - size, b"BIN\0"))
        views, accessors = scene["bufferViews"], scene["accessors"]
        targets = scene["meshes"][0]["primitives"][0]["targets"]
        self.assertEqual(len(targets), 3)
        _, first, _ = self.vertices("cat0.off")
        _, last, _ = self.vertices("cat1.off")
        numbers = {}
        for i in 1, targets[-1]["POSITION"]:
            view = views[accessors[i]["bufferView"]]
            numbers[i] = struct.unpack_from(f"<{len(first)}f", data,
                                            28 + size + view["byteOffset"])
        center = scene["nodes"][0]["translation"]
        for i, (a, b) in enumerate(zip(first, last)):
            self.assertAlmostEqual(numbers[1][i] + center[i % 3], a, places=5)
            self.assertAlmostEqual(numbers[targets[-1]["POSITION"]][i], b - a, places=5)

    def test_bad_input(self):
        self.write("open.off", OPEN)
        self.write("tiny.off", TETRAHEDRON)
        self.run_text("sample", "torus", "--vertices", "600", "-o", "torus.off")
        self.write("far.txt", "0 999999\n")
        self.write("twice.txt", "0 1\n0 2\n")
        self.write("odd.txt", "1 2 3\n")
        names = self.names()
        for words, says in ((["torus.off", "ball.off"], "genus 1"),
                            (["ball.off", "open.off"], "disks"),
                            (["cat0.off", "ball.off", "--landmarks", "far.txt"], "line 1"),
                            (["cat0.off", "ball.off", "--landmarks", "twice.txt"], "same vertex"),
                            (["cat0.off", "ball.off", "--landmarks", "odd.txt"], "line 1"),
                            (["cat0.off", "ball.off", "--landmarks", "none.txt"], "none.txt"),
                            (["cat0.off", "none.off"], "none.off")):
            _, err = self.run_text("map", *words, "-o", "map.json", status=2)
            self.assertIn(says, err)
            _, err = self.run_text("morph", *words, "-o", "out", status=2)
            self.assertIn(says, err)
        self.run_text("map", "ball.off", "tiny.off", "-o", "other.json")
        _, err = self.run_text("morph", "cat0.off", "ball.off", "--map", "other.json", "-o", "out",
                               status=2)
        self.assertIn("another pair", err)
        self.assertEqual(self.names(), sorted(names + ["other.json"]))

    def test_usage(self):
        self.usage_error("map", "cat0.off", "ball.off", says="-o MAP.json")
        self.usage_error("map", "cat0.off", "-o", "m.json", says="two models are needed")
        self.usage_error("morph", "cat0.off", "cat1.off", says="-o DIR")
        self.usage_error("morph", "cat0.off", "cat1.off", "-o", "-", says="folder")
        self.usage_error("morph", "cat0.off", "cat1.off", "-o", "o", "--guards", "--method", "arap",
                         says="no guards")
        self.usage_error("morph", "cat0.off", "cat1.off", "-o", "o", "--frames", "1", says="frames")
        self.usage_error("morph", "cat0.off", "cat1.off", "-o", "o", "--method", "x", says="star")
        self.usage_error("morph", "cat0.off", "cat1.off", "-o", "o", "--glb", "x.gltf", says=".glb")
        self.usage_error("morph", "cat0.off", "cat1.off", "-o", "o", "--map", "m", "--landmarks",
                         "l", says="--landmarks")


if __name__ == "__main__":
    support.main()
