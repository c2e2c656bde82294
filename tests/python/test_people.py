# SPDX-License-Identifier: Apache-2.0
"""What users of Python expect: pickles, sequences, notebooks, objects of other packages, help, examples."""
import base64
import concurrent.futures
import dataclasses
import glob
import importlib.util
import inspect
import multiprocessing
import os
import pickle
import re
import subprocess
import sys
import types
import unittest
import warnings

import numpy as np

import starguard
from support import FACES, SOURCE, VERTICES, Case, main

ROOM = starguard.sample("gallery", vertices=500)
if __name__ == "__main__":  # not in other processes
    GUARDS = starguard.guard(ROOM)
    PIECES = starguard.decompose(ROOM, effort=10)


def same(a, b):
    """Are two results the same, field by field? Whoever compares does not use the files of pickles."""
    if isinstance(a, np.ndarray):
        return a.dtype == b.dtype and a.shape == b.shape and np.array_equal(a, b)
    if isinstance(a, starguard.Mesh):
        return same(a.vertices, b.vertices) and same(a.faces, b.faces) and a.file == b.file
    if isinstance(a, starguard.TetMesh):
        return same(a.vertices, b.vertices) and same(a.tetrahedra, b.tetrahedra)
    if isinstance(a, (list, tuple)):
        return len(a) == len(b) and all(map(same, a, b))
    if dataclasses.is_dataclass(a):
        return all(same(getattr(a, f.name), getattr(b, f.name)) for f in dataclasses.fields(a)
                   if not f.name.startswith("_"))
    return a == b


def count(guards):
    return len(guards), guards.model.volume


class Pickles(Case):
    def test_meshes_keep_their_file(self):
        ROOM.write("room.off")
        mesh = starguard.Mesh.read("room.off")
        self.assertTrue(same(pickle.loads(pickle.dumps(mesh)), mesh))

    def test_guards(self):
        for guards in (GUARDS, starguard.guard(ROOM, max_guards=2, cone=90)):
            again = pickle.loads(pickle.dumps(guards))
            self.assertTrue(same(again, guards))
            self.assertTrue(starguard.verify(again.model, again).passed)
            guards.write("a.json")
            again.write("b.json")
            self.assertEqual(self.read("a.json"), self.read("b.json"))

    def test_guards_without_a_model(self):
        GUARDS.write("a.json")
        read = starguard.Guards.read("a.json")
        self.assertIsNone(read.model)
        self.assertTrue(same(pickle.loads(pickle.dumps(read)), read))

    def test_pieces(self):
        for pieces in (PIECES, starguard.decompose(starguard.sample("l-room", vertices=500), effort=1,
                                                   balls="even", tetgen_limit=7, seed=2**64 - 1)):
            again = pickle.loads(pickle.dumps(pieces))
            self.assertTrue(same(again, pieces))
            for result, name in ((pieces, "a"), (again, "b")):
                result.write(f"{name}.vtk")
                result.write_report(f"{name}.json")
            self.assertEqual(self.read("a.vtk"), self.read("b.vtk"))
            self.assertEqual(self.read("a.json"), self.read("b.json"))

    def test_other_processes(self):
        with concurrent.futures.ProcessPoolExecutor(1, multiprocessing.get_context("spawn")) as pool:
            self.assertEqual(pool.submit(count, GUARDS).result(), (len(GUARDS), ROOM.volume))
            self.assertTrue(same(pool.submit(starguard.guard, ROOM).result(), GUARDS))


class Sequences(Case):
    def test_guards(self):
        self.assertTrue(same([guard.position for guard in GUARDS], list(GUARDS.positions)))
        self.assertEqual([guard.seen_faces for guard in GUARDS], GUARDS.seen_faces.tolist())
        self.assertTrue(same(GUARDS[-1].position, GUARDS.positions[-1]))
        self.assertTrue(same([g.position for g in GUARDS[1:3]], list(GUARDS.positions[1:3])))
        self.assertIsNone(GUARDS[0].direction)
        with self.assertRaises(IndexError):
            GUARDS[len(GUARDS)]

    def test_cameras(self):
        cameras = starguard.guard(ROOM, max_guards=2, cone=90)
        for camera in cameras:
            self.assertAlmostEqual(float(np.linalg.norm(camera.direction)), 1)

    def test_pieces(self):
        self.assertEqual([piece["volume"] for piece in PIECES], PIECES.pieces["volume"].tolist())
        self.assertEqual(PIECES[0]["tetrahedra"], np.count_nonzero(PIECES.labels == 0))


class Notebooks(Case):
    def picture(self, thing):
        text = thing._repr_html_()
        found = re.search(r'src="data:image/png;base64,([^"]*)"', text)
        png = base64.b64decode(found[1])
        self.assertEqual(png[:8], b"\x89PNG\r\n\x1a\n")
        return text, png

    def test_each_has_a_picture_of_its_own(self):
        pictures = {self.picture(thing)[1] for thing in (ROOM, GUARDS, PIECES)}
        self.assertEqual(len(pictures), 3)
        self.assertIn(f"<td>{len(GUARDS)}</td>", GUARDS._repr_html_())
        self.assertIn(f"<td>{PIECES.strictly_star}</td>", PIECES._repr_html_())

    def test_nothing_to_draw(self):
        GUARDS.write("a.json")
        self.assertNotIn("<img", starguard.Guards.read("a.json")._repr_html_())
        self.assertNotIn("<img", starguard.Mesh([[0, 0, 0]], [])._repr_html_())


class Stand:
    """Takes the place of a package that is not installed, and keeps what it was given."""

    def __init__(self, *given, **named):
        self.given, self.named, self.cell_data = given, named, {}


