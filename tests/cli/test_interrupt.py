# SPDX-License-Identifier: Apache-2.0
"""Signals, time limits, and results that do not depend on the locale."""
import json
import os
import signal
import time

import support
from support import SLOWNESS, processor_time, processor_time_of_ended


class Interrupt(support.Case):
    """The sweep on a large sample runs for minutes if nobody stops it."""

    def setUp(self):
        super().setUp()
        self.model = self.sample("horse", 30000)

    def interrupt(self, number, *words):
        names = self.names()
        with self.start("guard", self.model, "--visibility", "sweep", "--threads", "1", *words) as process:
            self.wait_for_work(process, 0.5)
            before = processor_time_of_ended() + processor_time(process.pid)
            process.send_signal(number)
            out, err = process.communicate()
        self.assertEqual(process.returncode, 130, err)
        self.assertLess(processor_time_of_ended() - before, 2 * SLOWNESS)
        self.assertEqual(self.names(), names)
        return out, err

    def test_interrupt(self):
        self.write("g.json", "old")
        _, err = self.interrupt(signal.SIGINT, "-o", "g.json", "--marks", "g.ply")
        self.assertIn(b"cancelled", err)
        self.assertEqual(self.read("g.json"), b"old")

    def test_terminate(self):
        self.interrupt(signal.SIGTERM, "-o", "g.json")
        self.interrupt(signal.SIGHUP, "-o", "g.json")

    def test_json(self):
        out, _ = self.interrupt(signal.SIGINT, "-o", "g.json", "--json")
        self.assertEqual(json.loads(out)["error"]["status"], "cancelled")

    def test_to_standard_output(self):
        out, _ = self.interrupt(signal.SIGINT, "-o", "-")
        self.assertEqual(out, b"")

    def test_waiting_for_input(self):
        ends = os.pipe()
        with self.start("check", "-", stdin=ends[0]) as process:
            self.wait_for_sleep(process)
            process.send_signal(signal.SIGINT)
            process.communicate()
        os.close(ends[0])
        os.close(ends[1])
        self.assertEqual(process.returncode, 130)


class KeepBest(support.Case):
    """The first interrupt ends a search, the second one everything."""

    def interrupt(self, words, times):
        with self.start(*words, "--keep-best", "--threads", "1") as process:
            self.wait_for_work(process, 0.5)
            for _ in range(times):
                process.send_signal(signal.SIGINT)
                time.sleep(0.05)
            out, err = process.communicate()
        return process.returncode, out.decode(), err.decode()

    def test_guard(self):
        model = self.sample("horse", 10000)
        status, out, err = self.interrupt(("guard", model, "-o", "g.json", "--prove"), 1)
        self.assertEqual((status, err), (0, ""))
        self.assertIn("interrupted", out)
        self.assertTrue(json.loads(self.read("g.json"))["time_limited"])
        self.run_text("verify", model, "g.json")

    def test_decompose(self):
        model = self.sample("horse", 2000)
        status, out, _ = self.interrupt(("decompose", model, "-o", "p.vtk", "--effort", "best"), 1)
        self.assertEqual(status, 0)
        self.assertIn("interrupted", out)
        self.run_text("verify", model, "p.vtk")

    def test_twice(self):
        model = self.sample("horse", 30000)
        status, _, err = self.interrupt(("guard", model, "--visibility", "sweep", "-o", "g.json"), 2)
        self.assertEqual(status, 130)
        self.assertIn("cancelled", err)
        self.assertNotIn("g.json", self.names())


class TimeLimit(support.Case):
    def test_nothing_found(self):
        model = self.sample("horse", 30000)
        names = self.names()
        before = processor_time_of_ended()
        _, err = self.run_text("guard", model, "-o", "g.json", "--time-limit", "0.05", "--threads", "1",
                               status=3)
        self.assertIn("time limit", err)
        self.assertLess(processor_time_of_ended() - before, (1.05 * 0.05 + 2) * SLOWNESS)
        self.assertEqual(self.names(), names)

    def test_something_found(self):
        """Once there is the time to make candidates: how much that is differs from machine to machine."""
        model = self.sample("horse", 10000)
        limit = 1
        while "g.json" not in self.names():
            limit *= 2
            before = processor_time_of_ended()
            with self.start("guard", model, "-o", "g.json", "--visibility", "sweep", "--time-limit",
                            str(limit), "--threads", "1") as process:
                out, err = process.communicate()
            self.assertLess(processor_time_of_ended() - before, 1.05 * limit + 2 * SLOWNESS)
            self.assertIn(b"time limit", out + err)
            self.assertEqual(process.returncode, 0 if "g.json" in self.names() else 3)
        self.run_text("verify", model, "g.json")

    def test_enough(self):
        model = self.sample("l-room")
        self.run_text("guard", model, "-o", "a.json")
        self.run_text("guard", model, "-o", "b.json", "--time-limit", "600")
        self.assertEqual(self.read("a.json"), self.read("b.json"))


class SameBytes(support.Case):
    """For threads see test_determinism."""

    def test_locale(self):
        """A locale with a decimal comma changes nothing."""
        model = self.sample("l-room")
        self.run_text("guard", model, "-o", "a.json")
        self.run_text("guard", model, "-o", "b.json", "--coverage", "1.0",
                      environment={"LC_ALL": "de_DE.UTF-8"})
        self.assertEqual(self.read("a.json"), self.read("b.json"))


if __name__ == "__main__":
    support.main()
