"""Killed at any moment (docs/robustness.md): outputs are there whole or not at all, databases stay in
order, and what is left behind is in nobody's way. 6 kills of each command, with STARGUARD_LONG=1 200."""
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

KILLS = 200 if LONG else 6


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
        files = [f"m_{i}.off" for i in range(3)]
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


if __name__ == "__main__":
    support.main()
