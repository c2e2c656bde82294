# SPDX-License-Identifier: Apache-2.0
"""What each command does with good input, seen through its files and its --json."""
import json
import os
import re
import struct

import support
from support import OPEN, TETRAHEDRON


def ply_header(data):
    return data[:data.index(b"end_header")].decode()


class Sample(support.Case):
    def test_list(self):
        text = self.run_text("sample", "--list")[0]
        listed = self.run_json("sample", "--list")
        self.assertEqual(listed["format"], "starguard-samples")
        self.assertGreaterEqual(len(listed["samples"]), 13)
        for entry in listed["samples"]:
            self.assertIn(entry["name"], text)
            self.assertGreaterEqual(entry["poses"], 1)
        self.assertGreaterEqual(sum(entry["poses"] >= 5 for entry in listed["samples"]), 6)

    def test_formats(self):
        for extension, first in [("off", b"OFF"), ("obj", b"v "), ("ply", b"ply"), ("stl", b"")]:
            self.run_text("sample", "torus", "--vertices", "600", "-o", f"t.{extension}")
            self.assertTrue(self.read(f"t.{extension}").startswith(first), extension)
            self.assertTrue(self.run_json("check", f"t.{extension}")["usable"])

    def test_poses_share_faces(self):
        def faces(pose):
            data = self.run_bytes("sample", "cat", "--pose", pose, "--vertices", "800", "-o", "-")[0]
            lines = data.decode().splitlines()
            vertices, count, _ = map(int, lines[1].split())
            return lines[2:2 + vertices], lines[2 + vertices:2 + vertices + count]
        first, second = faces("0"), faces("3")
        self.assertEqual(first[1], second[1])
        self.assertNotEqual(first[0], second[0])


class Check(support.Case):
    def test_solid(self):
        self.write("m.off", TETRAHEDRON)
        report = self.run_json("check", "m.off")
        self.assertEqual(report["format"], "starguard-check")
        self.assertEqual(report["version"], 1)
        self.assertEqual(report["model"], {"file": "m.off", "vertices": 4, "faces": 4})
        for key in ["usable", "closed", "manifold", "oriented", "embedded"]:
            self.assertIs(report[key], True)
        self.assertEqual([report[k] for k in ("components", "cavities", "genus", "edges")],
                         [1, 0, 0, 6])
        self.assertAlmostEqual(report["volume"], 1 / 6)
        self.assertAlmostEqual(report["area"], 1.5 + 3 ** 0.5 / 2)
        self.assertEqual(report["findings"], {})

    def test_open(self):
        self.write("m.off", OPEN)
        report = self.run_json("check", "m.off", status=2)
        self.assertIs(report["usable"], False)
        found = report["findings"]["open_edges"]
        self.assertEqual(found["count"], 3)
        self.assertEqual(found["element"], "edge")
        self.assertEqual(sorted(map(sorted, found["first"])), [[1, 2], [1, 3], [2, 3]])
        out, err = self.run_text("check", "m.off", status=2)
        self.assertIn("open edges", out)
        self.assertIn("not a usable solid", err)
        out, err = self.run_text("check", "m.off", "--quiet", status=2)
        self.assertEqual(out, "")
        self.assertIn("not a usable solid", err)

    def test_self_intersection_is_a_warning(self):
        shifted = [f"{x + .1} {y + .1} {z + .1}" for x, y, z in
                   [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)]]
        lines = TETRAHEDRON.splitlines()
        faces = lines[6:] + ["3 " + " ".join(str(int(i) + 4) for i in f.split()[1:])
                             for f in lines[6:]]
        self.write("m.off", "\n".join(["OFF", "8 8 12"] + lines[2:6] + shifted + faces) + "\n")
        report = self.run_json("check", "m.off")
        self.assertIs(report["usable"], True)
        self.assertIs(report["embedded"], False)
        self.assertGreater(report["findings"]["self_intersections"]["count"], 0)
        _, err = self.run_text("check", "m.off")
        self.assertIn("warning", err)
        self.run_text("guard", "m.off", "-o", "g.json", "--count", "20")
        self.assertIn("g.json", self.names())

    def test_marks(self):
        self.write("m.off", OPEN)
        text = self.run_text("check", "m.off", "--marks", "marks.ply", status=2)[0]
        self.assertRegex(text, r"#[0-9A-F]{6}  open edges")
        header = ply_header(self.read("marks.ply"))
        self.assertIn("element face 3", header)
        self.assertIn("property uchar red", header)

    def test_standard_input(self):
        out = self.run_text("check", "-", input=TETRAHEDRON.encode())[0]
        self.assertIn("usable      yes", out)


