"""What holds when a run is killed, or disk, memory or time end (docs/robustness.md): outputs are there
whole or not at all, databases stay in order, the status and the message are those of the contract.

In `make check` a few cases of each; with STARGUARD_LONG=1 (check-long) 200 kills of each command and
many more limits on memory."""
import json
import os
import random
import resource
import shutil
import signal
import sqlite3
import subprocess
import tempfile
import time
import unittest

import support
from support import PROGRAM, SLOWNESS, TETRAHEDRON

LONG = os.environ.get("STARGUARD_LONG") == "1"
KILLS = 200 if LONG else 8
SANITIZED = SLOWNESS > 1


def limit(what, size):
    def apply():
        resource.setrlimit(what, (size, size))
    return apply


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
        self.sample("l-room", 500, "room.off")
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
            _, err = process.communicate(timeout=60 * SLOWNESS)
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


def is_leftover(name):
    """What a killed run may leave (docs/robustness.md)."""
    return name.startswith(".starguard-")


class Killed(Writing):
    """SIGKILL at random moments of each command that writes."""

    def kill_at(self, moment, *words):
        """True if it was still running."""
        with self.start(*words, "--threads", "1", "--quiet") as process:
            try:
                process.wait(timeout=moment)
            except subprocess.TimeoutExpired:
                pass
            process.kill()
            process.communicate()
        return process.returncode == -signal.SIGKILL

    def moments(self, name, took):
        """Half of them anywhere, half near the end, where files are written."""
        choice = random.Random(f"kills of {name}")
        for i in range(KILLS):
            yield choice.uniform(0, took) if i % 2 else choice.uniform(0.8 * took, 1.1 * took)

    def check_whole(self, outputs, old, wanted):
        """How many of the outputs are there; each is as it was or as it shall be."""
        there = 0
        for output in outputs:
            found = self.content(output)
            self.assertIn(found, (old, wanted[output]), f"a part of {output}")
            there += found == wanted[output]
        return there

    def leftovers(self):
        return [name for name in self.names() if is_leftover(name)]

    def test_outputs(self):
        print(f"{'command':12} {'seconds':>8} {'kills':>6} {'nothing':>8} {'all':>6} {'some':>6} "
              f"{'leftovers':>10}")
        for name, words, outputs in self.commands():
            with self.subTest(command=name):
                wanted, took = self.reference(name, words, outputs)
                kills, counts = 0, {}
                for i, moment in enumerate(self.moments(name, took)):
                    self.clear(outputs)
                    old = None
                    if i % 3 == 0 and "/" not in outputs[0]:
                        old = b"old"
                        for output in outputs:
                            self.write(output, old)
                    kills += self.kill_at(moment, *words)
                    there = self.check_whole(outputs, old, wanted)
                    state = {0: "nothing", len(outputs): "all"}.get(there, "some")
                    counts[state] = counts.get(state, 0) + 1
                    strange = [n for n in self.names() if n not in self.made and n not in outputs
                               and n != "frames" and not is_leftover(n)]
                    self.assertEqual(strange, [])
                left = len(self.leftovers())
                self.run_bytes(*words, "--quiet")  # what was left does not matter
                self.assertEqual(self.check_whole(outputs, None, wanted), len(outputs))
                self.clear(outputs)
                for leftover in self.leftovers():
                    os.remove(self.path(leftover))
                print(f"{name:12} {took:8.2f} {kills:6} {counts.get('nothing', 0):8} "
                      f"{counts.get('all', 0):6} {counts.get('some', 0):6} {left:10}")
                self.assertGreater(kills, 0)

    def whole(self, name):
        """Is every stored model stored whole? Their file names in the order of storing."""
        connection = sqlite3.connect(self.path(name))
        self.assertEqual(connection.execute("PRAGMA integrity_check").fetchone(), ("ok",))
        self.assertEqual(connection.execute("PRAGMA foreign_key_check").fetchall(), [])
        rows = connection.execute("SELECT path, (SELECT count(*) FROM signature WHERE model = id) "
                                  "FROM model ORDER BY id").fetchall()
        connection.close()
        self.assertTrue(all(count == 4 for _, count in rows), rows)
        return [path for path, _ in rows]

    def test_database_add(self):
        files = [f"m_{i}.off" for i in range(12)]
        for i, file in enumerate(files):
            self.write(file, TETRAHEDRON.replace("0 0 1\n", f"0 {0.01 * i} 1\n"))
        self.run_text("db", "create", "empty.db")
        empty = self.read("empty.db")
        words = ["db", "add", "a.db", *files]
        self.write("a.db", empty)
        began = time.monotonic()
        self.run_text(*words, "--threads", "1")
        took, stored = time.monotonic() - began, []
        for moment in self.moments("db add", took):
            self.write("a.db", empty)
            if os.path.exists(self.path("a.db-journal")):
                os.remove(self.path("a.db-journal"))
            self.kill_at(moment, *words)
            listed = json.loads(self.run_text("db", "list", "a.db", "--json")[0])["models"]
            found = self.whole("a.db")
            self.assertEqual(found, files[:len(found)])
            self.assertEqual(sorted(model["path"] for model in listed), sorted(found))
            stored.append(len(found))
        self.run_text(*words)
        self.assertEqual(self.whole("a.db"), files)
        print(f"db add: {took:.2f} s, models stored when killed: {sorted(stored)}")

    def test_database_remove(self):
        before = self.read("shapes.db")
        for moment in self.moments("db remove", 0.03):
            self.write("shapes.db", before)
            self.kill_at(moment, "db", "remove", "shapes.db", "ball.off")
            self.run_text("db", "list", "shapes.db")
            self.assertIn(self.whole("shapes.db"), ([], ["ball.off"]))

    def test_database_create(self):
        made = 0
        for moment in self.moments("db create", 0.04):
            self.kill_at(moment, "db", "create", "new.db")
            if os.path.exists(self.path("new.db")):
                made += 1
                self.assertEqual(self.whole("new.db"), [])
                os.remove(self.path("new.db"))
        print(f"db create: made {made} of {KILLS} times")
        self.run_text("db", "create", "new.db")
        self.assertEqual(self.whole("new.db"), [])


