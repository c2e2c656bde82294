# SPDX-License-Identifier: Apache-2.0
"""Disks that are full, places where outputs stand, and paths inside of mesh files
(docs/robustness.md)."""
import json
import os
import resource
import shutil
import subprocess
import tempfile
import unittest

import support
from support import PROGRAM, TETRAHEDRON
from writing import Writing, limit


class Full(Writing):
    """The disk is full: status 3, a message that names the file, and everything as it was."""

    def refuse(self, *words, says=(), **options):
        before = {name: self.content(name) for name in self.names()}
        _, err = self.run_text(*words, status=3, **options)
        self.assertTrue(any(word in err for word in says), err)
        self.assertNotIn(".starguard-", err)
        self.assertEqual({name: self.content(name) for name in self.names()}, before)

    def test_file_size(self):
        """RLIMIT_FSIZE: nothing, half and nearly all of each file can be written."""
        for name, words, outputs in self.commands():
            with self.subTest(command=name):
                # TetGen, which would meet the limit as well, is kept out of it.
                apart = {"environment": {"PATH": "/nowhere"}}
                wanted, _ = self.reference(name, words, outputs, **apart)
                largest = max(len(data) for data in wanted.values())
                for size in 0, largest // 2, largest - 1:
                    self.write(outputs[-1], "old")
                    self.refuse(*words, "--quiet", says=[f"'{output}'" for output in outputs],
                                preexec_fn=limit(resource.RLIMIT_FSIZE, size), **apart)
                    os.remove(self.path(outputs[-1]))

    def test_device(self):
        """A device that is full, under a name with the right extension; other outputs do not change."""
        for name, words, outputs in self.commands():
            with self.subTest(command=name):
                if name == "morph":
                    continue  # its frames are files of a folder
                for full in outputs:
                    for output in outputs:
                        if output != full:
                            self.write(output, "old")
                    os.symlink("/dev/full", self.path(full))
                    self.refuse(*words, "--quiet", says=["No space left"])
                    self.clear(outputs)

    def test_small_disk(self):
        """A file system of its own; needs the right to mount one."""
        disk = tempfile.mkdtemp()
        self.addCleanup(os.rmdir, disk)
        mounted = subprocess.run(["mount", "-t", "tmpfs", "-o", "size=16k", "none", disk],
                                 stderr=subprocess.DEVNULL, check=False)
        if mounted.returncode != 0:
            raise unittest.SkipTest("no right to mount a small file system")
        self.addCleanup(subprocess.run, ["umount", disk], check=True)
        os.symlink(disk, self.path("disk"))
        with open(os.path.join(disk, "filler"), "wb", buffering=0) as filler:
            while True:
                try:
                    filler.write(bytes(4096))
                except OSError:
                    break
        for name, words, outputs in self.commands():
            with self.subTest(command=name):
                moved = [f"disk/{word}" if word in outputs or word == "frames" else word
                         for word in words]
                self.refuse(*moved, "--quiet", says=["No space left"])
                self.assertEqual(os.listdir(disk), ["filler"])
        with self.subTest(command="db create"):
            self.refuse("db", "create", "disk/new.db", says=["full", "No space left"])
            self.assertEqual(os.listdir(disk), ["filler"])

    def test_no_temporary_files(self):
        """Nothing is written anywhere but where the options say."""
        self.run_text("decompose", "room.off", "-o", "p.vtk", "--report", "p.json", "--mode", "paper",
                      environment={"TMPDIR": "/nowhere"})
        self.run_text("verify", "room.off", "p.vtk", "p.json")


class Places(support.Case):
    """Where outputs stand: links, folders, inputs."""

    def setUp(self):
        super().setUp()
        self.write("m.off", TETRAHEDRON)
        self.words = ["guard", "m.off", "--count", "5", "-o"]

    def refuse(self, *words, says, status=3):
        names = self.names()
        _, err = self.run_text(*words, status=status)
        self.assertIn(says, err)
        self.assertEqual(self.names(), names)

    def test_links(self):
        os.mkdir(self.path("real"))
        os.symlink("real/new.json", self.path("dangling.json"))
        os.symlink("loop.json", self.path("loop.json"))
        os.symlink("real", self.path("folder.json"))
        self.write("first.json", "old")
        os.link(self.path("first.json"), self.path("second.json"))
        self.run_text(*self.words, "dangling.json")
        self.assertEqual(json.loads(self.read("dangling.json"))["format"], "starguard-guards")
        self.refuse(*self.words, "loop.json", says="loop.json")
        self.refuse(*self.words, "folder.json", says="directory")
        self.run_text(*self.words, "folder.json/g.json")
        self.run_text(*self.words, "first.json")
        self.assertEqual(self.read("second.json"), b"old")  # a new file, not the old one overwritten

    def test_input_is_output(self):
        """repair reads its input before the output takes its place; other commands refuse it."""
        self.run_text("repair", "m.off", "-o", "m.off")
        self.run_text("check", "m.off")
        os.symlink("m.off", self.path("l.off"))
        self.run_text("repair", "l.off", "-o", "l.off")
        self.assertTrue(os.path.islink(self.path("l.off")))
        self.run_text("check", "m.off")
        self.write("m.off", support.OPEN)
        self.run_text("guard", "m.off", "-o", "m.off", status=1)
        self.assertEqual(self.read("m.off").decode(), support.OPEN)

    def test_a_folder_that_may_not_change(self):
        """Immutable for root (chattr), else by its permission bits."""
        os.mkdir(self.path("locked"))
        folder = self.path("locked")
        self.write("locked/g.json", "old")
        if os.geteuid() == 0:
            if shutil.which("chattr") is None or subprocess.run(
                    ["chattr", "+i", folder], stderr=subprocess.DEVNULL, check=False).returncode != 0:
                raise unittest.SkipTest("root may write everything, and chattr does not work here")
            self.addCleanup(subprocess.run, ["chattr", "-i", folder], check=True)
        else:
            os.chmod(folder, 0o500)
            self.addCleanup(os.chmod, folder, 0o700)
        for name in "locked/new.json", "locked/g.json":
            self.refuse(*self.words, name, says=f"'{name}'")
        self.refuse("db", "create", "locked/new.db", says="'locked/new.db'")
        self.assertEqual(self.read("locked/g.json"), b"old")

    def test_missing_folder(self):
        self.refuse(*self.words, "no/where/g.json", says="'no/where/g.json'")
        self.refuse("db", "create", "no/new.db", says="'no/new.db'")