class Repair(support.Case):
    def test_fills_a_hole(self):
        self.write("m.off", OPEN)
        report = self.run_json("repair", "m.off", "-o", "mended.off")
        self.assertEqual(report["format"], "starguard-repair")
        self.assertEqual(report["repair"]["holes_filled"], 1)
        self.assertEqual(report["result"]["faces"], 4)
        self.assertIs(self.run_json("check", "mended.off")["usable"], True)

    def test_says_what_was_done(self):
        self.write("m.off", OPEN)
        self.assertRegex(self.run_text("repair", "m.off", "-o", "mended.off")[0],
                         r"holes filled +1\n")

    def test_hopeless(self):
        self.write("m.off", "OFF\n3 1 3\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n")
        self.run_text("repair", "m.off", "-o", "mended.off", status=2)
        self.assertEqual(self.names(), ["m.off"])


class Skeleton(support.Case):
    """Each format holds the graph that the report tells of."""

    def graph(self, name):
        nodes, edges = 0, []
        for line in self.read(name).decode().splitlines():
            word, *rest = line.split()
            nodes += word == "v"
            if word in ("l", "e"):
                edges.append(tuple(map(int, rest)))
        return nodes, edges

    def test_formats(self):
        torus = self.sample("torus")
        for extension in ("obj", "cg"):
            name = "s." + extension
            report = self.run_json("skeleton", torus, "-o", name, "--nodes", "60")
            nodes, edges = self.graph(name)
            self.assertEqual((nodes, len(edges)), (report["nodes"], report["edges"]))
            self.assertEqual((report["components"], report["loops"]), (1, 1))
            self.assertEqual(report["edges"] - report["nodes"] + 1, 1)
            self.assertIs(report["homotopic"], True)
            self.assertTrue(all(1 <= i <= nodes for edge in edges for i in edge))
        self.assertEqual(self.read("s.cg").decode().splitlines()[0],
                         f"# D:3 NV:{report['nodes']} NE:{report['edges']}")
        out, _ = self.run_text("skeleton", torus, "-o", "-", "--nodes", "60")
        self.assertIn(f"POINTS {report['nodes']} double", out)
        self.assertIn("SCALARS radius double 1", out)

    def test_threads_and_picture(self):
        torus = self.sample("torus")
        self.run_text("skeleton", torus, "-o", "a.obj", "--threads", "1")
        self.run_text("skeleton", torus, "-o", "b.obj", "--threads", "4", "--picture", "p.png")
        self.assertEqual(self.read("a.obj"), self.read("b.obj"))
        self.assertTrue(os.path.getsize(os.path.join(self.folder, "p.png")) > 1000)

    def test_bad(self):
        torus = self.sample("torus")
        self.run_text("skeleton", torus, status=1)
        self.run_text("skeleton", torus, "-o", "s.xyz", status=1)
        self.run_text("skeleton", torus, "-o", "s.obj", "--prune", "0.5", status=1)
        self.run_text("skeleton", torus, "-o", "s.obj", "--nodes", "0", status=1)
        self.run_text("skeleton", "none.off", "-o", "s.obj", status=2)


