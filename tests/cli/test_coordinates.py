# SPDX-License-Identifier: Apache-2.0
"""Coordinates far from the origin, tiny and huge: every writer gives back the same solid, or says why not."""
import json
import math
import os
import struct

from support import LONG, Case, main

# scale and shift: as they are, map coordinates, and sizes
PLACES = [(1, (512345.5, 5412345.25, 101)), (1e3, (5e5, 5e6, 0)), (1e-6, (0, 0, 0)), (1e-3, (0.25, 0, 0)),
          (1e6, (0, 0, 0)), (1e6, (5e5, 5e6, 0))]
CUBE = [(x, y, z) for x in (0, 1) for y in (0, 1) for z in (0, 1)]
SIDES = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
SINGLE = "single precision"


def off(vertices, faces):
    lines = [" ".join(f"{x:.17g}" for x in p) for p in vertices]
    lines += [f"{len(f)} " + " ".join(map(str, f)) for f in faces]
    return f"OFF\n{len(vertices)} {len(faces)} 0\n" + "\n".join(lines) + "\n"


def as_single(p):
    return struct.unpack("<3f", struct.pack("<3f", *p))


def boxes(*given):
    """Of (lower corner, sides, turned inside out)."""
    vertices, faces = [], []
    for lower, sides, inner in given:
        base = len(vertices)
        vertices += [tuple(lower[k] + sides[k] * c[k] for k in range(3)) for c in CUBE]
        faces += [tuple(base + v for v in (side[::-1] if inner else side)) for side in SIDES]
    return vertices, faces


def numbers_of(text):
    """Vertices and faces of OFF."""
    words = text.split()
    count = int(words[1])
    return ([tuple(map(float, words[4 + 3 * i:7 + 3 * i])) for i in range(count)],
            [tuple(map(int, words[5 + 3 * count + 4 * i:8 + 3 * count + 4 * i]))
             for i in range(int(words[2]))])


