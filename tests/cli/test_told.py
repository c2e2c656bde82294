# SPDX-License-Identifier: Apache-2.0
"""Nothing is dropped without a word: what an input asks for and does not get is said."""
import json
import struct

from support import OPEN, TETRAHEDRON, Case, main
from test_coordinates import boxes, off


def room(size, height, inner, pit):
    """A room with a square in the middle of its floor, at the bottom of a pit. The first face is the ceiling."""
    a, b = (size - inner) / 2, (size + inner) / 2
    floor = [(0, 0, 0), (size, 0, 0), (size, size, 0), (0, size, 0)]
    rim = [(a, a, 0), (b, a, 0), (b, b, 0), (a, b, 0)]
    vertices = floor + [(x, y, height) for x, y, _ in floor] + rim
    faces = [(4, 5, 6, 7)]
    for i in range(4):
        j = (i + 1) % 4
        faces += [(i, j, 4 + j, 4 + i), (j, i, 8 + i, 8 + j)]
        if pit:
            faces.append((8 + j, 8 + i, 12 + i, 12 + j))
    if pit:
        vertices += [(x, y, -pit) for x, y, _ in rim]
    faces.append((15, 14, 13, 12) if pit else (11, 10, 9, 8))
    return vertices, faces


class Told(Case):
    def test_uncovered_faces(self):
        """Faces under a crate, and around it with a corner beneath, are seen from nowhere: proven."""
        self.write("room.off", off(*room(10, 3, 1, 0)))
        self.write("crate.off", off(*boxes(((4, 4, 0), (2, 2, 1), False))))
        words = ["guard", "room.off", "--obstacles", "crate.off", "-o", "g.json"]
        out, _ = self.run_text(*words)
        self.assertIn("10 faces (10 that no place sees)", out)
        self.assertEqual(self.run_json(*words)["unseen_faces"], 10)
        self.write("p.txt", "1 1 1\n")
        out, _ = self.run_text(*words, "--candidates", "p.txt")
        self.assertIn("that no candidate sees)", out)  # more of them may, but not by --count

    def test_places_before_faces(self):
        """The bottom of a pit is seen from a spot of the ceiling, which few candidates do not hit."""
        self.write("pit.off", off(*room(10, 3, 0.2, 2)))
        self.write("roof.txt", "0\n1\n")
        told = self.run_json("guard", "pit.off", "--mount", "roof.txt", "--clearance", "0.05", "--count", "20",
                             "-o", "g.json")
        self.assertEqual(told["coverage"]["uncovered_faces"], [])

    def test_few_vertices(self):
        """What has too few for B gets the faces of the overlay, whatever the method, and says so."""
        self.write("a.off", TETRAHEDRON)
        self.write("b.off", off(*boxes(((5, 5, 5), (1, 2, 3), False))))
        self.sample("sphere", 520, "c.off")
        for a, b, method, poor in (("a.off", "c.off", "star", True), ("b.off", "c.off", "arap", True),
                                   ("c.off", "b.off", "linear", False), ("c.off", "c.off", "star", False)):
            words = ["morph", a, b, "--frames", "3", "-o", "frames", "--method", method]
            told = self.run_json(*words)
            out, err = self.run_text(*words)
            self.assertEqual("the faces of the overlay" in err, poor)
            self.assertEqual("overlay" in told, poor)
            self.assertIn(" of the last frame from B", out)
            if poor:
                self.assertLess(told["distance"], 1e-9)

    def test_look_of_frames(self):
        """Colours and texture coordinates of A are not in the frames."""
        ply = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n" \
              "{}element face 4\nproperty list uchar int vertex_indices\nend_header\n{}" \
              "3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n"
        points = ("0 0 0", "1 0 0", "0 1 0", "0 0 1")
        rgb = "".join(f"property uchar {c}\n" for c in ("red", "green", "blue"))
        self.write("b.ply", ply.format("", "".join(f"{p}\n" for p in points)))
        faces = "f 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n"
        for name, text, look in (
                ("a.ply", ply.format(rgb, "".join(f"{p} 9 8 7\n" for p in points)), "colours of A"),
                ("a.obj", "".join(f"v {p}\nvt 0 1\n" for p in points) + faces, "texture coordinates of A"),
                ("c.obj", "".join(f"v {p} 1 0 0\nvt 0 1\n" for p in points) + faces,
                 "colours and texture coordinates of A"),
                ("d.off", TETRAHEDRON.replace("3 0 2 1", "3 0 2 1 255 0 0"), "colours of A"),
                ("b.ply", None, None)):
            if text is not None:
                self.write(name, text)
            _, err = self.run_text("morph", name, "b.ply", "--frames", "2", "-o", "frames", "--method", "linear")
            self.assertEqual(look is not None, "leave out the" in err, (name, err))
            self.assertIn(look or "", err)

    def color_of_glb(self, name):
        """COLOR_0 of the first primitive, as read by the format's own words."""
        data = self.read(name)
        length, = struct.unpack("<I", data[12:16])
        scene, binary = json.loads(data[20:20 + length]), data[28 + length:]
        accessor = scene["accessors"][scene["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"]]
        view = scene["bufferViews"][accessor["bufferView"]]
        self.assertEqual((accessor["componentType"], accessor["type"]), (5126, "VEC3"))
        return struct.unpack(f"<{3 * accessor['count']}f", binary[view["byteOffset"]:][:view["byteLength"]])

    def test_colours_of_animation(self):
        """Colours of A's vertices are in the animation, of whatever format A is, and between the corners where the
        overlay has vertices of its own."""
        points = ("0 0 0", "1 0 0", "0 1 0", "0 0 1")
        self.write("b.off", TETRAHEDRON.replace("1 0 0", "2 0 0"))
        colors = [(0, 10, 255), (20, 128, 1), (255, 255, 255), (90, 60, 30)]
        light = [x / 255 / 12.92 if x <= 10 else ((x / 255 + 0.055) / 1.055) ** 2.4 for color in colors for x in color]
        faces = [(0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)]
        rows = ["%s %d %d %d" % (p, *c) for p, c in zip(points, colors)]
        corners = "".join("3 %d %d %d\n" % face for face in faces)
        self.write("a.off", "COFF\n4 4 0\n" + "".join(f"{row} 255\n" for row in rows) + corners)
        self.write("a.obj", "".join("v %s %r %r %r\n" % (p, *(x / 255 for x in c)) for p, c in zip(points, colors))
                   + "".join("f %d %d %d\n" % tuple(i + 1 for i in face) for face in faces))
        self.write("a.ply", "ply\nformat ascii 1.0\nelement vertex 4\n" + "".join(f"property float {x}\n" for x in "xyz")
                   + "".join(f"property uchar {c}\n" for c in ("red", "green", "blue"))
                   + "element face 4\nproperty list uchar int vertex_indices\nend_header\n" + "\n".join(rows) + "\n" + corners)
        for name in ("a.off", "a.obj", "a.ply"):
            _, err = self.run_text("morph", name, "b.off", "--frames", "2", "-o", "frames", "--method", "linear", "--glb",
                                   "m.glb")
            self.assertNotIn("leave out", err)
            for found, expected in zip(self.color_of_glb("m.glb"), light, strict=True):
                self.assertAlmostEqual(found, expected, delta=1e-6)
        self.sample("sphere", 520, "s.off")
        self.run_text("morph", "a.ply", "s.off", "--frames", "2", "-o", "frames", "--method", "linear", "--glb", "m.glb",
                      "--overlay")
        refined = self.color_of_glb("m.glb")
        self.assertGreater(len(refined), 3 * 500)
        self.assertEqual([x for x in refined if not 0 <= x <= 1], [])
        self.assertGreater(len(set(refined)), 100)

    def test_landmarks(self):
        self.sample("sphere", 520, "a.off")
        self.sample("sphere", 520, "b.off")
        for text in ("", "# none\n\n"):
            self.write("l.txt", text)
            _, err = self.run_text("map", "a.off", "b.off", "--landmarks", "l.txt", "-o", "m.json", status=2)
            self.assertIn("there is no landmark", err)
        first = [float(x) for x in self.read("a.off").split()[4:7]]
        for scale, status, says in ((1.001, 0, None), (1.1, 0, "of its diagonal"), (2, 2, "from A")):
            far = " ".join(str(scale * x) for x in first)
            self.write("l.txt", f"{far} {' '.join(map(str, first))}\n")
            _, err = self.run_text("map", "a.off", "b.off", "--landmarks", "l.txt", "-o", "m.json", "--quiet",
                                   status=status)
            self.assertEqual(says is not None, "l.txt' line 1 has a point" in err, err)
            self.assertIn(says or "", err)

    def test_open_models_in_databases(self):
        self.write("open.off", OPEN)
        self.run_text("db", "create", "shapes.db")
        told = json.loads(self.run_text("db", "add", "--json", "shapes.db", "open.off")[0])
        self.assertIn("bounds no solid", told["files"][0]["message"])
        self.run_text("db", "create", "more.db")
        _, err = self.run_text("db", "add", "more.db", "open.off", "--quiet")
        self.assertIn("warning: 'open.off': the surface bounds no solid", err)


if __name__ == "__main__":
    main()