class Visible(support.Case):
    def test_convex(self):
        self.write("m.off", TETRAHEDRON)
        report = self.run_json("visible", "m.off", "--from", "0.1,0.1,0.1", "--from", "2,2,2")
        self.assertEqual(report["format"], "starguard-visible")
        inside, outside = report["points"]
        self.assertEqual(inside["position"], [0.1, 0.1, 0.1])
        self.assertIs(inside["inside"], True)
        self.assertEqual(inside["faces"], [0, 1, 2, 3])
        self.assertEqual(inside["count"], 4)
        self.assertAlmostEqual(inside["area"], 1)
        self.assertIs(outside["inside"], False)
        self.assertEqual(outside["faces"], [])
        self.assertIn("not inside", self.run_text("visible", "m.off", "--from", "2,2,2")[0])

    def test_targets_and_range(self):
        self.write("m.off", TETRAHEDRON)
        report = self.run_json("visible", "m.off", "--from", ".1,.1,.1", "--target", "vertices")
        self.assertEqual(report["points"][0]["vertices"], [0, 1, 2, 3])
        report = self.run_json("visible", "m.off", "--from", ".1,.1,.1", "--range", "0.5")
        self.assertEqual(report["points"][0]["faces"], [])

    def test_boxes(self):
        room = self.sample("l-room")
        corners = [".4,.4,.4,.6,.6,.6", ".6,.6,.6,.4,.4,.4", "90,90,90,91,91,91"]
        options = [word for box in corners for word in ["--box", box]]
        some, same, none = self.run_json("visible", room, *options, "-o", "v.ply")["boxes"]
        self.assertEqual(some, same)
        self.assertEqual(some["lower"], [.4, .4, .4])
        self.assertEqual(none["faces"], [])
        self.assertIn("sees at most", self.run_text("visible", room, "--box", corners[0])[0])
        seen = self.run_json("visible", room, "--from", ".5,.5,.5")["points"][0]
        self.assertTrue(seen["inside"])
        self.assertLessEqual(set(seen["faces"]), set(some["faces"]))

    def test_engines_agree(self):
        room = self.sample("l-room")
        lower = self.run_json("check", room)
        self.assertIs(lower["usable"], True)
        guards = json.loads((self.run_bytes("guard", room, "-o", "-")[0]))
        point = ",".join(map(repr, guards["guards"][0]["position"]))
        for rule in ["vertices", "whole"]:
            seen = [self.run_json("visible", room, "--from", point, "--engine", engine,
                                  "--faces", rule)["points"]
                    for engine in ["fastest", "contours", "grid", "bvh", "sweep"]]
            self.assertGreater(seen[0][0]["count"], 0)
            for other in seen[1:]:
                self.assertEqual(seen[0], other)

    def test_colours(self):
        self.write("m.off", TETRAHEDRON)
        for target in ["faces", "vertices"]:
            self.run_text("visible", "m.off", "--from", "2,2,2", "--from", ".1,.1,.1", "-o",
                          "v.ply", "--target", target)
            data = self.read("v.ply")
            body = data[data.index(b"end_header\n") + 11:]
            size = 1 + 12 + 3
            colors = {struct.unpack_from("3B", body, 4 * 24 + size * f + 13) for f in range(4)}
            self.assertEqual(len(colors), 1)
            self.assertNotIn((190, 195, 200), colors)


class Kernel(support.Case):
    def test_star(self):
        self.write("m.off", TETRAHEDRON)
        report = self.run_json("kernel", "m.off")
        self.assertEqual(report["format"], "starguard-kernel")
        self.assertEqual(report["verdict"], "interior")
        self.assertIs(report["star"], True)
        radius = 1 / (3 + 3 ** 0.5)  # of the inscribed ball
        self.assertAlmostEqual(report["radius"], radius)
        for x in report["guard"]:
            self.assertAlmostEqual(x, radius)
        self.assertEqual(report["witness"], [])
        text = self.run_text("kernel", "m.off")[0]
        self.assertIn("star-shaped", text)
        self.assertRegex(text, r"(?m)^guard +0\.211")

    def test_no_star(self):
        torus = self.sample("torus")
        report = self.run_json("kernel", torus)
        self.assertEqual(report["verdict"], "empty")
        self.assertIs(report["star"], False)
        self.assertIsNone(report["guard"])
        self.assertLess(report["radius"], 0)
        self.assertIn(len(report["witness"]), [1, 2, 3, 4])
        self.assertIn("not star-shaped", self.run_text("kernel", torus)[0])

    def test_open(self):
        self.write("m.off", OPEN)
        self.run_text("kernel", "m.off", status=2)


