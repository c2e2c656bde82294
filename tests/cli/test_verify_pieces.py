# SPDX-License-Identifier: Apache-2.0
"""verify with star decompositions: which file is which, exit status, what is printed."""
import itertools
import json
import math
import operator
import os
import struct

import support
from support import OPEN, TETRAHEDRON

POINTS = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1), (.25, .25, .25)]
# The faces of the model, coned from its middle; two tetrahedra make a piece.
CELLS = [(0, 1, 2, 4), (0, 3, 1, 4), (0, 2, 3, 4), (1, 3, 2, 4)]
LABELS = [0, 0, 1, 1]


def vtk(points=POINTS, cells=CELLS, labels=LABELS, binary=False):
    """A PIECES.vtk, as bytes."""
    def numbers(values, code):
        if binary:
            return struct.pack(f">{len(values)}{code}", *values)
        return (" ".join(map(repr, values)) + "\n").encode()
    head = "# vtk DataFile Version 3.0\npieces\n" + ("BINARY" if binary else "ASCII")
    return b"".join([
        f"{head}\nDATASET UNSTRUCTURED_GRID\nPOINTS {len(points)} double\n".encode(),
        numbers([float(x) for p in points for x in p], "d"),
        f"\nCELLS {len(cells)} {5 * len(cells)}\n".encode(),
        numbers([i for c in cells for i in (4, *c)], "i"),
        f"\nCELL_TYPES {len(cells)}\n".encode(), numbers([10] * len(cells), "i"),
        f"\nCELL_DATA {len(cells)}\nSCALARS piece int 1\nLOOKUP_TABLE default\n".encode(),
        numbers(labels, "i")])


def middle(*corners):
    return [sum(POINTS[i][k] for i in corners) / 3 for k in range(3)]


def normal(a, b, c):
    u, v = ([q - p for p, q in zip(POINTS[a], POINTS[i])] for i in (b, c))
    return [u[i] * v[j] - u[j] * v[i] for i, j in ((1, 2), (2, 0), (0, 1))]


def dot(u, v):
    return sum(map(operator.mul, u, v))


def area(*corners):
    return math.hypot(*normal(*corners)) / 2


def sides(cell):
    """The faces of a tetrahedron, outward."""
    a, b, c, d = cell
    return [(b, c, d), (a, d, c), (a, b, d), (a, c, b)]


def smallest_angle(cell):
    normals = [normal(*side) for side in sides(cell)]
    return min(180 - math.degrees(math.acos(dot(u, v) / math.hypot(*u) / math.hypot(*v)))
               for u, v in itertools.combinations(normals, 2))


def corner(face):
    """The smallest angle of a triangle."""
    def angle(a, b, c):
        u, v = ([q - p for p, q in zip(POINTS[a], POINTS[i])] for i in (b, c))
        return math.degrees(math.acos(dot(u, v) / math.hypot(*u) / math.hypot(*v)))
    a, b, c = face
    return min(angle(a, b, c), angle(b, c, a), angle(c, a, b))


def flatness(cell):
    a, b, c, d = cell
    volume = dot(normal(a, b, c), [q - p for p, q in zip(POINTS[a], POINTS[d])]) / 6
    longest = max(math.dist(POINTS[i], POINTS[k]) for i, k in itertools.combinations(cell, 2))
    return 3 * volume / max(area(*side) for side in sides(cell)) / longest


def room(guard, cells):
    """The distance of a guard from the planes of a piece, and that by the piece's diagonal."""
    walls = [side for cell in cells for side in sides(cell)]
    walls = [w for w in walls if sum(set(w) == set(v) for v in walls) == 1]
    radius = min(dot(normal(*w), [p - g for p, g in zip(POINTS[w[0]], guard)]) / 2 / area(*w)
                 for w in walls)
    spans = [{POINTS[i][k] for w in walls for i in w} for k in range(3)]
    return {"radius": radius, "margin": radius / math.hypot(*(max(s) - min(s) for s in spans))}


def report(**changes):
    """The PIECES.json that belongs to it: guards amid the face that the two tetrahedra share."""
    shared = [(0, 2, 4), (1, 2, 4), (0, 3, 4), (1, 3, 4)]  # between the pieces
    angles = sorted(map(smallest_angle, CELLS))
    value = {
        "format": "starguard-pieces", "version": 1, "mode": "strict", "tetrahedra": 4,
        "model": {"vertices": 4, "faces": 4},
        "flattest": min(map(flatness, CELLS)), "smallest_angle": angles[0], "median_angle": angles[2],
        "smallest_angle_made": min([180, *(smallest_angle(c) for c in CELLS if smallest_angle(c) < corner(c[:3]))]),
        "pieces": [
            {"guard": middle(0, 1, 4), "tetrahedra": 2, "volume": 1 / 12, "star": True,
             **room(middle(0, 1, 4), CELLS[:2])},
            {"guard": middle(2, 3, 4), "tetrahedra": 2, "volume": 1 / 12, "star": True,
             **room(middle(2, 3, 4), CELLS[2:])}],
        "strictly_star": 2, "visible_vertices": 1,
        "adjacency": [[0, 1, sum(area(*f) for f in shared)]]}
    value.update(changes)
    return json.dumps(value)


