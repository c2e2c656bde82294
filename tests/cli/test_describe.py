# SPDX-License-Identifier: Apache-2.0
"""describe and match: descriptors there and back, distances, and what is refused."""
import json
import math
import random

import support


def surface(text):
    """Vertices and triangles of an OFF file."""
    lines = text.decode().split("\n")
    count, faces, _ = map(int, lines[1].split())
    return ([tuple(map(float, line.split())) for line in lines[2:2 + count]],
            [tuple(map(int, line.split()[1:])) for line in lines[2 + count:2 + count + faces]])


def copy(text, dice, scale, mirrored):
    """A model, moved and scaled, its vertices and faces in another order; the mirror image, its fronts outside."""
    points, faces = surface(text)
    q = [dice.gauss(0, 1) for _ in range(4)]
    w, x, y, z = (number / math.hypot(*q) for number in q)
    turn = [(1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)),
            (2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)),
            (2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y))]
    shift = [dice.uniform(-5, 5) for _ in range(3)]
    order = list(range(len(points)))
    dice.shuffle(order)
    place = {old: new for new, old in enumerate(order)}
    lines = []
    for old in order:
        p = [-c if mirrored and k == 1 else c for k, c in enumerate(points[old])]
        lines.append(" ".join(repr(scale * sum(map(lambda a, b: a * b, row, p)) + move)
                              for row, move in zip(turn, shift)))
    for a, b, c in dice.sample(faces, len(faces)):
        lines.append("3 %d %d %d" % tuple(place[v] for v in ((a, c, b) if mirrored else (a, b, c))))
    return f"OFF\n{len(points)} {len(faces)} 0\n" + "\n".join(lines) + "\n"


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


class Align(support.Case):
    """Scale and hand of copies that are made here, so that both are known."""

    def align(self, a, b, *words):
        return self.run_json("match", a, b, "--distance", "d2", "--align", *words)

    def test_copies(self):
        dice = random.Random(7)
        for name, pose, decided in (("horse", 2, True), ("knot", 0, True), ("polycube", 1, True), ("spikes", 0, True),
                                    ("human", 0, False), ("torus", 0, False), ("l-room", 0, False),
                                    ("star", 0, False))[::1 if support.LONG else 4]:
            model = self.sample(name, 520, None, "--pose", str(pose))
            for mirrored in False, True:
                scale = 10 ** dice.uniform(-3, 3)
                self.write("copy.off", copy(self.read(model), dice, scale, mirrored))
                told = self.align(model, "copy.off")["alignment"]
                self.assertAlmostEqual(told["scale"] / scale, 1, 9, name)
                self.assertEqual(told["hand"], ("mirrored" if mirrored else "same") if decided else "undecided", name)
                if decided:
                    self.assertLess(told["mirrored" if mirrored else "same"], 3e-3, name)
                if not mirrored and not support.LONG:
                    continue
                back = self.align("copy.off", model)["alignment"]
                self.assertEqual(back["hand"], told["hand"], name)
                self.assertAlmostEqual(back["scale"] * scale, 1, 9, name)

    def test_other_triangles(self):
        """A copy of another resolution is one, too."""
        self.write("copy.off", copy(self.read(self.sample("knot", 2000)), random.Random(1), 3, True))
        told = self.align(self.sample("knot", 520), "copy.off")["alignment"]
        self.assertEqual(told["hand"], "mirrored")
        self.assertAlmostEqual(told["scale"], 3, 1)
        self.assertLess(told["mirrored"], 0.01)

    def test_no_copies(self):
        """Shapes that differ, and poses of one, have no hand."""
        told = self.align(self.sample("knot"), self.sample("horse"))["alignment"]
        self.assertEqual(told["hand"], "undecided")
        self.assertGreater(min(told["same"], told["mirrored"]), 0.02)

    def test_weights(self):
        knot = self.sample("knot")
        self.write("copy.off", copy(self.read(knot), random.Random(5), 4, True))
        plain = self.run_json("match", knot, "copy.off", "--distance", "d2")
        self.assertNotIn("alignment", plain)
        weighed = self.align(knot, "copy.off", "--weigh-scale", "0.5", "--weigh-mirror", "3")
        self.assertAlmostEqual(weighed["distance"] - plain["distance"], 0.5 * 2 + 3, 9)
        self.usage_error("match", knot, "copy.off", "--weigh-mirror", "3", says="--align")
        self.run_text("describe", knot, "-o", "knot.json", "--effort", "1")
        _, err = self.run_text("match", "knot.json", knot, "--align", status=1)
        self.assertIn("needs the model", err)

    def test_query(self):
        knot = self.sample("knot")
        dice = random.Random(9)
        self.write("mirrored.off", copy(self.read(knot), dice, 1, True))
        self.write("large.off", copy(self.read(knot), dice, 8, False))
        self.write("gone.off", copy(self.read(knot), dice, 2, False))
        self.run_text("db", "create", "d.db", "--quiet")
        self.run_text("db", "add", "d.db", "mirrored.off", "large.off", "gone.off", "--quiet")
        words = ["db", "query", "d.db", knot, "--distance", "shape-dna", "--align"]
        with open(self.path("gone.off"), "w", encoding="ascii"):
            pass
        for more, first in ((("--weigh-scale", "9"), "mirrored.off"),
                            (("--weigh-mirror", "90", "--weigh-scale", "9"), "large.off")):
            found = [m for m in json.loads(self.run_text(*words, *more, "--json")[0])["models"] if m["name"] != "gone.off"]
            self.assertEqual([m["name"] for m in found][0], first)
        models = {m["name"]: m for m in json.loads(self.run_text(*words, "--json")[0])["models"]}
        self.assertEqual(models["mirrored.off"]["alignment"]["hand"], "mirrored")
        self.assertEqual(models["large.off"]["alignment"]["hand"], "same")
        self.assertAlmostEqual(models["large.off"]["alignment"]["scale"], 8, 9)
        self.assertIsNone(models["gone.off"]["alignment"])
        out, _ = self.run_text(*words)
        self.assertIn("not aligned", out)
        self.assertIn("hand mirrored", out)


if __name__ == "__main__":
    support.main()
