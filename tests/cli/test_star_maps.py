# SPDX-License-Identifier: Apache-2.0
"""Maps and morphs of solids that end at B itself: star-shaped pairs, pairs that are cut alike into pieces, and
what --connectivity a tells. Results are checked by `verify`, and small ones here in rational numbers."""
import itertools
import os
import random
import shutil
import unittest
from fractions import Fraction

import plain_solids as plain
import star_solids
from support import LONG, Case, main


def array(text, name):
    """The numbers of an array of MAP.vtu, as they are written."""
    return text.split(f'Name="{name}"', 1)[1].split(">", 1)[1].split("<", 1)[0].split()


def lines(numbers):
    """As MAP.vtu has points."""
    return [" ".join(numbers[i:i + 3]) for i in range(0, len(numbers), 3)]


def points(text, name):
    values = [Fraction(float(x)) for x in array(text, name)]
    return [values[i:i + 3] for i in range(0, len(values), 3)]


def six_volumes(places, cell):
    """Six times the volume of a tetrahedron, exactly."""
    a, b, c, d = (places[v] for v in cell)
    u, v, w = ([q[k] - a[k] for k in range(3)] for q in (b, c, d))
    return plain.dot(u, plain.cross(v, w))


def volume(solid):
    vertices, faces = solid
    corner = [[Fraction(x) for x in v] for v in vertices]
    return sum(plain.dot(corner[a], plain.cross(corner[b], corner[c])) for a, b, c in faces) / 6


