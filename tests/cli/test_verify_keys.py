# SPDX-License-Identifier: Apache-2.0
"""What docs/verification.md says of every key of every result is so: each is changed and taken away."""
import collections
import copy
import json
import os
import re
import unittest

import support
import test_scenes
from plain_solids import arc

PAGE = os.path.join(os.path.dirname(__file__), "..", "..", "docs", "verification.md")
REFUSED = {2, 4}  # not readable; read, and found to be false
WORDS = {"refused", "raised", "lowered", "varies", "open", "no claim"}


def table():
    """By file and key: what becomes of the result if it is changed, and if it is removed."""
    with open(PAGE, encoding="utf-8") as file:
        section = file.read().split("## Every key\n")[1].split("\n## ")[0]
    rows, name = {}, None
    for line in section.splitlines():
        if line.startswith("**"):
            name = line.split("**")[1]
        cells = [cell.strip() for cell in line.strip("|").split("|")]
        if line.startswith("| `"):
            for key in re.findall("`([^`]+)`", cells[0]):
                rows[name, key] = cells[1], cells[2]
    return rows


def places(node, path=()):
    """The paths of a JSON value; of lists the first and the last entry."""
    items = node.items() if isinstance(node, dict) else []
    if isinstance(node, list):
        items = [(i, node[i]) for i in sorted({0, len(node) - 1}) if node]
    for key, value in items:
        yield path + (key,)
        yield from places(value, path + (key,))


def name_of(path):
    return "".join("[]" if isinstance(part, int) else "." + part for part in path)[1:]


def changed(value):
    """How a value may be changed: up, down, or otherwise."""
    if isinstance(value, bool):
        return {"other": not value}
    if isinstance(value, int):
        return {"up": value + 1, **({"down": value - 1} if value > 0 else {})}
    if isinstance(value, float):
        return {"up": value + max(abs(value), 1e-3) / 8, "down": value - max(abs(value), 1e-3) / 8}
    if isinstance(value, str):
        return {"other": value + "x"}
    return {"up": 1.5} if value is None else {}


def mutants(text):
    """Of a JSON file: (key, how, text)."""
    known, often = json.loads(text), collections.Counter()
    for path in places(known):
        key = name_of(path)
        often[key] += 1
        if often[key] > 1:
            continue
        parent = known
        for part in path[:-1]:
            parent = parent[part]
        for how, value in [*changed(parent[path[-1]]).items(), ("removed", None)]:
            spoilt = copy.deepcopy(known)
            at = spoilt
            for part in path[:-1]:
                at = at[part]
            if how == "removed":
                del at[path[-1]]
            else:
                at[path[-1]] = value
            yield key, how, json.dumps(spoilt)


NUMBER = re.compile(r"(?<![\w.+-])-?\d+(\.\d+)?(e[+-]?\d+)?(?![\w.])")


def number_mutants(key, text, start, end):
    """A number of a part of a text, changed; the whole part removed."""
    number = NUMBER.search(text, start, end)
    value = float(number[0]) if re.search(r"[.e]", number[0]) else int(number[0])
    for how, other in changed(value).items():
        yield key, how, text[:number.start()] + repr(other) + text[number.end():]
    yield key, "removed", text[:start] + text[end:]


def vtu_mutants(text):
    for array in re.finditer(r"<DataArray [^>]*>[^<]*</DataArray>\n", text):
        name = re.search(r'Name="(\w+)"', array[0])
        body = array.start() + array[0].index(">")
        yield from number_mutants(name[1] if name else "Points", text, body, array.end())


def vtk_mutants(text):
    """The first number of each block, and the block without it."""
    for key, head in [("POINTS", r"POINTS \d+ double\n"), ("CELLS", r"CELLS \d+ \d+\n4 "),
                      ("CELL_TYPES", r"CELL_TYPES \d+\n"), ("piece", r"LOOKUP_TABLE default\n")]:
        begin = re.search(head, text).end()
        yield from number_mutants(key, text, begin, text.index("\n", begin) + 1)


def certificate_mutants(text):
    """Its head and the bound: lines of a word and a number."""
    for line in re.finditer(r"(?m)^(\w+) \d+$", text):
        yield from number_mutants(line[1], text, line.start() + len(line[1]), line.end())