class Coordinates(Case):
    def model_of_glb(self, name):
        """Vertices and faces of the first mesh, where its node puts them."""
        data = self.read(name)
        size = struct.unpack_from("<I", data, 12)[0]
        scene, numbers = json.loads(data[20:20 + size]), data[28 + size:]
        shift = scene["nodes"][0]["translation"]
        part = scene["meshes"][0]["primitives"][0]

        def values(accessor, kind, each):
            a = scene["accessors"][accessor]
            start = scene["bufferViews"][a["bufferView"]]["byteOffset"] + a.get("byteOffset", 0)
            flat = struct.unpack_from(f"<{each * a['count']}{kind}", numbers, start)
            return [flat[i:i + each] for i in range(0, len(flat), each)]

        points = values(part["attributes"]["POSITION"], "f", 3)
        corners = [i[0] for i in values(part["indices"], "I", 1)]
        return ([tuple(p[k] + shift[k] for k in range(3)) for p in points],
                [tuple(corners[i:i + 3]) for i in range(0, len(corners), 3)])

    def same(self, name, wanted):
        """The solid of `name` is that of which check said `wanted`."""
        told = self.run_json("check", name)
        for key in ("usable", "embedded", "components", "genus"):
            self.assertEqual(told[key], wanted[key], (name, key))
        self.assertEqual(told["model"]["faces"], wanted["model"]["faces"])
        for key in ("area", "volume", "diagonal"):
            self.assertTrue(math.isclose(told[key], wanted[key], rel_tol=1e-3), (name, key, told[key]))

    def there_and_back(self, wanted, far, thorough):
        """a.off through every writer of meshes and scenes."""
        original = self.read("a.off")
        for form in ("obj", "ply"):
            for write in ("repair", "export") if thorough else ("repair",):
                self.run_text(write, "a.off", "-o", f"b.{form}", "--quiet")
                self.run_text("repair", f"b.{form}", "-o", "c.off", "--quiet")
                self.assertEqual(self.read("c.off"), original, (write, form))
        self.run_text("export", "a.off", "-o", "b.vtu", "--quiet")
        vertices, faces = numbers_of(original.decode())
        self.assertIn(struct.pack(f"<{3 * len(vertices)}d", *(x for p in vertices for x in p)),
                      self.read("b.vtu"))
        self.run_text("export", "a.off", "-o", "b.glb", "--quiet")
        points, corners = self.model_of_glb("b.glb")
        self.assertEqual(corners, faces)
        reach = wanted["diagonal"] * 2 ** -24
        self.assertLessEqual(max(math.dist(p, q) for p, q in zip(vertices, points)), reach)
        self.run_text("repair", "a.off", "-o", "o.stl", "--origin", "auto", "--quiet")
        self.same("o.stl", wanted)
        if os.path.exists(self.path("b.stl")):
            os.remove(self.path("b.stl"))
        with self.start("repair", "a.off", "-o", "b.stl", "--quiet") as process:
            err = process.communicate()[1].decode()
        if process.returncode == 0:
            self.same("b.stl", wanted)
        else:
            self.assertEqual(process.returncode, 2)
            self.assertIn(SINGLE, err)
            self.assertIn("OFF, OBJ, PLY", err)
            self.assertTrue(far)
            self.assertIn("--origin auto", err)
            self.assertNotIn("b.stl", self.names())
        return process.returncode

    def test_samples(self):
        """Twenty of them, or five without STARGUARD_LONG, each at one place after another."""
        listed = [s["name"] for s in self.run_json("sample", "--list")["samples"]][:20]
        self.assertEqual(len(listed), 20)
        refused = {}
        for i, name in enumerate(listed[::1 if LONG else 4]):
            vertices, faces = numbers_of(self.read(self.sample(name, 500)).decode())
            for scale, shift in PLACES if i < 1 else (PLACES[0], PLACES[1 + i % 5]):
                with self.subTest(name=name, scale=scale, shift=shift):
                    self.write("a.off", off([tuple(scale * p[k] + shift[k] for k in range(3))
                                             for p in vertices], faces))
                    wanted = self.run_json("check", "a.off")
                    self.assertTrue(wanted["usable"] and not wanted["coarse"])
                    status = self.there_and_back(wanted, shift != (0, 0, 0), i < 1)
                    refused.setdefault((scale, shift), set()).add(status)
        self.assertEqual(refused[PLACES[0]], {2})
        for place in (PLACES[2], PLACES[4]):
            self.assertEqual(refused[place], {0})

    def test_frames(self):
        """An animation counts from the middle of the first frame; what is too small for it is refused."""
        place = (512345.5, 5412345.25, 101)
        self.write("a.off", off(*boxes((place, (1, 2, 3), False))))
        self.write("b.off", off(*boxes((place, (2, 2, 2), False))))
        words = ["--frames", "3", "--method", "linear", "--quiet", "-o", "frames"]
        self.run_text("morph", "a.off", "b.off", *words, "--glb", "m.glb")
        points, _ = self.model_of_glb("m.glb")
        vertices, _ = numbers_of(self.read("a.off").decode())
        self.assertLess(max(math.dist(p, q) for p, q in zip(vertices, points)), 1e-6)
        self.write("b.off", off(*boxes(((1e12, 0, 0), (2, 2, 2), False))))
        _, err = self.run_text("morph", "a.off", "b.off", *words, "--glb", "n.glb", status=2)
        self.assertIn(SINGLE, err)
        self.assertIn("frame 1", err)
        self.assertNotIn("n.glb", self.names())

    def test_what_is_refused(self):
        """Faces that lose their area, and faces that meet, also where nothing moves far."""
        self.write("a.off", off(*boxes(((1, 1, 1), (1, 1, 1e-9), False))))
        _, err = self.run_text("repair", "a.off", "-o", "a.stl", status=2)
        self.assertIn("would lose its area", err)
        self.write("a.off", off(*boxes(((0, 0, 0), (3, 1, 1), False), ((3 + 1e-9, 0, 0), (1, 1, 1), False))))
        for command, name, keeps in (("repair", "a.stl", "PLY"), ("export", "a.glb", ".vtu")):
            _, err = self.run_text(command, "a.off", "-o", name, status=2)
            self.assertIn("would meet", err)
            self.assertIn(keeps, err)
            self.assertNotIn("--origin", err)
            self.assertNotIn(name, self.names())

    def test_origin(self):
        place = (512345.5, 5412345.25, 101)
        vertices, faces = boxes((place, (1, 2, 3), False))
        self.write("a.off", off(vertices, faces))
        for origin, form in (("512345,5412345,0", "ply"), ("auto", "obj"), ("auto", "stl"), ("auto", "off")):
            told = self.run_json("repair", "a.off", "-o", f"b.{form}", "--origin", origin)["origin"]
            self.run_text("repair", f"b.{form}", "-o", "c.off", "--quiet")
            back, _ = numbers_of(self.read("c.off").decode())
            self.assertEqual({tuple(p[k] + told[k] for k in range(3)) for p in back}, set(vertices))
            self.assertLess(math.dist(told, place), 150)
            text = "origin {:.17g} {:.17g} {:.17g}".format(*told).encode()
            self.assertEqual(text in self.read(f"b.{form}"), form != "off")
        self.usage_error("repair", "a.off", "-o", "d.stl", "--origin", "1,2", says="--origin takes X,Y,Z")
        _, err = self.run_text("repair", "a.off", "-o", "d.stl", "--origin", "1e30,0,0", status=2)
        self.assertIn("give one near the mesh", err)

    def house(self, lower, outer, wall, single=True):
        """A box with walls, as a file of single precision holds it."""
        vertices, faces = boxes((lower, outer, False), (tuple(x + wall for x in lower),
                                                       tuple(x - 2 * wall for x in outer), True))
        self.write("house.off", off([as_single(p) for p in vertices] if single else vertices, faces))

    def test_grid(self):
        """Walls of 0.3 in steps of 0.5: told once, by all."""
        for outer in ((10, 8, 3), (40, 30, 12)):
            self.house((512345.3, 5412345.2, 100.1), outer, 0.3)
            told = self.run_json("check", "house.off")
            self.assertTrue(told["coarse"])
            self.assertEqual(told["grid"][1], 0.5)
            _, err = self.run_text("check", "house.off")
            self.assertEqual(err.count("\n"), 1, err)
            self.assertIn("steps of 0.0312, 0.5 and", err)
            _, err = self.run_text("guard", "house.off", "-o", "g.json", "--quiet")
            self.assertEqual(err.count("\n"), 1, err)
            self.assertIn("steps of", err)
        self.house((512345.3, 5412345.2, 100.1), (10, 8, 3), 0.3, single=False)
        self.assertFalse(self.run_json("check", "house.off")["coarse"])
        self.house((0, 0, 0), (8, 8, 3), 1)
        self.assertFalse(self.run_json("check", "house.off")["coarse"])
        text = off(*boxes(((512345, 5412345, 0), (10, 8, 3), False)))
        rounded = "\n".join(" ".join(f"{float(w):.6g}" for w in line.split()) if "." in line or
                            len(line) > 9 else line for line in text.split("\n"))
        self.write("text.off", rounded)
        told = self.run_json("check", "text.off")
        self.assertEqual((told["grid"][0], told["grid"][1], told["coarse"]), (1, 10, True))

    def test_repair_in_vain(self):
        self.write("a.off", off(*boxes(((0, 0, 0), (2, 2, 2), False), ((1, 1, 1), (2, 2, 2), False))))
        _, err = self.run_text("repair", "a.off", "-o", "b.off", status=2)
        self.assertIn("no fewer than before; --union", err)
        self.assertNotIn("b.off", self.names())
        self.run_text("repair", "a.off", "-o", "b.off", "--union")

    def test_underflow(self):
        """What guard refuses is not usable for check."""
        for sides in ((1e-95, 1e-95, 1e-95), (1e-80, 1e-80, 1e-170)):
            self.write("a.off", off(*boxes(((0, 0, 0), sides, False))))
            told = self.run_json("check", "a.off", status=2)
            self.assertFalse(told["usable"])
            _, err = self.run_text("check", "a.off", status=2)
            self.assertIn("underflows; scale its coordinates", err)
            self.run_text("guard", "a.off", "-o", "g.json", status=2)
        self.write("a.off", off(*boxes(((0, 0, 0), (1e-80, 1e-80, 1e-80), False))))
        self.assertTrue(self.run_json("check", "a.off")["usable"])


if __name__ == "__main__":
    main()
