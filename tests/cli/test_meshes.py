# SPDX-License-Identifier: Apache-2.0
"""Meshes as people have them: voxel bodies with T-junctions, solids to be united, formats of scenes."""
import io
import itertools
import json
import os
import random
import shutil
import subprocess
import sys
import zipfile

from support import BUILD, LONG, Case, main
from test_coordinates import boxes, off

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "bench"))
import families  # noqa: E402


class Families(Case):
    """Small parts of the families of bench/families.py, with its own counts of volume and area."""

    def check_case(self, case, *options):
        families.write(self.path("in.off"), case.vertices, case.faces)
        self.run_text("repair", "in.off", "-o", "out.off", *options)
        self.assertEqual(case.faults(*families.read(self.path("out.off"))), [])

    def test_voxels(self):
        for seed in range(12):
            with self.subTest(seed=seed):
                self.check_case(families.voxels(random.Random(seed), 8 + 12 * seed, seed % 2 == 1))

    def test_pairs(self):
        for seed in range(16):
            with self.subTest(seed=seed):
                self.check_case(families.pair(random.Random(seed)), "--union")

    def test_slivers(self):
        """Solids in nearly the same place, far from the origin: what rounding makes is joined before it grows."""
        for seed in (160, 188, 207):
            with self.subTest(seed=seed):
                case = families.pair(random.Random(seed))
                self.check_case(case, "--union")
                self.assertLess(len(families.read(self.path("out.off"))[1]), 8 * len(case.faces))


class Junctions(Case):
    """T-junctions where a solid is needed: joined, or the command that joins them."""

    def decompose(self, case, surface):
        families.write(self.path("in.off"), case.vertices, case.faces)
        report = self.run_json("decompose", "in.off", "-o", "p.vtk", "--report", "p.json", "--effort", "20")
        result = json.loads(self.read("p.json"))
        told = [line["message"] for line in report["log"]]
        joined = [line for line in told if "(T-junctions) were joined" in line]
        self.assertEqual((len(joined), any("stuffing" in line for line in told)), (surface, not surface), told)
        self.run_text("verify", "in.off", "p.json", "p.vtk")
        return result

    def test_decompose(self):
        open_ = 0
        for seed in range(8):
            with self.subTest(seed=seed):
                case = families.voxels(random.Random(seed), 4 + 3 * seed, seed % 2 == 1)
                families.write(self.path("in.off"), case.vertices, case.faces)
                if self.run_json("check", "in.off", status=None)["usable"]:
                    continue
                open_ += 1
                result = self.decompose(case, True)
                self.assertLess(abs(sum(p["volume"] for p in result["pieces"]) - case.volume), 2 * case.loose)
                size = max(max(p[k] for p in case.vertices) - min(p[k] for p in case.vertices) for k in range(3))
                self.assertLess(max(result["distance"], result["distance_back"]), 1e-8 * size)
        self.assertGreater(open_, 4)

    def test_seeds(self):
        """A face is as far from the small triangles that lie on it as rounding makes it, whatever the cuts."""
        case = families.voxels(random.Random(3), 13, True)
        families.write(self.path("in.off"), case.vertices, case.faces)
        for seed in 24, 34, 60:
            report = self.run_json("decompose", "in.off", "-o", "p.vtk", "--effort", "20", "--seed", str(seed))
            self.assertLess(max(report["distance"], report["distance_back"]), 1e-6, seed)

    def test_far(self):
        """Far from the origin parts of faces, whose distances are bounded, are convex up to rounding only."""
        for seed, far in (13, 1e6), (126, 1e8):
            case = families.voxels(random.Random(seed), 4, True)
            size = max(max(p[k] for p in case.vertices) - min(p[k] for p in case.vertices) for k in range(3))
            case.vertices = [tuple(p[k] + far * size * (1, -1, 1 / 3)[k] for k in range(3)) for p in case.vertices]
            self.assertLess(self.decompose(case, True)["distance"], 1e-15 * 16 * far * size)

    def test_hole(self):
        """What joining does not close is filled as before."""
        case = families.voxels(random.Random(3), 12)
        case.faces.pop()
        result = self.decompose(case, False)
        self.assertNotIn("faces_kept", result)

    def test_guard(self):
        case = families.voxels(random.Random(3), 12)
        families.write(self.path("MODEL"), case.vertices, case.faces)
        _, err = self.run_text("guard", "MODEL", "-o", "g.json", status=2)
        command = err.split("'")[err.split("'").index("starguard check") + 2]
        self.assertEqual(command, "starguard repair MODEL -o SOLID.off")
        self.run_text(*command.split()[1:])
        self.run_text("guard", "SOLID.off", "-o", "g.json")


