# SPDX-License-Identifier: Apache-2.0
"""A folder with every file that examples speak of, and commands run in it."""
import cmath
import itertools
import os
import re
import shutil
import subprocess
import tempfile

PROGRAM = os.path.abspath(os.environ.get("STARGUARD", "build/starguard"))
SOURCE = os.environ.get("STARGUARD_SOURCE", os.path.join(os.path.dirname(__file__), "..", ".."))

LONG = bool(os.environ.get("STARGUARD_LONG"))  # commands as they stand, not as quick ones

# What `make check` adds to commands or puts in them, unless they say something else: the same is done with less.
QUICK = [(r"\bstarguard sample (?=\w)(?!.*--vertices)", "starguard sample --vertices 500 "),
         (r"--vertices \d+", "--vertices 500"),
         (r"\bstarguard guard (?!.*--(effort|prove|method|time-limit))", "starguard guard --effort quick "),
         (r"\bstarguard guard (?!.*--(count|candidates))", "starguard guard --count 30 "),
         (r"\bstarguard decompose (?!.*--(effort|time-limit|prove|mode))", "starguard decompose --effort 100 "),
         (r"--time-limit \d+", "--time-limit 1"),
         (r"\bdb add (\S+) models/\*\.off", r"db add \1 models/cat_1.off models/dog_0.off"),
         (r"\bstarguard map --solid (?!.*--steps)", "starguard map --solid --steps 10 "),
         (r"--frames \d+", "--frames 3")]

# A cube of five tetrahedra, Gmsh 2.
CUBE = """$MeshFormat
2.2 0 8
$EndMeshFormat
$Nodes
8
1 0 0 0
2 1 0 0
3 1 1 0
4 0 1 0
5 0 0 1
6 1 0 1
7 1 1 1
8 0 1 1
$EndNodes
$Elements
5
1 4 2 1 1 1 2 4 5
2 4 2 1 1 2 3 4 7
3 4 2 1 1 2 5 6 7
4 4 2 1 1 4 5 7 8
5 4 2 1 1 2 4 5 7
$EndElements
"""


def quick(script):
    if LONG:
        return script
    script = script.replace("\\\n", " ")
    for pattern, words in QUICK:
        script = re.sub(pattern, words, script)
    return script