class Others(Case):
    def stand_in(self, package, kind):
        if package not in sys.modules:
            self.addCleanup(sys.modules.pop, package)
        else:
            self.addCleanup(sys.modules.__setitem__, package, sys.modules[package])
        sys.modules[package] = types.SimpleNamespace(**{kind: Stand})

    def test_trimesh(self):
        self.stand_in("trimesh", "Trimesh")
        made = ROOM.to_trimesh().named
        self.assertIs(made["process"], False)
        self.assertTrue(np.array_equal(made["vertices"], ROOM.vertices))
        self.assertTrue(np.array_equal(made["faces"], ROOM.faces))
        made["vertices"][:] = 0  # a copy: the mesh does not change

    def test_pyvista(self):
        self.stand_in("pyvista", "PolyData")
        vertices, faces = ROOM.to_pyvista().given
        again = starguard.as_mesh(types.SimpleNamespace(points=vertices, faces=faces))
        self.assertTrue(same(again.faces, ROOM.faces))
        self.stand_in("pyvista", "UnstructuredGrid")
        grid = PIECES.to_pyvista()
        cells, kinds, points = grid.given
        self.assertEqual(set(kinds.tolist()), {10})
        self.assertTrue(np.array_equal(cells.reshape(-1, 5)[:, 1:], PIECES.mesh.tetrahedra))
        self.assertTrue(np.array_equal(points, PIECES.mesh.vertices))
        self.assertTrue(np.array_equal(grid.cell_data["piece"], PIECES.labels))

    @unittest.skipUnless(importlib.util.find_spec("meshio"), "meshio is not installed")
    def test_meshio(self):
        self.assertTrue(same(starguard.as_mesh(ROOM.to_meshio()).faces, ROOM.faces))
        PIECES.to_meshio().write("a.vtu")
        import meshio
        read = meshio.read("a.vtu")
        self.assertTrue(np.array_equal(read.cells_dict["tetra"], PIECES.mesh.tetrahedra))
        self.assertTrue(np.array_equal(read.cell_data["piece"][0], PIECES.labels))

    def test_what_is_missing_is_named(self):
        sys.modules["trimesh"] = None
        self.addCleanup(sys.modules.pop, "trimesh")
        with self.assertRaisesRegex(ImportError, "trimesh.*pip install trimesh"):
            ROOM.to_trimesh()


class Help(Case):
    def texts(self):
        for name in starguard.__all__:
            value = getattr(starguard, name)
            if inspect.isfunction(value) or inspect.isclass(value):
                yield name, value.__doc__
            if inspect.isclass(value):
                for member in vars(value):
                    if not member.startswith("_"):
                        yield f"{name}.{member}", inspect.getdoc(getattr(value, member, None)) or ""

    def test_it_never_sends_to_c(self):
        for name, text in self.texts():
            self.assertNotRegex(text, r"\b\w+\.h\b|STARG_|\bstarg_", name)

    def test_choices_are_listed(self):
        for thing, option in ((starguard.guard, "method"), (starguard.guard, "visibility"),
                              (starguard.decompose, "mode"), (starguard.Morph, "method")):
            line = next(line for line in thing.__doc__.splitlines() if line.startswith(f"- `{option}`"))
            self.assertGreater(line.count('"'), 3, line)

    def test_old_names_work_and_say_so(self):
        tetra = starguard.Mesh(VERTICES, FACES)
        with warnings.catch_warnings(record=True) as said:
            warnings.simplefilter("always")
            self.assertEqual(starguard.match(tetra, tetra, kind="d2"), 0)
        self.assertEqual([w.category for w in said], [DeprecationWarning])
        self.assertEqual(said[0].filename, __file__)


class Examples(Case):
    def run_example(self, name, *words):
        done = subprocess.run([sys.executable, "-B", os.path.join(SOURCE, "examples", name), *words],
                              capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 0, done.stderr)
        return done.stdout

    def test_every_example_is_tested(self):
        names = {os.path.basename(path)[:-3] for path in glob.glob(os.path.join(SOURCE, "examples", "*.py"))}
        tested = {name[len("test_run_"):] for name in dir(self) if name.startswith("test_run_")}
        self.assertEqual(names, tested)

    def test_run_cameras(self):
        text = self.run_example("cameras.py")
        seen, most = re.search(r"see (\S+)% of the area; .* more than (\S+)%", text).groups()
        self.assertLess(40, float(seen))
        self.assertLessEqual(float(seen), float(most))
        self.assertEqual(text.count("looking along"), 5)
        with open("cameras.csv", encoding="utf-8") as file:
            self.assertEqual(len(file.readlines()), 1 + 5)

    def test_run_tetrahedra(self):
        text = self.run_example("tetrahedra.py")
        pieces, star = map(int, re.search(r"(\d+) pieces, (\d+) proven", text).groups())
        self.assertEqual(pieces, star)
        self.assertIn("all tetrahedra positive: True", text)
        self.assertEqual(*re.search(r"volume (\S+) of (\S+)\n", text).groups())
        self.assertTrue(starguard.is_tetrahedral("pieces.vtk"))

    def test_run_poses(self):
        text = self.run_example("poses.py")
        self.assertIn("nearest neighbour right: 100%", text)

    def test_run_morph(self):
        text = self.run_example("morph.py")
        drift = [float(word) for word in re.findall(r"at most (\S+)%", text)]
        self.assertLess(drift[1], drift[0])  # by guards, the volume changes less than linearly
        self.assertEqual(len(starguard.read_animation("morph.glb")), 11)


if __name__ == "__main__":
    main()
