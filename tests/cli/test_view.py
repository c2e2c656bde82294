# SPDX-License-Identifier: Apache-2.0
"""view: what goes into a page, what is refused, and what a build without the viewer says."""
import base64
import json
import os
import re
import shlex

import support
from support import Case, TETRAHEDRON


def data_of(page):
    """The JSON block of a page."""
    found = re.search(rb'<script type="application/json" id="data">(.*?)</script>', page, re.S)
    return json.loads(found.group(1))


def block_of(page, name):
    """The bytes of a block; None if there is none."""
    mark = f'<script type="text/plain" id="{name}">(.*?)</script>'.encode()
    found = re.search(mark, page, re.S)
    return base64.b64decode(found.group(1), validate=True) if found else None


class View(Case):
    def setUp(self):
        super().setUp()
        self.write("t.off", TETRAHEDRON)
        with self.start("view", "t.off", "-o", "probe.html") as process:
            _, err = process.communicate()
        if process.returncode == 3:
            self.assertIn(b"has no viewer", err)
            self.assertEqual(self.names(), ["t.off"])
            self.skipTest("this build has no viewer (docs/viewer.md)")
        os.remove(self.path("probe.html"))

    def results(self):
        self.sample("l-room", 500, "room.off")
        self.run_text("guard", "room.off", "-o", "guards.json")
        self.run_text("decompose", "room.off", "-o", "pieces.vtk", "--report", "pieces.json",
                      "--mode", "paper")
        self.run_text("skeleton", "room.off", "-o", "curve.obj", "--nodes", "30")
        return json.loads(self.read("guards.json"))

    def test_all_results_in_one_page(self):
        guards = self.results()
        self.run_text("morph", "room.off", "room.off", "--frames", "3", "--method", "linear",
                      "-o", "frames")
        report = self.run_json("view", "guards.json", "pieces.json", "pieces.vtk", "curve.obj",
                               "frames", "-o", "page.html")
        page = self.read("page.html")
        data = data_of(page)
        pieces = json.loads(self.read("pieces.json"))
        self.assertEqual(data["title"], "room.off")
        self.assertEqual(data["model"]["vertices"], guards["model"]["vertices"])
        self.assertEqual([g["faces"] for g in data["guards"]["list"]],
                         [g["faces"] for g in guards["guards"]])
        self.assertEqual([p["volume"] for p in data["pieces"]["list"]],
                         [p["volume"] for p in pieces["pieces"]])
        self.assertTrue(data["skeleton"]["radii"])
        self.assertEqual(data["morph"]["frames"], 3)
        self.assertEqual(report["shown"]["guards"], len(guards["guards"]))
        self.assertEqual(report["shown"]["pieces"], len(pieces["pieces"]))
        self.assertEqual(report["output"], "page.html")
        row = (guards["model"]["faces"] + 7) // 8
        seen = block_of(page, "guard-seen")
        for i, guard in enumerate(guards["guards"]):
            bits = sum(bin(byte).count("1") for byte in seen[i * row:(i + 1) * row])
            self.assertEqual(bits, guard["faces"])

    def test_a_morph_has_its_guards(self):
        self.sample("l-room", 500, "a.off")
        self.run_text("morph", "a.off", "a.off", "--frames", "2", "--guards", "-o", "frames")
        self.run_text("view", "frames", "-o", "page.html")
        page = self.read("page.html")
        count = len(json.loads(self.read("frames/guards_a.json"))["guards"])
        self.assertEqual(data_of(page)["morph"]["guards"], count)
        for end in "01":
            self.assertEqual(len(block_of(page, f"morph-guards-{end}")), 12 * count)
        self.write("frames/guards_b.json", self.read("frames/guards_a.json").replace(
            b'"guards": [', b'"guards": [\n    {"position": [1, 1, 1], "faces": 1, "level": 0},', 1))
        _, err = self.run_text("view", "frames", "-o", "page.html", status=2)
        self.assertIn("guards", err)
        os.remove(self.path("frames/guards_b.json"))
        self.run_text("view", "frames", "-o", "page.html")
        self.assertEqual(data_of(self.read("page.html"))["morph"]["guards"], 0)

    def command_of(self, *results, part="guards"):
        """The words of the command in the page of a result; None if it has none."""
        self.run_text("view", *results, "-o", "page.html")
        command = data_of(self.read("page.html"))[part].get("command")
        return command and shlex.split(command)

    def test_the_command_makes_the_same_guards(self):
        self.sample("labyrinth", 500, "it's a maze.off")
        plain = ["starguard", "guard", "it's a maze.off", "-o", "g.json"]
        for options in ([], ["--prove", "--seed", "7", "--prove-work", "300000"],
                        ["--seed", "18446744073709551615", "--count", "30"],
                        ["--method", "greedy", "--candidates", "interior", "--count", "77"],
                        ["--no-refine", "--coarsest", "100", "--step", "60", "--significance", "0.3"],
                        ["--method", "ilp", "--max-nodes", "3", "--visibility", "sweep"],
                        ["--cone", "120", "--range", "3", "--incidence", "80.1", "--no-refine",
                         "--count", "20"],
                        ["--outside", "--standoff", "0.1,0.30000000000000004", "--fov", "90,60",
                         "--count", "30", "--see", "0-20,40,50-55"],
                        ["--over", "0-800", "--height", "0.5", "--up", "1,0,0", "--count", "50",
                         "--within", "6,0,0,0,25,25", "--ignore", "3"],
                        ["--mount", "0-100,200", "--clearance", "0.1", "--count", "20"])[::1 if support.LONG else 2]:
            with self.subTest(options=options):
                self.run_text("guard", "it's a maze.off", "-o", "g.json", *options)
                first = self.read("g.json")
                words = self.command_of("g.json")
                self.assertEqual(words[:5], plain)
                self.assertTrue(options or words == plain, words)
                self.run_text(*words[1:])
                self.assertEqual(self.read("g.json"), first, words)

    def test_the_command_makes_the_same_pieces(self):
        self.sample("gallery", 500, "it's a room.off")
        self.sample("l-room", 500, "l.off")
        self.run_text("decompose", "it's a room.off", "-o", "tets.vtk", "--mode", "paper", "--density", "4")
        plain = ["starguard", "decompose", "it's a room.off", "-o", "p.vtk", "--report", "p.json"]
        self.run_text("guard", "it's a room.off", "-o", "GUARDS", "--method", "greedy")
        for model, options in (
                ("it's a room.off", ["--effort", "30"]),
                ("it's a room.off", ["--effort", "20", "--seed", "9223372036854775808", "--binary"]),
                ("l.off", ["--effort", "20", "--seed", "18446744073709551615", "--quality"]),
                ("l.off", ["--max-pieces", "12", "--seed", "0"]),
                ("it's a room.off", ["--effort", "9", "--prove", "--prove-work", "100000"]),
                ("it's a room.off", ["--effort", "9", "--balls", "even"]),
                ("it's a room.off", ["--effort", "9", "--guards", "GUARDS"]),
                ("it's a room.off", ["--mode", "paper", "--density", "3.7", "--max-pieces", "5"]),
                ("it's a room.off", ["--mode", "paper", "--generator", "stuffing"]),
                ("tets.vtk", ["--effort", "9", "--balls"]))[::1 if support.LONG else 3]:
            with self.subTest(model=model, options=options):
                self.run_text("decompose", model, "-o", "p.vtk", "--report", "p.json", *options)
                first = self.read("p.vtk"), self.read("p.json")
                words = self.command_of("p.vtk", "p.json", part="pieces")
                plain[2] = model
                self.assertEqual(words[:3] + words[3:5], plain[:5])
                self.assertEqual(len(words), len(plain) + len(options) + (options[-1] == "--balls"), words)
                for name in "p.vtk", "p.json":
                    os.remove(self.path(name))
                self.run_text(*words[1:])
                self.assertEqual((self.read("p.vtk"), self.read("p.json")), first, words)

    def test_pieces_that_nothing_makes_again_have_no_command(self):
        self.sample("gallery", 500, "room.off")
        files = "p.vtk", "p.json"
        self.run_text("decompose", "room.off", "-o", "p.vtk", "--report", "p.json", "--effort", "9")
        self.assertTrue(self.command_of(*files, part="pieces"))
        report = json.loads(self.read("p.json"))
        for change in ({"options": None}, {"time_limited": True},
                       {"options": dict(report["options"], target=500)}):
            other = {key: value for key, value in {**report, **change}.items() if value is not None}
            self.write("p.json", json.dumps(other))
            self.assertIsNone(self.command_of(*files, part="pieces"), change)

    def test_a_command_names_files_that_are_not_known(self):
        self.sample("l-room", 500, "room.off")
        self.write("places.txt", "0.2 0.2 0.2\n0.3 0.2 0.2\n")
        self.run_text("guard", "room.off", "-o", "g.json", "--candidates", "places.txt")
        self.assertIn("CANDIDATES", self.command_of("g.json"))

    def test_names_that_are_no_utf_8(self):
        folder = os.fsencode(self.folder)
        self.write("t.off", TETRAHEDRON)
        self.run_text("guard", "t.off", "-o", "g.json")
        self.run_text("db", "create", "s.db")
        self.run_text("db", "add", "s.db", "t.off")
        for name, key in (b"g.json", "guards"), (b"s.db", "shapes"):
            os.rename(os.path.join(folder, name), os.path.join(folder, b"\xff" + name))
            self.run_text("view", b"\xff" + name, "-o", "page.html")
            self.assertIn(key, data_of(self.read("page.html")))

    def test_the_same_bytes(self):
        self.results()
        for threads in "1", "3":
            self.run_text("view", "guards.json", "curve.obj", "-o", threads, "--threads", threads)
        self.assertEqual(self.read("1"), self.read("3"))
        out, _ = self.run_bytes("view", "guards.json", "curve.obj", "-o", "-", "--threads", "2")
        self.assertEqual(out, self.read("1"))

    def test_model_beside_the_result(self):
        os.mkdir(self.path("sub"))
        self.write("sub/t.off", TETRAHEDRON)
        self.run_text("guard", "t.off", "-o", "sub/g.json")
        os.remove(self.path("t.off"))
        self.run_text("view", "sub/g.json", "-o", "page.html")
        os.rename(self.path("sub/t.off"), self.path("sub/moved.off"))
        os.remove(self.path("page.html"))
        _, err = self.run_text("view", "sub/g.json", "-o", "page.html", status=2)
        self.assertIn("--model", err)
        self.assertFalse(os.path.exists(self.path("page.html")))
        self.run_text("view", "sub/g.json", "--model", "sub/moved.off", "-o", "page.html")
        self.assertEqual(data_of(self.read("page.html"))["title"], "moved.off")
        self.run_text("view", "sub/g.json", "sub/moved.off", "-o", "again.html")
        self.assertEqual(self.read("page.html"), self.read("again.html"))

    def test_wrong_models(self):
        self.results()
        _, err = self.run_text("view", "guards.json", "--model", "t.off", "-o", "p", status=2)
        self.assertIn("give the right one with --model", err)
        # as many vertices and faces, but somewhere else
        text = self.read("room.off").decode().split("\n")
        for i in range(2, 2 + int(text[1].split()[0])):
            x, y, z = map(float, text[i].split())
            text[i] = f"{x + 100:.17g} {y:.17g} {z:.17g}"
        self.write("other.off", "\n".join(text))
        _, err = self.run_text("view", "guards.json", "--model", "other.off", "-o", "p")
        self.assertIn("this may be the wrong model", err)

    def test_refusals(self):
        self.results()
        self.write("broken.json", "{")
        self.write("empty.csv", "")
        self.write("short.csv", "model,a,b\na,0,1\n")
        self.write("wrong.csv", "model,a,b\na,0,1\nc,1,0\n")
        self.write("words.csv", "model,a,b\na,0,x\nb,1,0\n")
        self.write("long.csv", "model,a\na,0,1\n")
        os.mkdir(self.path("none"))
        before = self.names()
        for words, says in [
                (["missing.json"], "missing.json"),
                (["broken.json"], "broken.json"),
                (["pieces.json"], "PIECES.vtk"),
                (["none"], "frame_0000.off"),
                (["empty.csv"], "line"),
                (["short.csv"], "one row per model"),
                (["wrong.csv"], "line 3"),
                (["words.csv"], "line 2"),
                (["long.csv"], "more numbers"),
        ]:
            _, err = self.run_text("view", *words, "-o", "page.html", status=2)
            self.assertIn(says, err)
        for words in (["guards.json", "guards.json"], ["curve.obj", "curve.obj"],
                      ["room.off", "t.off"], ["pieces.vtk", "pieces.vtk"]):
            _, err = self.run_text("view", *words, "-o", "page.html", status=1)
            self.assertIn("second", err)
        self.usage_error("view", "guards.json", says="-o")
        self.usage_error("view", "-o", "page.html", says="RESULT")
        self.run_text("view", "guards.json", "-o", "nowhere/page.html", status=3)
        self.assertEqual(self.names(), before)
        self.write("page.html", "before")
        self.run_text("view", "broken.json", "-o", "page.html", status=2)
        self.assertEqual(self.read("page.html"), b"before")

    def test_names_are_escaped(self):
        name = "<script>alert(1)<!--&.off"
        self.write(name, TETRAHEDRON)
        self.run_text("guard", name, "-o", "g.json")
        self.run_text("view", "g.json", "-o", "page.html")
        page = self.read("page.html")
        self.assertEqual(data_of(page)["title"], name)
        self.assertNotIn(b"<script>alert(1)", page)

    def test_tables(self):
        for name, pose in ("a_0", "0"), ("a_1", "1"):
            self.run_text("sample", "cat", "--pose", pose, "--vertices", "500", "-o",
                          f"{name}.off")
        self.run_text("sample", "sphere", "--vertices", "500", "-o", "b, \"c\".off")
        self.run_text("db", "create", "s.db")
        self.run_text("db", "add", "s.db", "a_0.off", "a_1.off", "b, \"c\".off")
        self.run_text("db", "matrix", "s.db", "-o", "m.csv")
        self.run_text("view", "s.db", "-o", "db.html")
        self.run_text("view", "m.csv", "-o", "csv.html")
        db, csv = self.read("db.html"), self.read("csv.html")
        self.assertEqual(data_of(db)["shapes"], data_of(csv)["shapes"])
        self.assertEqual(block_of(db, "shape-distances"), block_of(csv, "shape-distances"))
        for i in range(3):
            self.assertTrue(block_of(db, f"shape-picture-{i}").startswith(b"\x89PNG"))
        self.assertNotIn("table_command", data_of(csv))
        first = self.read("m.csv")
        for options in [], ["--distance", "d2"]:
            self.run_text("view", "s.db", "-o", "db.html", *options, "--seed", "7")
            command = data_of(self.read("db.html"))["table_command"]
            self.assertEqual(command, " ".join(["starguard db matrix s.db -o distances.csv", *options]))
            self.run_text(*shlex.split(command)[1:])
            self.assertEqual(self.read("distances.csv") == first, not options)
        os.remove(self.path("a_1.off"))
        _, err = self.run_text("view", "s.db", "-o", "db.html")
        self.assertIn("1 of 3 models", err)
        self.assertIsNone(block_of(self.read("db.html"), "shape-picture-1"))


if __name__ == "__main__":
    support.main()
