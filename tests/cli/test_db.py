# SPDX-License-Identifier: Apache-2.0
"""The retrieval database: contract, wrong use, harm from outside, several processes at once."""
import json
import os
import re
import resource
import signal
import sqlite3
import time
import unittest

from support import SANITIZE, SLOWNESS, TETRAHEDRON, Case, main
from writing import limit

MEASURES = ["nearest_neighbour", "first_tier", "second_tier", "e_measure", "dcg"]


def box(x, y, z):
    """The surface of a box, whose measures make its content its own. Ten vertices, two of them amid faces,
    become 2,050 for its spectra; eight would become 6,146."""
    corners = [(x * (i & 1), y * (i >> 1 & 1), z * (i >> 2)) for i in range(8)]
    points = "\n".join("%r %r %r" % p for p in corners + [(x / 2, y / 2, 0), (x / 2, y / 2, z)])
    faces = [(0, 2, 8), (2, 3, 8), (3, 1, 8), (1, 0, 8), (4, 5, 9), (5, 7, 9), (7, 6, 9), (6, 4, 9),
             (0, 1, 5), (0, 5, 4), (2, 6, 7), (2, 7, 3), (0, 4, 6), (0, 6, 2), (1, 3, 7), (1, 7, 5)]
    return f"OFF\n10 16 0\n{points}\n" + "\n".join("3 %d %d %d" % f for f in faces) + "\n"


def corner(x, y, z):
    """A tetrahedron: what is described soonest, as its surface is refined the least for its spectra."""
    return f"OFF\n4 4 0\n0 0 0\n{x} 0 0\n0 {y} 0\n0 0 {z}\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 2 0 3\n"


class Database(Case):
    def corners(self, count):
        return [self.write(f"corner_{i}.off", corner(1 + i, 2 + 0.1 * i, 1)) for i in range(count)]

    def create(self, *files, name="shapes.db"):
        self.run_text("db", "create", name, "--quiet")
        if files:
            self.run_text("db", "add", name, *files, "--quiet")
        return name

    def db(self, word, *words, **options):
        out, _ = self.run_text("db", word, *words, "--json", **options)
        return json.loads(out)

    def stored(self, name="shapes.db"):
        return self.db("list", name)["models"]


