# SPDX-License-Identifier: Apache-2.0
"""A collection of broken meshes: each is done or rejected, and quickly."""
import glob
import os
import resource
import unittest

import support
from support import SHARED
from writing import limit


class Nasty(support.Case):
    """Each file of the collection: done or rejected within a minute of processor time. Without STARGUARD_LONG
    a third of them are repaired, and guards are placed in another third, of few candidates."""

    def walk(self, *options, half=None):
        files = sorted(glob.glob(os.path.join(SHARED, "data", "nasty", "*")))
        if half is not None and not support.LONG:
            files = files[half::3]
        if not files:
            raise unittest.SkipTest(f"no shared data at {SHARED}")
        for file in map(os.path.abspath, files):
            with self.subTest(file=os.path.basename(file)):
                words = [options[0], file, *options[1:]]
                with self.start(*words, preexec_fn=limit(resource.RLIMIT_CPU, 60 * support.SLOWNESS)) as process:
                    _, err = process.communicate()
                self.assertIn(process.returncode, (0, 2), err)
                if process.returncode == 2:
                    self.assertTrue(err.strip())
                yield file, process.returncode

    def test_check(self):
        statuses = [status for _, status in self.walk("check")]
        self.assertIn(0, statuses)
        self.assertIn(2, statuses)

    def test_repair(self):
        for file, status in self.walk("repair", "-o", "out.off", half=0):
            if status == 0:
                self.run_text("check", "out.off")
                os.remove(self.path("out.off"))
            self.assertEqual(self.names(), [], file)

    def test_guard(self):
        fewer = [] if support.LONG else ["--count", "60", "--no-refine"]
        for file, status in self.walk("guard", "-o", "g.json", "--method", "greedy", *fewer, half=1):
            self.assertEqual("g.json" in self.names(), status == 0, file)
            if status == 0:
                os.remove(self.path("g.json"))


if __name__ == "__main__":
    support.main()
