# SPDX-License-Identifier: Apache-2.0
"""Output files appear whole or not at all, and only after success."""
import json
import os
import resource
import subprocess
import tempfile
import unittest

import support
from support import OPEN, TETRAHEDRON


def limit(what, size):
    def apply():
        resource.setrlimit(what, (size, size))
    return apply


def limit_file_size(size):
    return limit(resource.RLIMIT_FSIZE, size)


class Outputs(support.Case):
    def setUp(self):
        super().setUp()
        self.write("m.off", TETRAHEDRON)
        self.write("open.off", OPEN)

    def refuse(self, *words, status=3, says="", **options):
        """A run that fails: a message, and everything in the folder as it was."""
        before = {name: self.read(name) for name in self.names()
                  if os.path.isfile(self.path(name))}
        names = self.names()
        _, err = self.run_text(*words, status=status, **options)
        self.assertIn(says, err)
        self.assertNotIn(".starguard-", err)
        self.assertEqual(self.names(), names)
        for name, data in before.items():
            self.assertEqual(self.read(name), data)

    def test_replaces(self):
        self.write("g.json", "old")
        self.run_text("guard", "m.off", "-o", "g.json", "--count", "5")
        self.assertEqual(json.loads(self.read("g.json"))["format"], "starguard-guards")
        self.assertEqual(self.names(), ["g.json", "m.off", "open.off"])

    def test_keeps_the_old_file(self):
        self.write("g.json", "old")
        self.write("g.ply", "old")
        self.refuse("guard", "open.off", "-o", "g.json", status=2, says="open")
        self.refuse("guard", "none.off", "-o", "g.json", status=2, says="none.off")
        self.refuse("guard", "m.off", "-o", "g.json", "--clearance", "50", status=2)
        self.refuse("guard", "m.off", "-o", "g.json", "--marks", "no/folder.ply",
                    says="'no/folder.ply'")
        self.refuse("guard", "m.off", "-o", "no/folder.json", "--marks", "g.ply",
                    says="'no/folder.json'")

    def test_wrong_places(self):
        os.mkdir(self.path("folder"))
        self.refuse("guard", "m.off", "-o", "folder", says="directory")
        self.refuse("guard", "m.off", "-o", "folder/", says="directory")
        self.refuse("guard", "m.off", "-o", "new/", says="'new/'")
        self.refuse("guard", "m.off", "-o", "m.off/g.json", says="'m.off/g.json'")
        self.refuse("sample", "torus", "-o", "x" * 300 + ".off", says="too long")

    def test_longest_name(self):
        name = "x" * 251 + ".off"
        self.run_text("sample", "torus", "--vertices", "500", "-o", name)
        self.assertIn(name, self.names())

    def test_read_only(self):
        """As root only a file system can be read-only."""
        if os.geteuid() != 0:
            os.mkdir(self.path("locked"), 0o500)
            self.refuse("sample", "torus", "-o", "locked/t.off", says="locked")
        if os.path.isdir("/sys/kernel"):
            self.refuse("sample", "torus", "-o", "/sys/kernel/t.off", says="/sys/kernel/t.off")

    def test_devices(self):
        self.refuse("guard", "m.off", "-o", "/dev/full", says="No space left")
        self.run_text("guard", "m.off", "-o", "/dev/null")
        self.assertTrue(os.path.exists("/dev/null") and not os.path.isfile("/dev/null"))
        out = self.run_text("guard", "m.off", "-o", "/dev/stdout", "--quiet")[0]
        self.assertEqual(json.loads(out)["format"], "starguard-guards")

    def test_full_standard_output(self):
        with open("/dev/full", "wb") as full:
            self.refuse("guard", "m.off", "-o", "-", stdout=full, says="No space left")
            self.refuse("sample", "torus", "-o", "-", stdout=full, says="No space left")
            self.refuse("check", "m.off", stdout=full, says="standard output")
            self.refuse("check", "m.off", "--json", stdout=full, says="standard output")
            self.refuse("guard", "m.off", "-o", "g.json", stdout=full, says="standard output")
            self.refuse("guard", "m.off", "-o", "-", "--marks", "g.ply", stdout=full)

    def test_closed_pipe(self):
        """Nobody reads the text: no reason to fail. Nobody reads the result: one."""
        for words, status in [(["guard", "m.off", "-o", "g.json"], 0),
                              (["guard", "m.off", "-o", "-"], 3)]:
            ends = os.pipe()
            os.close(ends[0])
            with self.start(*words, stdout=ends[1]) as process:
                os.close(ends[1])
                process.communicate()
            self.assertEqual(process.returncode, status, words)
        self.assertIn("g.json", self.names())

    @unittest.skipIf(support.SANITIZE == "thread", "the sanitizer writes a file of its own")
    def test_file_size_limit(self):
        self.write("g.json", "old")
        self.write("t.off", "old")
        self.refuse("sample", "torus", "--vertices", "2000", "-o", "t.off",
                    preexec_fn=limit_file_size(10000), says="'t.off'")
        self.refuse("sample", "torus", "--vertices", "2000", "-o", "t.off",
                    preexec_fn=limit_file_size(0), says="'t.off'")
        self.refuse("guard", "m.off", "-o", "g.json", "--marks", "g.ply", "--picture", "g.png",
                    preexec_fn=limit_file_size(1500))
        self.refuse("check", "m.off", "--marks", "c.ply", preexec_fn=limit_file_size(100),
                    says="'c.ply'")

    @unittest.skipIf(support.SANITIZE, "sanitizers need all the addresses there are")
    def test_out_of_memory(self):
        self.write("t.ply", "old")
        self.refuse("sample", "knot", "--vertices", "1000000", "-o", "t.ply",
                    preexec_fn=limit(resource.RLIMIT_AS, 80 << 20), says="out of memory")

    def test_full_disk(self):
        """A file system of its own that is too small; needs the right to mount one."""
        disk = tempfile.mkdtemp()
        self.addCleanup(os.rmdir, disk)
        mounted = subprocess.run(["mount", "-t", "tmpfs", "-o", "size=64k", "none", disk],
                                 stderr=subprocess.DEVNULL, check=False)
        if mounted.returncode != 0:
            raise unittest.SkipTest("no right to mount a small file system")
        self.addCleanup(subprocess.run, ["umount", disk], check=True)
        file = os.path.join(disk, "t.off")
        with open(file, "w", encoding="ascii") as old:
            old.write("old")
        self.refuse("sample", "torus", "--vertices", "5000", "-o", file, says="No space left")
        self.assertEqual(os.listdir(disk), ["t.off"])
        with open(file, encoding="ascii") as old:
            self.assertEqual(old.read(), "old")

    def test_link_to_nothing(self):
        """Is written through, as a link to a file is."""
        os.mkdir(self.path("real"))
        os.symlink("real/second", self.path("first"))
        os.symlink("third.off", self.path("real/second"))
        self.run_text("repair", "m.off", "-o", "first", status=1)  # no extension
        os.symlink("first", self.path("link.off"))
        self.run_text("repair", "m.off", "-o", "link.off")
        self.assertTrue(os.path.islink(self.path("link.off")) and os.path.islink(self.path("real/second")))
        self.assertEqual(self.read("real/third.off"), self.read("link.off"))
        self.assertEqual(sorted(os.listdir(self.path("real"))), ["second", "third.off"])
        os.symlink("nowhere/x.off", self.path("lost.off"))
        self.refuse("repair", "m.off", "-o", "lost.off", says="No such file")
        os.symlink("round.off", self.path("round.off"))
        self.refuse("repair", "m.off", "-o", "round.off", says="symbolic links")

    def test_symbolic_link(self):
        os.mkdir(self.path("real"))
        self.write("real/g.json", "old")
        os.symlink("real/g.json", self.path("link.json"))
        self.run_text("guard", "m.off", "-o", "link.json", "--count", "5")
        self.assertTrue(os.path.islink(self.path("link.json")))
        self.assertEqual(json.loads(self.read("real/g.json"))["format"], "starguard-guards")
        self.assertEqual(os.listdir(self.path("real")), ["g.json"])

    def test_same_name_twice(self):
        os.symlink("target", self.path("a.ply"))
        self.write("target", "old")
        self.refuse("guard", "m.off", "-o", "target", "--marks", "a.ply", says="two outputs")
        self.refuse("guard", "m.off", "-o", "x.json", "--poses", "x.json", says="two outputs")

    def test_same_file_twice(self):
        """By a hard link, or in one folder by two names."""
        self.write("old", "old")
        os.link(self.path("old"), self.path("hard.ply"))
        os.mkdir(self.path("folder"))
        os.symlink("folder", self.path("link"))
        self.refuse("guard", "m.off", "-o", "old", "--marks", "hard.ply", says="two outputs")
        self.refuse("guard", "m.off", "-o", "folder/x.json", "--poses", "link/x.json", says="two outputs")

    def test_output_is_input(self):
        """Every command that reads and writes files, each output against each input."""
        self.write("p.txt", "0.2 0.2 0.2\n")
        self.run_text("guard", "m.off", "-o", "g.json", "--count", "5")
        self.run_text("sample", "sphere", "--vertices", "520", "-o", "s.ply")
        self.run_text("decompose", "m.off", "-o", "t.vtk", "--report", "t.json", "--effort", "1")
        self.run_text("db", "create", "shapes.db")
        self.run_text("db", "add", "shapes.db", "s.ply")
        self.run_text("morph", "m.off", "m.off", "--method", "linear", "--frames", "2", "-o", "frames")
        self.write("t.node", "4 3 0 0\n0 0 0 0\n1 1 0 0\n2 0 1 0\n3 0 0 1\n")
        self.write("t.ele", "1 4 0\n0 0 1 2 3\n")
        for words, input in [
                ("check s.ply --marks OUT.ply", "s.ply"),
                ("skeleton m.off -o OUT.obj", "m.off"),
                ("visible s.ply --from 0,0,0 -o OUT.ply", "s.ply"),
                ("guard m.off -o OUT", "m.off"),
                ("guard s.ply -o x.json --marks OUT.ply", "s.ply"),
                ("guard m.off -o x.json --candidates g.json --picture OUT.png", "g.json"),
                ("guard m.off --candidates p.txt -o OUT", "p.txt"),
                ("guard - -o OUT", "m.off"),
                ("decompose m.off -o OUT", "m.off"),
                ("decompose m.off -o x.vtk --report OUT", "m.off"),
                ("decompose m.off --guards g.json -o OUT", "g.json"),
                ("decompose --tets t.vtk -o OUT", "t.vtk"),
                ("decompose --tets t.node -o OUT", "t.ele"),
                ("describe m.off -o OUT", "m.off"),
                ("map m.off s.ply -o OUT", "s.ply"),
                ("map m.off m.off --landmarks p.txt -o OUT", "p.txt"),
                ("morph m.off s.ply -o x --map g.json --glb OUT.glb", "g.json"),
                ("morph m.off frames/frame_0001.off --frames 2 -o frames", "frames/frame_0001.off"),
                ("view g.json -o OUT", "g.json"),
                ("view t.vtk t.json -o OUT", "t.json"),
                ("view m.off g.json --model m.off -o OUT", "m.off"),
                ("view g.json -o OUT", "m.off"),
                ("view frames -o OUT", "frames/frame_0000.off"),
                ("view shapes.db -o OUT", "s.ply"),
                ("export s.ply -o OUT.ply", "s.ply"),
                ("export g.json -o OUT.ply", "m.off"),
                ("db matrix shapes.db -o OUT.csv", "shapes.db"),
                ("db evaluate shapes.db --classes p.txt -o OUT.csv", "p.txt")]:
            for link in [os.link, os.symlink, None]:
                output = next((word for word in words.split() if "OUT" in word), None)
                if link is not None and output is not None:
                    link(self.path(input), self.path(output))
                elif output is not None and "." not in output:
                    output = input
                elif output is not None:
                    continue
                # the extension is refused first where only another input names the file
                hidden = output == input and words.startswith("view") and input not in words.split()
                says = "such files are written by" if hidden else "it is also an input"
                with self.subTest(words=words, output=output), open(self.path("m.off"), "rb") as model:
                    self.refuse(*[output if "OUT" in word else word for word in words.split()],
                                status=1, says=says, stdin=model)
                if output != input and output is not None:
                    os.remove(self.path(output))

    def test_words_are_no_inputs(self):
        """A file that is called like a word of an option is not what the word means."""
        for _ in range(2):
            self.run_text("guard", "m.off", "-o", "skeleton", "--count", "5")
        for _ in range(2):
            self.run_text("sample", "sphere", "--vertices", "500", "-o", "sphere.off")
            os.replace(self.path("sphere.off"), self.path("sphere"))
            os.symlink("sphere", self.path("sphere.off"))
            self.run_text("sample", "sphere", "--vertices", "500", "-o", "sphere.off")
            os.remove(self.path("sphere.off"))

    def test_json_needs_standard_output(self):
        out, err = self.run_text("guard", "m.off", "-o", "-", "--json", status=1)
        self.assertEqual(json.loads(out)["error"]["status"], "argument")
        self.assertIn("--json", err)

    def test_odd_names(self):
        for name in ["with space.off", "ünïcode.off", "quote\"'.off", "-dash.off", "%s%n.off"]:
            self.run_text("sample", "torus", "--vertices", "500", f"--output={name}")
            report = self.run_json("check", "--", name)
            self.assertEqual(report["model"]["file"], name)
        raw = os.fsencode(self.path("")) + b"\xff\xfe.off"
        with open(raw, "wb") as file:
            file.write(TETRAHEDRON.encode())
        out, _ = self.run_bytes("check", b"\xff\xfe.off", "--json")
        self.assertEqual(json.loads(out)["model"]["file"], "\ufffd\ufffd.off")


if __name__ == "__main__":
    support.main()