class Details(Case):
    """Details between which no plane fits: corners are merged, so that pieces keep to the model."""

    def test_nearly_flush(self):
        """Boxes whose sides are apart by e, and that overlap by as much: their union, and a step within one."""
        for e in (1e-15, 1e-12, 1e-9, 1e-6) if LONG else (1e-9,):
            given = (((0, 0, 0), (2, 2, 2), False), ((1 - e, 1 - e, 1), (2 + e, 2 + e, 2), False),
                     ((-e, 1 - e, e), (1 + e, 3 + e, 1 - e), False))
            self.write("in.off", off(*boxes(*given)))
            self.run_text("repair", "in.off", "--union", "-o", "u.off")
            for file in "in.off", "u.off":
                with self.subTest(e=e, file=file):
                    report = self.run_json("decompose", file, "-o", "p.vtk", "--report", "p.json", "--effort", "quick")
                    self.assertFalse([line for line in report["log"] if "stuffing" in line["message"]])
                    self.assertAlmostEqual(sum(p["volume"] for p in report["pieces"]), 17, delta=20 * e + 1e-9)
                    self.assertLess(len(report["pieces"]), 6)
                    self.assertLess(report.get("distance", 0), 1e-7)
                    self.run_text("verify", file, "p.vtk", "p.json")


class Touching(Case):
    """Cubes that touch in edges and corners, with a bar among them: each has a skeleton and a piece of its own."""

    def test_parts(self):
        cells = [(x, y, z) for x in range(3) for y in range(3) for z in range(3) if (x + y + z) % 2 == 0]
        given = [(cell, (1, 1, 1), False) for cell in cells] + [((3, 3, 0), (9, 1, 1), False)]
        self.write("in.off", off(*boxes(*given)))
        report = self.run_json("skeleton", "in.off", "-o", "s.obj", "--nodes", "100")
        self.assertEqual((report["components"], report["loops"], report["ends"]), (15, 0, 2))
        self.assertEqual([line for line in report["log"] if line["level"] == "warning"], [])
        nodes = [tuple(map(float, line.split()[1:])) for line in self.read("s.obj").decode().split("\n")
                 if line.startswith("v ")]
        pieces = self.run_json("decompose", "in.off", "-o", "p.vtk", "--report", "p.json")
        self.assertEqual((len(pieces["pieces"]), pieces["optimal"], pieces["surface"]), (15, True, "kept"))
        self.assertLess(pieces["counted_work"], 1000)
        self.run_text("verify", "in.off", "p.vtk", "p.json")
        for lower, sides, _ in given:
            self.assertTrue(any(all(lower[k] < p[k] < lower[k] + sides[k] for k in range(3)) for p in nodes), lower)


def is_within(a, b):
    """Is a box, of (lower corner, sides), within another, flush or not?"""
    return all(b[0][k] <= a[0][k] and a[0][k] + a[1][k] <= b[0][k] + b[1][k] for k in range(3))


