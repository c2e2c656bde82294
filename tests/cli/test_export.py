# SPDX-License-Identifier: Apache-2.0
"""`starguard export`: its files, opened by readers that are not ours."""
import json
import math
import os
import shutil
import struct
import subprocess
import unittest
import zipfile
from xml.etree import ElementTree

from support import BUILD, Case, main

try:
    import vtk
except ImportError:
    vtk = None

MODULES = os.environ.get("STARGUARD_VIEWER_MODULES", "")
VALIDATOR = os.path.join(MODULES, "node_modules", "gltf-validator")
NODE = shutil.which("node") or shutil.which("nodejs")

VALIDATE = """
const validator = require(process.argv[1]);
const bytes = new Uint8Array(require('fs').readFileSync(process.argv[2]));
validator.validateBytes(bytes).then(report => console.log(JSON.stringify(report)));
"""


def without(name):
    """A decorator: the test is skipped where a reader is missing, with a printed reason."""
    there = {"vtk": (vtk is not None, "python3-vtk9 is not installed: VTK opens no file"),
             "import": (os.path.exists(os.path.join(BUILD, "starguard-import")),
                        "libassimp-dev is not installed: there is no starguard-import"),
             "assimp": (shutil.which("assimp"), "assimp-utils is not installed: assimp opens no file"),
             "validator": (NODE and os.path.isdir(VALIDATOR),
                           "npm has not fetched gltf-validator: .glb is not validated")}
    found, reason = there[name]
    if not found:
        print("skipped:", reason)
    return unittest.skipUnless(found, reason)


def glb_json(data):
    """The JSON chunk, and the binary one."""
    magic, version, length, size, kind = struct.unpack_from("<4sIII4s", data)
    assert (magic, version, length, kind) == (b"glTF", 2, len(data), b"JSON")
    return json.loads(data[20:20 + size]), data[28 + size:]


def determinant(a, b, c):
    return (a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0])
            + a[2] * (b[0] * c[1] - b[1] * c[0]))


