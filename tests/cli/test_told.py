# SPDX-License-Identifier: Apache-2.0
"""Nothing is dropped without a word: what an input asks for and does not get is said."""
import json
import os
import struct

from support import BUILD, OPEN, TETRAHEDRON, Case, main
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
        """Colours and texture coordinates of A are not in frames as OFF."""
        ply = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n" \
              "{}element face 4\nproperty list uchar int vertex_indices\nend_header\n{}" \
              "3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n"
        points = ("0 0 0", "1 0 0", "0 1 0", "0 0 1")
        rgb = "".join(f"property uchar {c}\n" for c in ("red", "green", "blue"))
        self.write("b.ply", ply.format("", "".join(f"{p}\n" for p in points)))
        faces = "f 1/1 3/2 2/1\nf 1/4 2/1 4/1\nf 1/4 4/1 3/1\nf 2/1 3/1 4/4\n"
        for name, text, look in (
                ("a.ply", ply.format(rgb, "".join(f"{p} 9 8 7\n" for p in points)), "colours of A"),
                ("a.obj", "".join(f"v {p}\nvt 0 1\n" for p in points) + faces, "texture coordinates of A"),
                ("c.obj", "".join(f"v {p} 1 0 0\nvt 0 1\n" for p in points) + faces,
                 "colours and texture coordinates of A"),
                ("e.obj", "".join(f"v {p}\nvt 0 1\n" for p in points) + faces.replace("4/4", "4"), "texture coordinates of A"),
                ("d.off", TETRAHEDRON.replace("3 0 2 1", "3 0 2 1 255 0 0"), "colours of A"),
                ("b.ply", None, None)):
            if text is not None:
                self.write(name, text)
            _, err = self.run_text("morph", name, "b.ply", "--frames", "2", "-o", "frames", "--method", "linear")
            self.assertEqual(look is not None, "leave out the" in err, (name, err))
            self.assertIn(look or "", err)
            _, err = self.run_text("morph", name, "b.ply", "--frames", "2", "-o", "ply", "--method", "linear",
                                   "--frames-format", "ply")
            self.assertEqual(name in ("d.off", "e.obj"), "leave out the" in err, (name, err))

    def faces_of_glb(self, name):
        """Place and texture coordinates, v upward, of each corner, and the places of the last frame."""
        data = self.read(name)
        length, = struct.unpack("<I", data[12:16])
        scene, binary = json.loads(data[20:20 + length]), data[28 + length:]
        primitive = scene["meshes"][0]["primitives"][0]

        def numbers(index, width):
            accessor = scene["accessors"][index]
            view = scene["bufferViews"][accessor["bufferView"]]
            count = width * accessor["count"]
            self.assertEqual(view["byteLength"], 4 * count)
            flat = struct.unpack(f"<{count}{'I' if width == 1 else 'f'}", binary[view["byteOffset"]:][:4 * count])
            return [flat[i:i + width] for i in range(0, count, width)]

        moved = scene["nodes"][0]["translation"]
        places = [tuple(x + m for x, m in zip(p, moved)) for p in numbers(primitive["attributes"]["POSITION"], 3)]
        shifts = numbers(primitive["targets"][-1]["POSITION"], 3)
        texture = [(u, 1 - v) for u, v in numbers(primitive["attributes"]["TEXCOORD_0"], 2)]
        return [(places[i], texture[i], tuple(map(sum, zip(places[i], shifts[i]))))
                for i, in numbers(primitive["indices"], 1)]

    def corners_of_ply(self, name):
        """The same of a frame, without the last."""
        head, _, data = self.read(name).partition(b"end_header\n")
        count = [int(line.split()[2]) for line in head.decode().splitlines() if line.startswith("element")]
        self.assertIn(b"property list uchar float texcoord\n", head)
        points = [struct.unpack_from("<3d", data, 24 * i) for i in range(count[0])]
        faces = [struct.unpack_from("<B3IB6f", data, 24 * count[0] + 38 * i) for i in range(count[1])]
        self.assertEqual({(face[0], face[4]) for face in faces}, {(3, 6)})
        return [(points[face[1 + k]], face[5 + 2 * k:7 + 2 * k]) for face in faces for k in range(3)]

    def test_texture_of_animation(self):
        """Each corner keeps its texture coordinates, on both sides of a seam, from each format, in the animation and in
        frames as PLY; in the overlay they are linear on A's faces."""
        points = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)]
        faces = [(0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)]

        def uv(face, point):
            """Another linear function on each face: every edge is a seam."""
            return (0.25 * face + 0.125 * point[0] + 0.0625 * point[1], 0.5 * point[2] + 0.03125 * face * point[1])

        corners = [(points[v], uv(f, points[v])) for f, face in enumerate(faces) for v in face]
        self.write("b.off", TETRAHEDRON.replace("1 0 0", "2 0 0"))
        body = "".join("v %d %d %d\n" % p for p in points)
        texture = "".join("vt %r %r\n" % place for _, place in corners)
        self.write("a.obj", body + texture + "".join(
            "f " + " ".join(f"{v + 1}/{3 * f + k + 1}" for k, v in enumerate(face)) + "\n" for f, face in enumerate(faces)))
        self.write("back.obj", body + texture + "".join(
            "f " + " ".join(f"{v - 4}/{3 * f + k - 12}/1" for k, v in enumerate(face)) + "\n"
            for f, face in enumerate(faces)))
        self.write("a.ply", "ply\nformat ascii 1.0\nelement vertex 4\n" + "".join(f"property float {x}\n" for x in "xyz")
                   + "element face 4\nproperty list uchar float texcoord\nproperty list uchar int vertex_indices\n"
                   + "end_header\n" + "".join("%d %d %d\n" % p for p in points)
                   + "".join("6 %s 3 %d %d %d\n" % (" ".join("%r %r" % uv(f, points[v]) for v in face), *face)
                             for f, face in enumerate(faces)))
        words = ("b.off", "--frames", "2", "-o", "frames", "--method", "linear", "--glb", "m.glb", "--frames-format", "ply")
        for name in ("a.obj", "back.obj", "a.ply", "c.ply", "c.glb"):
            if name == "c.glb" and not os.path.exists(os.path.join(BUILD, "starguard-import")):
                continue
            _, err = self.run_text("morph", name, *words)
            self.assertNotIn("leave out", err)
            found = self.faces_of_glb("m.glb")
            self.assertEqual([corner[:2] for corner in found], corners)
            self.assertEqual({last for first, _, last in found if first == (1, 0, 0)}, {(2, 0, 0)})
            self.assertEqual(self.corners_of_ply("frames/frame_0000.ply"), corners)
            self.write("c.ply", self.read("frames/frame_0000.ply"))
            self.write("c.glb", self.read("m.glb"))
        self.run_text("verify", "a.obj", "b.off", "frames")
        self.run_text("view", "frames", "-o", "p.html")
        self.run_text("morph", "a.obj", *words[:-2])
        for *command, status in (("verify", "a.obj", "b.off", "frames", 2), ("view", "frames", "-o", "p.html", 2)):
            _, err = self.run_text(*command, status=status)
            self.assertIn("as OFF and as PLY", err)
        self.sample("sphere", 520, "s.off")
        self.run_text("morph", "a.obj", "s.off", *words[1:], "--overlay")
        found = self.faces_of_glb("m.glb")
        self.assertGreater(len(found), 3 * 500)
        of_faces = [0] * 4
        for i in range(0, len(found), 3):
            middle = [sum(corner[0][k] for corner in found[i:i + 3]) / 3 for k in range(3)]
            face = min(range(4), key=lambda f: abs((middle[2], middle[1], middle[0], sum(middle) - 1)[f]))
            of_faces[face] += 1
            for place, texture, _ in found[i:i + 3]:
                for x, expected in zip(texture, uv(face, place)):
                    self.assertAlmostEqual(x, expected, delta=1e-6)
        self.assertGreater(min(of_faces), 20)

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