class Guard(support.Case):
    def setUp(self):
        super().setUp()
        self.room = self.sample("l-room")

    def test_result_and_report_agree(self):
        report = self.run_json("guard", self.room, "-o", "g.json", "--marks", "g.ply", "--picture",
                               "g.png")
        result = json.loads(self.read("g.json"))
        self.assertEqual(result["format"], "starguard-guards")
        self.assertEqual({key: report[key] for key in result}, result)
        for absent in ["seconds", "memory", "log", "threads"]:
            self.assertNotIn(absent, result)
        self.assertGreater(report["memory"]["peak_resident_bytes"], 0)
        self.assertGreater(report["seconds"]["total"], 0)
        self.assertTrue(self.read("g.png").startswith(b"\x89PNG\r\n"))
        self.assertIn("property uchar red", ply_header(self.read("g.ply")))
        self.run_text("verify", self.room, "g.json")

    def test_options_reach_the_result(self):
        self.run_text("guard", self.room, "-o", "g.json", "--method", "greedy", "--candidates",
                      "interior", "--count", "50", "--coverage", "0.5", "--redundancy", "2",
                      "--clearance", "0.01", "--range", "1000", "--faces", "whole")
        options = json.loads(self.read("g.json"))["options"]
        expected = {"method": "greedy", "candidates": "interior", "count": 50, "coverage": 0.5,
                    "redundancy": 2, "clearance": 0.01, "range": 1000.0, "faces": "whole",
                    "target": "faces", "max_guards": 0}
        for key, value in expected.items():
            self.assertEqual(options[key], value, key)
        self.run_text("verify", self.room, "g.json")

    def test_limits(self):
        maze = self.sample("labyrinth")
        one = self.run_json("guard", maze, "-o", "g.json", "--max-guards", "1", "--count", "60")
        self.assertEqual(len(one["guards"]), 1)
        self.assertLess(one["coverage"]["area"], 1)
        self.run_text("verify", maze, "g.json")
        vertices = self.run_json("guard", self.room, "-o", "v.json", "--target", "vertices")
        self.assertEqual(vertices["coverage"]["vertices"], 1)
        self.run_text("verify", self.room, "v.json")

    def test_text(self):
        text = self.run_text("guard", self.room, "-o", "g.json")[0]
        for line in ["guards", "coverage", "uncovered", "candidates"]:
            self.assertRegex(text, rf"(?m)^{line} +\d")
        self.assertNotIn("lower bound", text)
        for more in (["--verbose"], ["--candidates", "g.json"]):
            text = self.run_text("guard", self.room, "-o", "h.json", *more)[0]
            self.assertRegex(text, r"(?m)^lower bound +\d+ of these candidates \(")

    def test_without_a_bound(self):
        """There is a bound for all places in the line of the guards, or the reason why not."""
        for words, says in [(["--no-refine", "--target", "vertices"], r"was not sought \(--prove does\)"),
                            (["--coverage", "0.9"], r"is not sought for a part of the area \(--prove does\)"),
                            (["--coverage", "0.9", "--prove", "--prove-work", "30000"], None), ([], None)]:
            text = self.run_text("guard", self.sample("gallery"), "-o", "g.json", "--count", "60", *words)[0]
            known = "lower_bound_everywhere" in json.loads(self.read("g.json"))
            self.assertEqual(known, says is None, words)
            self.assertRegex(text, r"(?m)^guards +\d+(, the fewest possible|; at least \d+ (is|are) needed) wherever they "
                             "stand$" if known else rf"(?m)^guards +\d+; how many are needed wherever they stand {says}$")

    def test_anywhere(self):
        maze = self.sample("gallery")
        plain = self.run_json("guard", maze, "-o", "g.json", "--count", "60")
        self.assertGreater(plain.get("lower_bound_everywhere", 2), 1)
        report = self.run_json("guard", maze, "-o", "p.json", "--count", "60", "--prove",
                               "--prove-work", "50000")
        self.assertLessEqual(len(report["guards"]), len(plain["guards"]))
        self.assertLessEqual(report["lower_bound_everywhere"], report["lower_bound"])
        self.assertIs(report["optimal_everywhere"],
                      report["lower_bound_everywhere"] == len(report["guards"]))
        self.assertGreater(report["cells"], 1)
        self.run_text("verify", maze, "p.json")
        text = self.run_text("guard", maze, "-o", "p.json", "--count", "60", "--prove",
                             "--prove-work", "30000")[0]
        self.assertRegex(text, r"(?m)^guards +\d+(, the fewest possible|; at least \d+ (is|are) needed) "
                               "wherever they stand$")

    def test_anywhere_of_other_questions(self):
        maze = self.sample("gallery")
        self.run_text("guard", maze, "-o", "g.json", "--count", "60", "--no-refine")
        for options in [["--coverage", "0.9"], ["--redundancy", "2"], ["--cone", "120"],
                        ["--candidates", "g.json"], ["--max-guards", "2"]]:
            model = self.room if options[0] == "--cone" else maze  # it takes long in the other
            out = self.run_text("guard", model, "-o", "p.json", "--count", "60", "--prove",
                                "--prove-work", "10000", "--refine-lines", "5000", *options)[0]
            self.run_text("verify", model, "p.json")
            report = json.loads(self.read("p.json"))
            if options[0] == "--max-guards":
                self.assertRegex(out, r"(?m)^guards +2 of at most 2$")
                self.assertRegex(out, r"(?m)^area +\S+ % seen, at most \S+ % possible with 2 guards "
                                      "wherever they stand$")
                self.assertNotIn("fewe", out)
                self.assertNotIn("lower", out)
                self.assertLessEqual(report["coverage"]["area"],
                                     report["coverage"]["area_bound_everywhere"])
            else:
                self.assertGreaterEqual(report["lower_bound_everywhere"], 1)
                self.assertRegex(out, r"(?m)^guards .* wherever they stand$")
        for options in [["--coverage", "0.9"], ["--max-guards", "2"]]:
            err = self.run_text("guard", maze, "-o", "no.json", "--prove", "--certificate", "c",
                                *options, status=1)[1]
            self.assertIn("everything is to be seen", err)
        self.assertNotIn("no.json", self.names())

    def test_certificate(self):
        maze = self.sample("gallery")
        prove = ["guard", maze, "--count", "60", "--prove", "--prove-work", "30000"]
        self.run_text(*prove, "-o", "plain.json")
        self.run_text(*prove, "-o", "g.json", "--certificate", "why.txt")
        self.assertEqual(self.read("plain.json"), self.read("g.json"))
        self.assertTrue(self.read("why.txt").startswith(b"starguard-certificate 2\n"))
        out = self.run_text("verify", maze, "g.json")[0]
        self.assertRegex(out, r"not checked: that at least \d+ guards? (is|are) needed, wherever they stand")
        told = self.run_json("verify", maze, "g.json", "why.txt")["results"]
        self.assertEqual([(r["file"], r["certificate"], r["passed"]) for r in told],
                         [("g.json", "why.txt", True)])
        self.assertTrue(any("wherever they stand" in c["claim"] for c in told[0]["claims"]))
        self.assertFalse(any("wherever" in text for text in told[0]["not_checked"]))
        room = self.room
        self.run_text("guard", room, "-o", "r.json", "--prove")
        out = self.run_text("verify", room, "r.json", "why.txt", status=4)[0]
        self.assertIn("it is of another model", out)
        raised = json.loads(self.read("g.json"))
        bound = raised["lower_bound_everywhere"] = raised["lower_bound_everywhere"] + 1
        raised["lower_bound"] = max(bound, raised["lower_bound"])
        self.write("raised.json", json.dumps(raised))
        out = self.run_text("verify", maze, "raised.json", "why.txt", status=4)[0]
        self.assertRegex(out, r"FAILED.*the certificate says no more than")
        self.write("short.txt", self.read("why.txt")[:-20].decode())
        err = self.run_text("verify", maze, "g.json", "short.txt", status=2)[1]
        self.assertRegex(err, r"'short.txt', line \d+: ")
        for operands in [["why.txt"], ["why.txt", "g.json"], ["g.json", "why.txt", "why.txt"]]:
            err = self.run_text("verify", maze, *operands, status=1)[1]
            self.assertIn("behind its GUARDS.json", err)
        err = self.run_text("guard", maze, "-o", "no.json", "--certificate", "no.txt", status=1)[1]
        self.assertIn("add --prove", err)
        self.assertFalse({"no.json", "no.txt"} & set(self.names()))

    def test_candidates_from_files(self):
        self.run_text("guard", self.room, "-o", "g.json")
        guards = json.loads(self.read("g.json"))["guards"]
        lines = "".join("{!r} {!r} {!r}\n".format(*g["position"]) for g in guards)
        self.write("points.txt", "# from a file\n" + lines)
        for file in ["g.json", "points.txt"]:
            again = self.run_json("guard", self.room, "-o", "again.json", "--candidates", file)
            self.assertEqual(again["candidates"], len(guards))
            self.assertEqual(sorted(g["position"] for g in again["guards"]),
                             sorted(g["position"] for g in guards))
        data = self.read("points.txt")
        self.run_text("guard", self.room, "-o", "-", "--candidates", "-", input=data)
        self.write("bad.txt", "1 2\n")
        self.run_text("guard", self.room, "-o", "bad.json", "--candidates", "bad.txt", status=2)
        self.run_text("guard", self.room, "-o", "bad.json", "--candidates", "./none", status=2)
        self.run_text("guard", "-", "-o", "bad.json", "--candidates", "-", status=1)
        self.assertNotIn("bad.json", self.names())

    def test_pipes(self):
        model = self.read(self.room)
        out, err = self.run_text("guard", "-", "-o", "-", input=model)
        result = json.loads(out)
        self.assertEqual(result["model"]["file"], "-")
        self.assertIn("guards  ", err)
        self.assertEqual(self.names(), [self.room])
        claims = self.run_text("verify", self.room, "-", input=out.encode())[0]
        self.assertIn("verified", claims)
        out, err = self.run_text("guard", "-", "-o", "-", "--quiet", input=model)
        self.assertEqual(err, "")