class Fixtures:
    """Made once; every user gets a copy."""

    def __init__(self):
        self.scratch = tempfile.TemporaryDirectory()
        self.template = os.path.join(self.scratch.name, "template")
        os.makedirs(os.path.join(self.template, "models"))
        os.makedirs(os.path.join(self.template, ".config/fish/completions"))
        os.makedirs(os.path.join(self.scratch.name, "bin"))
        os.symlink(PROGRAM, os.path.join(self.scratch.name, "bin", "starguard"))
        self.fill()
        self.has_viewer = self.makes_pages()

    def close(self):
        self.scratch.cleanup()

    def starguard(self, *words):
        subprocess.run([PROGRAM, *words, "--quiet"], cwd=self.template, check=True)

    def makes_pages(self):
        """Builds without npm have no viewer (docs/viewer.md)."""
        run = subprocess.run([PROGRAM, "view", "model.off", "-o", "-"], cwd=self.template, check=False,
                             capture_output=True)
        return run.returncode != 3

    def write(self, name, text):
        with open(os.path.join(self.template, name), "w", encoding="utf-8") as file:
            file.write(text)

    def sample(self, name, *files, pose=0):
        """Of 520 vertices: spectra are taken of a surface of 2,000 at least, so one of 500 is subdivided twice."""
        for file in files:
            self.starguard("sample", name, "--pose", str(pose), "--vertices", "520", "-o", file)

    def fill(self):
        self.sample("l-room", "model.off", "model.obj", "room.off", "room.obj", "scan.off")
        self.sample("gallery", "hall.stl")
        self.sample("horse", "horse.off")
        for length, animal in enumerate(["cat", "dog"], 5):
            if LONG:
                self.sample(animal, f"{animal}.off")
            else:
                self.bar(f"{animal}.off", 0, length)
        for pose in [1, 2]:
            self.sample("cat", f"models/cat_{pose}.off", pose=pose)
        shutil.copy(os.path.join(self.template, "dog.off"), os.path.join(self.template, "models/dog_0.off"))
        for pose in range(2):
            self.bar(f"horse_{pose}.off", 0.2 * pose, 6)
        self.sample("l-room", "new.off")
        self.open_surface("scan.off", ["scan.stl", "scan.ply"])
        self.write("solid.msh", CUBE)
        self.write("cat_dog.txt", self.landmarks("cat.off", "dog.off"))
        self.write("field.txt", "".join(f"{x} {y} {z} {x}\n" for x, y, z in
                                        self.numbers("horse_0.off")[:20]))
        self.write("places.txt", "1 1 1\n5 1 1\n1 1 5\n")
        self.write("stay.txt", "1 1 1\n")
        self.write("cameras.txt", "1 2 1  1 -1 1\n5 2 1  -1 -1 0\n")
        # Slow to make, and wanted more than once.
        for animal in ["cat", "dog"]:
            self.starguard("describe", f"{animal}.off", "-o", f"models/{animal}.json")
        self.starguard("db", "create", "models/ready.db")
        models = sorted(os.listdir(os.path.join(self.template, "models")))
        self.starguard("db", "add", "models/ready.db",
                       *[f"models/{name}" for name in models if name.endswith(".off")])

    def bar(self, name, turn, length):
        """A twisted bar of some 60 vertices: maps and morphs of animals take long."""
        cells, places, faces = (length, 2, 2), {}, []
        for axis in range(3):
            u, v = (axis + 1) % 3, (axis + 2) % 3
            for side, i, j in itertools.product((0, cells[axis]), range(cells[u]), range(cells[v])):
                corners = []
                for more in (0, 0), (1, 0), (1, 1), (0, 1):
                    place = {axis: side, u: i + more[0], v: j + more[1]}
                    corners.append(places.setdefault((place[0], place[1], place[2]), len(places)))
                a, b, c, d = corners if side else reversed(corners)
                faces += [f"3 {a} {b} {c}", f"3 {a} {c} {d}"]
        turned = [complex(y - 1, z - 1) * cmath.exp(1j * turn * x) for x, y, z in places]
        points = [f"{place[0]} {p.real!r} {p.imag!r}" for place, p in zip(places, turned)]
        self.write(name, "\n".join(["OFF", f"{len(points)} {len(faces)} 0", *points, *faces, ""]))

    def numbers(self, name):
        """The vertices of an OFF file."""
        with open(os.path.join(self.template, name), encoding="ascii") as file:
            lines = file.read().split("\n")
        count = int(lines[1].split()[0])
        return [tuple(map(float, line.split())) for line in lines[2:2 + count]]

    def landmarks(self, a, b):
        """The tips along the axes are each other's counterparts."""
        pairs = {}
        for axis in range(3):
            for choose in (min, max):
                tips = []
                for name in (a, b):
                    points = self.numbers(name)
                    tips.append(points.index(choose(points, key=lambda p: p[axis])))
                pairs[tips[0]] = tips[1]
        return "".join(f"{i} {j}\n" for i, j in pairs.items())

    def open_surface(self, name, files):
        """A surface with a hole, in formats that scanners write."""
        path = os.path.join(self.template, name)
        with open(path, encoding="ascii") as file:
            lines = file.read().split("\n")
        vertices, faces, _ = map(int, lines[1].split())
        lines[1] = f"{vertices} {faces - 1} 0"
        del lines[1 + vertices + faces]
        points = [line.split() for line in lines[2:2 + vertices]]
        corners = [list(map(int, line.split()[1:])) for line in lines[2 + vertices:] if line]
        for file in files:
            if file.endswith(".ply"):
                head = (f"ply\nformat ascii 1.0\nelement vertex {vertices}\nproperty double x\n"
                        f"property double y\nproperty double z\nelement face {len(corners)}\n"
                        "property list uchar int vertex_indices\nend_header\n")
                body = [" ".join(p) for p in points] + [f"3 {a} {b} {c}" for a, b, c in corners]
                self.write(file, head + "\n".join(body) + "\n")
            else:
                facets = "".join(
                    "facet normal 0 0 0\nouter loop\n" +
                    "".join(f"vertex {' '.join(points[i])}\n" for i in face) +
                    "endloop\nendfacet\n" for face in corners)
                self.write(file, f"solid scan\n{facets}endsolid scan\n")
        os.remove(path)

    def use(self, name, *more):
        """A copy of the template, with what the named commands leave in it."""
        folder = os.path.join(self.scratch.name, name)
        shutil.copytree(self.template, folder)
        for command in more:
            self.shell(folder, command)
        return folder

    def shell(self, folder, script):
        """Runs lines of a shell; its output. Raises AssertionError when one fails."""
        if not self.has_viewer and "starguard view" in script:
            print("skipped, this build has no viewer: starguard view ...")
            script = "\n".join(x for x in script.split("\n") if not x.startswith("starguard view"))
        environment = dict(os.environ, HOME=folder, NO_COLOR="1",
                           PATH=os.path.join(self.scratch.name, "bin") + ":" + os.environ["PATH"])
        run = subprocess.run(["bash", "-euo", "pipefail", "-c", script], cwd=folder, env=environment,
                             stdin=subprocess.DEVNULL, capture_output=True, text=True, check=False)
        if run.returncode != 0:
            raise AssertionError(f"{script}\nstatus {run.returncode}\n{run.stdout}{run.stderr}")
        return run.stdout