OF_TETRAHEDRA = report(model={"vertices": 5, "tetrahedra": 4})


class Pieces(support.Case):
    def setUp(self):
        super().setUp()
        self.write("m.off", TETRAHEDRON)
        self.write("p.vtk", vtk())
        self.write("p.json", report())

    def failed(self, *words):
        found = self.run_json("verify", *words, status=4)
        self.assertIs(found["passed"], False)
        return [c["claim"] for r in found["results"] for c in r["claims"] if not c["holds"]]

    def test_passes(self):
        self.write("b.vtk", vtk(binary=True))
        for words in [("p.json", "p.vtk"), ("p.vtk", "p.json"), ("b.vtk", "p.json")]:
            out, err = self.run_text("verify", "m.off", *words)
            self.assertEqual(err, "")
            self.assertIn("\n  verified: 2 of 2 pieces are star-shaped", out)
            self.assertNotIn("ok  ", out)
            out, err = self.run_text("verify", "m.off", *words, "--verbose")
            self.assertIn("2 of 2, exactly proven", out)
            self.assertNotRegex(out, r"\d\.\d{10}")
        found = self.run_json("verify", "m.off", "p.json", "p.vtk")
        result = found["results"][0]
        self.assertIs(found["passed"], True)
        self.assertEqual(len(found["results"]), 1)
        self.assertEqual([result[k] for k in ("file", "report", "tetrahedra", "pieces",
                                              "strictly_star")], ["p.vtk", "p.json", 4, 2, 2])
        self.assertEqual(self.run_text("verify", "m.off", "p.json", "p.vtk", "--quiet"), ("", ""))

    def test_order(self):
        self.run_text("guard", "m.off", "-o", "g.json", "--count", "20", "--quiet")
        for words in ["p.json p.vtk m.off", "p.vtk m.off p.json", "g.json m.off", "p.vtk p.json m.off g.json"]:
            self.assertIs(self.run_json("verify", *words.split())["passed"], True)
        self.write("tets.vtk", vtk(binary=True))  # before its pieces, as it could be them
        self.write("t.json", OF_TETRAHEDRA)
        self.run_text("verify", "t.json", "tets.vtk", "p.vtk")

    def test_standard_input(self):
        self.run_text("verify", "m.off", "-", "p.vtk", input=report().encode())
        self.run_text("verify", "m.off", "p.json", "-", input=vtk())
        self.run_text("verify", "-", "p.json", "p.vtk", input=TETRAHEDRON.encode())

    def test_pipe(self):
        self.write("t.json", OF_TETRAHEDRA)
        for model, told in [(TETRAHEDRON.encode(), "p.json"), (vtk(), "t.json")]:
            read, write = os.pipe()
            os.write(write, model)
            os.close(write)
            self.run_text("verify", f"/dev/fd/{read}", told, "p.vtk", pass_fds=[read])
            os.close(read)

    def test_beside_guards(self):
        self.run_text("guard", "m.off", "-o", "g.json", "--count", "20", "--quiet")
        found = self.run_json("verify", "m.off", "p.json", "g.json", "p.vtk")
        self.assertEqual([r["file"] for r in found["results"]], ["g.json", "p.vtk"])

    def test_tetrahedral_model(self):
        self.write("m.vtk", vtk(binary=True))
        self.write("t.json", OF_TETRAHEDRA)
        self.run_text("verify", "m.vtk", "t.json", "p.vtk")
        self.assertIn("the model has 4 vertices and 0 tetrahedra",
                      self.failed("m.vtk", "p.json", "p.vtk")[0])
        self.write("m.node", "4 3 0 0\n0 0 0 0\n1 1 0 0\n2 0 1 0\n3 0 0 1\n")
        self.write("m.ele", "1 4 0\n0 0 1 2 3\n")
        self.write("one.json", report(model={"vertices": 4, "tetrahedra": 1}))
        self.run_text("verify", "m.ele", "one.json", "p.vtk")
        self.write("other.vtk", vtk(cells=CELLS[:3], labels=[0, 0, 0]))
        self.assertTrue(self.failed("other.vtk", "t.json", "p.vtk"))

    def test_fails(self):
        pieces = json.loads(report())["pieces"]
        moved = [dict(pieces[0], guard=[.25, .25, .25]), pieces[1]]
        for name, says, changes in [
                ("guard", "first piece 0, whose guard is not strictly", {"pieces": moved}),
                ("count", "tetrahedra (the file holds 4)", {"tetrahedra": 5}),
                ("star", "1 pieces are strictly", {"strictly_star": 1}),
                ("contact", "contacts", {"adjacency": []}),
                ("seen", "vertices", {"visible_vertices": .5})]:
            self.write("bad.json", report(**changes))
            self.assertTrue(any(says in c for c in self.failed("m.off", "bad.json", "p.vtk")), name)
            out, _ = self.run_text("verify", "m.off", "bad.json", "p.vtk", status=4)
            self.assertIn("NOT verified", out)
        self.write("bad.vtk", vtk(cells=CELLS[:3] + [(1, 2, 3, 4)]))
        out, err = self.run_text("verify", "m.off", "p.json", "bad.vtk", "--quiet", status=4)
        self.assertEqual(out, "")
        self.assertIn("inverted or flat, first tetrahedron 3 of piece 1", err)

    def test_what_decompose_makes(self):
        room = self.sample("l-room")
        for options in [(), ("--binary",)]:
            self.run_text("decompose", room, "-o", "d.vtk", "--report", "d.json", "--effort", "30",
                          "--quiet", *options)
            found = self.run_json("verify", room, "d.vtk", "d.json")
            self.assertIs(found["passed"], True)
            self.assertGreater(found["results"][0]["strictly_star"], 0)
        other = self.sample("torus")
        self.assertTrue(self.failed(other, "d.vtk", "d.json"))

    def test_what_the_model_encloses(self):
        """Pieces that overlap, and a small part that is missing, though all else is as it should be."""
        def twice(scale, shift):
            points = POINTS + [[scale * x + shift for x in p] for p in POINTS]
            lines = [" ".join(map(str, points[i])) for i in (0, 1, 2, 3, 5, 6, 7, 8)]
            faces = [line.split()[1:] for line in TETRAHEDRON.splitlines()[6:10]]
            lines += [" ".join(["3", *(str(int(v) + d) for v in face)]) for d in (0, 4) for face in faces]
            self.write("two.off", "\n".join(["OFF", "8 8 0", *lines, ""]))
            return points
        one, model = json.loads(report()), {"vertices": 8, "faces": 8}
        self.write("both.vtk", vtk(twice(1, .125), CELLS + [[i + 5 for i in c] for c in CELLS], [0, 0, 1, 1, 2, 2, 3, 3]))
        moved = [{**p, "guard": [x + .125 for x in p["guard"]]} for p in one["pieces"]]
        (_, _, shared), = one["adjacency"]
        self.write("both.json", report(model=model, tetrahedra=8, strictly_star=4, pieces=one["pieces"] + moved,
                                       adjacency=[[0, 1, shared], [2, 3, shared]]))
        failed, = self.failed("two.off", "both.vtk", "both.json")
        self.assertRegex(failed, "fill what the model encloses, once: .* 0 inside the model are in no piece")
        twice(.015625, -.001)  # at a corner
        for distance in (1e-9, .5):
            self.write("short.json", report(model=model, surface="approximated", distance=distance, distance_back=.1))
            failed, = self.failed("two.off", "p.vtk", "short.json")
            self.assertRegex(failed, "fill what the model encloses, once: .* 0 others are in a piece")

    def test_approximated(self):
        self.write("near.json", report(surface="approximated", distance=.01,
                                      distance_back=.01))
        self.write("open.off", OPEN)
        self.run_text("verify", "m.off", "near.json", "p.vtk")
        self.assertIn("away", self.failed("open.off", "near.json", "p.vtk")[0])
        self.run_text("verify", "open.off", "p.json", "p.vtk", status=2)

    def test_files_that_do_not_go_together(self):
        out, err = self.run_text("verify", "m.off", "p.vtk")
        self.assertIn("has no PIECES.json", err)
        self.assertIn("verified", out)
        self.assertIn("add its PIECES.vtk",
                      self.run_text("verify", "m.off", "p.json", status=2)[1])
        self.usage_error("verify", "m.off", "p.vtk", "p.json", "p.vtk", says="separately")

    def test_unreadable(self):
        self.write("short.vtk", vtk()[:200])
        self.write("short.bin.vtk", vtk(binary=True)[:300])
        self.write("huge.vtk", vtk().replace(b"CELLS 4 20", b"CELLS 100000000 500000000"))
        self.write("nan.vtk", vtk().replace(b"0.25", b"nan", 1))
        self.write("text.vtk", "some text")
        self.write("bad.json", report(version=2))
        for name in ["short.vtk", "short.bin.vtk", "huge.vtk", "nan.vtk", "text.vtk", "none.vtk"]:
            _, err = self.run_text("verify", "m.off", "p.json", name, status=2)
            self.assertIn(name, err)
        self.run_text("verify", "m.off", "bad.json", "p.vtk", status=2)
        self.run_text("verify", "none.off", "p.json", "p.vtk", status=2)

    def test_keys_are_documented(self):
        text = ""
        for page in [os.path.join(os.path.dirname(__file__), "../../docs/formats.md"),
                     os.path.join(support.BUILD, "docs/fields.md")]:
            with open(page, encoding="utf-8") as file:
                text += file.read()
        result = self.run_json("verify", "m.off", "p.json", "p.vtk")["results"][0]
        for key in list(json.loads(report())) + list(result):
            self.assertRegex(text, rf"`[^`]*\b{key}\b[^`]*`")


if __name__ == "__main__":
    support.main()