class Export(Case):
    """A room with guards, pieces and a skeleton."""

    model = "gallery.off"
    made = {}  # by file name: its bytes, for all tests

    def make(self):
        self.sample("gallery", 1000)
        self.run_text("guard", self.model, "-o", "g.json", "--quiet")
        self.run_text("decompose", self.model, "-o", "p.vtk", "--report", "p.json", "--effort", "20",
                      "--quiet")
        self.run_text("skeleton", self.model, "-o", "s.vtk", "--nodes", "50", "--quiet")
        self.made.update({name: self.read(name) for name in self.names()})

    def results(self):
        if not self.made:
            self.make()
        for name, data in self.made.items():
            self.write(name, data)
        self.guards = json.loads(self.read("g.json"))["guards"]
        self.pieces = json.loads(self.read("p.json"))["pieces"]
        return ["g.json", "p.vtk", "p.json", "s.vtk"]

    def export(self, *words, name):
        self.run_text("export", *words, "-o", name)
        return self.path(name)

    def counts(self):
        """Vertices and faces of the model."""
        vertices, faces, _ = self.read(self.model).split(b"\n")[1].split()
        return int(vertices), int(faces)

    # ---- .glb ----

    def test_nodes_of_glb(self):
        self.export(*self.results(), name="all.glb")
        scene, numbers = glb_json(self.read("all.glb"))
        nodes = scene["nodes"]
        self.assertEqual(len(numbers), scene["buffers"][0]["byteLength"])
        root = nodes[scene["scenes"][0]["nodes"][0]]
        names = [nodes[i]["name"] for i in root["children"]]
        self.assertEqual(names, ["guards", "pieces", "skeleton"])
        guards, pieces = (nodes[i] for i in root["children"][:2])
        self.assertEqual([nodes[i]["name"] for i in guards["children"]],
                         [f"guard_{i:04}" for i in range(len(self.guards))])
        self.assertEqual([nodes[i]["name"] for i in pieces["children"]],
                         [f"piece_{i:04}" for i in range(len(self.pieces))])
        for i, guard in zip(guards["children"], self.guards):
            self.assertEqual(nodes[i]["extras"]["position"], guard["position"])
            self.assertEqual(nodes[i]["extras"]["faces"], guard["faces"])
            place = [a + b for a, b in zip(root["translation"], nodes[i]["translation"])]
            self.assertLess(math.dist(place, guard["position"]), 1e-12)
        for i, piece in zip(pieces["children"], self.pieces):
            self.assertEqual(nodes[i]["extras"],
                             {"guard": piece["guard"], "volume": piece["volume"], "star": True})

    def test_model_of_glb(self):
        self.results()
        self.export("g.json", name="guards.glb")
        scene, _ = glb_json(self.read("guards.glb"))
        root = scene["nodes"][0]
        self.assertEqual([scene["nodes"][i]["name"] for i in root["children"]], ["model", "guards"])
        parts = scene["meshes"][scene["nodes"][root["children"][0]]["mesh"]]["primitives"]
        names = [scene["materials"][part["material"]]["name"] for part in parts]
        self.assertEqual(len(names), len(set(names)))
        self.assertIn("seen by 1", names)
        for part in parts:
            self.assertEqual(scene["materials"][part["material"]]["alphaMode"], "BLEND")
        self.assertEqual(sum(scene["accessors"][part["indices"]]["count"] for part in parts), 3 * self.counts()[1])

    @without("validator")
    def test_glb_is_valid(self):
        files = self.results()
        wholes = {"all.glb": files, "guards.glb": ["g.json"], "pieces.glb": ["p.vtk"],
                  "skeleton.glb": ["s.vtk"], "model.glb": [self.model],
                  "more.glb": ["s.vtk", "--model", self.model]}
        self.run_text("morph", self.model, self.model, "--frames", "3", "-o", "frames", "--glb", "morph.glb")
        for name, words in (wholes | {"morph.glb": None}).items():
            with self.subTest(name=name):
                path = self.export(*words, name=name) if words else self.path(name)
                told = subprocess.run([NODE, "-e", VALIDATE, VALIDATOR, path], check=True,
                                      capture_output=True, text=True).stdout
                issues = json.loads(told)["issues"]
                self.assertEqual((issues["numErrors"], issues["numWarnings"], issues["numInfos"]),
                                 (0, 0, 0), issues["messages"][:3])

    @without("vtk")
    def test_glb_by_vtk(self):
        files = self.results()
        reader = vtk.vtkGLTFReader()
        reader.SetFileName(self.export(self.model, name="model.glb"))
        reader.Update()
        self.assertEqual(reader.GetOutput().GetNumberOfPoints(), self.counts()[0])
        self.assertEqual(reader.GetOutput().GetNumberOfCells(), self.counts()[1])
        reader = vtk.vtkGLTFReader()
        reader.SetFileName(self.export(*files, name="all.glb"))
        reader.Update()
        self.assertGreater(reader.GetOutput().GetNumberOfCells(), self.counts()[1])

    @without("assimp")
    def test_by_assimp(self):
        files = self.results()
        for name in ("all.glb", "all.obj", "all.ply"):
            with self.subTest(name=name):
                path = self.export(*files, name=name)
                told = subprocess.run(["assimp", "info", path], check=False, capture_output=True,
                                      text=True)
                self.assertEqual(told.returncode, 0, told.stdout[-500:])
                if name == "all.ply":
                    continue
                for i in range(len(self.pieces)):
                    self.assertIn(f"piece_{i:04}", told.stdout)

    # ---- .vtu ----

    @without("vtk")
    def test_vtu_by_vtk(self):
        files = self.results()
        reader = vtk.vtkXMLUnstructuredGridReader()
        reader.SetFileName(self.export(*files, name="all.vtu"))
        reader.Update()
        grid, data = reader.GetOutput(), reader.GetOutput().GetCellData()
        cells = range(grid.GetNumberOfCells())
        part, piece, guard = ([data.GetArray(name).GetTuple1(i) for i in cells]
                              for name in ("part", "piece", "guard"))
        types = [{5: 0, 10: 1, 1: 2, 3: 3}[grid.GetCellType(i)] for i in cells]
        self.assertEqual(types, part)
        self.assertEqual(part.count(0), self.counts()[1])
        self.assertEqual(part.count(2), len(self.guards))
        for i, wanted in enumerate(self.pieces):
            self.assertEqual(piece.count(i), wanted["tetrahedra"])
        self.assertTrue(all((p >= 0) == (q == 1) for p, q in zip(piece, part)))
        first = part.index(2)
        for i, wanted in enumerate(self.guards):
            self.assertEqual(list(grid.GetCell(first + i).GetPoints().GetPoint(0)), wanted["position"])
            self.assertEqual(guard[first + i], i)
        seen = [g for g, p in zip(guard, part) if p == 0]
        self.assertEqual(seen.count(0), self.guards[0]["faces"])
        self.assertEqual(seen.count(-1), 0)
        volume = sum(self.volume(grid.GetCell(i)) for i in cells if part[i] == 1)
        self.assertAlmostEqual(volume, sum(p["volume"] for p in self.pieces))
        radii = grid.GetPointData().GetArray("radius")
        self.assertGreater(radii.GetTuple1(grid.GetNumberOfPoints() - 1), 0)

    @staticmethod
    def volume(cell):
        points = [cell.GetPoints().GetPoint(i) for i in range(4)]
        return vtk.vtkTetra.ComputeVolume(*points)

    def test_vtu_by_meshio(self):
        try:
            import meshio
        except ImportError:
            self.skipTest("python3-meshio is not installed")
        mesh = meshio.read(self.export(*self.results(), name="all.vtu"))
        kinds = {block.type: len(block.data) for block in mesh.cells}
        self.assertEqual(kinds["triangle"], self.counts()[1])
        self.assertEqual(kinds["vertex"], len(self.guards))
        self.assertEqual(sorted(kinds), ["line", "tetra", "triangle", "vertex"])

    # ---- .ply and .obj ----

    @without("vtk")
    def test_ply_by_vtk(self):
        self.results()
        reader = vtk.vtkPLYReader()
        reader.SetFileName(self.export("g.json", name="guards.ply"))
        reader.Update()
        mesh = reader.GetOutput()
        colors = mesh.GetCellData().GetArray("RGB")
        kinds = {colors.GetTuple3(i) for i in range(mesh.GetNumberOfCells())}
        self.assertEqual(len(kinds), len(self.guards))
        ball = 72
        self.assertEqual(mesh.GetNumberOfPolys(), self.counts()[1] + ball * len(self.guards))
        sizes = vtk.vtkMassProperties()
        sizes.SetInputData(mesh)
        room = sum(piece["volume"] for piece in self.pieces)
        self.assertGreater(sizes.GetVolume(), room)  # balls face outward: they add to it
        self.assertLess(sizes.GetVolume(), 1.01 * room)

    @without("vtk")
    def test_obj_by_vtk(self):
        files = self.results()
        reader = vtk.vtkOBJReader()
        reader.SetFileName(self.export(*files, name="all.obj"))
        reader.Update()
        mesh = reader.GetOutput()
        self.assertEqual(mesh.GetNumberOfVerts(), len(self.guards))
        self.assertEqual(mesh.GetNumberOfLines(), self.read("s.vtk").count(b"\n2 "))
        objects = [line.split()[1] for line in self.read("all.obj").decode().splitlines()
                   if line.startswith("o ")]
        self.assertEqual(objects, [f"piece_{i:04}" for i in range(len(self.pieces))]
                         + [f"guard_{i:04}" for i in range(len(self.guards))] + ["skeleton"])

    # ---- 3MF ----

    def objects_of(self, name):
        """The objects of a 3MF by name: corners and faces."""
        with zipfile.ZipFile(self.path(name)) as archive:
            self.assertIsNone(archive.testzip())
            self.assertEqual(archive.namelist()[0], "[Content_Types].xml")
            relations = ElementTree.fromstring(archive.read("_rels/.rels"))
            model = ElementTree.fromstring(archive.read(relations[0].get("Target")[1:]))
        space = "{" + model.tag[1:].split("}")[0] + "}"
        found = {}
        for thing in model.iter(space + "object"):
            found[thing.get("id")] = (
                thing.get("name"), [[float(v.get(k)) for k in "xyz"] for v in thing.iter(space + "vertex")],
                [[int(t.get(f"v{k}")) for k in (1, 2, 3)] for t in thing.iter(space + "triangle")])
        self.assertEqual([item.get("objectid") for item in model.iter(space + "item")], list(found))
        return list(found.values())

    def test_3mf(self):
        """Each piece is an object, closed, of the volume that the report says."""
        self.results()
        self.export("p.vtk", "p.json", name="all.3mf")
        objects = self.objects_of("all.3mf")
        self.assertEqual([o[0] for o in objects], [f"piece_{i:04}" for i in range(len(self.pieces))])
        for (_, points, faces), piece in zip(objects, self.pieces):
            sides = {(f[i], f[(i + 1) % 3]) for f in faces for i in range(3)}
            self.assertEqual(len(sides), 3 * len(faces))
            self.assertEqual(sides, {(b, a) for a, b in sides})
            self.assertEqual({i for f in faces for i in f}, set(range(len(points))))
            volume = sum(determinant(*(points[i] for i in f)) for f in faces) / 6
            self.assertAlmostEqual(volume, piece["volume"], 9)
        self.export(self.model, name="model.3mf")
        [(name, points, faces)] = self.objects_of("model.3mf")
        self.assertEqual((name, len(points), len(faces)), ("model", *self.counts()))
        self.assertIn("there are none", self.run_text("export", "s.vtk", "-o", "s.3mf", status=1)[1])

    @without("import")
    def test_3mf_by_assimp(self):
        self.results()
        self.export(self.model, name="model.3mf")
        volume = self.run_json("check", self.model)["volume"]
        self.assertAlmostEqual(self.run_json("check", "model.3mf")["volume"] / volume, 1, 5)
        self.export("p.vtk", "p.json", name="all.3mf")
        ply = subprocess.run([os.path.join(BUILD, "starguard-import"), self.path("all.3mf")], check=True,
                             capture_output=True).stdout
        faces = sum(len(o[2]) for o in self.objects_of("all.3mf"))
        self.assertIn(f"element face {faces}\n".encode(), ply)
        for i in range(len(self.pieces)):
            self.assertIn(f"piece_{i:04}".encode(), ply)

    # ---- the command ----

    def test_the_same_bytes(self):
        files = self.results()
        for name in ("a.glb", "a.vtu", "a.ply", "a.obj", "a.3mf"):
            self.export(*files, "--threads", "1", name=name)
            self.export(*files[::-1], "--threads", "3", name="b" + name[1:])
            self.assertEqual(self.read(name), self.read("b" + name[1:]))
        out, _ = self.run_bytes("export", *files, "-o", "-")
        self.assertEqual(out, self.read("a.glb"))

    def test_report(self):
        told = self.run_json("export", *self.results(), "-o", "a.vtu")
        self.assertEqual((told["format"], told["version"], told["output"]),
                         ("starguard-export", 1, "a.vtu"))
        self.assertEqual(told["model"]["faces"], self.counts()[1])
        self.assertEqual((told["written"]["model_faces"], told["written"]["guards"]),
                         (self.counts()[1], len(self.guards)))

    def test_usage(self):
        self.usage_error("export", says="RESULT")
        model = self.sample("star")
        self.usage_error("export", model, says="-o FILE.glb, .vtu, .ply, .obj or .3mf")
        self.usage_error("export", model, "-o", "a.stl", says="writes FILE.glb|.vtu|.ply|.obj|.3mf")

    def test_what_does_not_fit(self):
        self.results()
        other = self.sample("star")
        _, err = self.run_text("export", "g.json", "--model", other, "-o", "a.glb", status=2)
        self.assertIn("--model", err)
        _, err = self.run_text("export", "p.json", "-o", "a.glb", status=2)
        self.assertIn("PIECES.vtk", err)
        self.run_text("db", "create", "shapes.db", "--quiet")
        self.run_text("db", "add", "shapes.db", other, "--quiet")
        _, err = self.run_text("export", "shapes.db", "-o", "a.glb", status=1)
        self.assertIn("table of shapes", err)
        self.assertNotIn("a.glb", self.names())

    def test_far_away_and_tiny(self):
        """Single precision counts from the middle of all."""
        corners = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)]
        for scale, shift in ((1e-12, 0), (1, 1e9), (1e-3, 1e6), (1e30, 0)):
            lines = [" ".join(repr(shift + scale * x) for x in corner) for corner in corners]
            self.write("t.off", "OFF\n4 4 0\n" + "\n".join(lines)
                       + "\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n")
            self.export("t.off", name="t.glb")
            scene, numbers = glb_json(self.read("t.glb"))
            middle = scene["nodes"][0]["translation"]
            found = struct.unpack_from("<12f", numbers)
            for i, corner in enumerate(corners):
                wanted = [shift + scale * x for x in corner]
                got = [middle[k] + found[3 * i + k] for k in range(3)]
                self.assertLess(math.dist(wanted, got), 1e-6 * scale + 1e-15 * abs(shift))


if __name__ == "__main__":
    main()