class Flush(Case):
    """Boxes that overlap, with sides in common planes: none lies in another, and all are one solid."""

    def measure(self, given):
        """The union's volume, by unit cells, is that of the pieces; no box is turned."""
        self.write("in.off", off(*boxes(*((lower, sides, False) for lower, sides in given))))
        report = self.run_json("decompose", "in.off", "-o", "p.vtk", "--effort", "quick")
        cells = {cell for lower, sides in given
                 for cell in itertools.product(*(range(lower[k], lower[k] + sides[k]) for k in range(3)))}
        self.assertAlmostEqual(report["volume"], len(cells), delta=1e-9 * len(cells), msg=given)
        self.assertFalse([line for line in report["log"] if "turned" in line["message"]], given)

    def test_row(self):
        """Each begins where the one before the last ends: the others cover all of its sides."""
        self.measure([((i, 0, 0), (2, 2, 8)) for i in range(5)])

    def test_random(self):
        for seed in range(200 if LONG else 20):
            rng = random.Random(seed)
            full = [rng.random() < 0.7 for _ in range(3)]
            full[rng.randrange(3)] = False
            given = []
            for _ in range(rng.randint(2, 8)):
                ends = [(0, 6) if full[k] else sorted(rng.sample(range(7), 2)) for k in range(3)]
                lower, sides = tuple(e[0] for e in ends), tuple(e[1] - e[0] for e in ends)
                fresh = (lower, sides)
                if not any(is_within(box, fresh) or is_within(fresh, box) for box in given):
                    given.append(fresh)
            self.measure(given)


