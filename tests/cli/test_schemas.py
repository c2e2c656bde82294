# SPDX-License-Identifier: Apache-2.0
"""Results and reports are what the schemas say, those of docs/schema and those that the build makes of
the field tables, by a validator that we did not write.

The schemas leave room for keys of later versions, as readers have to. Here that room is closed, so
that a key which no schema tells of fails the test. Every document that passes is then spoilt in every
place, one at a time: a schema that takes all of that would say nothing."""
import copy
import glob
import json
import os
import unittest

import support

try:
    import jsonschema
except ImportError:
    jsonschema = None

FOLDERS = [os.path.join(folder, "docs", "schema") for folder in (
    os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", ".."),
    support.BUILD)]
MIXIN = "mixin"  # the $comment of a schema that others add keys to


def load(name):
    found = [path for folder in FOLDERS
             if os.path.exists(path := os.path.join(folder, f"{name}.schema.json"))]
    assert len(found) == 1, f"{name}: {found}"
    with open(found[0], encoding="utf-8") as file:
        return json.load(file)


def closed(schema):
    """The same schema without room for more keys."""
    if isinstance(schema, list):
        return [closed(part) for part in schema]
    if not isinstance(schema, dict):
        return schema
    result = {key: value if key in ("if", "const", "enum") else closed(value)
              for key, value in schema.items()}
    if schema.get("type") == "object" and schema.get("$comment") != MIXIN:
        if "additionalProperties" not in schema:
            result["unevaluatedProperties"] = False
    return result


def places(value, path=()):
    """Paths of all values in a document; of lists only the first entry."""
    yield path
    if isinstance(value, dict):
        for key in value:
            yield from places(value[key], path + (key,))
    elif isinstance(value, list) and value:
        yield from places(value[0], path + (0,))


def shortened(value):
    """The first entries of long lists, except of numbers, whose count may have to be right: spoilt
    documents are copied and validated hundreds of times."""
    if isinstance(value, dict):
        return {key: shortened(part) for key, part in value.items()}
    if isinstance(value, list) and value and isinstance(value[0], (dict, list)):
        return [shortened(part) for part in value[:4]]
    return value


def at(value, path):
    for key in path:
        value = value[key]
    return value


def names():
    files = [file for folder in FOLDERS for file in glob.glob(os.path.join(folder, "*.schema.json"))]
    return {os.path.basename(file)[:-len(".schema.json")] for file in files}


