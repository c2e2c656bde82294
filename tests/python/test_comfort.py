# SPDX-License-Identifier: Apache-2.0
"""What makes the package pleasant: reprs of a line, bars, files of maps, sparse matrices, many models."""
import contextlib
import importlib.util
import io
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
