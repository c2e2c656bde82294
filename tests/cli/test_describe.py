# SPDX-License-Identifier: Apache-2.0
"""describe and match: descriptors there and back, distances, and what is refused."""
import json

import support


class Describe(support.Case):
    def describe(self, name="l-room", *more):
        model = self.sample(name)
        report = self.run_json("describe", model, "-o", f"{name}.json", "--effort", "1", *more)
        return report, json.loads(self.read(f"{name}.json"))

    def test_files(self):
        report, file = self.describe("torus", "--detail", "0", "--directions", "100", "--reconstruct", "points.ply",
                                     "--picture", "guards.png",
                                     "--histograms", "seen.svg")
        self.assertEqual({key: report[key] for key in file}, file)
        self.assertEqual(file["format"], "starguard-descriptor")
        self.assertEqual(file["version"], 5)
        self.assertEqual(file["model"]["file"], "torus.off")
        self.assertEqual({len(g["distances"]) for g in file["guards"]}, {100})
        points = report["reconstruction"]["points"]
        self.assertEqual(points, 100 * len(file["guards"]))
        self.assertLess(report["reconstruction"]["to_largest"], 1e-9)
        self.assertIn(b"element vertex %d\n" % points, self.read("points.ply"))
        drawn = self.read("seen.svg").decode()
        largest = sorted(range(len(file["guards"])), key=lambda i: (-file["guards"][i]["volume"], i))
        for i in largest[:8]:
            self.assertIn(f"guard {i}<", drawn)
        self.assertEqual(drawn.count("guard "), min(8, len(largest)))
        self.assertEqual(self.read("guards.png")[:8], b"\x89PNG\r\n\x1a\n")

    def test_same_bytes_on_any_threads(self):
        model = self.sample("torus")
        out = [self.run_bytes("describe", model, "-o", "-", "--quiet", "--threads", n)[0]
               for n in "14"]
        self.assertEqual(out[0], out[1])

    def test_refused(self):
        self.write("flat.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n")
        before = self.names()
        self.run_text("describe", "flat.off", "-o", "a.json", status=2)
        self.run_text("describe", "missing.off", "-o", "a.json", status=2)
        self.assertEqual(self.names(), before)
        self.usage_error("describe", "flat.off", says="FILE.json")
        self.usage_error("describe", "flat.off", "-o", "a.json", "--directions", "3",
                         says="directions")


class Match(support.Case):
    def test_models_and_descriptors(self):
        for name in "torus", "l-room":
            self.run_text("describe", self.sample(name), "-o", f"{name}.json")
        for distance in "star", "paper":
            found = [self.run_json("match", a, b, "--distance", distance)
                     for a in ("torus.json", "torus.off") for b in ("l-room.json", "l-room.off")]
            self.assertEqual(found[0]["format"], "starguard-match")
            self.assertEqual(found[0]["kind"], distance)
            self.assertEqual(len({m["distance"] for m in found}), 1)
            self.assertGreater(found[0]["distance"], 0)
            same = self.run_json("match", "torus.json", "torus.off", "--distance", distance)
            self.assertEqual(same["distance"], 0)
        by_pipe = self.run_json("match", "-", "torus.off", input=self.read("torus.json"))
        self.assertEqual(by_pipe["distance"], 0)
        self.run_json("match", "torus.off", "l-room.off", "--distance", "d2")

    def test_older_descriptors_are_named(self):
        self.run_text("describe", self.sample("torus"), "-o", "new.json", "--effort", "1")
        text = self.read("new.json").decode()
        self.assertIn('"version": 5,', text)
        self.write("old.json", text.replace('"version": 5,', '"version": 4,'))
        _, err = self.run_text("match", "new.json", "new.json")
        self.assertNotIn("version", err)
        _, err = self.run_text("match", "old.json", "new.json")
        self.assertIn("old.json has version 4", err)
        self.assertNotIn("new.json", err)

    def test_refused(self):
        self.run_text("describe", self.sample("torus"), "-o", "torus.json", "--effort", "1")
        out, err = self.run_text("match", "torus.json", "torus.off", "--distance", "shape-dna",
                                 status=1)
        self.assertIn("is a descriptor", err)
        self.write("broken.json", "{\"format\": \"starguard-descriptor\"}")
        _, err = self.run_text("match", "broken.json", "torus.off", status=2)
        self.assertIn("broken.json", err)
        self.usage_error("match", "torus.off", says="too few arguments")


if __name__ == "__main__":
    support.main()
