# SPDX-License-Identifier: Apache-2.0
"""One command of each kind that writes, for the tests of what happens when it cannot, or is killed."""
import os
import resource
import shutil
import tempfile
import time

import support

LONG = support.LONG


def limit(what, size):
    """For the child of a run: a limit on a resource."""
    def apply():
        resource.setrlimit(what, (size, size))
    return apply


def is_leftover(name):
    """What a killed run may leave (docs/robustness.md)."""
    return name.startswith(".starguard-")


class Writing(support.Case):
    """One command of each kind that writes, on inputs as small as they come."""

    # name: words, outputs. Every output is the same whenever the command is run.
    COMMANDS = {
        "sample": (["sample", "torus", "--vertices", "5000", "-o", "t.off"], ["t.off"]),
        "check": (["check", "room.off", "--marks", "marks.ply"], ["marks.ply"]),
        "repair": (["repair", "open.off", "-o", "mended.off"], ["mended.off"]),
        "skeleton": (["skeleton", "cat.off", "-o", "curve.vtk"], ["curve.vtk"]),
        "visible": (["visible", "room.off", "--from", "0.5,0.5,0.5", "-o", "seen.ply"],
                    ["seen.ply"]),
        "guard": (["guard", "room.off", "-o", "g.json", "--marks", "g.ply", "--picture", "g.png",
                   "--count", "50"], ["g.json", "g.ply", "g.png"]),
        "decompose": (["decompose", "room.off", "-o", "p.vtk", "--report", "p.json",
                       "--effort", "30"], ["p.vtk", "p.json"]),
        "describe": (["describe", "room.off", "-o", "d.json"], ["d.json"]),
        "map": (["map", "cat.off", "ball.off", "-o", "map.json"], ["map.json"]),
        "morph": (["morph", "cat.off", "cat_1.off", "--frames", "4", "-o", "frames", "--method",
                   "arap", "--glb", "m.glb"], [f"frames/frame_000{i}.off" for i in range(4)] + ["m.glb"]),
        "view": (["view", "guards.json", "--model", "room.off", "-o", "page.html"], ["page.html"]),
        "export": (["export", "guards.json", "--model", "room.off", "-o", "scene.glb"],
                   ["scene.glb"]),
        "db matrix": (["db", "matrix", "shapes.db", "-o", "m.csv", "--picture", "m.png"],
                      ["m.csv", "m.png"]),
    }
    made, viewer = None, True

    @classmethod
    def setUpClass(cls):
        cls.store = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.store.cleanup)

    def setUp(self):
        super().setUp()
        if self.made is None:
            self.make_inputs()
            type(self).viewer = self.has_viewer()
            type(self).made = self.names()
            shutil.copytree(self.folder, os.path.join(self.store.name, "inputs"))
        else:
            shutil.copytree(os.path.join(self.store.name, "inputs"), self.folder, dirs_exist_ok=True)
        self.results = os.path.join(self.store.name, "results")

    def make_inputs(self):
        self.sample("l-room", 520, "room.off")
        self.sample("cat", 600, "cat.off")
        self.sample("cat", 600, "cat_1.off", "--pose", "1")
        self.sample("sphere", 600, "ball.off")
        head, counts, *lines = self.read("room.off").decode().split("\n")
        vertices, faces, _ = map(int, counts.split())
        self.write("open.off", "\n".join([head, f"{vertices} {faces - 1} 0",
                                          *lines[:vertices + faces - 1], ""]))
        self.run_text("guard", "room.off", "-o", "guards.json", "--count", "50")
        self.run_text("db", "create", "shapes.db")
        self.run_text("db", "add", "shapes.db", "ball.off")

    def has_viewer(self):
        with self.start("view", "room.off", "-o", "probe.html") as process:
            _, err = process.communicate()
        if process.returncode == 0:
            os.remove(self.path("probe.html"))
            return True
        self.assertIn(b"has no viewer", err)
        print("skipped: view, this build has no viewer")
        return False

    def commands(self):
        for name, (words, outputs) in self.COMMANDS.items():
            if name != "view" or self.viewer:
                yield name, words, outputs

    def content(self, name):
        """What stands there; None if nothing does."""
        return self.read(name) if os.path.isfile(self.path(name)) else None

    def reference(self, name, words, outputs, **options):
        """What the command writes if nothing happens, and how long it takes."""
        began = time.monotonic()
        self.run_bytes(*words, "--threads", "1", "--quiet", **options)
        took = time.monotonic() - began
        wanted = {output: self.read(output) for output in outputs}
        self.clear(outputs)
        self.assertEqual(self.names(), self.made, name)
        return wanted, took

    def clear(self, outputs):
        for output in outputs:
            if os.path.exists(self.path(output)):
                os.remove(self.path(output))
        if os.path.isdir(self.path("frames")):
            shutil.rmtree(self.path("frames"))
