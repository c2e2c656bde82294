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

    def test_symbolic_link(self):
        os.mkdir(self.path("real"))
        self.write("real/g.json", "old")
        os.symlink("real/g.json", self.path("link.json"))
        self.run_text("guard", "m.off", "-o", "link.json", "--count", "5")
        self.assertTrue(os.path.islink(self.path("link.json")))
        self.assertEqual(json.loads(self.read("real/g.json"))["format"], "starguard-guards")
        self.assertEqual(os.listdir(self.path("real")), ["g.json"])

    def test_same_name_twice(self):
        os.symlink("target.ply", self.path("a.ply"))
        self.write("target.ply", "old")
        self.refuse("guard", "m.off", "-o", "target.ply", "--marks", "a.ply", says="two outputs")
        self.refuse("guard", "m.off", "-o", "x.ply", "--marks", "x.ply", says="two outputs")

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
