# SPDX-License-Identifier: Apache-2.0
"""The package gives what the command line gives, to the byte."""
import json

import numpy as np

import starguard
from support import Case, main


class Same(Case):
    def model(self, name="gallery", vertices=800):
        self.cli("sample", name, "--vertices", vertices, "-o", f"{name}.off", "--quiet")
        return f"{name}.off"

    def test_samples(self):
        for name, pose in (("horse", 0), ("dog", 3), ("knot", 0)):
            self.cli("sample", name, "--pose", pose, "--vertices", 700, "-o", "a.ply", "--quiet")
            starguard.sample(name, pose=pose, vertices=700).write("b.ply")
            self.assertEqual(self.read("a.ply"), self.read("b.ply"))
        told = json.loads(self.cli("sample", "--list", "--json"))["samples"]
        self.assertEqual([(s["name"], s["description"], s["poses"]) for s in told],
                         [(s.name, s.description, s.poses) for s in starguard.samples()])

    def test_guards(self):
        model = self.model("gallery", 500)
        for words, options in (([], {}), (["--method", "ilp"], {"method": "ilp"}),
                               (["--method", "greedy", "--candidates", "interior"],
                                {"method": "greedy", "candidates": "interior"}),
                               (["--coverage", "0.9", "--range", "3", "--clearance", "0.05"],
                                {"coverage": 0.9, "range": 3, "clearance": 0.05}),
                               (["--target", "vertices", "--redundancy", "2", "--seed", "7"],
                                {"target": "vertices", "redundancy": 2, "seed": 7}),
                               (["--cone", "120", "--max-guards", "4"],
                                {"cone": 120, "max_guards": 4})):
            with self.subTest(words=words):
                self.cli("guard", model, "-o", "a.json", "--quiet", "--count", 200, *words)
                found = starguard.guard(model, count=200, **options)
                found.write("b.json")
                self.assertEqual(self.read("a.json"), self.read("b.json"))
                told = json.loads(self.read("a.json"))
                self.assertEqual(found.positions.tolist(), [g["position"] for g in told["guards"]])
                self.assertEqual(found.uncovered.tolist(), told["coverage"]["uncovered_faces"])
                self.assertEqual(found.lower_bound, told["lower_bound"])

    def test_decomposition(self):
        model = self.model("l-room", 500)
        for words, options in ((["--effort", "30"], {"effort": 30}),
                               (["--mode", "paper"], {"mode": "paper"})):
            with self.subTest(words=words):
                self.cli("decompose", model, "-o", "a.vtk", "--report", "a.json", "--quiet", *words)
                pieces = starguard.decompose(model, **options)
                pieces.write("b.vtk")
                pieces.write_report("b.json")
                self.assertEqual(self.read("a.vtk"), self.read("b.vtk"))
                self.assertEqual(self.read("a.json"), self.read("b.json"))
                told = json.loads(self.read("a.json"))
                self.assertEqual(pieces.guards.tolist(), [p["guard"] for p in told["pieces"]])
                again = starguard.decompose(starguard.TetMesh.read("a.vtk"), **options)
                self.assertAlmostEqual(again.mesh.volume, pieces.mesh.volume)

    def test_skeleton(self):
        model = self.model("torus", 500)
        self.cli("skeleton", model, "-o", "a.vtk", "--nodes", 60, "--quiet")
        starguard.skeleton(model, nodes=60).write("b.vtk")
        self.assertEqual(self.read("a.vtk"), self.read("b.vtk"))

    def test_visible_and_kernel(self):
        model = self.model()
        told = json.loads(self.cli("visible", model, "--from", "1,1,1", "--from", "3,1,1", "--faces",
                                   "whole", "--json"))
        seen = starguard.visible(model, [[1, 1, 1], [3, 1, 1]], faces="whole")
        self.assertEqual([seen.indices(i).tolist() for i in range(2)],
                         [point["faces"] for point in told["points"]])
        self.assertEqual(starguard.Solid(model).contains([[1, 1, 1], [3, 1, 1]]).tolist(),
                         [point["inside"] for point in told["points"]])
        told = json.loads(self.cli("kernel", model, "--json"))
        kernel = starguard.kernel(model)
        self.assertEqual((kernel.verdict, kernel.star, kernel.witness.tolist(), kernel.radius),
                         (told["verdict"], told["star"], told["witness"], told["radius"]))

    def test_check(self):
        starguard.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]],
                       [[0, 2, 1], [0, 1, 3], [0, 3, 2]]).write("open.off")
        told = json.loads(self.cli("check", "open.off", "--json", status=2))
        check = starguard.Mesh.read("open.off").check()
        self.assertEqual((check.usable, check.closed, check.edges, check.components, check.area),
                         tuple(told[key] for key in ("usable", "closed", "edges", "components", "area")))
        self.assertEqual({name.replace(" ", "_").replace("-", ""): found.first.tolist()
                          for name, found in check.findings.items()},
                         {name: np.reshape(found["first"], (-1, 2)).tolist()
                          for name, found in told["findings"].items()})

    def test_shapes(self):
        a, b = self.model("l-room", 520), self.model("star", 520)
        self.cli("describe", a, "-o", "a.json", "--quiet")
        starguard.describe(a).write("b.json")
        self.assertEqual(self.read("a.json"), self.read("b.json"))
        starguard.describe(b).write("c.json")
        for kind, first, second in (("star", a, b), ("paper", "b.json", "c.json"), ("shape-dna", a, b),
                                    ("d2", a, b)):
            told = json.loads(self.cli("match", first, second, "--distance", kind, "--json"))
            self.assertEqual(starguard.match(first, second, kind), told["distance"])
        self.assertEqual(starguard.match("b.json", b), starguard.match("b.json", "c.json"))

    def test_databases(self):
        files = [self.model(name, 520) for name in ("l-room", "star", "torus")]
        self.cli("db", "create", "a.db", "--quiet")
        self.cli("db", "add", "a.db", *files, "--quiet")
        with starguard.Database.create("b.db") as ours:
            ours.add(files)
            self.cli("db", "matrix", "a.db", "-o", "a.csv", "--distance", "d2", "--quiet")
            table = np.genfromtxt("a.csv", delimiter=",", skip_header=1)[:, 1:]
            self.assertTrue((table == ours.distances("d2")).all())
            found = ours.query(files[1], 2, "d2")
            told = json.loads(self.cli("db", "query", "a.db", files[1], "--count", 2, "--distance",
                                       "d2", "--json"))
            self.assertEqual([model.path for model in found], [m["path"] for m in told["models"]])
            with open("classes.txt", "w", encoding="utf-8") as file:
                file.write("l-room.off flat\ntorus.off flat\n")
            overall, by_class = ours.evaluate("classes.txt", "d2")
            told = json.loads(self.cli("db", "evaluate", "a.db", "--classes", "classes.txt",
                                       "--distance", "d2", "--json"))
            self.assertEqual(overall.dcg, told["dcg"])
            self.assertEqual(list(by_class), list(told["classes"]))
            self.assertEqual(ours.models().classes("classes.txt"), ["flat", None, "flat"])
            self.assertEqual(ours.models().classes(), ["l-room.off", "star.off", "torus.off"])
            ours.remove(["star.off"])
            self.assertEqual([m.name for m in ours.models()], ["l-room.off", "torus.off"])

    def test_morph(self):
        for pose in (0, 1):
            self.cli("sample", "dog", "--pose", pose, "--vertices", 500, "-o", f"{pose}.off", "--quiet")
        self.cli("map", "0.off", "1.off", "-o", "a.json", "--quiet")
        poses = starguard.map_surface("0.off", "1.off")
        poses.write("b.json")
        self.assertEqual(self.read("a.json"), self.read("b.json"))
        self.cli("morph", "0.off", "1.off", "--frames", 3, "-o", "frames", "--quiet")
        starguard.Morph("0.off", poses).frame(0.5).write("half.off")
        self.assertEqual(self.read("frames/frame_0001.off"), self.read("half.off"))

    def test_verify(self):
        model = self.model("l-room", 500)
        self.cli("guard", model, "-o", "g.json", "--quiet")
        told = json.loads(self.cli("verify", model, "g.json", "--json"))["results"][0]
        verdict = starguard.verify(model, "g.json")
        self.assertEqual([(c.text, c.holds) for c in verdict.claims],
                         [(c["claim"], c["holds"]) for c in told["claims"]])
        self.cli("guard", model, "-o", "proven.json", "--prove", "--certificate", "why.txt", "--quiet")
        guards = starguard.guard(model, prove=True, certificate="same.txt")
        self.assertEqual(self.read("why.txt"), self.read("same.txt"))
        told = json.loads(self.cli("verify", model, "proven.json", "why.txt", "--json"))["results"][0]
        verdict = starguard.verify(model, guards, "same.txt")
        self.assertEqual([c.text for c in verdict.claims], [c["claim"] for c in told["claims"]])
        self.assertTrue(verdict)
        lie = json.loads(self.read("g.json"))
        lie["guards"][0]["faces"] += 1
        verdict = starguard.verify(model, starguard.Guards.from_bytes(json.dumps(lie).encode()))
        self.assertFalse(verdict)
        self.assertFalse(all(claim.holds for claim in verdict.claims))


if __name__ == "__main__":
    main()
