# SPDX-License-Identifier: Apache-2.0
"""Arrays in and out: shapes, types, values; what is copied, what is not, and who keeps whom."""
import copy
import gc
import pickle
import types

import numpy as np

import starguard
from support import FACES, VERTICES, Case, main


class Into(Case):
    def test_shapes(self):
        for vertices in ([0, 1, 2], [[0, 1]], np.zeros((2, 3, 3)), np.zeros((4, 2))):
            self.fails(starguard.ArgumentError, "vertices must have the shape (n, 3)",
                       starguard.Mesh, vertices, [])
        for faces in ([[0, 1, 2, 3]], [0, 1, 2], np.zeros((1, 1, 3), int)):
            self.fails(starguard.ArgumentError, "faces must have the shape (m, 3)",
                       starguard.Mesh, VERTICES, faces)

    def test_types(self):
        self.fails(starguard.ArgumentError, "vertices must be numbers", starguard.Mesh, "abc", FACES)
        self.fails(starguard.ArgumentError, "vertices must be numbers", starguard.Mesh, [[1, 2], [3]],
                   FACES)
        self.fails(starguard.ArgumentError, "faces must be integers", starguard.Mesh, VERTICES,
                   np.asarray(FACES, float))
        self.fails(starguard.ArgumentError, "faces must be integers", starguard.Mesh, VERTICES,
                   np.asarray(FACES, bool))

    def test_nothing_is_dropped(self):
        """Masks and imaginary parts; an array without hidden entries may have a mask."""
        rows = np.array(VERTICES, float)
        hidden = np.ma.MaskedArray(rows, mask=rows > 0)
        for vertices in (hidden, rows + 1j, [[1j, 0, 0]]):
            with self.assertRaises(TypeError):
                starguard.Mesh(vertices, FACES)
        with self.assertRaises(TypeError):
            starguard.Mesh(VERTICES, np.ma.MaskedArray(FACES, mask=np.array(FACES) == 0))
        with self.assertRaises(TypeError):
            starguard.Solid(starguard.Mesh(VERTICES, FACES)).contains(hidden[1])
        with self.assertRaises(TypeError):
            starguard.Mesh(VERTICES, FACES).write("a.ply", face_colors=np.ma.masked_less(FACES, 1))
        with self.assertRaises(TypeError):
            starguard.cover([[True, True]], weights=np.ma.masked_less([0, 1], 1))
        plain = starguard.Mesh(np.ma.MaskedArray(rows), FACES)
        self.assertEqual(plain.vertices.tolist(), rows.tolist())

    def test_origin_of_files(self):
        far = np.array(VERTICES, float) + [512345.3, 5412345.3, 100]
        mesh = starguard.Mesh(far, FACES)
        self.fails(starguard.RangeError, "single precision", mesh.write, "a.stl")
        mesh.write("b.stl", origin=mesh.origin)
        self.assertAlmostEqual(starguard.Mesh.read("b.stl").volume, mesh.volume, 6)
        mesh.write("a.stl", origin=[512345, 5412345, 100])
        self.assertAlmostEqual(starguard.Mesh.read("a.stl").volume, mesh.volume, 6)

    def test_values(self):
        for bad in (np.nan, np.inf, -np.inf, 1e100):
            rows = np.array(VERTICES, float)
            rows[2, 1] = bad
            error = self.fails(starguard.RangeError, "", starguard.Mesh, rows, FACES)
            self.assertEqual((error.element, error.elements.tolist()), ("vertex", [2]))
        self.fails(starguard.ArgumentError, "not -1", starguard.Mesh, VERTICES, [[0, 1, -1]])
        self.fails(starguard.ArgumentError, "not 4294967296", starguard.Mesh, VERTICES,
                   np.array([[0, 1, 2**32]]))
        self.fails(starguard.ArgumentError, "", starguard.Mesh, VERTICES, [[0, 1, 4]])

    def test_every_integer_type(self):
        for kind in ("i1", "u1", "i2", "u2", "i4", "u4", "i8", "u8", ">i4", ">u8"):
            mesh = starguard.Mesh(VERTICES, np.array(FACES, kind))
            self.assertEqual(mesh.faces.tolist(), FACES, kind)

    def test_every_layout(self):
        rows = np.array(VERTICES, np.float32)
        for vertices in (rows, np.asfortranarray(rows), np.repeat(rows, 2, axis=0)[::2],
                         rows.astype(">f8"), [tuple(row) for row in rows]):
            for faces in (np.asfortranarray(FACES), np.repeat(FACES, 2, axis=0)[::2]):
                mesh = starguard.Mesh(vertices, faces)
                self.assertEqual(mesh.vertices.tolist(), rows.tolist())
                self.assertEqual(mesh.faces.tolist(), FACES)

    def test_nothing(self):
        for empty in ([], np.empty((0, 3)), np.empty(0)):
            mesh = starguard.Mesh(empty, np.empty((0, 3), int))
            self.assertEqual((mesh.vertices.shape, mesh.faces.shape), ((0, 3), (0, 3)))
            self.assertEqual(mesh.bounds.tolist(), [[0, 0, 0], [0, 0, 0]])

    def test_what_the_caller_does_later_changes_nothing(self):
        rows, corners = np.array(VERTICES, float), np.array(FACES, np.uint32)
        mesh = starguard.Mesh(rows, corners)
        rows[:], corners[:] = 7, 0
        self.assertEqual(mesh.vertices.tolist(), VERTICES)
        self.assertEqual(mesh.faces.tolist(), FACES)

    def test_numbers_of_numpy(self):
        mesh = starguard.Mesh(VERTICES, FACES)
        guards = starguard.guard(mesh, threads=np.int64(1), seed=np.uint64(2**64 - 1),
                                 count=np.int32(10), coverage=np.float32(0.5),
                                 max_guards=np.uint8(1), refine=np.bool_(False))
        self.assertEqual(guards.options["max_guards"], 1)
        self.assertIs(guards.options["refine"], False)

    def test_a_single_point(self):
        room = starguard.sample("l-room", vertices=500)
        self.assertEqual(starguard.visible(room, [0.5, 0.5, 0.5]).shape[0], 1)
        self.fails(starguard.ArgumentError, "points must have the shape", starguard.visible, room,
                   [1.0, 2.0])

    def test_tetrahedra(self):
        self.fails(starguard.ArgumentError, "tetrahedra must have the shape (m, 4)",
                   starguard.TetMesh, VERTICES, FACES)
        self.fails(starguard.ArgumentError, "regions must have the shape (1,)", starguard.TetMesh,
                   VERTICES, [[0, 1, 2, 3]], [1, 2])
        tets = starguard.TetMesh(VERTICES, [[0, 2, 1, 3]], [5])
        self.assertEqual((tets.turned, tets.tetrahedra.tolist()), (1, [[0, 2, 3, 1]]))
        self.assertEqual(tets.neighbours.tolist(), [[starguard.NO_NEIGHBOUR] * 4])
        self.assertAlmostEqual(tets.volume, 1 / 6)

    def test_colors(self):
        mesh = starguard.Mesh(VERTICES, FACES)
        for colors in ([[0, 0, 0]], [[0, 0, 256]] * 4, [[-1, 0, 0]] * 4, [[0.5, 0, 0]] * 4):
            self.fails(starguard.ArgumentError, "face_colors must be whole numbers", mesh.write,
                       "m.ply", face_colors=colors)