class NamedFiles(support.Case):
    """Paths that stand in a mesh file are never opened: each is a pipe that nobody writes into, so that
    opening it would hang, and what is opened is traced where that is possible."""

    FILES = {
        "m.obj": "mtllib honey\nusemtl honey\nmap_Kd honey\ncall honey\nv 0 0 0\nv 1 0 0\nv 0 1 0\n"
                 "v 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n",
        "m.ply": "ply\nformat ascii 1.0\ncomment TextureFile honey\nobj_info honey\n"
                 "element vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
                 "element face 4\nproperty list uchar int vertex_indices\nend_header\n"
                 "0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n",
        "m.stl": "solid honey\n" + "".join(
            "facet normal 0 0 0\nouter loop\n" + "".join(f"vertex {p}\n" for p in face) +
            "endloop\nendfacet\n" for face in (("0 0 0", "0 1 0", "1 0 0"), ("0 0 0", "1 0 0", "0 0 1"),
                                               ("0 0 0", "0 0 1", "0 1 0"),
                                               ("1 0 0", "0 1 0", "0 0 1"))) + "endsolid honey\n",
        "m.off": TETRAHEDRON.replace("OFF\n", "OFF # honey\n"),
        "m.vtk": "# vtk DataFile Version 3.0\nhoney\nASCII\nDATASET UNSTRUCTURED_GRID\n"
                 "POINTS 4 float\n0 0 0 1 0 0 0 1 0 0 0 1\nCELLS 1 5\n4 0 1 2 3\nCELL_TYPES 1\n10\n"
                 "METADATA\nINFORMATION 1\nNAME honey LOCATION honey\n\n",
        "m.mesh": "MeshVersionFormatted 1\n# honey\nDimension 3\nVertices\n4\n0 0 0 0\n1 0 0 0\n"
                  "0 1 0 0\n0 0 1 0\nTetrahedra\n1\n1 2 3 4 0\nEnd\n",
    }

    def setUp(self):
        super().setUp()
        for name, text in self.FILES.items():
            self.write(name, text)
        os.mkfifo(self.path("honey"))

    def opened(self, *words):
        """The names that a run opens, if that can be traced; it must not hang in any case."""
        process = self.start(*words)
        process.communicate()
        self.assertIn(process.returncode, (0, 2))
        if support.SANITIZE or shutil.which("strace") is None:
            return ""
        trace = subprocess.run(["strace", "-f", "-e", "trace=%file", os.path.abspath(PROGRAM), *words],
                               cwd=self.folder, stdin=subprocess.DEVNULL, capture_output=True,
                               check=False)
        return trace.stderr.decode(errors="replace")

    def test_models(self):
        for name in self.FILES:
            for command in ("check", name), ("decompose", name, "-o", "p.vtk", "--effort", "5"):
                trace = self.opened(*command)
                self.assertNotIn("honey", trace, command)
                if trace and "attach" not in trace:
                    self.assertIn(f'"{name}"', trace)  # the trace does tell of files

    def test_animation(self):
        """A binary glTF whose buffer is said to be another file."""
        text = json.dumps({"asset": {"version": "2.0"},
                           "buffers": [{"uri": "honey", "byteLength": 36}],
                           "images": [{"uri": "honey"}],
                           "bufferViews": [{"buffer": 0, "byteLength": 36}],
                           "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3,
                                          "type": "VEC3"}],
                           "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "targets":
                                                       [{"POSITION": 0}]}]}]}).encode()
        text += b" " * (-len(text) % 4)
        size = (20 + len(text)).to_bytes(4, "little")
        self.write("m.glb", b"glTF" + (2).to_bytes(4, "little") + size +
                   len(text).to_bytes(4, "little") + b"JSON" + text)
        self.assertNotIn("honey", self.opened("view", "m.glb", "-o", "page.html"))


if __name__ == "__main__":
    support.main()
