# SPDX-License-Identifier: Apache-2.0
"""Every status is an exception of its own, with the library's message and what it is about."""
import os
import unittest

import numpy as np

import starguard
from support import FACES, VERTICES, Case, main


class Errors(Case):
    def test_read(self):
        error = self.fails(starguard.ReadError, "none.off", starguard.Mesh.read, "none.off")
        self.assertIsInstance(error, OSError)
        self.assertTrue(error.stage)
        self.fails(starguard.ReadError, "", starguard.Guards.read, ".")
        self.fails(starguard.ReadError, "", starguard.Database, "none.db")

    @unittest.skipIf(os.geteuid() == 0 and not os.path.exists("/dev/full"), "nothing refuses writing")
    def test_write(self):
        mesh = starguard.Mesh(VERTICES, FACES)
        error = self.fails(starguard.WriteError, "no/such", mesh.write, "no/such/mesh.off")
        self.assertIsInstance(error, OSError)
        starguard.Database.create("shapes.db").close()
        self.fails(starguard.WriteError, "shapes.db", starguard.Database.create, "shapes.db")

    def test_format(self):
        with open("bad.off", "w", encoding="utf-8") as file:
            file.write("OFF\n3 1 0\n0 0 0\n1 0 0\n0 x 0\n3 0 1 2\n")
        error = self.fails(starguard.FormatError, "bad.off", starguard.Mesh.read, "bad.off")
        self.assertEqual((error.element, error.elements.tolist()), ("line", [5]))
        for read in (starguard.Guards.from_bytes, starguard.PiecesMesh.from_bytes,
                     starguard.PiecesReport.from_bytes, starguard.Certificate.from_bytes,
                     starguard.Descriptor.from_bytes,
                     starguard.TetMesh.from_bytes, starguard.Mesh.from_bytes,
                     starguard.Skeleton.from_bytes,
                     starguard.points_from_bytes):
            for data in (b"", b"garbage", b"{}", b"\0\xff" * 50):
                with self.assertRaises(starguard.Error, msg=f"{read} {data!r}") as caught:
                    if read is starguard.points_from_bytes and not data:
                        raise starguard.FormatError("no points is no error")
                    read(data, "thing")
                self.assertIsInstance(caught.exception, ValueError)

    def test_mesh(self):
        error = self.fails(starguard.MeshError, "", starguard.Solid, (VERTICES, FACES[:3]))
        self.assertIsInstance(error, ValueError)
        self.assertEqual(error.element, "edge")
        self.assertEqual(error.elements.shape[1], 2)
        self.assertTrue(set(map(tuple, error.elements.tolist())) <= {(1, 2), (2, 3), (1, 3), (2, 1),
                                                                     (3, 2), (3, 1)})
        self.fails(starguard.MeshError, "", starguard.guard, (VERTICES, FACES[:3]))
        self.fails(starguard.MeshError, "", starguard.kernel, (VERTICES, FACES[:3]))

    def test_calls(self):
        """Messages tell of calls and keyword arguments, not of commands and options."""
        error = self.fails(starguard.MeshError, "try `Mesh.repair()`", starguard.Solid, (VERTICES, FACES[:3]))
        self.assertNotRegex(str(error), "starguard |--")
        loose = np.random.default_rng(1).random((90, 3)), np.arange(90).reshape(30, 3)
        error = self.fails(starguard.MeshError, "`Scene(model, soup=True)` takes them", starguard.guard, loose)
        self.assertIn("`Mesh.repair(merge_distance=...)`", str(error))
        self.assertNotRegex(str(error), "starguard |--")
        error = self.fails(starguard.ReadError, "--soup.off", starguard.Mesh.read, "--soup.off") # names stay
        self.assertNotIn("soup=True", str(error))
        self.fails(starguard.ArgumentError, "did you mean 'horse'?", starguard.sample, "hors")

    def test_warnings(self):
        """Like messages of errors: here of a box without a lid."""
        box = starguard.Mesh([(x, y, z) for z in (0, 1) for y in (0, 1) for x in (0, 1)],
                             [(0, 1, 4), (1, 5, 4), (1, 3, 5), (3, 7, 5), (3, 2, 7), (2, 6, 7), (2, 0, 6), (0, 4, 6),
                              (0, 2, 1), (1, 2, 3)])
        with self.assertLogs("starguard") as caught:
            scene = starguard.Scene(box, soup=True, start=(0.5, 0.5, 0.5), cell=0.1)
        self.assertIn("Scene.leak shows the way", caught.output[-1])
        self.assertIn("(cell)", caught.output[-1])
        self.assertNotIn("--", caught.output[-1])
        self.assertGreater(scene.leak[-1][2], 1)

    def test_argument(self):
        mesh = starguard.Mesh(VERTICES, FACES)
        error = self.fails(starguard.ArgumentError, "it must be one of ilp, greedy, pilp",
                           starguard.guard, mesh, method="best")
        self.assertIsInstance(error, ValueError)
        self.assertEqual((error.element, len(error.elements)), ("none", 0))
        for options in ({"coverage": 0}, {"coverage": np.nan}, {"redundancy": 0},
                        {"max_guards": -1}, {"max_guards": 1.5}, {"max_guards": 2**64},
                        {"clearance": -1}, {"range": -1}, {"cone": 0}, {"threads": -1},
                        {"threads": 1025}, {"seed": -1}, {"seed": 2**64}, {"time_limit": 0},
                        {"time_limit": np.nan}, {"candidates": [[0, 0]]}, {"candidates": "here"},
                        {"method": 3}, {"visibility": "eyes"}, {"refine": 2}, {"step": 0}, {"coverage": "all"}):
            with self.subTest(options=options):
                self.fails(starguard.ArgumentError, "", starguard.guard, mesh, **options)
        self.fails(starguard.ArgumentError, "", starguard.sample, "unicorn")
        self.fails(starguard.ArgumentError, "", starguard.sample, "dog", pose=99)
        self.fails(starguard.ArgumentError, "a zero byte", starguard.Mesh.read, "a\0b")
        self.fails(starguard.ArgumentError, "", mesh.write, "mesh.xyz")
        self.fails(starguard.ArgumentError, "give a result", starguard.verify, mesh)

    def test_range(self):
        error = self.fails(starguard.RangeError, "", starguard.Mesh, [[0, 0, np.inf]], [])
        self.assertIsInstance(error, ValueError)

    def test_time(self):
        dog = starguard.sample("dog")
        error = self.fails(starguard.TimeLimitError, "", starguard.visible, dog,
                           np.tile(dog.vertices.mean(axis=0), (2000, 1)), engine="sweep",
                           time_limit=1e-9)
        self.assertIsInstance(error, TimeoutError)

    def test_memory(self):
        """No machine has room for so many bits; NumPy needs one for them all."""
        many = np.broadcast_to(np.False_, (2**20, 2**40))
        error = self.fails(starguard.OutOfMemoryError, "memory", starguard.Bits.of, many)
        self.assertIsInstance(error, MemoryError)

    def test_file_names_of_any_bytes(self):
        name = b"caf\xe9.off"
        mesh = starguard.Mesh(VERTICES, FACES)
        mesh.write(name)
        again = starguard.Mesh.read(name)
        self.assertEqual(again.file, name)
        guards = starguard.guard(again)
        guards.write("guards.json")
        self.assertEqual(starguard.Guards.read("guards.json").file.encode("utf-8", "replace")[:3],
                         b"caf")
        self.fails(starguard.ReadError, "caf", starguard.Mesh.read, b"caf\xe8.off")

    def test_a_closed_database(self):
        with starguard.Database.create("shapes.db") as shapes:
            self.assertEqual(len(shapes.models()), 0)
        self.fails(starguard.ArgumentError, "closed", shapes.models)
        shapes.close()


