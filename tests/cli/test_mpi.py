# SPDX-License-Identifier: Apache-2.0
"""Runs of several processes by mpirun: the same bytes as of one, and no half file when one dies."""
import glob
import json
import os
import shutil
import signal
import sqlite3
import time
import unittest

import support

MPIRUN = shutil.which("mpirun")
REASON = ("this build is without MPI (-DSTARGUARD_MPI=ON)"
          if os.environ.get("STARGUARD_MPI", "OFF") != "ON" else
          "there is no mpirun" if MPIRUN is None else
          "MPI's own code does not pass the sanitizers" if support.SANITIZE else None)


@unittest.skipIf(REASON, REASON)
class Ranks(support.Case):
    def launcher(self, ranks):
        return [MPIRUN, "--allow-run-as-root", "--oversubscribe", "-n", str(ranks)]

    def run_ranks(self, ranks, *words, **options):
        return self.run_text(*words, launcher=self.launcher(ranks), **options)


class Guard(Ranks):
    def test_same_bytes(self):
        model = self.sample("horse", 3000)
        for method in "pilp", "greedy":
            words = ["guard", model, "--method", method, "--coarsest", "1500", "--step", "1500",
                     "--refine-lines", "200000"]
            outputs = ["-o", "g.json", "--marks", "g.ply"]
            self.run_text(*words, *outputs)
            expected = self.read("g.json"), self.read("g.ply")
            for ranks in 1, 2, 3:
                os.remove(self.path("g.json"))
                out, _ = self.run_ranks(ranks, *words, *outputs, "--json")
                self.assertEqual((self.read("g.json"), self.read("g.ply")), expected)
                report = json.loads(out)
                if ranks == 1:
                    self.assertNotIn("ranks", report)
                    continue
                shared = report["ranks"]
                self.assertEqual(shared["count"], ranks)
                self.assertGreater(shared["helped_items"], 0)
                self.assertGreater(shared["shared_seconds"], 0)
                self.assertLess(shared["shared_seconds"], report["seconds"]["total"])

    def test_standard_input(self):
        model = self.sample("cat", 2500)
        self.run_text("guard", model, "-o", "a.json", "--method", "greedy")
        out, _ = self.run_ranks(2, "guard", "-", "-o", "-", "--method", "greedy", "--quiet",
                                input=self.read(model))
        expected = json.loads(self.read("a.json"))
        expected["model"]["file"] = "-"
        self.assertEqual(json.loads(out), expected)

    def test_what_goes_wrong_is_told_once(self):
        self.assertEqual(self.run_ranks(3, "--version")[0].count("starguard"), 1)
        _, err = self.run_ranks(3, "guard", "none.off", "-o", "g.json", status=2)
        self.assertEqual(err.count("none.off"), 1)
        _, err = self.run_ranks(2, "guard", "none.off", status=1)
        self.assertEqual(err.count("no output; add"), 1)
        self.assertEqual(self.names(), [])

    def test_other_commands(self):
        """What is not shared is done by rank 0 alone."""
        model = self.sample()
        out, _ = self.run_ranks(2, "check", model)
        self.assertEqual(out, self.run_text("check", model)[0])


def processes_of(launcher):
    """{rank: process} of what a launcher has started."""
    found = {}
    for folder in glob.glob("/proc/[0-9]*"):
        try:
            with open(f"{folder}/stat", encoding="utf-8") as file:
                parent = int(file.read().rsplit(")", 1)[1].split()[1])
            with open(f"{folder}/environ", "rb") as file:
                words = dict(entry.split(b"=", 1) for entry in file.read().split(b"\0") if b"=" in entry)
        except OSError:
            continue
        if parent == launcher and b"OMPI_COMM_WORLD_RANK" in words:
            found[int(words[b"OMPI_COMM_WORLD_RANK"])] = int(os.path.basename(folder))
    return found


def is_running(process):
    """Not gone, nor dead and waiting to be asked about."""
    try:
        with open(f"/proc/{process}/stat", encoding="utf-8") as file:
            return file.read().rsplit(")", 1)[1].split()[0] != "Z"
    except OSError:
        return False