class Contract(Database):
    @classmethod
    def setUpClass(cls):
        cls.cached = None

    def filled(self):
        """Three boxes and three rods, made once for all tests."""
        for i in range(3):
            self.write(f"box_{i}.off", box(1, 1.1 + 0.02 * i, 1))
            self.write(f"rod_{i}.off", box(1, 1, 8 + 0.1 * i))
        files = sorted(n for n in self.names() if n.endswith(".off"))
        if Contract.cached is None:
            self.create(*files)
            Contract.cached = self.read("shapes.db")
        self.write("shapes.db", Contract.cached)
        return "shapes.db"

    def test_list(self):
        models = self.stored(self.filled())
        self.assertEqual([m["name"] for m in models], [f"{c}_{i}.off" for c in ("box", "rod") for i in range(3)])
        self.assertEqual({m["faces"] for m in models}, {16})
        self.assertTrue(all(re.fullmatch("[0-9a-f]{64}", m["hash"]) for m in models))
        out, _ = self.run_text("db", "list", "shapes.db")
        self.assertIn("6 models", out)

    def test_query(self):
        self.filled()
        for distance in "d2", "shape-dna", "star":
            found = self.db("query", "shapes.db", "rod_1.off", "-k", "3", "--distance", distance)
            self.assertEqual(found["distance"], distance)
            self.assertEqual(found["models"][0]["name"], "rod_1.off")
            self.assertEqual(found["models"][0]["distance"], 0)
            self.assertEqual({m["name"][:3] for m in found["models"]}, {"rod"})
            distances = [m["distance"] for m in found["models"]]
            self.assertEqual(distances, sorted(distances))
        by_pipe = self.db("query", "shapes.db", "-", input=self.read("rod_1.off"))
        self.assertEqual(len(by_pipe["models"]), 6)

    def test_matrix(self):
        self.filled()
        self.run_text("db", "matrix", "shapes.db", "-o", "m.csv", "--picture", "m.png")
        rows = [line.split(",") for line in self.read("m.csv").decode().splitlines()]
        self.assertEqual(rows[0], ["model"] + [r[0] for r in rows[1:]])
        table = [[float(x) for x in r[1:]] for r in rows[1:]]
        for i in range(6):
            self.assertEqual(table[i][i], 0)
            self.assertEqual(table[i], [table[k][i] for k in range(6)])
        query = self.db("query", "shapes.db", "box_0.off")
        self.assertEqual(sorted(table[0]), [m["distance"] for m in query["models"]])
        self.assertEqual(self.read("m.png")[:8], b"\x89PNG\r\n\x1a\n")
        out, _ = self.run_bytes("db", "matrix", "shapes.db", "-o", "-")
        self.assertEqual(out, self.read("m.csv"))

    def test_evaluate(self):
        self.filled()
        result = self.db("evaluate", "shapes.db", "--classes", "by-prefix", "-o", "pr.csv",
                         "--picture", "pr.svg")
        self.assertEqual(result["format"], "starguard-db-evaluate")
        for part in result, result["classes"]["box"], result["classes"]["rod"]:
            for key in MEASURES:
                self.assertTrue(0 <= part[key] <= 1)
            self.assertEqual(part["nearest_neighbour"], 1)
            self.assertEqual(part["first_tier"], 1)
        self.assertEqual(set(result["classes"]), {"box", "rod"})
        rows = self.read("pr.csv").decode().splitlines()
        self.assertEqual(rows[0], "recall,all,box,rod")
        self.assertEqual(len(rows), 21)
        self.assertTrue(self.read("pr.svg").startswith(b"<svg"))
        self.assertIn(b">rod</text>", self.read("pr.svg"))

    def test_classes_of_a_file(self):
        self.filled()
        self.write("classes.txt", "box_0.off a\nrod_1.off a\nbox_1.off b\n")
        result = self.db("evaluate", "shapes.db", "--classes", "classes.txt")
        self.assertEqual(result["models"], 3)
        self.assertEqual(result["queries"], 2)
        self.assertEqual(result["classes"]["a"]["nearest_neighbour"], 0)
        self.assertIsNone(result["classes"]["b"]["dcg"])
        self.write("classes.txt", "unknown.off a\n")
        _, err = self.run_text("db", "evaluate", "shapes.db", "--classes", "classes.txt", status=2)
        self.assertIn("unknown.off", err)
        self.assertIn("line 1", err)

    def test_remove(self):
        self.filled()
        before = self.read("shapes.db")
        _, err = self.run_text("db", "remove", "shapes.db", "box_1.off", "cube.off", status=2)
        self.assertIn("cube.off", err)
        self.assertEqual(self.read("shapes.db"), before)
        self.run_text("db", "remove", "shapes.db", "box_1.off", "id:6")
        self.assertEqual(len(self.stored()), 4)

    def test_same_bytes(self):
        """The same models in the same order give the same results on any number of threads."""
        files = self.corners(3)
        texts = []
        for threads in "1", "4":
            self.run_text("db", "create", f"{threads}.db")
            self.run_text("db", "add", f"{threads}.db", *files, "--threads", threads)
            self.run_text("db", "matrix", f"{threads}.db", "-o", "m.csv", "--threads", threads)
            texts.append(self.read("m.csv"))
        self.assertEqual(texts[0], texts[1])


class Usage(Database):
    def test_help(self):
        for words in ("db", "--help"), ("help", "db"), ("db", "-h"):
            out, err = self.run_text(*words)
            self.assertEqual(err, "")
            for word in "create", "add", "remove", "list", "query", "matrix", "evaluate":
                self.assertRegex(out, rf"\n  {word} ")
                self.assertIn(f"starguard db {word}", self.run_text("help", "db", word)[0])
                self.assertEqual(self.run_text("db", word, "--help")[0],
                                 self.run_text("help", "db", word)[0])

    def test_wrong_words(self):
        self.usage_error("db", says="Usage")
        self.usage_error("db", "evalute", "x.db", says="did you mean 'evaluate'?")
        self.assertIn("options follow", self.run_text("db", "--json", "list", "x.db", status=1)[1])
        self.usage_error("help", "db", "lst", says="did you mean 'list'?")
        self.usage_error("db", "list", says="too few")
        self.usage_error("db", "add", "x.db", says="too few")
        self.usage_error("db", "matrix", "x.db", says="no output; add")
        self.usage_error("db", "matrix", "x.db", "-o", "x.txt", says=".csv")
        self.usage_error("db", "evaluate", "x.db", "--distance", "d3", says="did you mean 'd2'?")
        self.usage_error("db", "query", "x.db", "m.off", "-k", "0", says="from 1")

    def test_standard_input(self):
        self.create()
        _, err = self.run_text("db", "add", "shapes.db", "-", status=1)
        self.assertIn("standard input", err)