@unittest.skipIf(jsonschema is None, "python3-jsonschema is not installed")
class Schemas(support.Case):
    used = set()

    @classmethod
    def setUpClass(cls):
        cls.common = load("common")

    def validator(self, name, strict):
        schema, common = load(name), self.common
        if strict:
            schema, common = closed(schema), closed(common)
        resolver = jsonschema.RefResolver.from_schema(
            schema, store={"common.schema.json": common})
        return jsonschema.Draft202012Validator(schema, resolver=resolver)

    def check(self, name, document):
        """A document is accepted, and is not when any part of it is spoilt."""
        Schemas.used.add(name)
        strict = self.validator(name, strict=True)
        errors = [f"{list(error.absolute_path)}: {error.message[:300]}"
                  for error in strict.iter_errors(document)]
        self.assertEqual(errors, [], name)
        self.spoil(name, document)

    def spoil(self, name, document):
        validator = self.validator(name, strict=False)
        document = shortened(document)
        self.assertTrue(validator.is_valid(document))
        for path in places(document):
            if not path:
                continue
            wrong = copy.deepcopy(document)
            instead = ["made up"] if isinstance(at(document, path), dict) else {"made": "up"}
            at(wrong, path[:-1])[path[-1]] = instead
            self.assertFalse(validator.is_valid(wrong), f"{name}: {path} may be {instead}")
            if isinstance(path[-1], str) and self.required(name, path):
                wrong = copy.deepcopy(document)
                del at(wrong, path[:-1])[path[-1]]
                self.assertFalse(validator.is_valid(wrong), f"{name}: {path} may be missing")

    OPTIONAL = {"levels", "flattest_given", "direction", "area_bound", "coarsest", "step",
                "significance", "refine", "prove", "prove_work", "max_nodes", "refine_lines", "seed",
                "peak_resident_bytes", "report", "map", "letter", "words", "separate", "cells", "witnesses",
                "work", "landmark_pairs", "directions", "target_directions", "overlay_points",
                "overlay_faces", "overlay", "lower_bound_everywhere", "optimal_everywhere",
                "area_bound_everywhere", "patch", "partial", "points"}

    def required(self, name, path):
        if path[-1] in self.OPTIONAL:
            return False
        if path[0] in ("seconds", "findings", "classes") and len(path) == 2:
            return path[-1] == "total"  # keys of maps
        if path[0] in ("written", "shown") and len(path) == 2: # keys of what there is
            return False
        if path[-1] in ("smallest_angle", "smallest_angle_made", "median_angle", "margin"):
            return False
        if name in ("pieces", "report-decompose") and (path[-1] in (
                "lower_bound", "optimal", "distance", "distance_back") or path in (
                ("model", "faces"), ("model", "tetrahedra"), ("options",), ("guards_given",))): # what there is
            return False
        if name == "report-morph" and path == ("pieces",): # has them where it is asked to
            return False
        if path[0] == "results" and path[-1] in ("tetrahedra", "pieces", "strictly_star", "target",
                                                 "frames"):
            return False
        return not (path[0] == "coverage" and path[-1].endswith("vertices"))

    def report(self, name, *words, **options):
        Schemas.used.add(f"report-{name}")
        document = self.run_json(*words, **options)
        self.check(f"report-{name}", document)
        return document

    def file(self, name, path):
        self.check(name, json.loads(self.read(path)))

    # ---- one test for each group of commands ----

    def test_schemas_are_schemas(self):
        for name in names():
            jsonschema.Draft202012Validator.check_schema(load(name))

    def test_samples_and_checks(self):
        self.report("sample", "sample", "cat", "--vertices", "500", "-o", "cat.off")
        self.report("samples", "sample", "--list")
        good = self.report("check", "check", "cat.off")
        self.assertEqual(good["findings"], {})
        self.write("open.off", support.OPEN)
        self.report("check", "check", "open.off", status=2)
        self.write("double.off", "OFF\n5 3 0\n0 0 0\n1 0 0\n0 1 0\n0 0 0\n9 9 9\n"
                   "3 0 1 2\n3 0 1 2\n3 3 3 1\n")
        self.report("check", "check", "double.off", status=2)
        self.report("repair", "repair", "open.off", "-o", "closed.off")
        self.report("kernel", "kernel", "closed.off")
        self.report("kernel", "kernel", "cat.off")

    def test_skeleton_and_sight(self):
        room = self.sample("l-room")
        self.report("skeleton", "skeleton", room, "-o", "room.cg")
        self.report("visible", "visible", room, "--from", "1,1,1", "--from", "99,0,0")
        self.report("visible", "visible", room, "--from", "1,1,1", "--target", "vertices",
                    "--range", "3")
        for target in ["faces", "vertices"]:
            self.report("visible", "visible", room, "--box", "1,1,1,2,2,2", "--target", target)

    def test_guards(self):
        room = self.sample("l-room")
        for options in [[], ["--method", "ilp", "--target", "vertices"],
                        ["--method", "greedy", "--cone", "90", "--range", "5", "--max-guards", "2"],
                        ["--target", "points"], ["--prove", "--range", "4", "--prove-work", "20000"]]:
            self.report("guard", "guard", room, "-o", "g.json", *options)
            self.file("guards", "g.json")
            self.report("verify", "verify", room, "g.json")

    def test_pieces(self):
        room = self.sample("l-room")
        self.report("decompose", "decompose", room, "-o", "p.vtk", "--report", "p.json")
        self.file("pieces", "p.json")
        self.report("verify", "verify", room, "p.vtk", "p.json")
        self.write("open.off", support.OPEN)
        self.report("decompose", "decompose", "open.off", "-o", "o.vtk", "--report", "o.json",
                    "--effort", "10", "--fill")
        self.file("pieces", "o.json")
        self.report("decompose", "decompose", "--tets", "p.vtk", "-o", "t.vtk", "--report", "t.json",
                    "--mode", "paper")
        self.file("pieces", "t.json")

    def test_pages(self):
        room = self.sample("l-room")
        self.run_text("guard", room, "-o", "g.json")
        self.run_text("skeleton", room, "-o", "s.vtk")
        self.report("export", "export", "g.json", "s.vtk", "-o", "room.glb")
        with self.start("view", "g.json", "-o", "probe.html") as process:
            process.communicate()
        if process.returncode != 3: # or else this build has no viewer
            self.report("view", "view", "g.json", "s.vtk", "-o", "room.html")
        else:
            Schemas.used.add("report-view")

    def test_shapes(self):
        cat = self.sample("cat")
        horse = self.sample("horse")
        self.report("describe", "describe", cat, "-o", "cat.json")
        self.file("descriptor", "cat.json")
        for kind in ["star", "paper", "shape-dna", "d2"]:
            models = ["cat.json", "cat.json"] if kind in ("star", "paper") else [cat, horse]
            self.report("match", "match", *models, "--distance", kind)

    def test_morphs(self):
        for pose in "01":
            self.run_text("sample", "horse", "--pose", pose, "--vertices", "500", "-o",
                          f"horse_{pose}.off")
        self.report("map", "map", "horse_0.off", "horse_1.off", "-o", "map.json")
        self.file("map", "map.json")
        self.write("marks.txt", "0 5\n240 134\n380 303\n")
        self.run_text("sample", "sphere", "--vertices", "500", "-o", "ball.off")
        self.run_text("sample", "star", "--vertices", "500", "-o", "star.off")
        self.report("map", "map", "ball.off", "star.off", "--landmarks", "marks.txt", "--overlay",
                    "-o", "overlay.json")
        self.file("map", "overlay.json")
        self.report("morph", "morph", "ball.off", "star.off", "--map", "overlay.json", "--overlay",
                    "--frames", "3", "-o", "overlaid", "--method", "linear", "--report")
        self.report("verify", "verify", "ball.off", "star.off", "overlay.json", "overlaid")
        for method, *more in [["star"], ["star", "--guards", "--pieces"], ["linear"]]:
            self.report("morph", "morph", "horse_0.off", "horse_1.off", "--frames", "3", "-o", "frames",
                        "--method", method, *more)

    def test_database(self):
        def db(name, *words, **options):
            out, _ = self.run_text("db", name, "d.db", *words, "--json", **options)
            self.check(f"report-db-{name}", json.loads(out))
        models = [self.sample("torus", 520, f"torus_{i}.off", "--pose", "0") for i in range(1)]
        models += [self.sample("cat", 520, f"cat_{i}.off", "--pose", str(i)) for i in range(2)]
        db("create")
        db("add", *models, models[0], "none.off", status=3)
        db("list")
        db("query", models[0])
        db("matrix", "-o", "m.csv")
        db("evaluate")
        db("remove", models[0])

    def test_errors(self):
        for words, status in [(["check", "none.off"], 2), (["check", "--nonsense"], 1)]:
            self.check("error", self.run_json(*words, status=status))
        self.write("bad.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 x\n3 0 1 2\n")
        self.check("error", self.run_json("check", "bad.off", status=2))

    def test_help(self):
        self.report("completion", "completion", "bash")
        out, _ = self.run_text("help", "--json")
        self.check("help", json.loads(out))

    def test_wrong_documents(self):
        """Made up: right in form, wrong in what they say."""
        room = self.sample("l-room")
        self.run_text("guard", room, "-o", "g.json")
        good = json.loads(self.read("g.json"))
        def refused(change):
            wrong = copy.deepcopy(good)
            change(wrong)
            self.assertFalse(self.validator("guards", strict=False).is_valid(wrong))
        refused(lambda d: d.update(format="starguard-pieces"))
        refused(lambda d: d.update(version=2))
        refused(lambda d: d["coverage"].update(area=1.5))
        refused(lambda d: d["guards"][0].update(position=[0, 0]))
        refused(lambda d: d["options"].update(method="magic"))
        later = dict(good, news="of a later version")
        self.assertTrue(self.validator("guards", strict=False).is_valid(later))
        self.assertFalse(self.validator("guards", strict=True).is_valid(later))

    def test_zz_every_schema_is_tried(self):
        """Runs last; on its own there is nothing to say."""
        if len(Schemas.used) < 5:
            self.skipTest("only with all other tests")
        self.assertEqual(names() - Schemas.used, {"common"})

    def test_every_command_has_one(self):
        out, _ = self.run_text("help", "--json")
        commands = {"report-" + command["name"].replace(" ", "-")
                    for command in json.loads(out)["commands"] if not command["group"]}
        self.assertEqual(commands - names(), set())


if __name__ == "__main__":
    if jsonschema is None:
        print("skipped: python3-jsonschema is not installed")
    support.main()
