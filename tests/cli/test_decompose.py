# SPDX-License-Identifier: Apache-2.0
"""Star decomposition: files that agree with each other, models of every kind, failures that leave
nothing behind."""
import json
import os

import support
from support import OPEN, TETRAHEDRON

MEDIT = """MeshVersionFormatted 2
Dimension 3
Vertices
5
0 0 0 0
1 0 0 0
0 1 0 0
0 0 1 0
1 1 1 0
Tetrahedra
2
1 2 3 4 0
2 3 4 5 0
End
"""


class Decompose(support.Case):
    def setUp(self):
        super().setUp()
        self.write("m.off", TETRAHEDRON)
        self.write("m.mesh", MEDIT)

    def grid(self, name):
        """Points, tetrahedra and labels of a VTK file as text."""
        words = self.read(name).decode().split()
        at = words.index("POINTS")
        count = int(words[at + 1])
        numbers = list(map(float, words[at + 3:at + 3 + 3 * count]))
        points = [numbers[i:i + 3] for i in range(0, 3 * count, 3)]
        at = words.index("CELLS")
        cells = int(words[at + 1])
        rows = list(map(int, words[at + 3:at + 3 + 5 * cells]))
        tets = [rows[i + 1:i + 5] for i in range(0, 5 * cells, 5)]
        at = words.index("LOOKUP_TABLE")
        self.assertEqual(words[at - 4:at + 2],
                         ["SCALARS", "piece", "int", "1", "LOOKUP_TABLE", "default"])
        return points, tets, list(map(int, words[at + 2:at + 2 + cells]))

    def volume(self, points, tet):
        a, b, c, d = (points[i] for i in tet)
        u, v, w = ([p[k] - a[k] for k in range(3)] for p in (b, c, d))
        return (u[0] * (v[1] * w[2] - v[2] * w[1]) + u[1] * (v[2] * w[0] - v[0] * w[2])
                + u[2] * (v[0] * w[1] - v[1] * w[0])) / 6

    def agree(self, grid, report):
        """The two files tell of the same pieces."""
        points, tets, labels = self.grid(grid)
        result = json.loads(self.read(report))
        self.assertEqual(result["format"], "starguard-pieces")
        self.assertEqual(result["version"], 1)
        self.assertEqual(result["tetrahedra"], len(tets))
        volumes, counts = {}, {}
        for tet, label in zip(tets, labels):
            size = self.volume(points, tet)
            self.assertGreater(size, 0)
            volumes[label] = volumes.get(label, 0) + size
            counts[label] = counts.get(label, 0) + 1
        self.assertEqual(sorted(counts), list(range(len(result["pieces"]))))
        for label, piece in enumerate(result["pieces"]):
            self.assertEqual(piece["tetrahedra"], counts[label])
            self.assertAlmostEqual(piece["volume"], volumes[label])
            if piece["star"]:
                self.assertGreater(piece["radius"], 0)
        self.assertEqual(result["strictly_star"], sum(p["star"] for p in result["pieces"]))
        for i, j, area in result["adjacency"]:
            self.assertLess(i, j)
            self.assertGreater(area, 0)
        return result

    def test_filling_needs_a_bound(self):
        """Two triangles opposite each other are not filled unless that is asked for."""
        self.write("two.off", "OFF\n6 2 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 0 1\n0 1 1\n"
                              "3 0 2 1\n3 3 4 5\n")
        _, err = self.run_text("decompose", "two.off", "-o", "p.vtk", "--effort", "1", status=2)
        self.assertIn("diagonal", err)
        self.assertIn("--fill", err)
        self.assertNotIn("p.vtk", self.names())
        self.run_text("decompose", "two.off", "-o", "p.vtk", "--effort", "1", "--fill")
        self.assertIn("p.vtk", self.names())

    def test_nothing_inside(self):
        """A tilted triangle and its back, and doubled faces, are told at once."""
        self.write("flat.off", "OFF\n3 2 0\n0 0 0\n1 .3 .7\n.2 1 .9\n3 0 1 2\n3 0 2 1\n")
        self.write("double.off", "OFF\n4 6 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n"
                                 "3 0 1 2\n3 0 2 1\n3 0 1 3\n3 0 3 1\n3 0 2 3\n3 0 3 2\n")
        for name in ("flat.off", "double.off"):
            _, err = self.run_text("decompose", name, "-o", "p.vtk", status=2)
            self.assertRegex(err, "encloses no volume|nothing is inside")

    def test_thin(self):
        """A plate far thinner than the finest lattice is cut as it is; where tetrahedra must fill it, it is
        refused at once, by what is wrong with it."""
        self.write("plate.off", "OFF\n8 12 0\n" + "".join(
            f"{x} {y} {z}\n" for z in ("0", "1e-8") for y in (0, 8) for x in (0, 8)) +
            "3 0 2 1\n3 1 2 3\n3 4 5 6\n3 5 7 6\n3 0 1 4\n3 1 5 4\n"
            "3 2 6 3\n3 3 6 7\n3 0 4 2\n3 2 4 6\n3 1 3 5\n3 3 7 5\n")
        _, err = self.run_text("decompose", "plate.off", "-o", "p.vtk", "--mode", "paper", status=3,
                               environment={"PATH": "/nowhere"})
        self.assertIn("too thin", err)
        self.assertNotIn("p.vtk", self.names())
        self.run_text("decompose", "plate.off", "-o", "p.vtk", "--report", "p.json")
        self.assertEqual(len(self.agree("p.vtk", "p.json")["pieces"]), 1)

    def test_needs_no_program(self):
        """The surface is kept, and nothing is said of programs that could be there."""
        model = self.sample("gallery")
        out, err = self.run_text("decompose", model, "-o", "p.vtk", "--report", "p.json",
                                 "--effort", "1", environment={"PATH": "/nowhere"})
        self.assertEqual(self.agree("p.vtk", "p.json")["surface"], "kept")
        self.assertNotIn("tetgen", (out + err).lower())
        self.run_text("verify", model, "p.vtk", "p.json")

    def test_balls(self):
        """Maps to balls stand in the file, are verified, and are missed when they are spoiled."""
        model = self.sample("horse")
        base = ("decompose", model, "-o", "p.vtk", "--report", "p.json", "--effort", "5")
        self.run_text(*base)
        plain = self.read("p.vtk")
        for words, kind in ((("--balls",), "rays"), (("--balls", "even"), "even")):
            out, _ = self.run_text(*base, *words)
            self.assertIn("no tetrahedron inverted", out)
            self.assertEqual(self.agree("p.vtk", "p.json")["balls"]["kind"], kind)
            self.assertTrue(self.read("p.vtk").startswith(plain))
            self.assertIn("positive images", self.run_text("verify", "--verbose", model, "p.json", "p.vtk")[0])
        lines = self.read("p.vtk").decode().split("\n")
        first = next(i for i, line in enumerate(lines) if line.startswith("ball 12")) + 1
        numbers = lines[first].split()
        turned = numbers[3:6] + numbers[:3] + numbers[6:]
        away = [repr(1.5 * float(x)) for x in numbers]
        for spoiled, said in ((turned, "positive images"), (away, "spheres")):
            self.write("q.vtk", "\n".join(lines[:first] + [" ".join(spoiled)] + lines[first + 1:]))
            self.assertIn(said, self.run_text("verify", model, "p.json", "q.vtk", status=4)[0])
        self.write("q.vtk", "\n".join(lines[:first - 2]) + "\n")
        self.assertIn("agree", self.run_text("verify", model, "p.json", "q.vtk", status=4)[0])
        _, err = self.run_text(*base, "--balls", "--mode", "paper", status=1)
        self.assertIn("--mode strict", err)

    def test_thin_tetrahedra_of_cuts(self):
        """Cuts get vertices within where their triangles are thin: 0.045 degrees without."""
        model = self.sample("cat", 500)
        result = self.run_json("decompose", model, "-o", "p.vtk", "--effort", "30")
        self.assertGreater(result["smallest_angle"], 0.06)

    def test_no_time(self):
        """However short the time, there are pieces, all star-shaped."""
        model = self.sample("gallery")
        report = self.run_json("decompose", model, "-o", "p.vtk", "--report", "p.json",
                               "--time-limit", "1")
        self.assertEqual(report["surface"], "kept")
        self.assertEqual(report["strictly_star"], len(report["pieces"]))
        self.run_text("verify", model, "p.vtk", "p.json")

    def test_strict(self):
        room = self.sample("l-room")
        report = self.run_json("decompose", room, "-o", "p.vtk", "--report", "p.json",
                               "--density", "3", "--effort", "100")
        result = self.agree("p.vtk", "p.json")
        self.assertEqual(result["mode"], "strict")
        self.assertEqual({key: report[key] for key in result}, result)
        self.assertTrue(all(piece["star"] for piece in result["pieces"]))
        self.assertEqual(result["visible_vertices"], 1)
        self.assertEqual(report["contacts"], len(result["adjacency"]))

    def test_paper(self):
        room = self.sample("l-room")
        for threads in "1", "3":
            self.run_text("decompose", room, "-o", f"{threads}.vtk", "--report",
                          f"{threads}.json", "--mode", "paper", "--density", "5",
                          "--threads", threads)
        self.assertEqual(self.read("1.vtk"), self.read("3.vtk"))
        self.assertEqual(self.read("1.json"), self.read("3.json"))
        result = self.agree("1.vtk", "1.json")
        self.assertEqual(result["mode"], "paper")
        self.assertGreater(result["visible_vertices"], 0.99)
        self.run_text("guard", room, "-o", "g.json", "--count", "100")
        self.run_text("decompose", room, "-o", "g.vtk", "--report", "p.json", "--mode", "paper",
                      "--density", "5", "--guards", "g.json", "--max-pieces", "1")
        self.assertEqual(len(self.agree("g.vtk", "p.json")["pieces"]), 1)

    def test_tetrahedra(self):
        wanted = {"file": "m.mesh", "vertices": 5, "tetrahedra": 2}
        for words in ["m.mesh"], ["--tets", "m.mesh"]:
            report = self.run_json("decompose", *words, "-o", "p.vtk", "--report", "p.json",
                                   "--mode", "paper")
            self.assertEqual(report["model"], wanted)
            self.assertEqual(self.agree("p.vtk", "p.json")["model"], wanted)
            self.assertEqual(report["surface"], "kept")
            self.assertAlmostEqual(report["volume"], 0.5)
        self.write("flat.mesh", MEDIT.replace("1 2 3 4 0", "1 2 3 3 0"))
        _, err = self.run_text("decompose", "flat.mesh", "-o", "q.vtk", status=2)
        self.assertIn("no volume", err)

    def test_standard_streams(self):
        out, err = self.run_text("decompose", "-", "-o", "-", input=TETRAHEDRON.encode())
        self.assertTrue(out.startswith("# vtk DataFile"))
        self.assertIn("pieces", err)
        out, _ = self.run_text("decompose", "-", "-o", "-", "--mode", "paper",
                               input=MEDIT.encode())
        self.assertIn("CELLS 2 10", out)
        self.run_text("decompose", "-", "-o", "p.vtk", input=b"", status=2)

    def test_open_surface(self):
        lines = self.read(self.sample("torus")).decode().splitlines()
        vertices, faces, _ = map(int, lines[1].split())
        lines[1] = f"{vertices} {faces - 3} 0"
        self.write("open.off", "\n".join(lines[:2 + vertices + faces - 3]) + "\n")
        report = self.run_json("decompose", "open.off", "-o", "p.vtk", "--report", "p.json",
                               "--mode", "paper", "--density", "4")
        result = self.agree("p.vtk", "p.json")
        self.assertEqual(result["surface"], "approximated")
        for key in "distance", "distance_back":
            self.assertEqual(result[key], report[key])
            self.assertGreater(result[key], 0)
        self.assertEqual(result["model"]["faces"], faces - 3)
        self.assertTrue(any("stuffing" in line["message"] for line in report["log"]))

    def test_self_intersecting(self):
        """Two tetrahedra that run through one another: closed, but not embedded."""
        lines = TETRAHEDRON.splitlines()
        moved = [" ".join(f"{float(x) + .1:g}" for x in line.split()) for line in lines[2:6]]
        faces = lines[6:] + ["3 " + " ".join(str(int(i) + 4) for i in line.split()[1:])
                             for line in lines[6:]]
        self.write("two.off", "\n".join(["OFF", "8 8 12"] + lines[2:6] + moved + faces) + "\n")
        for mode in "strict", "paper":
            report = self.run_json("decompose", "two.off", "-o", "p.vtk", "--report", "p.json",
                                   "--mode", mode, "--density", "40", "--effort", "100")
            result = self.agree("p.vtk", "p.json")
            self.assertEqual(result["surface"], "approximated")
            strict = mode == "strict"
            self.assertNotEqual(any("stuffing" in line["message"] for line in report["log"]), strict)
            self.assertEqual("faces_kept" in result, strict)
            if strict:  # three faces of one are clear of the other, and one of that
                self.assertEqual(result["faces_kept"], 4)
                self.assertLess(result["distance"], 1e-12)
                self.assertGreater(result["distance_back"], .01)
            self.run_text("verify", "two.off", "p.vtk", "p.json")

    def test_quiet_warns_of_another_surface(self):
        """Pieces that are not of the given surface are told of whatever the options are."""
        self.write("closed.off", TETRAHEDRON)
        self.write("open.off", OPEN)
        for model, reason in [("closed.off", "approximates"), ("open.off", "open")]:
            with self.subTest(model=model):
                words = ["decompose", model, "-o", "p.vtk", "--mode", "paper", "--fill"]
                out, err = self.run_text(*words, "--quiet")
                self.assertEqual(out, "")
                self.assertEqual(err.count("warning:"), 1, err)
                self.assertIn(reason, err)
                self.assertIn("stuffing", err)
                if model == "open.off":
                    _, told = self.run_text("describe", model, "-o", "d.json", "--quiet")
                    self.assertIn("warning: the surface bounds no solid", told)
                log = self.run_json(*words)["log"]
                self.assertEqual([line["level"] for line in log if "stuffing" in line["message"]],
                                 ["warning"])

    def test_surfaces_and_picture(self):
        room = self.sample("l-room")
        report = self.run_json("decompose", room, "-o", "p.vtk", "--mode", "paper", "--density",
                               "5", "--surfaces", "parts", "--picture", "p.png")
        count = len(report["pieces"])
        names = sorted(os.listdir(self.path("parts")))
        self.assertEqual(names, [f"piece_{i:04d}.ply" for i in range(count)] + ["pieces.obj"])
        total = 0
        for i in range(count):
            piece = self.run_json("check", f"parts/piece_{i:04d}.ply")
            total += piece["volume"]
            self.assertAlmostEqual(piece["volume"], report["pieces"][i]["volume"])
            self.assertIn(b"property uchar red", self.read(f"parts/piece_{i:04d}.ply"))
        self.assertAlmostEqual(total, report["volume"])
        groups = [line for line in self.read("parts/pieces.obj").decode().splitlines()
                  if line.startswith("g ")]
        self.assertEqual(groups, [f"g piece_{i:04d}" for i in range(count)])
        self.assertTrue(self.read("p.png").startswith(b"\x89PNG"))
        # again, into the folder that is there now
        self.run_text("decompose", "m.off", "-o", "p.vtk", "--surfaces", "parts")

    def test_binary(self):
        self.run_text("decompose", "m.mesh", "-o", "b.vtk", "--binary", "--mode", "paper")
        self.assertIn(b"\nBINARY\n", self.read("b.vtk"))
        self.run_text("decompose", "b.vtk", "-o", "t.vtk", "--mode", "paper")
        self.run_text("decompose", "m.mesh", "-o", "u.vtk", "--mode", "paper")
        self.assertEqual(self.read("t.vtk"), self.read("u.vtk"))

    def test_leaves_nothing(self):
        names = self.names()
        self.write("closed", "")
        self.run_text("decompose", "none.off", "-o", "p.vtk", "--surfaces", "parts", status=2)
        self.run_text("decompose", "m.off", "-o", "no/p.vtk", "--surfaces", "parts", status=3)
        self.run_text("decompose", "m.off", "-o", "p.vtk", "--surfaces", "closed", status=3)
        self.run_text("decompose", "m.off", "-o", "p.vtk", "--surfaces", "no/parts", status=3)
        self.run_text("decompose", "m.off", "-o", "p.vtk", "--guards", "none.json", status=2)
        self.assertEqual(self.names(), sorted(names + ["closed"]))

    def test_usage(self):
        self.usage_error("decompose", "m.off", says="-o PIECES.vtk")
        self.usage_error("decompose", "-o", "p.vtk", says="--tets")
        self.usage_error("decompose", "m.off", "--tets", "m.mesh", "-o", "p.vtk", says="--tets")
        self.usage_error("decompose", "m.off", "-o", "p.vtk", "--mode", "papr", says="paper")
        self.usage_error("decompose", "m.off", "-o", "p.vtk", "--picture", "p.jpg", says=".png")


if __name__ == "__main__":
    support.main()
