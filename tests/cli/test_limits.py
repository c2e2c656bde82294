# SPDX-License-Identifier: Apache-2.0
"""Memory and time end (docs/robustness.md): the status and the message are those of the contract, and
no output is left or changed. With STARGUARD_LONG=1 in many more steps."""
import functools
import json
import os
import resource
import shutil
import sqlite3
import stat
import subprocess
import unittest

import support
from support import PROGRAM, SLOWNESS, processor_time_of_ended
from writing import LONG, Writing, limit


@functools.cache
def least():
    """Addresses that are needed to start at all."""
    size = 16 << 20
    while subprocess.run([PROGRAM, "--version"], capture_output=True, check=False,
                         preexec_fn=limit(resource.RLIMIT_AS, size)).returncode != 0:
        size += 1 << 20
    return size


@unittest.skipIf(support.SANITIZE, "sanitizers need all the addresses there are")
class Memory(Writing):
    """RLIMIT_AS: done, or status 3 with a message about memory; never a signal, never half a file.
    What CBC, SQLite, Eigen, jansson and the C library allocate on their own counts here."""

    def attempt(self, size, words, outputs):
        """The status, with all that it promises."""
        with self.start(*words, "--quiet", preexec_fn=limit(resource.RLIMIT_AS, size)) as process:
            _, err = process.communicate()
        told = f"{words} with {size} bytes: {process.returncode} {err!r}"
        self.assertIn(process.returncode, (0, 3), told)
        if process.returncode == 3:
            self.assertIn(b"out of memory", err, told)
            self.assertEqual(self.names(), self.made, told)
        self.clear(outputs)
        return process.returncode

    def sweep(self, words, outputs, step):
        """From next to nothing until it is enough."""
        size, failures = least(), 0
        while self.attempt(size, words, outputs) != 0:
            failures += 1
            size += step
            self.assertLess(size, 4 << 30)
        return failures, size

    def test_commands(self):
        step = 1 << (18 if LONG else 24)
        for name, words, outputs in self.commands():
            with self.subTest(command=name):
                for threads in ("1", "3") if LONG else ("3",):
                    failures, size = self.sweep([*words, "--threads", threads], outputs, step)
                    print(f"{name} on {threads} threads: {failures} failures, "
                          f"enough with {size >> 20} MiB")

    def test_solver(self):
        """An instance that reaches CBC, whose memory fails by a C++ exception."""
        words = ["guard", "cat.off", "-o", "g.json", "--method", "ilp", "--candidates", "interior",
                 "--count", "300", "--redundancy", "2", "--max-nodes", "200", "--threads", "1"]
        failures, size = self.sweep(words, ["g.json"], 1 << (16 if LONG else 23))
        print(f"solver: {failures} failures, enough with {size >> 20} MiB")

    def test_database(self):
        before = self.read("shapes.db")
        size, step = least(), 1 << (18 if LONG else 23)
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
            _, err = process.communicate()
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
                                       preexec_fn=limit(resource.RLIMIT_AS, 120 << 20))
            self.assertIn("out of memory", err)
            self.assertEqual(self.names(), self.made)


@unittest.skipIf(support.SANITIZE, "sanitizers need larger stacks")
class Stack(Writing):
    def test_commands(self):
        """A stack of 64 KiB is enough, for the threads that are started as well, whose stacks are as large."""
        for name, words, outputs in self.commands():
            with self.subTest(command=name):
                self.run_text(*words, "--threads", "2", "--quiet",
                              launcher=["env", "-i", f"PATH={os.environ['PATH']}"],
                              preexec_fn=limit(resource.RLIMIT_STACK, 64 << 10))
                self.clear(outputs)


class TimeLimits(support.Case):
    """A limit of S seconds ends a run within 1.05 S + 2. Processor time on one thread is measured, so
    that a busy machine does not matter."""

    def spend(self, seconds, *words, statuses=(0, 3)):
        before = processor_time_of_ended()
        with self.start(*words, "--threads", "1", "--quiet", "--time-limit", str(seconds)) as process:
            out, err = process.communicate()
        spent = processor_time_of_ended() - before
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
        self.sample("cat", 40000, "pose.off", "--pose", "1")
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
                 ["morph", "cat.off", "pose.off", "--frames", "500", "-o", "frames"],
                 ["db", "add", "shapes.db", "horse.off", "cat.off", "maze.off"]]
        self.run_text("db", "create", "shapes.db")
        for words in cases:
            for seconds in (1, 3) if LONG else (0.5,):
                with self.subTest(words=words, seconds=seconds):
                    self.spend(seconds, *words)

    def test_something_to_show(self):
        """Struck at several moments; what was found is shown soon after. The slowest engine makes the
        candidates' rows last."""
        for seconds in (2, 3, 4, 5, 6, 8, 10) if LONG else (5,):
            with self.subTest(seconds=seconds):
                self.spend(seconds, "guard", "horse.off", "-o", "g.json", "--visibility", "sweep")
                if "g.json" in self.names():
                    self.assertTrue(json.loads(self.read("g.json"))["time_limited"])
                    os.remove(self.path("g.json"))

    def test_nothing_to_show(self):
        """What is whole or nothing ends with a message, and leaves no file."""
        self.run_text("guard", "maze.off", "-o", "g.json", "--method", "greedy", "--candidates", "interior",
                      "--count", "50", "--coverage", "0.5", "--quiet")
        before = self.names()
        for words in (["check", "horse.off", "--marks", "m.ply"], ["repair", "horse.off", "-o", "r.off"],
                      ["kernel", "horse.off"], ["skeleton", "horse.off", "-o", "s.obj"],
                      ["verify", "maze.off", "g.json"]):
            with self.subTest(words=words):
                _, err = self.run_text(*words, "--time-limit", "0.001", status=3)
                self.assertIn("time limit", err)
                self.assertEqual(self.names(), before)

    @unittest.skipUnless(LONG, "this takes more than half a minute")
    @unittest.skipUnless(shutil.which("tetgen"), "the program tetgen is not installed")
    def test_slow_tetgen(self):
        """TetGen may take longer than its usual 30 s where the run may, and no longer than half of that."""
        tool = self.write("tetgen", f"#!/bin/sh\nsleep 33\nexec {shutil.which('tetgen')} \"$@\"\n")
        os.chmod(self.path(tool), stat.S_IRWXU)
        words = ["decompose", self.sample(), "-o", "p.vtk", "--mode", "paper", "--generator", "tetgen"]
        path = {"PATH": f"{self.folder}:{os.environ['PATH']}"}
        report = self.run_json(*words, "--time-limit", "200", environment=path)
        self.assertEqual((report["surface"], report["log"]), ("kept", []))
        _, err = self.run_text(*words, "--time-limit", "40", environment=path, status=3)
        self.assertIn("too long", err)


if __name__ == "__main__":
    support.main()