class Scenes(Case):
    """Scenes by starguard-import, and what happens without it or with broken files."""

    def setUp(self):
        super().setUp()
        if not os.path.exists(os.path.join(BUILD, "starguard-import")):
            self.skipTest("starguard-import is not built: libassimp-dev is missing")

    def test_round_trip(self):
        self.run_text("sample", "gallery", "-o", "gallery.off")
        self.run_text("guard", "gallery.off", "-o", "g.json", "--method", "greedy", "--quiet")
        self.run_text("export", "g.json", "-o", "gallery.glb")
        self.run_text("check", "gallery.glb")

    def test_corners(self):
        """Objects whose rims meet are one surface; closed ones that touch keep their corners."""
        corners = [(i & 1, i >> 1 & 1, i >> 2) for i in range(8)]
        sides = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]
        text = ""
        for box in range(2):
            text += "".join(f"v {x + box} {y} {z}\n" for x, y, z in corners)
            for number, side in enumerate(sides):
                text += f"o wall{number}\n" if box == 0 else "o box\n" if number == 0 else ""
                text += "f " + " ".join(str(i + 1 + 8 * box) for i in side) + "\n"
        self.write("two.obj", text)
        ran = subprocess.run([os.path.join(BUILD, "starguard-import"), self.path("two.obj")], capture_output=True, check=True)
        self.write("two.ply", ran.stdout)
        told = self.run_json("check", "two.ply")
        self.assertEqual((told["model"]["vertices"], round(told["volume"], 9), told["components"]), (16, 2, 2))
        self.assertEqual(told["findings"]["duplicate_vertices"]["count"], 4)
        self.assertNotIn("isolated_vertices", told["findings"])

    def test_groups(self):
        """A room from groups to cameras and back: names stay, and are words for --see again."""
        names = {"floor": 2, "ceil & ing": 2, "z\u00fcrich": 2}
        text = "".join(f"v {8 * (i & 1)} {6 * (i >> 1 & 1)} {3 * (i >> 2)}\n" for i in range(8))
        sides = iter([(1, 3, 4, 2), (5, 6, 8, 7), (1, 2, 6, 5), (3, 7, 8, 4), (1, 5, 7, 3), (2, 4, 8, 6)])
        for name in names:
            text += f"g {name}\nf " + " ".join(map(str, next(sides))) + "\n"
        text += "o\ng\n" + "".join("f " + " ".join(map(str, side)) + "\n" for side in sides)
        self.write("room.obj", text)
        self.run_text("export", "room.obj", "-o", "room.glb")
        self.assertAlmostEqual(self.run_json("check", "room.glb")["volume"], 144, 4)
        self.run_text("guard", "room.glb", "-o", "g.json", "--see", "floor", "--see", "ceil & ing", "--table", "t.csv")
        rows = [line.split(",") for line in self.read("t.csv").decode().splitlines()[1:]]
        self.assertEqual(sorted(row[1] for row in rows), ["ceil & ing"] * 2 + ["floor"] * 2)
        for row in rows:
            self.assertAlmostEqual(float(row[2]), 24, 4)
        told = subprocess.run([os.path.join(BUILD, "starguard"), "check", self.path("room.glb")], capture_output=True, text=True)
        self.assertIn("y is up in glTF", told.stderr)
        self.run_text("view", "room.glb", "g.json", "-o", "page.html")
        self.run_text("export", "room.glb", "g.json", "-o", "back.glb")
        data = self.read("back.glb")
        nodes = json.loads(data[20:20 + int.from_bytes(data[12:16], "little")])["nodes"]
        found = [node["name"] for node in nodes]
        for name in [*names, "model", "guards"]:
            self.assertIn(name, found)
        model = nodes[found.index("model")]
        self.assertEqual([nodes[i]["name"] for i in model["children"]], ["model", *names])

    def damaged(self, rng, name, data):
        """Bytes changed or cut off; of a 3MF sometimes those of the XML in a sound archive."""
        inner = name.endswith("3mf") and rng.random() < 0.5
        if inner:
            with zipfile.ZipFile(io.BytesIO(data)) as archive:
                parts = {part: archive.read(part) for part in archive.namelist()}
            data = parts["3D/3dmodel.model"]
        bytes_ = bytearray(data[:rng.randint(20, len(data))] if rng.random() < 0.3 else data)
        for _ in range(rng.randint(1, 8)):
            bytes_[rng.randrange(12, len(bytes_))] = rng.randrange(256)
        if not inner:
            return bytes(bytes_)
        parts["3D/3dmodel.model"] = bytes(bytes_)
        out = io.BytesIO()
        with zipfile.ZipFile(out, "w") as archive:
            for part, text in parts.items():
                archive.writestr(part, text)
        return out.getvalue()

    def test_damaged(self):
        """200 broken files, or 40 without STARGUARD_LONG: a result or a message, and nothing else is left."""
        rng = random.Random(1)
        self.write("box.obj", "".join(f"v {i & 1} {i >> 1 & 1} {i >> 2}\n" for i in range(8)) + "g floor\nf 1 3 4 2\n"
                   "g rest\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n")
        outcomes = set()
        for name in ("bad.glb", "bad.3mf"):
            self.run_text("export", "box.obj", "-o", name)
            good = self.read(name)
            for _ in range(100 if LONG else 20):
                self.write(name, self.damaged(rng, name, good))
                with self.start("repair", name, "-o", "out.off") as process:
                    _, err = process.communicate()
                outcomes.add((name, process.returncode))
                self.assertIn(process.returncode, (0, 2), err)
                self.assertTrue(process.returncode == 0 or err)
                self.assertEqual("out.off" in self.names(), process.returncode == 0)
                self.assertEqual(set(self.names()) - {"bad.glb", "bad.3mf", "box.obj", "out.off"}, set())
                if process.returncode == 0:
                    os.remove(self.path("out.off"))
        self.assertEqual(len(outcomes), 4)

    def test_missing_program(self):
        os.makedirs(self.path("bin"))
        shutil.copy(os.path.join(BUILD, "starguard"), self.path("bin"))
        self.write("room.glb", b"glTF    ")
        result = subprocess.run([self.path("bin/starguard"), "check", self.path("room.glb")], env={"PATH": "/nowhere"},
                                capture_output=True, text=True, check=False)
        self.assertEqual(result.returncode, 2)
        self.assertIn("libassimp-dev", result.stderr)


if __name__ == "__main__":
    main()