class Out(Case):
    def test_read_only_views_of_one_memory(self):
        mesh = starguard.sample("l-room", vertices=500)
        again = starguard.Solid(mesh).mesh
        for array, kind in ((mesh.vertices, np.float64), (mesh.faces, np.uint32)):
            self.assertEqual((array.dtype, array.ndim, array.shape[1]), (kind, 2, 3))
            self.assertFalse(array.flags.writeable or array.flags.owndata)
            self.assertTrue(array.flags.c_contiguous and array.flags.aligned)
            with self.assertRaises(ValueError):
                array[0] = 0
            with self.assertRaises(ValueError):
                array.flags.writeable = True
        self.assertFalse(np.shares_memory(mesh.vertices, again.vertices))
        self.assertTrue(np.shares_memory(mesh.vertices, starguard.as_mesh(mesh).vertices))

    def test_arrays_keep_their_owner(self):
        kept, wanted = [], []
        for pose in range(3):
            mesh = starguard.sample("dog", pose=pose, vertices=500)
            kept.append(mesh.vertices[10:20])
            wanted.append(mesh.vertices[10:20].copy())
            del mesh
        pieces = starguard.decompose(starguard.sample("star", vertices=500), effort=30)
        tets, guards = pieces.mesh.tetrahedra[:5], pieces.guards
        expected = tets.copy(), guards.copy()
        del pieces
        gc.collect()
        churn = [starguard.sample("star", vertices=600) for _ in range(20)]
        for array, copy in zip(kept, wanted):
            self.assertTrue((array == copy).all())
        self.assertTrue((tets == expected[0]).all() and (guards == expected[1]).all())
        self.assertEqual(len(churn), 20)

    def test_a_solid_keeps_its_mesh(self):
        mesh = starguard.sample("star", vertices=500).solid.mesh
        gc.collect()
        self.assertGreater(mesh.volume, 0)
        self.assertGreater(float(mesh.vertices.max()), 0)

    def test_structured_arrays(self):
        pieces = starguard.decompose(starguard.sample("gallery", vertices=1000), effort=30)
        self.assertGreater(len(pieces), 1)
        records = pieces.pieces
        self.assertEqual(records.dtype.names, ("guard", "radius", "margin", "tetrahedra", "volume", "star",
                                               "spread"))
        self.assertTrue(records["star"].all())
        self.assertEqual(records["tetrahedra"].sum(), len(pieces.labels))
        self.assertAlmostEqual(records["volume"].sum(), pieces.mesh.volume)
        self.assertFalse(records.flags.writeable)
        self.assertTrue((pieces.contacts["first"] < pieces.contacts["second"]).all())
        self.assertEqual(sorted(set(pieces.labels.tolist())), list(range(len(pieces))))
        self.check_read_back(pieces)

    def check_read_back(self, pieces):
        """Both files, written, read and written again."""
        def written(pieces):
            pieces.write("p.vtk", binary=True)
            pieces.write_report("p.json", pieces.file or "room.off")
            return [open(name, "rb").read() for name in ("p.vtk", "p.json")]
        files = written(pieces)
        for read in (starguard.Decomposition.read("p.vtk", "p.json"),
                     starguard.Decomposition.from_bytes(*files)):
            self.assertEqual(written(read), files)
            self.assertEqual(read.file, "room.off")
            self.assertTrue((read.labels == pieces.labels).all())
            self.assertTrue((read.pieces == pieces.pieces).all())
        self.fails(starguard.FormatError, "\"format\"", starguard.Decomposition.from_bytes,
                   files[0], b"{}")

    def test_bits(self):
        rng = np.random.default_rng(1)
        for shape in ((1, 1), (3, 64), (4, 65), (7, 200), (0, 5), (5, 0)):
            matrix = rng.random(shape) < 0.5
            bits = starguard.Bits.of(matrix)
            self.assertEqual(bits.shape, shape)
            self.assertTrue((np.asarray(bits) == matrix).all())
            self.assertEqual(bits.counts().tolist(), matrix.sum(axis=1).tolist())
            for i, j in np.ndindex(*shape):
                self.assertEqual(bool(bits[i, j]), matrix[i, j])
        self.assertEqual(bits[1:3].shape, (2, 0))
        with self.assertRaises(IndexError):
            starguard.Bits.of([[True]])[0, 1]
        self.fails(starguard.ArgumentError, "two dimensions", starguard.Bits.of, [True])

    def test_pickles(self):
        mesh = starguard.sample("star", vertices=500)
        again = pickle.loads(pickle.dumps(mesh))
        self.assertTrue((again.vertices == mesh.vertices).all() and (again.faces == mesh.faces).all())
        tets = starguard.TetMesh([*VERTICES, [1, 1, 1]], [[0, 1, 2, 3], [1, 2, 3, 4]], [4, 5])
        again = pickle.loads(pickle.dumps(tets))
        self.assertEqual(again.regions.tolist(), [4, 5])
        self.assertEqual(again.tetrahedra.tolist(), tets.tetrahedra.tolist())
        signature = starguard.signature(mesh, "d2")
        self.assertEqual(starguard.match(signature, pickle.loads(pickle.dumps(signature))), 0)

    def test_every_result(self):
        """Copies of any type work and are as good; pickles work too, or say what to do, at once."""
        mesh = starguard.sample("star", vertices=500)
        solid = starguard.Solid(mesh)
        scene = starguard.Scene(mesh, obstacles=[mesh])
        results = [mesh, solid, scene, starguard.Bits.of([[True, False]]), starguard.skeleton(mesh, nodes=20),
                   starguard.guard(mesh), starguard.kernel(mesh), starguard.describe(mesh), mesh.check(),
                   starguard.map_surface(mesh, mesh), starguard.map_solid(mesh, mesh), starguard.decompose(mesh),
                   starguard.cover(starguard.Bits.of([[True]])), starguard.Morph(mesh, mesh, method="linear")]
        kept = 0
        for result in results:
            kind = type(result)
            for again in (copy.copy(result), copy.deepcopy(result)):
                self.assertIs(type(again), kind)
                self.assertEqual(repr(again).split(" at ")[0], repr(result).split(" at ")[0])
            try:
                data = pickle.dumps(result)
            except TypeError as error:
                self.assertRegex(str(error), "write it to a file|; pickle its", kind)
                self.assertNotIn("recursion", str(error))
            else:
                self.assertEqual(repr(pickle.loads(data)), repr(result))
                kept += 1
        self.assertGreaterEqual(kept, 5)
        self.assertEqual(pickle.loads(pickle.dumps(solid)).contains([[0, 0, 0]]), solid.contains([[0, 0, 0]]))
        with starguard.Database.create("copied.db") as shapes:
            self.assertEqual(len(pickle.loads(pickle.dumps(shapes)).models()), 0)
            self.assertEqual(len(copy.deepcopy(shapes).models()), 0)
        gc.collect()


