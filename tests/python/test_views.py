# SPDX-License-Identifier: Apache-2.0
"""Pages, files for other programs, skeletons and animations read back."""
import json
import os

import numpy as np

import starguard
from support import FACES, VERTICES, Case, main


class Views(Case):
    def setUp(self):
        super().setUp()
        starguard.sample("gallery", vertices=800).write("m.off")
        self.model = starguard.Mesh.read("m.off")
        self.guards = starguard.guard(self.model)
        self.pieces = starguard.decompose(self.model, effort=20)
        self.skeleton = starguard.skeleton(self.model, nodes=40)

    def test_the_same_as_the_command(self):
        self.guards.write("g.json")
        self.pieces.write("p.vtk")
        self.pieces.write_report("p.json")
        self.skeleton.write("s.vtk")
        for extension in ("glb", "vtu", "ply", "obj"):
            self.cli("export", "g.json", "p.vtk", "p.json", "s.vtk", "-o", f"a.{extension}", "--quiet")
            starguard.write_scene(f"b.{extension}", self.model, guards=self.guards, pieces=self.pieces,
                                  skeleton=self.skeleton)
            self.assertEqual(self.read(f"a.{extension}"), self.read(f"b.{extension}"), extension)
            starguard.write_scene("c", self.model, guards=starguard.read_result("g.json"),
                                  pieces=starguard.read_result("p.vtk"),
                                  report=starguard.read_result("p.json"),
                                  skeleton=starguard.Skeleton.read("s.vtk"), format=extension)
            self.assertEqual(self.read("c"), self.read(f"b.{extension}"), extension)

    def test_scenes_with_obstacles(self):
        """The same as the command writes of two obstacles."""
        x, y, z = self.guards.positions[0]
        for name, shift in ("a.off", 0.02), ("b.off", -0.04):
            starguard.Mesh(np.array(VERTICES) * 0.01 + (x + shift, y + shift, z), FACES).write(name)
        obstacles = [starguard.Mesh.read(name) for name in ("a.off", "b.off")]
        scene = starguard.Scene(self.model, obstacles=obstacles)
        self.cli("guard", "m.off", "--obstacles", "a.off", "--obstacles", "b.off", "--count", "50",
                 "-o", "g.json", "--quiet")
        for extension in ("glb", "vtu"):
            self.cli("export", "g.json", "-o", f"a.{extension}", "--quiet")
            starguard.write_scene(f"b.{extension}", scene, guards=starguard.Guards.read("g.json"))
            self.assertEqual(self.read(f"a.{extension}"), self.read(f"b.{extension}"), extension)

    def test_pages(self):
        if not starguard.page_available():
            self.fails(starguard.WriteError, "viewer", starguard.write_page, "a.html", self.model)
            self.skipTest("this build has no viewer")
        starguard.write_page("a.html", self.model, guards=self.guards, pieces=self.pieces,
                             skeleton=self.skeleton, title="<script>alert(1)</script>",
                             frames=[self.model, self.model],
                             shapes={"a": b"", "b": starguard.picture(self.model, size=(64, 48))},
                             distances=[[0, 1], [1, 0]])
        page = self.read("a.html")
        self.assertIn(b"<!doctype html>", page[:100].lower())
        self.assertNotIn(b"<script>alert", page)
        self.fails(starguard.ArgumentError, "distances of 1 shapes", starguard.write_page, "b.html",
                   shapes={"a": b""})
        self.fails(starguard.ArgumentError, "no content", starguard.write_page, "b.html")
        self.assertFalse(os.path.exists("b.html"))

    def test_a_page_with_a_proof(self):
        if not starguard.page_available():
            self.skipTest("this build has no viewer")
        room = starguard.sample("gallery", vertices=500)
        guards = starguard.guard(room, prove=True, prove_work=20000, certificate="why")
        room.write("room.off")
        guards.write("g.json")
        certificate = starguard.read_result("why")
        starguard.write_page("a.html", room, guards=guards, certificate=certificate)
        self.cli("view", "g.json", "why", "--model", "room.off", "-o", "b.html", "--quiet")
        self.assertIn(b'id="proof-cells"', self.read("a.html"))
        self.assertIn(b'id="proof-cells"', self.read("b.html"))
        self.fails(starguard.ArgumentError, "needs its guards", starguard.write_page, "c.html", room,
                   certificate=certificate)

    def test_what_does_not_fit(self):
        self.fails(starguard.ArgumentError, "nothing", starguard.write_scene, "a.glb")
        self.fails(starguard.ArgumentError, "format",
                   starguard.write_scene, "a.xyz", self.model)
        self.fails(starguard.ArgumentError, "format", starguard.write_scene, "a", self.model,
                   format="stl")
        self.fails(starguard.ArgumentError, "needs its tetrahedra", starguard.write_scene, "a.glb",
                   self.model, report=self.report())
        self.fails(starguard.ArgumentError, "guards", starguard.write_scene, "a.glb",
                   (VERTICES, FACES), guards=self.guards)

    def report(self):
        self.pieces.write_report("p.json")
        return starguard.read_result("p.json")

    def test_skeletons(self):
        for extension in ("obj", "cg", "vtk"):
            self.skeleton.write(f"s.{extension}")
            again = starguard.Skeleton.read(f"s.{extension}")
            self.assertTrue((again.positions == self.skeleton.positions).all())
            self.assertTrue((again.edges == self.skeleton.edges).all())
            self.assertEqual(again.loops, self.skeleton.loops)
            self.assertEqual(again.vertex_nodes.shape, (0,))
            if extension == "vtk":
                self.assertTrue((again.radii == self.skeleton.radii).all())
            else:
                self.assertIsNone(again.radii)
            for other in ("obj", "cg", "vtk"):
                again.write(f"t.{other}")
                self.assertEqual(len(starguard.Skeleton.read(f"t.{other}").edges), len(again.edges))

    def test_animations(self):
        rows = np.array(VERTICES, float)
        starguard.write_animation("a.glb", (rows, FACES), [rows, 2 * rows, 3 * rows])
        frames = starguard.read_animation("a.glb")
        for i, frame in enumerate(frames):
            self.assertLess(abs(frame.vertices - (i + 1) * rows).max(), 1e-6)
            self.assertEqual(frame.faces.tolist(), FACES)
        with open("a.glb", "rb") as file:
            data = file.read()
        self.assertEqual(json.loads(data[20:20 + int.from_bytes(data[12:16], "little")])["asset"],
                         {"version": "2.0"})
        self.fails(starguard.FormatError, "", starguard.read_animation, "m.off")

    def test_pictures(self):
        starguard.write_picture("a.png", self.model, points=self.guards.positions, size=(160, 120))
        same = starguard.picture(self.model, points=self.guards.positions, size=(160, 120))
        self.assertEqual(self.read("a.png"), same)
        self.fails(starguard.ArgumentError, "", starguard.picture, self.model, size=(1, 1))


if __name__ == "__main__":
    main()