class LeftOver(support.Case):
    def test_a_name_that_is_taken(self):
        """A process of the same number may have been killed before: its files are in no one's way."""
        for name in "a.db.{}.0.tmp", "a.db.{}.1.tmp", ".starguard-{}-0", ".starguard-{}-0.{}.0.tmp":
            script = (f"import os, sys; open({name!r}.replace('{{}}', str(os.getpid())), 'w').write('x');"
                      "os.execv(sys.argv[1], sys.argv[1:])")
            for words in (["db", "create", "a.db"],
                          ["sample", "torus", "--vertices", "500", "-o", "t.off"]):
                done = subprocess.run(["/usr/bin/python3", "-c", script, os.path.abspath(PROGRAM), *words],
                                      cwd=self.folder, capture_output=True, text=True, check=False)
                self.assertEqual(done.returncode, 0, done.stderr)
            self.run_text("db", "list", "a.db")
            self.run_text("check", "t.off")
            os.remove(self.path("a.db"))


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
        """A device that is full, under a name with the right ending; other outputs do not change."""
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

    def test_no_room_for_temporary_files(self):
        """TetGen's files cannot be written: stuffing takes over."""
        self.run_text("decompose", "room.off", "-o", "p.vtk", "--report", "p.json", "--effort", "10",
                      environment={"TMPDIR": "/nowhere"})
        self.run_text("verify", "room.off", "p.vtk", "p.json")


@unittest.skipIf(SANITIZED, "sanitizers need all the addresses there are")
class Memory(Writing):
    """RLIMIT_AS: done, or status 3 with a message about memory; never a signal, never half a file.
    What CBC, SQLite, ARPACK, jansson and the C library allocate on their own counts here."""

    def least(self):
        """Addresses that are needed to start at all."""
        size = 16 << 20
        while subprocess.run([PROGRAM, "--version"], capture_output=True, check=False,
                             preexec_fn=limit(resource.RLIMIT_AS, size)).returncode != 0:
            size += 1 << 20
        return size

    def attempt(self, size, words, outputs):
        """The status, with all that it promises."""
        with self.start(*words, "--quiet", preexec_fn=limit(resource.RLIMIT_AS, size)) as process:
            try:
                _, err = process.communicate(timeout=120)
            except subprocess.TimeoutExpired:
                process.kill()
                self.fail(f"{words} hangs with {size} bytes")
        told = f"{words} with {size} bytes: {process.returncode} {err!r}"
        self.assertIn(process.returncode, (0, 3), told)
        if process.returncode == 3:
            self.assertIn(b"out of memory", err, told)
            self.assertEqual(self.names(), self.made, told)
        self.clear(outputs)
        return process.returncode

    def sweep(self, words, outputs, step):
        """From next to nothing until it is enough."""
        size, failures = self.least(), 0
        while self.attempt(size, words, outputs) != 0:
            failures += 1
            size += step
            self.assertLess(size, 4 << 30)
        return failures, size

    def test_commands(self):
        step = 1 << (18 if LONG else 22)
        for name, words, outputs in self.commands():
            with self.subTest(command=name):
                for threads in "1", "3":
                    failures, size = self.sweep([*words, "--threads", threads], outputs, step)
                    print(f"{name} on {threads} threads: {failures} failures, "
                          f"enough with {size >> 20} MiB")

    def test_solver(self):
        """An instance that reaches CBC, whose memory fails by a C++ exception."""
        words = ["guard", "cat.off", "-o", "g.json", "--method", "ilp", "--candidates", "interior",
                 "--count", "300", "--redundancy", "2", "--max-nodes", "200", "--threads", "1"]
        failures, size = self.sweep(words, ["g.json"], 1 << (16 if LONG else 20))
        print(f"solver: {failures} failures, enough with {size >> 20} MiB")

    def test_database(self):
        before = self.read("shapes.db")
        size, step = self.least(), 1 << (18 if LONG else 22)
        for _ in range(400):
            self.write("shapes.db", before)
            done = self.attempt_add(size)
            if done == 0:
                return
            size += step
        self.fail("never enough")

    def attempt_add(self, size):
        with self.start("db", "add", "shapes.db", "room.off", "--quiet",
                        preexec_fn=limit(resource.RLIMIT_AS, size)) as process:
            _, err = process.communicate(timeout=120)
        self.assertIn(process.returncode, (0, 3), err)
        if process.returncode == 3:
            self.assertIn(b"memory", err)
        connection = sqlite3.connect(self.path("shapes.db"))
        self.assertEqual(connection.execute("PRAGMA integrity_check").fetchone(), ("ok",))
        connection.close()
        return process.returncode

    def test_endless_input(self):
        """Standard input is not read for ever, and not cut off where memory ends."""
        for command in (["decompose", "-", "-o", "p.vtk"], ["describe", "-", "-o", "d.json"],
                        ["guard", "-", "-o", "g.json"]):
            with open("/dev/zero", "rb") as zero:
                _, err = self.run_text(*command, stdin=zero, status=3,
                                       preexec_fn=limit(resource.RLIMIT_AS, 300 << 20))
            self.assertIn("out of memory", err)
            self.assertEqual(self.names(), self.made)


