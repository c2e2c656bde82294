# SPDX-License-Identifier: Apache-2.0
"""What makes the package pleasant: reprs of a line, bars, files of maps, sparse matrices, many models."""
import contextlib
import importlib.util
import io
import pathlib
import shutil
import unittest

import numpy as np
import starguard
from support import Case, main


class Comfort(Case):
    def setUp(self):
        super().setUp()
        self.room = starguard.sample("l-room", vertices=500)

    def test_reprs_are_lines(self):
        guards = starguard.guard(self.room, count=100)
        for thing in (self.room, guards, starguard.verify(self.room, guards), starguard.kernel(self.room),
                      starguard.cover(np.eye(3, dtype=bool)), starguard.signature(self.room, "d2")):
            self.assertNotIn("\n", repr(thing))
            self.assertLess(len(repr(thing)), 300, repr(thing))
            self.assertTrue(repr(thing).startswith(type(thing).__name__), repr(thing))

    def test_files_of_guards(self):
        guards = starguard.guard(self.room, count=100)
        guards.write_table("t.csv", self.room)
        guards.write_summary("s.csv", self.room)
        guards.write_sheet("sheet.html", self.room, title="A <room>")
        self.assertEqual(len(self.read("t.csv").splitlines()), 1 + len(self.room.faces))
        self.assertEqual(self.read("s.csv").count(b"camera,"), len(guards))
        self.assertIn(b"<h1>A &lt;room&gt;</h1>", self.read("sheet.html"))

    def test_names_of_faces(self):
        """Groups of the model's file, as on the command line: a box with a floor and two walls by name."""
        corners = [(x, y, z) for z in (0, 3) for y in (0, 4) for x in (0, 5)]
        quads = {"Floor": (1, 3, 4, 2), "Ceiling": (5, 6, 8, 7), "wall west": (1, 5, 7, 3), "wall east": (2, 4, 8, 6),
                 "front": (1, 2, 6, 5), "back": (3, 7, 8, 4)}
        lines = ["v %d %d %d" % corner for corner in corners]
        for name, quad in quads.items():
            lines += [f"g {name.replace(' ', '_')}", "f " + " ".join(map(str, quad[::-1]))]
        pathlib.Path("room.obj").write_text("\n".join(lines) + "\n", encoding="utf-8")
        room = starguard.Mesh.read("room.obj")
        options = {"soup": True, "start": (1.1, 1.1, 2.4), "cell": 0.2, "up": (0, 0, 1)}
        for see, ignore in (["Floor", "wall*"], None), (None, ["Ceiling", "front", "back"]):
            named = starguard.Scene(room, see=see, ignore=ignore, mount=("Ceiling", 1), **options)
            numbers = starguard.Scene(room, see=[0, 1, 4, 5, 6, 7], mount=([2, 3], 1), **options)
            positions = [starguard.guard(scene, patch=1.0).positions for scene in (named, numbers)]
            np.testing.assert_array_equal(*positions)
        for wrong, error in ({"see": "Roof"}, starguard.Error), ({"see": [99]}, starguard.ArgumentError), (
                {"see": "Floor", "ignore": "front"}, starguard.ArgumentError):
            with self.assertRaises(error):
                starguard.Scene(room, **wrong, **options)
        with self.assertRaisesRegex(starguard.ArgumentError, "Mesh.read"):
            starguard.Scene(starguard.Mesh(room.vertices, room.faces), see="Floor", **options)

    def test_bar(self):
        error = io.StringIO()
        with contextlib.redirect_stderr(error):
            with_bar = starguard.guard(self.room, count=100, progress=True)
        self.assertIn("%", error.getvalue())
        quiet = io.StringIO()
        with contextlib.redirect_stderr(quiet):
            without = starguard.guard(self.room, count=100, progress=False)
        self.assertEqual(quiet.getvalue(), "")
        np.testing.assert_array_equal(with_bar.positions, without.positions)

    def test_many(self):
        models = [self.room, starguard.sample("torus", vertices=500)]
        alone = [starguard.guard(model, count=100) for model in models]
        for processes in (1, 2):
            together = starguard.guard_many(models, processes=processes, count=100)
            for one, other in zip(alone, together):
                np.testing.assert_array_equal(one.positions, other.positions)

    @unittest.skipUnless(importlib.util.find_spec("scipy"), "SciPy is not installed")
    def test_sparse(self):
        seen = starguard.visible(self.room, [[0.5, 0.5, 0.5], [0.1, 0.2, 0.3]])
        np.testing.assert_array_equal(seen.to_scipy().toarray().astype(bool), np.asarray(seen))

    @unittest.skipUnless(shutil.which("tetgen"), "tetgen is not installed")
    def test_maps(self):
        one = starguard.map_solid(starguard.sample("sphere", vertices=500), "ball")
        one.write("map.vtu")
        again = starguard.SolidMap.read("map.vtu")
        np.testing.assert_array_equal(again.images, one.images)
        self.assertNotIn("\n", repr(one))
        if importlib.util.find_spec("meshio"):
            mesh = one.to_meshio()
            np.testing.assert_array_equal(mesh.point_data["image"], one.images)


if __name__ == "__main__":
    main()