class StarMaps(Case):
    def write_all(self, solids):
        for name, solid in solids:
            star_solids.write(self.path(f"{name}.off"), solid)
        return dict(solids)

    def fills(self, file, a, b):
        """All tetrahedra are positive in both places, and have the volumes of the solids."""
        text = self.read(file).decode()
        cells = [int(v) for v in array(text, "connectivity")]
        cells = [cells[i:i + 4] for i in range(0, len(cells), 4)]
        for name, solid in (("", a), ("image", b)):
            places = points(text.split("<Points>")[1] if name == "" else text, name or "Points")
            sizes = [six_volumes(places, cell) for cell in cells]
            self.assertGreater(min(sizes), 0)
            if solid is not None:
                self.assertAlmostEqual(float(sum(sizes) / 6 / volume(solid)), 1, 12)

    def test_maps(self):
        """All ordered pairs, or every sixth without STARGUARD_LONG: one piece, B itself."""
        solids = self.write_all(star_solids.solids())
        for a, b in list(itertools.permutations(solids, 2))[::1 if LONG else 6]:
            report = self.run_json("map", "--solid", f"{a}.off", f"{b}.off", "-o", "m.vtu")
            self.assertEqual(report["pieces"], 1)
            self.run_text("verify", f"{a}.off", f"{b}.off", "m.vtu")
            if report["tetrahedra"] < 100:
                self.fills("m.vtu", solids[a], solids[b])

    def test_morphs(self):
        """Of turned solids: straight ways, positive at all times."""
        solids = self.write_all(star_solids.solids(random.Random(5)))
        for a, b in list(itertools.permutations(solids, 2))[::4 if LONG else 7]:
            report = self.run_json("morph", f"{a}.off", f"{b}.off", "--frames", "3", "-o", "out", "--method", "solid",
                                   "--certificate", "path.vtu")
            self.assertEqual((report["solid"]["keys"], report["solid"]["inverted"]), (3, 0), (a, b))
            self.run_text("verify", f"{a}.off", f"{b}.off", "path.vtu")

    def test_pieces_begun_anew(self):
        """Solids that no point sees, of which parts resist the first cuts and are cut anew."""
        for seed in (57, 84, 89) if LONG else (84, 89):
            rng = random.Random(seed)
            for name in "ab":
                star_solids.write(self.path(f"{name}.off"), star_solids.random_ball(rng)[1])
            report = self.run_json("map", "--solid", "a.off", "b.off", "-o", "m.vtu")
            self.assertGreater(report["pieces"], 1)
            self.run_text("verify", "a.off", "b.off", "m.vtu")
            self.fills("m.vtu", None, None)

    def test_landmarks(self):
        """A given map is met: cones over its overlay."""
        self.write_all(star_solids.solids())
        self.write("marks.txt", "0 0\n1 1\n")
        self.run_text("map", "octahedron.off", "tetrahedron.off", "--landmarks", "marks.txt", "-o", "m.json")
        report = self.run_json("map", "--solid", "octahedron.off", "tetrahedron.off", "--map", "m.json", "-o", "m.vtu")
        self.assertEqual(report["pieces"], 1)
        self.run_text("verify", "octahedron.off", "tetrahedron.off", "m.vtu")

    def test_pieces(self):
        """Solids that no point sees are cut alike in both, into few pieces."""
        solids = self.write_all([
            ("stairs", star_solids.blocks([(x, y, 0) for x in range(4) for y in range(x + 1)])),
            ("U", star_solids.blocks([(0, 0, 0), (1, 0, 0), (2, 0, 0), (0, 1, 0), (2, 1, 0)])),
            ("hook", star_solids.blocks([(0, 0, z) for z in range(4)] +
                                        [(1, 0, 3), (2, 0, 3), (2, 1, 3), (2, 2, 3), (2, 2, 2)])),
            ("cube", star_solids.blocks([(0, 0, 0)]))])
        for a, b in ("stairs", "U"), ("U", "cube"), ("hook", "stairs"), ("cube", "hook"):
            report = self.run_json("map", "--solid", f"{a}.off", f"{b}.off", "-o", "m.vtu")
            self.assertLess(report["pieces"], 9)
            self.run_text("verify", f"{a}.off", f"{b}.off", "m.vtu")
            self.fills("m.vtu", solids[a], solids[b])

    def test_balls(self):
        """Random plain solids without holes, most of which no point sees."""
        for seed in range(9 if LONG else 3):
            rng = random.Random(seed)
            solids = self.write_all([(name, star_solids.random_ball(rng)[1]) for name in "ab"])
            report = self.run_json("map", "--solid", "a.off", "b.off", "-o", "m.vtu")
            self.run_text("verify", "a.off", "b.off", "m.vtu")
            if report["tetrahedra"] < 1000:
                self.fills("m.vtu", solids["a"], solids["b"])

    def test_crossing(self):
        """A solid one of whose arms passes through the other is refused, whichever way."""
        vertices, faces = star_solids.blocks([(0, 0, 0), (1, 0, 0), (2, 0, 0), (0, 1, 0), (2, 1, 0)])
        bent = [(x - 1.7, y, z + 0.2) if y == 2 and x > 1 else (x, y, z) for x, y, z in vertices]
        self.write_all([("U", (vertices, faces)), ("bent", (bent, faces)),
                        ("stairs", star_solids.blocks([(x, y, 0) for x in range(4) for y in range(x + 1)]))])
        for a, b, which in ("bent", "stairs", "A"), ("stairs", "bent", "B"):
            _, err = self.run_text("map", "--solid", f"{a}.off", f"{b}.off", "-o", "m.vtu", status=2)
            self.assertIn(f"{which} meets itself", err)
            self.assertFalse(os.path.exists(self.path("m.vtu")))

    def test_limbs(self):
        """Animals of other limbs, which no surface map that comes first leads to."""
        for name in "horse", "human":
            self.run_text("sample", name, "--vertices", "500", "-o", f"{name}.off")
        self.run_text("map", "--solid", "horse.off", "human.off", "--steps", "5", "-o", "m.vtu")
        self.run_text("verify", "horse.off", "human.off", "m.vtu")

    @unittest.skipUnless(shutil.which("tetgen"), "the program tetgen is not installed")
    def test_shapes(self):
        """To a ball and a cube: A's vertices are on them, and verify sees where one is not."""
        stairs = star_solids.blocks([(x, y, 0) for x in range(3) for y in range(x + 1)])
        star_solids.write(self.path("stairs.off"), stairs)
        for shape in "ball", "cube":
            self.run_json("map", "--solid", "stairs.off", "--to", shape, "-o", "m.vtu")
            out, _ = self.run_text("verify", "stairs.off", "m.vtu", "--verbose")
            self.assertIn("on the sphere of radius 1" if shape == "ball" else "on the cube of edge 2", out)
            text = self.read("m.vtu").decode()
            self.fills("m.vtu", stairs, None)
            images, places = array(text, "image"), array(text.split("<Points>")[1], "Points")
            corner = [float(x) for x in stairs[0][0]]
            first = next(v for v in range(len(places) // 3) if list(map(float, places[3 * v:3 * v + 3])) == corner)
            inward = [repr(float(x) * 0.999) for x in images[3 * first:3 * first + 3]]
            forged = [*images[:3 * first], *inward, *images[3 * first + 3:]]
            self.write("forged.vtu", text.replace("\n".join(lines(images)), "\n".join(lines(forged))))
            self.assertNotEqual(self.read("forged.vtu").decode(), text)
            out, _ = self.run_text("verify", "stairs.off", "forged.vtu", status=4)
            self.assertIn("A's vertices are on the", out)
        self.run_json("map", "--solid", "stairs.off", "stairs.off", "-o", "m.vtu")
        self.run_text("verify", "stairs.off", "m.vtu", status=4)

    @unittest.skipUnless(shutil.which("tetgen"), "the program tetgen is not installed")
    def test_connectivity(self):
        """B in A's faces: the first line and the file tell what is missed, and verify checks it."""
        self.write_all(star_solids.solids())
        pair = "cube.off", "cylinder.off"
        out, _ = self.run_text("map", "--solid", *pair, "--connectivity", "a", "-o", "m.vtu")
        self.assertIn("B in A's faces", out.splitlines()[0])
        out, _ = self.run_text("verify", *pair, "m.vtu")
        self.assertIn("near B", out)
        text = self.read("m.vtu").decode()
        missed = array(text, "missed")
        self.assertTrue(0.9 < float(missed[1]) < 1 and 5 < float(missed[2]) < 5.5)
        for i, factor in (0, 0.5), (1, 0.5), (2, 1.001):
            forged = list(missed)
            forged[i] = repr(float(missed[i]) * factor)
            self.write("forged.vtu", text.replace(" ".join(missed), " ".join(forged)))
            self.run_text("verify", *pair, "forged.vtu", status=4)
        out, _ = self.run_text("morph", *pair, "--method", "solid", "--connectivity", "a", "--frames", "2", "-o", "out",
                               "--certificate", "path.vtu")
        self.assertIn("B in A's faces", out.splitlines()[0])
        self.run_text("verify", *pair, "path.vtu")

    def test_usage(self):
        both = "map", "--solid", "a.off", "b.off", "-o", "m.vtu", "--connectivity", "a"
        self.usage_error(*both, "--overlay", says="leave out --overlay")
        self.usage_error("map", "a.off", "b.off", "-o", "m.json", "--connectivity", "a", says="--solid")
        self.usage_error("morph", "a.off", "b.off", "-o", "out", "--connectivity", "a", says="method solid")


if __name__ == "__main__":
    main()