class Death(Ranks):
    """One of the processes ends in the middle: the others go too, soon, and leave nothing."""

    def strike(self, rank, number):
        model = self.sample("horse", 30000)
        self.write("g.json", "old")
        before = self.names()
        process = self.start("guard", model, "-o", "g.json", "--visibility", "sweep",
                             launcher=self.launcher(3))
        found = {}
        while sorted(found) != [0, 1, 2] or min(map(support.processor_time, found.values())) < 1:
            self.assertIsNone(process.poll(), "it ended before one of its processes was killed")
            time.sleep(0.05)
            found = processes_of(process.pid)
        os.kill(process.pid if rank is None else found[rank], number)
        _, err = process.communicate()
        self.assertNotEqual(process.returncode, 0)
        self.assertEqual(self.read("g.json"), b"old")
        self.assertEqual(self.names(), before)
        while any(map(is_running, found.values())):
            time.sleep(0.05)
        return process.returncode, err

    def test_helper_killed(self):
        _, err = self.strike(2, signal.SIGKILL)
        self.assertIn(b"rank 2", err)

    def test_first_killed(self):
        self.strike(0, signal.SIGKILL)

    def test_first_interrupted(self):
        status, err = self.strike(0, signal.SIGINT)
        self.assertEqual(status, 130)
        self.assertIn(b"cancelled", err)

    def test_launcher_interrupted(self):
        self.strike(None, signal.SIGINT)


class Database(Ranks):
    def model(self, i):
        """A tetrahedron of its own."""
        return self.write(f"model_{i}.off", support.TETRAHEDRON.replace("1 0 0", f"{i + 1} 0 0", 1))

    def dump(self, name):
        connection = sqlite3.connect(self.path(name))
        self.assertEqual(connection.execute("PRAGMA integrity_check").fetchone(), ("ok",))
        text = "\n".join(connection.iterdump())
        connection.close()
        return text

    def test_same_contents(self):
        """Models, one that is no model, and one twice."""
        files = [self.model(i) for i in range(3)]
        files[1:1] = [self.write("bad.off", "OFF\n3 1 0\n")]
        files.append(self.write("again.off", self.read(files[0])))
        reports, dumps = [], []
        for ranks in None, 2, 3:
            self.run_text("db", "create", f"{ranks}.db")
            words = ["db", "add", f"{ranks}.db", *files, "--json"]
            out, err = (self.run_text(*words, status=3) if ranks is None else
                        self.run_ranks(ranks, *words, status=3))
            self.assertEqual(err.count("bad.off"), 1)
            report = json.loads(out)
            if ranks is not None:
                self.assertGreater(report["ranks"]["helped_items"], 0)
            reports.append([report[key] for key in ("added", "known", "refused", "files")])
            dumps.append(self.dump(f"{ranks}.db"))
        self.assertEqual(reports[0][:3], [3, 1, 1])
        self.assertEqual(reports[1:], reports[:1] * 2)
        self.assertEqual(dumps[1:], dumps[:1] * 2)

    def test_killed(self):
        """What was stored so far stays, whole, and the same command goes on from there."""
        files = [self.model(i) for i in range(14)]
        count = 14
        while count == 14: # it was done before we noticed
            if "s.db" in self.names():
                os.remove(self.path("s.db"))
            self.run_text("db", "create", "s.db")
            process = self.start("db", "add", "s.db", *files, launcher=self.launcher(2))
            while process.poll() is None and self.dump("s.db").count('INSERT INTO "model"') == 0:
                time.sleep(0.02)
            found = processes_of(process.pid)
            if 1 in found:
                os.kill(found[1], signal.SIGKILL)
            process.communicate()
            count = self.dump("s.db").count('INSERT INTO "model"')
        self.assertNotEqual(process.returncode, 0)
        self.assertGreater(count, 0)
        self.run_ranks(2, "db", "add", "s.db", *files)
        self.run_text("db", "create", "t.db")
        self.run_text("db", "add", "t.db", *files)
        self.assertEqual(self.dump("s.db"), self.dump("t.db"))


if __name__ == "__main__":
    support.main()