class Verify(support.Case):
    def setUp(self):
        super().setUp()
        self.room = self.sample("l-room")
        self.run_text("guard", self.room, "-o", "g.json", "--count", "60")
        self.result = json.loads(self.read("g.json"))

    def test_passes(self):
        report = self.run_json("verify", self.room, "g.json", "g.json")
        self.assertIs(report["passed"], True)
        self.assertEqual([r["file"] for r in report["results"]], ["g.json", "g.json"])
        self.assertTrue(all(c["holds"] for r in report["results"] for c in r["claims"]))
        out, err = self.run_text("verify", self.room, "g.json", "--quiet")
        self.assertEqual(out + err, "")

    def test_fails(self):
        changes = {
            "moved": lambda r: r["guards"][0].update(position=[1e6, 0, 0]),
            "count": lambda r: r["guards"][0].update(faces=1),
            "area": lambda r: r["coverage"].update(area=0.5),
            "bound": lambda r: r.update(lower_bound=len(r["guards"]) + 1),
            "hidden": lambda r: r["coverage"].update(uncovered_faces=[0]),
        }
        for name, change in changes.items():
            result = json.loads(json.dumps(self.result))
            change(result)
            self.write("bad.json", json.dumps(result))
            out, _ = self.run_text("verify", self.room, "bad.json", status=4)
            self.assertIn("FAILED", out, name)
            report = self.run_json("verify", self.room, "g.json", "bad.json", status=4)
            self.assertIs(report["passed"], False)
            self.assertEqual([r["passed"] for r in report["results"]], [True, False])
            out, err = self.run_text("verify", self.room, "bad.json", "--quiet", status=4)
            self.assertEqual(out, "")
            self.assertIn("FAILED", err)

    def test_unreadable(self):
        self.write("text.json", "{")
        self.write("other.json", '{"format": "something"}')
        self.write("empty.json", "")
        for name in ["none.json", "text.json", "other.json", "empty.json", "."]:
            self.run_text("verify", self.room, "g.json", name, status=2)

    def test_other_model(self):
        other = self.sample("torus")
        self.run_text("verify", other, "g.json", status=4)