class Harm(Database):
    """Files that are none of ours, and folders that cannot be written."""

    def all_fail(self, name, says, status=2):
        self.write("m.off", TETRAHEDRON)
        before = self.read(name) if os.path.isfile(self.path(name)) else None
        for words in (("list", name), ("add", name, "m.off"), ("remove", name, "m.off"),
                      ("query", name, "m.off"), ("matrix", name, "-o", "m.csv"),
                      ("evaluate", name)):
            _, err = self.run_text("db", *words, status=status)
            self.assertIn(says, err)
        self.assertEqual(before, self.read(name) if before is not None else None)
        self.assertNotIn("m.csv", self.names())

    def test_missing(self):
        self.all_fail("none.db", "starguard db create")

    def test_no_database(self):
        self.write("text.db", "nothing of the kind " * 100)
        self.all_fail("text.db", "not a starguard database")
        self.write("empty.db", "")
        self.all_fail("empty.db", "not a starguard database")
        sqlite3.connect(self.path("foreign.db")).executescript("CREATE TABLE x (y); INSERT INTO x VALUES (1)")
        self.all_fail("foreign.db", "not a starguard database")

    def test_other_versions(self):
        for version, says in (0, "create a new one"), (9, "newer"):
            name = self.create(name=f"v{version}.db")
            sqlite3.connect(self.path(name)).execute(f"PRAGMA user_version = {version}").connection.commit()
            self.all_fail(name, says)

    def test_exists(self):
        self.write("mine.txt", "precious")
        _, err = self.run_text("db", "create", "mine.txt", status=3)
        self.assertIn("already exists", err)
        self.assertEqual(self.read("mine.txt"), b"precious")
        self.assertEqual(self.names(), ["mine.txt"])

    def test_empty(self):
        self.create()
        self.assertEqual(self.stored(), [])
        self.write("m.off", TETRAHEDRON)
        self.assertEqual(self.db("query", "shapes.db", "m.off")["models"], [])
        for words in ("matrix", "shapes.db", "-o", "m.csv"), ("evaluate", "shapes.db"):
            _, err = self.run_text("db", *words, status=2)
            self.assertIn("has no models", err)
        self.assertNotIn("m.csv", self.names())

    def test_bad_files(self):
        """Bad files are told of at the end, the others are stored."""
        good = self.corners(2)
        self.write("bad.off", "OFF\n3 1 0\n")
        self.write("flat.off", "OFF\n3 1 0\n1 1 1\n1 1 1\n1 1 1\n3 0 1 2\n")
        self.create()
        out, err = self.run_text("db", "add", "shapes.db", good[0], "bad.off", "none.off", "flat.off",
                                 good[1], good[0], status=3)
        self.assertIn("2 added, 1 already stored, 3 refused", out)
        for name in "bad.off", "none.off":
            self.assertIn(name, err)
        self.assertEqual(len(self.stored()), 2)
        result = self.db("add", "shapes.db", "bad.off", good[1], status=3)
        self.assertEqual([f["outcome"] for f in result["files"]], ["refused", "known"])

    @unittest.skipIf(os.geteuid() == 0, "root may write everything")
    def test_read_only(self):
        name = self.create(*self.corners(1))
        os.chmod(self.folder, 0o555)
        self.addCleanup(os.chmod, self.folder, 0o755)
        self.assertEqual(len(self.stored()), 1)
        _, err = self.run_text("db", "remove", name, "corner_0.off", status=3)
        self.assertIn("writable", err)
        self.run_text("db", "create", "new.db", status=3)

    def test_no_folder(self):
        self.run_text("db", "create", "nowhere/new.db", status=3)

    @unittest.skipIf(SANITIZE == "thread", "the sanitizer writes a file of its own")
    def test_disk_full(self):
        """A limit on the size of files stands for a full disk: nothing is stored, nothing harmed."""
        name = self.create()
        files = self.corners(4)
        size = len(self.read(name))
        self.run_text("db", "add", name, *files, status=3, preexec_fn=limit(resource.RLIMIT_FSIZE, size))
        self.assertEqual(self.stored(), [])
        self.run_text("db", "add", name, *files[:2])
        self.assertEqual(len(self.stored()), 2)