class TimeLimits(support.Case):
    """A limit of S seconds ends a run within 1.05 S + 2. Processor time on one thread is measured, so
    that a busy machine does not matter."""

    def spend(self, seconds, *words, statuses=(0, 3)):
        with self.start(*words, "--threads", "1", "--quiet", "--time-limit", str(seconds)) as process:
            out, err = process.stdout.read(), process.stderr.read()
            _, status, usage = os.wait4(process.pid, 0)
            process.returncode = os.waitstatus_to_exitcode(status)
        spent = usage.ru_utime + usage.ru_stime
        self.assertIn(process.returncode, statuses, err)
        print(f"{words[0]:10} {words[1]:12} limit {seconds} s: {spent:.2f} s, "
              f"status {process.returncode}")
        self.assertLess(spent, (1.05 * seconds + 2) * SLOWNESS, (words, out, err))
        if process.returncode == 3:
            self.assertIn(b"time limit", err)
        return process.returncode

    def setUp(self):
        super().setUp()
        self.sample("horse", 40000, "horse.off")
        self.sample("cat", 40000, "cat.off")
        self.sample("labyrinth", 30000, "maze.off")

    def test_commands(self):
        cases = [["guard", "horse.off", "-o", "g.json", "--visibility", "sweep"],
                 ["guard", "maze.off", "-o", "g.json", "--method", "ilp", "--faces", "whole"],
                 ["decompose", "maze.off", "-o", "p.vtk"],
                 ["decompose", "horse.off", "-o", "p.vtk", "--mode", "paper"],
                 ["skeleton", "horse.off", "-o", "s.obj"],
                 ["describe", "horse.off", "-o", "d.json"],
                 ["match", "horse.off", "cat.off"],
                 ["map", "horse.off", "cat.off", "-o", "m.json"],
                 ["db", "add", "shapes.db", "horse.off", "cat.off", "maze.off"]]
        self.run_text("db", "create", "shapes.db")
        for words in cases:
            for seconds in (1, 3) if LONG else (1,):
                with self.subTest(words=words, seconds=seconds):
                    self.spend(seconds, *words)


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
        """The input is read before the output takes its place."""
        self.run_text("repair", "m.off", "-o", "m.off")
        self.run_text("check", "m.off")
        os.symlink("m.off", self.path("l.off"))
        self.run_text("repair", "l.off", "-o", "l.off")
        self.assertTrue(os.path.islink(self.path("l.off")))
        self.run_text("check", "m.off")
        self.write("m.off", support.OPEN)
        self.run_text("guard", "m.off", "-o", "m.off", status=2)
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
        try:
            process.communicate(timeout=30 * SLOWNESS)
        except subprocess.TimeoutExpired:
            process.kill()
            self.fail(f"{words} opened what the file names")
        self.assertIn(process.returncode, (0, 2))
        if SANITIZED or shutil.which("strace") is None:
            return ""
        trace = subprocess.run(["strace", "-f", "-e", "trace=%file", os.path.abspath(PROGRAM), *words],
                               cwd=self.folder, stdin=subprocess.DEVNULL, capture_output=True,
                               check=False, timeout=60)
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