class Documentation(support.Case):
    """Every key that is printed or written is in docs/formats.md or docs/fields.md."""

    def keys(self, value):
        if isinstance(value, list):
            return set().union(*map(self.keys, value))
        if not isinstance(value, dict):
            return set()
        stages = set(value.get("seconds", {}))
        return (set(value) | set().union(*map(self.keys, value.values()))) - stages

    def test_keys(self):
        words = set()
        for page in [os.path.join(os.path.dirname(__file__), "../../docs/formats.md"),
                     os.path.join(support.BUILD, "docs/fields.md")]:
            with open(page, encoding="utf-8") as file:
                words |= set(re.findall(r"\w+", " ".join(re.findall(r"`([^`]*)`", file.read()))))
        room = self.sample("l-room")
        self.write("open.off", OPEN)
        look = ["visible", room, "--from", "0,0,0", "--target"]
        guard = ["guard", room, "-o", "g.json", "--count", "60"]
        reports = [
            self.run_json("sample", "--list"),
            self.run_json("sample", "torus", "-o", "t.off"),
            self.run_json("check", room),
            self.run_json("check", "open.off", status=2),
            self.run_json("check", "none.off", status=2),
            self.run_json("repair", "open.off", "-o", "m.off"),
            self.run_json("skeleton", room, "-o", "s.cg"),
            self.run_json("kernel", room),
            self.run_json(*look, "faces"),
            self.run_json(*look, "vertices"),
            self.run_json(*guard),
            self.run_json("verify", room, "g.json"),
            json.loads(self.read("g.json")),
            self.run_json(*guard, "--target", "vertices", "--max-guards", "1"),
            json.loads(self.read("g.json")),
        ]
        for report in reports:
            self.assertEqual(self.keys(report) - words, set())


if __name__ == "__main__":
    support.main()