class Several(Database):
    def whole(self, name="shapes.db"):
        """Is every stored model stored whole? How many there are."""
        connection = sqlite3.connect(self.path(name))
        self.assertEqual(connection.execute("PRAGMA integrity_check").fetchone(), ("ok",))
        models = connection.execute("SELECT count(*) FROM model").fetchone()[0]
        kinds = connection.execute("SELECT count(DISTINCT kind) FROM signature").fetchone()[0]
        signatures = connection.execute("SELECT count(*) FROM signature").fetchone()[0]
        connection.close()
        self.assertEqual(signatures, models * kinds)
        return models

    def count(self):
        connection = sqlite3.connect(self.path("shapes.db"), timeout=60)
        models = connection.execute("SELECT count(*) FROM model").fetchone()[0]
        connection.close()
        return models

    def test_killed(self):
        """Killed at several moments of adding: the file stays in order, and adding goes on."""
        files = self.corners(12)
        self.create()
        for wanted in 0, 1, 1, 5:
            count = 12
            while count == 12: # it was done before we noticed
                if self.count() == 12:
                    os.remove(self.path("shapes.db"))
                    self.create()
                process = self.start("db", "add", "shapes.db", *files, "--threads", "2")
                while self.count() < wanted and process.poll() is None:
                    time.sleep(0.01)
                process.kill()
                process.communicate()
                count = self.whole()
            self.assertGreaterEqual(count, wanted)
            self.assertEqual([m["name"] for m in sorted(self.stored(), key=lambda m: m["id"])],
                             files[:count])
        self.run_text("db", "add", "shapes.db", *files)
        self.assertEqual(self.whole(), 12)

    def test_killed_while_writing(self):
        """A journal that a dead writer left behind is played back."""
        self.create(*self.corners(3))
        script = ("import os, sqlite3, sys\n"
                  "c = sqlite3.connect(sys.argv[1])\n"
                  "c.execute('PRAGMA cache_size = 1')\n"
                  "c.execute('BEGIN IMMEDIATE')\n"
                  "c.execute('DELETE FROM signature')\n"
                  "c.execute('DELETE FROM model')\n"
                  "c.execute('CREATE TABLE big (x)')\n"
                  "c.executemany('INSERT INTO big VALUES (?)', [('x' * 3000,)] * 100)\n"
                  "os.kill(os.getpid(), 9)\n")
        self.write("die.py", script)
        os.system(f"/usr/bin/python3 {self.path('die.py')} {self.path('shapes.db')} 2>/dev/null")
        self.assertIn("shapes.db-journal", self.names())
        self.assertEqual(len(self.stored()), 3)
        self.assertEqual(self.whole(), 3)

    def test_interrupted(self):
        files = self.corners(10)
        count = 10
        while count == 10: # it was done before we noticed
            if "shapes.db" in self.names():
                os.remove(self.path("shapes.db"))
            self.create()
            process = self.start("db", "add", "shapes.db", *files, "--threads", "2")
            while self.count() < 1 and process.poll() is None:
                time.sleep(0.01)
            process.send_signal(signal.SIGINT)
            process.communicate()
            count = self.whole()
        self.assertEqual(process.returncode, 130)
        self.assertGreaterEqual(count, 1)

    def test_two_writers(self):
        """Two processes add at once, some models both: nothing is lost, nothing is double."""
        files = self.corners(6)
        self.create()
        first = self.start("db", "add", "shapes.db", *files[:4], "--json")
        second = self.start("db", "add", "shapes.db", *files[2:], "--json")
        reports = []
        for process in first, second:
            out, err = process.communicate()
            self.assertEqual(process.returncode, 0, err)
            reports.append(json.loads(out))
        self.assertEqual(sum(r["added"] for r in reports), 6)
        self.assertEqual(sum(r["known"] for r in reports), 2)
        self.assertEqual(self.whole(), 6)
        self.assertEqual(sorted(m["name"] for m in self.stored()), sorted(files))

    def test_waits_for_a_writer(self):
        name = self.create()
        self.write("m.off", TETRAHEDRON)
        holder = sqlite3.connect(self.path(name), isolation_level=None)
        holder.execute("BEGIN IMMEDIATE")
        process = self.start("db", "add", name, "m.off")
        time.sleep(2 * SLOWNESS)
        self.assertIsNone(process.poll())
        holder.execute("COMMIT")
        holder.close()
        process.communicate()
        self.assertEqual(process.returncode, 0)
        self.assertEqual(len(self.stored()), 1)


if __name__ == "__main__":
    main()
