# SPDX-License-Identifier: Apache-2.0
"""Killed at any moment (docs/robustness.md): outputs are there whole or not at all, databases stay in
order, and what is left behind is in nobody's way. 3 kills of each command, with STARGUARD_LONG=1 200."""
import collections
import json
import os
import random
import signal
import sqlite3
import subprocess
import time

import support
from support import PROGRAM, TETRAHEDRON
from writing import LONG, Writing, is_leftover

KILLS = 200 if LONG else 3


class Killed(Writing):
    """SIGKILL at random moments of each command that writes."""

    def kill_at(self, moment, words):
        """How long it ran if it ended before, else None: it was killed."""
        began = time.monotonic()
        with self.start(*words, "--threads", "1", "--quiet") as process:
            try:
                process.wait(timeout=moment)
            except subprocess.TimeoutExpired:
                pass
            took = time.monotonic() - began
            process.kill()
            process.communicate()
        return None if process.returncode == -signal.SIGKILL else took

    def kills(self, name, took, words, prepare):
        """Yields after each run, until KILLS of them were killed. Half of the moments are anywhere, half
        near the end, where files are written; how long it takes is believed of the last run that ended."""
        choice, killed, runs = random.Random(f"kills of {name}"), 0, 0
        while killed < KILLS:
            prepare(runs)
            moment = choice.uniform(0, took) if runs % 2 else choice.uniform(0.8 * took, 1.1 * took)
            ended = self.kill_at(moment, words)
            killed, took, runs = killed + (ended is None), ended or took, runs + 1
            yield runs

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
        print(f"{'command':12} {'seconds':>8} {'kills':>6} {'runs':>6} {'nothing':>8} {'all':>6} {'some':>6} "
              f"{'leftovers':>10}")
        for name, words, outputs in self.commands():
            with self.subTest(command=name):
                wanted, took = self.reference(name, words, outputs)
                self.check_kills(name, words, outputs, wanted, took)

    def check_kills(self, name, words, outputs, wanted, took):
        old, counts = None, collections.Counter()

        def prepare(run):
            nonlocal old
            self.clear(outputs)
            old = b"old" if run % 3 == 0 and "/" not in outputs[0] else None
            for output in outputs if old else ():
                self.write(output, old)

        for _ in self.kills(name, took, words, prepare):
            there = self.check_whole(outputs, old, wanted)
            counts[{0: "nothing", len(outputs): "all"}.get(there, "some")] += 1
            strange = [n for n in self.names() if n not in self.made and n not in outputs
                       and n != "frames" and not is_leftover(n)]
            self.assertEqual(strange, [])
        left = len(self.leftovers())
        self.run_bytes(*words, "--quiet")  # what was left does not matter
        self.assertEqual(self.check_whole(outputs, None, wanted), len(outputs))
        self.clear(outputs)
        for leftover in self.leftovers():
            os.remove(self.path(leftover))
        print(f"{name:12} {took:8.2f} {KILLS:6} {counts.total():6} {counts['nothing']:8} {counts['all']:6} "
              f"{counts['some']:6} {left:10}")

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
        files = [f"m_{i}.off" for i in range(3)]
        for i, file in enumerate(files):
            self.write(file, TETRAHEDRON.replace("0 0 1\n", f"0 {0.01 * i} 1\n"))
        self.run_text("db", "create", "empty.db")
        empty = self.read("empty.db")
        words = ["db", "add", "a.db", *files]

        def prepare(_run):
            self.write("a.db", empty)
            if os.path.exists(self.path("a.db-journal")):
                os.remove(self.path("a.db-journal"))

        prepare(0)
        began = time.monotonic()
        self.run_text(*words, "--threads", "1")
        took, stored = time.monotonic() - began, []
        for _ in self.kills("db add", took, words, prepare):
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
        for _ in self.kills("db remove", 0.03, ["db", "remove", "shapes.db", "ball.off"],
                            lambda _run: self.write("shapes.db", before)):
            self.run_text("db", "list", "shapes.db")
            self.assertIn(self.whole("shapes.db"), ([], ["ball.off"]))

    def test_database_create(self):
        def prepare(_run):
            if os.path.exists(self.path("new.db")):
                os.remove(self.path("new.db"))

        made = 0
        for runs in self.kills("db create", 0.04, ["db", "create", "new.db"], prepare):
            if os.path.exists(self.path("new.db")):
                made += 1
                self.assertEqual(self.whole("new.db"), [])
        print(f"db create: made {made} of {runs} times")
        prepare(runs)
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


if __name__ == "__main__":
    support.main()