class Cases(Case):
    def test_bad_mixtures(self):
        room = starguard.sample("l-room", vertices=500)
        self.fails(starguard.ArgumentError, "2 points and 1 directions", starguard.visible, room,
                   [[0.5] * 3] * 2, cone=90, directions=[1, 0, 0])
        self.fails(starguard.ArgumentError, "directions", starguard.visible, room, [0.5] * 3, cone=90)
        self.fails(starguard.ArgumentError, "4 vertices", starguard.Morph, (VERTICES, FACES),
                   [[0, 0, 0]])
        self.fails(starguard.ArgumentError, "must be square", starguard.write_matrix_picture, "m.png",
                   [[0, 1]])
        self.fails(starguard.ArgumentError, "same length", starguard.write_picture_sheet, "s.png",
                   [[room], [room, room]])
        self.fails(starguard.ArgumentError, "2 names for 1 row", starguard.write_picture_sheet, "s.png",
                   [[room]], names=["a", "b"])
        self.fails(starguard.ArgumentError, "weights", starguard.cover, [[1, 0]], weights=[1])
        self.fails(starguard.ArgumentError, "weights", starguard.cover, [[1, 0]], weights=[1, -1])
        descriptor = starguard.describe(room)
        self.fails(starguard.ArgumentError, "needs the model itself", starguard.match, descriptor,
                   descriptor, "d2")
        report = starguard.decompose(room, effort=30)
        report.write_report("pieces.json")
        self.fails(starguard.ArgumentError, "has no tetrahedra", starguard.verify, room, "pieces.json")


if __name__ == "__main__":
    main()