class Conventions(Case):
    """Objects of other packages."""

    def test_vertices_and_faces(self):
        like = types.SimpleNamespace(vertices=np.array(VERTICES, float), faces=np.array(FACES))
        self.assertEqual(starguard.as_mesh(like).faces.tolist(), FACES)
        self.assertEqual(starguard.as_mesh((VERTICES, FACES)).faces.tolist(), FACES)

    def test_pyvista(self):
        flat = np.array([[3, *face] for face in FACES]).ravel()
        like = types.SimpleNamespace(points=np.array(VERTICES, np.float32), faces=flat)
        self.assertEqual(starguard.as_mesh(like).faces.tolist(), FACES)
        like.faces = np.array([4, 0, 1, 2, 3])
        self.fails(starguard.ArgumentError, "other than triangles", starguard.as_mesh, like)

    def test_meshio(self):
        try:
            import meshio
        except ImportError:
            self.skipTest("meshio is not installed")
        mesh = meshio.Mesh(np.array(VERTICES, float), [("triangle", np.array(FACES))])
        self.assertTrue(starguard.as_mesh(mesh).check().usable)
        ours = starguard.sample("star", vertices=500)
        meshio.write("star.vtk", meshio.Mesh(ours.vertices, [("triangle", ours.faces)]))
        back = starguard.as_mesh(meshio.read("star.vtk"))
        self.assertTrue((back.vertices == ours.vertices).all() and (back.faces == ours.faces).all())

    def test_what_is_none(self):
        for model in (None, 7, [1, 2], object()):
            self.fails(starguard.ArgumentError, "is not a mesh", starguard.as_mesh, model)


if __name__ == "__main__":
    main()