@unittest.skipIf(os.environ.get("STARGUARD_SANITIZE"), "many runs of what other tests run")
class Keys(support.Case):
    def setUp(self):
        super().setUp()
        self.rows, self.met = table(), collections.Counter()
        self.assertTrue(WORDS.issuperset(word for row in self.rows.values() for word in row))

    def spoil(self, kind, made, file, words):
        """Every mutant of a file, in its place or in its folder, verified as it was; without STARGUARD_LONG one of
        each key, in turn one change or another, and in a second file one that has to be refused."""
        self.run_text("verify", *words)
        with self.start("verify", self.sample("torus", 500), *words[1:]) as process:
            process.communicate()
        self.assertIn(process.returncode, REFUSED, "of another model")
        put, number = ("spoilt", words.index(file)) if file in words else (file, len(words))
        mutants = list(made(self.read(file).decode()))
        if not support.LONG:
            of_key = {key: [m for m in mutants if m[0] == key] for key, *_ in mutants}
            mutants = [some[turn % len(some)] for turn, (key, some) in enumerate(of_key.items())
                       if self.met[kind, key] < 2]
        for key, how, text in mutants:
            self.met[kind, key] += 1
            self.assertIn((kind, key), self.rows, "has no row in docs/verification.md")
            change, removal = self.rows[kind, key]
            must = {"refused": True, "raised": how == "up", "lowered": how == "down"}.get(
                removal if how == "removed" else change, False)
            if not support.LONG and not must and self.met[kind, key] > 1:
                continue
            self.write(put, text)
            with self.start("verify", *words[:number], *[put][:len(words) - number],
                            *words[number + 1:]) as process:
                out, err = process.communicate()
            with self.subTest(file=kind, key=key, how=how):
                self.assertIn(process.returncode, REFUSED if must else REFUSED | {0}, (out, err))

    def all_met(self, *kinds):
        """No row is about a key that no file has."""
        self.assertEqual({row for row in self.rows if row[0] in kinds} - set(self.met), set())

    def test_guards(self):
        self.sample("octopus", 500)
        for words in ["--redundancy 2 --baseline 10 --no-refine --clearance 0.001", "--max-guards 3 --prove --seed 2",
                      "--target vertices --range 1 --fov 90,80 --prove",
                      "--see 0-99 --outside --standoff 0.1,2 --within -9,-9,-9,9,9,9"]:
            self.run_text("guard", "octopus.off", "-o", "g.json", "--count", "60", "--refine-lines", "1000",
                          "--prove-work", "1000", *words.split())
            self.spoil("GUARDS.json", mutants, "g.json", ["octopus.off", "g.json"])
            coverage = (known := json.loads(self.read("g.json")))["coverage"]
            for key in {"area_bound", "area_bound_everywhere"} & set(coverage):
                self.write("low.json", json.dumps({**known, "coverage": {**coverage, key: coverage["area"] / 2}}))
                self.assertIn("within", self.run_text("verify", "octopus.off", "low.json", status=4)[0])
        self.write("parts.off", support.TETRAHEDRON)
        self.run_text("guard", "parts.off", "--patch", "0.25", "--range", "0.5", "--max-guards", "2", "-o", "g.json")
        self.spoil("GUARDS.json", mutants, "g.json", ["parts.off", "g.json"])
        self.write("stay.txt", "0.2 0.2 0.2 1 1 1\n")
        self.write("zone.off", support.TETRAHEDRON)
        self.run_text("guard", "parts.off", "--patch", "0.25", "--keep", "stay.txt", "--tilt", "-80,80",
                      "--within", "zone.off", "--without", "0.5,0.5,0.5,1,1,1", "--require", "1=1,2", "--clear", "0",
                      *"--fov 90,80 --resolution 100,100 --density 1 --unit mm -o g.json".split())
        self.spoil("GUARDS.json", mutants, "g.json", ["parts.off", "g.json"])
        self.write("apart.off", test_scenes.off(*(test_scenes.box((x, 0, 0), (x + 1, 1, 1)) for x in (0, 3))))
        self.run_text("guard", "apart.off", "--order", "-o", "g.json")
        self.spoil("GUARDS.json", mutants, "g.json", ["apart.off", "g.json"])
        self.write("one.txt", "0.2 0.2 0.2\n")
        self.run_text("guard", "parts.off", "--target", "points", "--range", "0.5", "--candidates", "one.txt", "-o",
                      "g.json", "--no-refine")
        self.spoil("GUARDS.json", mutants, "g.json", ["parts.off", "g.json"])
        self.all_met("GUARDS.json")

    def test_certificate(self):
        self.sample("gallery", 500)
        self.run_text("guard", "gallery.off", "-o", "g.json", "--count", "60", "--prove", "--prove-work",
                      "30000", "--certificate", "why.txt")
        self.spoil("Certificate", certificate_mutants, "why.txt", ["gallery.off", "g.json", "why.txt"])
        self.all_met("Certificate")

    def test_pieces(self):
        self.sample("star", 500)
        crossing = support.TETRAHEDRON.split("\n")  # two tetrahedra that cross
        points = [" ".join(str(float(x) + d) for x in line.split()) for d in (0, 0.1) for line in crossing[2:6]]
        faces = [" ".join(["3", *(str(int(v) + d) for v in line.split()[1:])])
                 for d in (0, 4) for line in crossing[6:10]]
        self.write("two.off", "\n".join(["OFF", "8 8 0", *points, *faces, ""]))
        for model, words in [("star.off", "--balls rays --prove --prove-work 1000"), ("two.off", "")]:
            self.run_text("decompose", model, "-o", "p.vtk", "--report", "p.json", "--effort", "30", *words.split())
            self.spoil("PIECES.json", mutants, "p.json", [model, "p.json", "p.vtk"])
            self.spoil("PIECES.vtk", vtk_mutants, "p.vtk", [model, "p.json", "p.vtk"])
        self.all_met("PIECES.json", "PIECES.vtk")

    def test_maps(self):
        for pose, file in enumerate(["a.off", "b.off"]):
            self.sample("cat", 500, file, "--pose", str(pose))
        self.run_text("map", "a.off", "b.off", "--overlay", "-o", "m.json")
        self.spoil("MAP.json", mutants, "m.json", ["a.off", "b.off", "m.json"])
        self.run_text("map", "--solid", "a.off", "b.off", "--steps", "20", "-o", "m.vtu")
        self.spoil("MAP.vtu", vtu_mutants, "m.vtu", ["a.off", "b.off", "m.vtu"])
        arc(0.5).write(self.path("c.off"))
        self.sample("sphere", 500, "d.off")
        self.run_text("map", "--solid", "c.off", "d.off", "--connectivity", "a", "--steps", "20", "-o", "n.vtu")
        self.spoil("MAP.vtu", lambda text: (m for m in vtu_mutants(text) if m[0] == "missed"), "n.vtu",
                   ["c.off", "d.off", "n.vtu"])
        self.run_text("morph", "a.off", "b.off", "--frames", "3", "-o", "frames", "--report")
        self.spoil("morph.json", mutants, "frames/morph.json", ["a.off", "b.off", "frames"])
        self.all_met("MAP.json", "MAP.vtu", "morph.json")


if __name__ == "__main__":
    support.main()
