# SPDX-License-Identifier: Apache-2.0
"""What is said: numbers that are right, elements of the model and of nothing else, each thing once."""
import math

import support
from support import TETRAHEDRON

HEADINGS = {"Commands", "Options", "Common options", "Examples"}


def parse(text):
    """Vertices and faces of OFF text."""
    lines = text.split("\n")
    vertices, faces, _ = map(int, lines[1].split())
    return ([tuple(map(float, line.split())) for line in lines[2:2 + vertices]],
            [tuple(map(int, line.split()[1:])) for line in lines[2 + vertices:2 + vertices + faces]])


def join(*parts):
    """OFF text of several surfaces, each with an offset along x, a scale, and turned inside out or not."""
    vertices, faces = [], []
    for (points, triangles), offset, scale, turned in parts:
        faces += [[i + len(vertices) for i in (reversed(face) if turned else face)] for face in triangles]
        vertices += [(scale * x + offset, scale * y, scale * z) for x, y, z in points]
    return "\n".join([f"OFF\n{len(vertices)} {len(faces)} 0",
                      *(" ".join(map(repr, p)) for p in vertices),
                      *("3 " + " ".join(map(str, face)) for face in faces), ""])


def moebius(steps=24, two_sided=False):
    """A strip with a half turn, or a whole one with some faces the wrong way round."""
    halves, vertices, faces = (2 if two_sided else 1), [], []
    for i in range(steps):
        a = math.tau * i / steps
        for side in -1, 1:
            r = 3 + side * math.cos(halves * a / 2)
            vertices.append((r * math.cos(a), r * math.sin(a), side * math.sin(halves * a / 2)))
    for i in range(steps):
        a, b, c, d = (k % (2 * steps) for k in range(2 * i, 2 * i + 4))
        if i == steps - 1 and not two_sided:
            c, d = d, c
        faces += [(a, b, c), (b, d, c)]
    if two_sided:
        faces[5] = faces[5][::-1]
    return vertices, faces


class Messages(support.Case):
    def ball(self, vertices=600):
        return parse(self.read(self.sample("sphere", vertices)).decode())

    def test_percent(self):
        """57 of 100 is 57 %, though 0.57 times 100 is not 57 in doubles."""
        tetrahedron = parse(TETRAHEDRON)
        self.write("many.off", join(*((tetrahedron, 2 * i, 1, False) for i in range(100))))
        self.write("points.txt", "".join(f"{2 * i + .2} .2 .2\n" for i in range(100)))
        for count in 57, 69, 100, 99:
            out, _ = self.run_text("guard", "many.off", "-o", "g.json", "--candidates", "points.txt",
                                   "--max-guards", str(count))
            self.assertIn(f"{count} % of the faces", out)

    def test_intersections_are_of_the_model(self):
        """Levels of detail cross themselves as the model does; what is told is about the model, once."""
        ball = self.ball(600)
        self.write("two.off", join((ball, 0, 1, False), (ball, .7, 1, False)))
        found = self.run_json("check", "two.off")["findings"]["self_intersections"]
        log = self.run_json("guard", "two.off", "-o", "g.json", "--coarsest", "500", "--step", "500",
                            "--count", "50", "--no-refine")["log"]
        told = [line["message"] for line in log if "faces intersect" in line["message"]]
        self.assertEqual(len(told), 1, log)
        first = found["first"][0]
        self.assertIn(f"{found['count']} pairs of faces intersect (first: {first[0]} and {first[1]})", told[0])

    def test_stage_of_a_time_limit(self):
        _, err = self.run_text("check", self.sample("sphere", 20000), "--time-limit", "1e-9", status=3)
        self.assertIn("time limit reached in stage '", err)
        self.assertNotIn("was finished", err)

    def test_one_side_cannot_be_mended(self):
        self.write("strip.off", join((moebius(), 0, 1, False)))
        self.write("band.off", join((moebius(two_sided=True), 0, 1, False)))
        self.write("empty.off", "OFF\n0 0 0\n")
        for words in ["check"], ["guard", "-o", "g.json"]:
            _, err = self.run_text(*words, "strip.off", status=2)
            self.assertNotIn("try 'starguard repair'", err)
            self.assertIn("one-sided", err)
            _, err = self.run_text(*words, "band.off", status=2)
            self.assertIn("try 'starguard repair'", err)
            _, err = self.run_text(*words, "empty.off", status=2)
            self.assertNotIn("one-sided", err)
        self.run_text("repair", "strip.off", "-o", "r.off", status=2)

    def test_one_cavity(self):
        ball = self.ball()
        self.write("hollow.off", join((ball, 0, 1, False), (ball, 0, .5, True)))
        _, err = self.run_text("skeleton", "hollow.off", "-o", "s.obj")
        self.assertIn("has 1 cavity, which", err)

    def test_no_empty_headings(self):
        for words in [(command,) for command in [*support.COMMANDS, "db", "view", "export"]] + \
                [("db", member) for member in ("create", "add", "remove", "list", "query", "matrix", "evaluate")]:
            out, _ = self.run_text("help", *words)
            lines = out.split("\n")
            for line, after in zip(lines, lines[1:]):
                if line in HEADINGS:
                    self.assertNotEqual(after, "", (words, line))

    def test_morph_warns_once(self):
        """Of each end; and bounds are of what they bound."""
        ball = self.ball()
        self.write("a.off", join((ball, 0, 1, False), (ball, .7, 1, False)))
        self.write("b.off", join((ball, 0, 1, False), (ball, .8, 1, False)))
        report = self.run_json("morph", "a.off", "b.off", "--frames", "2", "--guards", "-o", "frames")
        told = [line["message"] for line in report["log"] if "faces intersect" in line["message"]]
        self.assertEqual(len(told), 2, told)
        self.assertTrue(told[0].startswith("A: ") and told[1].startswith("B in A's connectivity: "), told)
        out, _ = self.run_text("morph", "a.off", "b.off", "--frames", "2", "--guards", "-o", "frames")
        faces = report["unguarded_faces"]
        self.assertIn(f"in each shape; {faces} face{'s' * (faces != 1)} seen in both by none\n", out)
        self.assertIn("for all that is seen there\n", out)


if __name__ == "__main__":
    support.main()
