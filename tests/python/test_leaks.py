# SPDX-License-Identifier: Apache-2.0
"""Nothing of the library is left behind, whatever becomes of the objects; no memory grows."""
import gc
import sys
import threading
import unittest

import numpy as np

import starguard
from starguard import _session
from support import FACES, SANITIZE, VERTICES, Case, main


def live():
    """Objects and contexts of the library that have not been freed."""
    gc.collect()
    return len(_session._owned), len(_session._callbacks)


def resident():
    """Bytes that the process holds."""
    with open("/proc/self/statm", encoding="ascii") as file:
        return int(file.read().split()[1]) * 4096


ROOM = starguard.sample("l-room", vertices=500)


def use_everything():
    """Makes an object of every kind, and an error."""
    solid = starguard.Solid(ROOM)
    guards = starguard.guard(solid, candidates="interior", count=20, method="greedy")
    seen = starguard.visible(solid, guards.positions)
    starguard.cover(seen, prices=True, method="lp")
    starguard.kernel(solid)
    starguard.skeleton(solid, nodes=20)
    pieces = starguard.decompose((VERTICES, FACES), generator="stuffing", effort=30)
    pieces.surfaces()
    starguard.TetMesh(VERTICES, [[0, 1, 2, 3]]).surface()
    starguard.verify((VERTICES, FACES), starguard.guard((VERTICES, FACES)))
    descriptor = starguard.describe((VERTICES, FACES))
    descriptor.points()
    starguard.match(descriptor, descriptor)
    starguard.Mesh(VERTICES, FACES[:3]).repair()
    ROOM.simplify(100)
    ROOM.levels(100, 200)
    morph = starguard.Morph((VERTICES, FACES), VERTICES, method="star", candidates=10)
    morph.measure(0.5)
    starguard.map_surface((VERTICES, FACES), (VERTICES, FACES)).images()
    try:
        starguard.Solid((VERTICES, FACES[:3]))
    except starguard.MeshError:
        pass


class Leaks(Case):
    def test_counts(self):
        before = live()
        use_everything()
        self.assertEqual(live(), before)

    def test_databases(self):
        before = live()
        ROOM.write("room.off")
        with starguard.Database.create("shapes.db") as shapes:
            shapes.add(["room.off", "none.off"])
            models = shapes.signatures("d2")
            shapes.evaluate()
        self.assertEqual(len(models[0].signature.numbers), 64)
        open_one = starguard.Database("shapes.db")
        open_one.models()
        del models, open_one, shapes
        self.assertEqual(live(), before)

    def test_results_of_files(self):
        before = live()
        guards = starguard.guard(ROOM)
        pieces = starguard.decompose(ROOM, effort=30)
        guards.write("g.json"), pieces.write("p.vtk"), pieces.write_report("p.json")
        kept = [starguard.read_result(name).__class__ for name in ("g.json", "p.vtk", "p.json")]
        self.assertEqual(kept, [starguard.Guards, starguard.PiecesMesh, starguard.PiecesReport])
        self.assertTrue(starguard.verify(ROOM, "g.json", "p.vtk", "p.json"))
        del guards, pieces
        self.assertEqual(live(), before)

    def test_cyclic_garbage(self):
        """The collector takes objects apart in no order; none may need another that is gone."""
        before = live()
        for _ in range(50):
            holder = {"mesh": starguard.sample("star", vertices=500)}
            holder["solid"] = holder["mesh"].solid
            holder["inner"] = holder["solid"].mesh
            holder["view"] = holder["inner"].vertices[3:]
            holder["guards"] = starguard.guard(holder["inner"], method="greedy",
                                               candidates="interior", count=5)
            holder["self"] = holder
            del holder
        self.assertEqual(live(), before)

    def test_interrupted_calls(self):
        self.assertTrue(ROOM.solid)  # made once, and kept
        before = live()
        for _ in range(20):
            try:
                starguard.guard(ROOM, progress=lambda *_: False)
            except starguard.CancelledError:
                pass
        self.assertEqual(live(), before)

    def test_objects_die_on_other_threads(self):
        before = live()
        meshes = [starguard.Mesh(VERTICES, FACES) for _ in range(200)]

        def drop():
            while meshes:
                try:
                    meshes.pop()
                except IndexError:
                    return

        threads = [threading.Thread(target=drop) for _ in range(4)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertEqual(live(), before)

    @unittest.skipIf(SANITIZE, "sanitizers keep freed memory for a while")
    @unittest.skipUnless(sys.platform == "linux", "/proc/self/statm tells the memory on Linux")
    def test_memory_of_a_thousand_calls(self):
        vertices = np.array(VERTICES, float)

        def call():
            mesh = starguard.Mesh(vertices, FACES)
            mesh.check()
            mesh.solid.contains([[0.1, 0.1, 0.1]])
            starguard.kernel(mesh)
            starguard.visible(mesh, [0.1, 0.1, 0.1])
            try:
                starguard.Mesh(vertices, [[0, 1, 9]])
            except starguard.ArgumentError:
                pass

        for _ in range(200):
            call()
        before = resident()
        for _ in range(1000):
            call()
        self.assertLess(resident() - before, 3 << 20)


if __name__ == "__main__":
    main()
